// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/cuts.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "kilter/io/file.h"
#include "kilter/io/result_file.h"

namespace kilter {
namespace {

using nlohmann::json;

// Submaps lie in a list in the root, their poses one deeper.
constexpr int kMaxDepth = 32;

// Keeps `last + 1` from wrapping; a robot that scans at 10 Hz would take three years.
constexpr std::uint64_t kMaxScan = 1'000'000'000;

constexpr const char* kTakes = "--cuts takes the output folder of `kilter check`, or its result.json";

// Builds only the keys of interest, so that the thousands of pairs in a large result cost no memory.
Expected<json> parse_root(std::string_view text, const std::string& where) {
  bool too_deep = false;
  const auto keep = [&](int depth, json::parse_event_t event, json& value) {
    if (depth > kMaxDepth) {
      too_deep = true;
      return false;
    }
    const bool root_key = depth == 1 && event == json::parse_event_t::key;
    return !root_key || value == "schema" || value == "submaps" || value == "run" || value == "config";
  };
  try {
    json root = json::parse(text.begin(), text.end(), keep);
    if (!too_deep) return root;
    return fail(ErrorCode::kParse, fmt::format("the JSON is nested more than {} deep", kMaxDepth), where);
  } catch (const json::parse_error& error) {
    return fail(ErrorCode::kParse, fmt::format("not valid JSON at byte {}", error.byte), where, kTakes);
  } catch (const json::exception&) {
    return fail(ErrorCode::kParse, "not valid JSON: a number is too large", where, kTakes);
  }
}

const json* find(const json& object, const char* key) {
  if (!object.is_object()) return nullptr;
  const auto found = object.find(key);
  return found == object.end() ? nullptr : &*found;
}

Expected<void> check_schema(const json& root, const std::string& where) {
  const json* schema = find(root, "schema");
  if (schema == nullptr || !schema->is_string()) {
    return fail(ErrorCode::kParse, "expected a key \"schema\": this is no result of kilter", where, kTakes);
  }
  if (*schema == "kilter.result/1") return {};
  return fail(
      ErrorCode::kUnsupported,
      fmt::format("schema \"{}\"; kilter.result/1 is read", printable(schema->get_ref<const std::string&>(), 60)),
      where);
}

// first_scan or last_scan.
Expected<std::size_t> scan_number(const json& submap, const char* key, const std::string& where) {
  const json* value = find(submap, key);
  if (value != nullptr && value->is_null()) {
    return fail(ErrorCode::kUnsupported, fmt::format("{} is null: finished submaps have no scans to cut at", key),
                where);
  }
  if (value == nullptr || !value->is_number_unsigned() || value->get<std::uint64_t>() > kMaxScan) {
    return fail(ErrorCode::kParse, fmt::format("expected {} to be a whole number from 0 to {}", key, kMaxScan), where);
  }
  return value->get<std::size_t>();
}

Expected<void> append_range(std::vector<ScanRange>& ranges, ScanRange range, const std::string& where) {
  const std::size_t expected = ranges.empty() ? 0 : ranges.back().last + 1;
  if (range.first != expected || range.last < range.first) {
    return fail(ErrorCode::kParse,
                fmt::format("scans {} to {}: expected a range that begins at scan {}, after the robot's one before",
                            range.first, range.last, expected),
                where);
  }
  ranges.push_back(range);
  return {};
}

Expected<void> add_submap(const json& submap, const std::string& where, Cuts& cuts) {
  const json* robot = find(submap, "robot");
  if (robot == nullptr || !robot->is_string()) {
    return fail(ErrorCode::kParse, "expected a key \"robot\" with a name", where);
  }
  const auto first = scan_number(submap, "first_scan", where);
  if (!first) return pass_up(first.error());
  const auto last = scan_number(submap, "last_scan", where);
  if (!last) return pass_up(last.error());
  return append_range(cuts[robot->get<std::string>()], {*first, *last}, where);
}

struct ResultText {
  std::string where;
  ByteBuffer bytes;
};

Expected<ResultText> text_of_result(const std::filesystem::path& result) {
  const auto file = find_result_file(result, "result.json", kTakes);
  if (!file) return pass_up(file.error());
  auto bytes = read_file(*file);
  if (!bytes) return pass_up(bytes.error());
  return ResultText{shown(*file), *std::move(bytes)};
}

Expected<json> root_of_result(const std::filesystem::path& result) {
  const auto text = text_of_result(result);
  if (!text) return pass_up(text.error());
  return parse_root(text->bytes.view(), text->where);
}

}  // namespace

Expected<Cuts> parse_cuts(std::string_view json_text, const std::string& where) {
  const Expected<json> root = parse_root(json_text, where);
  if (!root) return pass_up(root.error());
  if (auto ok = check_schema(*root, where); !ok) return pass_up(ok.error());
  const json* submaps = find(*root, "submaps");
  if (submaps == nullptr || !submaps->is_array()) {
    return fail(ErrorCode::kParse, "expected a key \"submaps\" with a list", where);
  }
  Cuts cuts;
  std::size_t index = 0;
  for (const json& submap : *submaps) {
    const std::string place = fmt::format("{}: submaps[{}]", where, index++);
    if (auto added = add_submap(submap, place, cuts); !added) return pass_up(added.error());
  }
  if (cuts.empty()) return fail(ErrorCode::kEmptyInput, "the result holds no submap", where);
  return cuts;
}

std::map<std::string, double> config_numbers_of_result(const std::filesystem::path& result,
                                                       std::span<const std::string_view> keys) {
  std::map<std::string, double> numbers;
  const Expected<json> root = root_of_result(result);
  const json* config = root ? find(*root, "config") : nullptr;
  for (const std::string_view key : keys) {
    const json* value = config != nullptr ? find(*config, std::string(key).c_str()) : nullptr;
    if (value != nullptr && value->is_number()) numbers.emplace(key, value->get<double>());
  }
  return numbers;
}

std::optional<std::string> poses_of_result(const std::filesystem::path& result) {
  const Expected<json> root = root_of_result(result);
  const json* run = root ? find(*root, "run") : nullptr;
  const json* poses = run != nullptr ? find(*run, "poses") : nullptr;
  if (poses == nullptr || !poses->is_string()) return std::nullopt;
  return poses->get<std::string>();
}

Expected<Cuts> read_cuts(const std::filesystem::path& result) {
  const auto text = text_of_result(result);
  if (!text) return pass_up(text.error());
  return parse_cuts(text->bytes.view(), text->where);
}

}  // namespace kilter
