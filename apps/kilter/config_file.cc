// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "apps/kilter/settings.h"

#include <algorithm>
#include <charconv>
#include <optional>

#include <fmt/format.h>

// NOLINTBEGIN(readability-identifier-naming,cppcoreguidelines-macro-usage): the library reads these names
#define TOML_EXCEPTIONS 0
#define TOML_ENABLE_FORMATTERS 0
// Its parser asserts what it answers with an error a line later, and would stop on a mistyped list.
#define TOML_ASSERT(condition) static_cast<void>(0)
// NOLINTEND(readability-identifier-naming,cppcoreguidelines-macro-usage)
#include <toml++/toml.h>

#include "kilter/io/byte_cursor.h"
#include "kilter/io/file.h"

namespace kilter::app {
namespace {

constexpr std::uint64_t kMaxConfigBytes = 1 << 20;

Expected<Pose3> pose_from_node(const toml::node& node) {
  if (const auto* text = node.as_string()) return parse_pose(text->get());
  const toml::array* list = node.as_array();
  if (list == nullptr) {
    return fail(ErrorCode::kConfig, fmt::format("{}: expected a list of seven numbers or a text", kSensorKey));
  }
  std::vector<double> numbers;
  for (const toml::node& item : *list) {
    const std::optional<double> number = item.value<double>();
    if (!number || !item.is_number()) {
      return fail(ErrorCode::kConfig, fmt::format("{}: expected numbers only in the list", kSensorKey));
    }
    numbers.push_back(*number);
  }
  return pose_from_numbers(numbers);
}

Expected<void> set_sensor(Settings& settings, const std::string& robot, const toml::node& node) {
  const Expected<Pose3> pose = pose_from_node(node);
  if (!pose) return pass_up(pose.error());
  settings.T_body_sensor[robot] = *pose;
  return {};
}

Expected<void> set_from_node(Settings& settings, std::string_view key, const toml::node& node) {
  const Expected<OptionField> option = find_option(settings, key);
  if (!option) return pass_up(option.error());
  if (const auto* text = node.as_string()) return option->assign(text->get());
  if (const auto* flag = node.as_boolean()) return option->assign(flag->get() ? "true" : "false");
  if (const auto* whole = node.as_integer()) return option->assign_number(static_cast<double>(whole->get()));
  if (const auto* real = node.as_floating_point()) return option->assign_number(real->get());
  return fail(ErrorCode::kConfig, fmt::format("{}: expected a number, a text or true or false", option->name));
}

std::string place(const std::string& file, const toml::source_region& source) {
  return fmt::format("{}:{}", file, source.begin.line);
}

Expected<void> located(Expected<void> done, const std::string& file, const toml::node& node) {
  if (!done) done.error().where = place(file, node.source());
  return done;
}

bool is_ascii(char c) { return static_cast<unsigned char>(c) <= 0x7F; }

struct LineParts {
  std::string_view before_comment;  // a # between quotes begins none
  bool plain_is_ascii = true;       // what of it stands outside quotes
};

LineParts parts_of(std::string_view line) {
  char quote = '\0';
  bool plain_is_ascii = true;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (quote == '\0' && line[i] == '#') return {line.substr(0, i), plain_is_ascii};
    if (quote == '"' && line[i] == '\\') {
      ++i;
    } else if (line[i] == quote) {
      quote = '\0';
    } else if (quote == '\0') {
      if (line[i] == '"' || line[i] == '\'') quote = line[i];
      plain_is_ascii = plain_is_ascii && is_ascii(line[i]);
    }
  }
  return {line, plain_is_ascii};
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r";
  text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
  return text.substr(0, text.find_last_not_of(kBlanks) + 1);
}

// What was most likely meant by a line that is no TOML: a value that has to be in quotes, or another sign than =. Empty
// where that is no guess.
std::string meant_by(std::string_view line) {
  line = trimmed(parts_of(line).before_comment);
  constexpr std::string_view kOfKeys = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.";
  const std::string_view key = line.substr(0, line.find_first_not_of(kOfKeys));
  std::string_view value = trimmed(line.substr(key.size()));
  const bool has_equals = value.starts_with('=');
  if (key.empty() || value.empty()) return {};
  if (has_equals || value.starts_with(':')) value = trimmed(value.substr(1));
  constexpr std::string_view kOfValues = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.+-% ";
  if (value.empty() || value.find_first_not_of(kOfValues) != std::string_view::npos) return {};
  double number = 0.0;
  const auto [end, status] = std::from_chars(value.data(), value.data() + value.size(), number);
  const bool is_bare =
      (status == std::errc() && end == value.data() + value.size()) || value == "true" || value == "false";
  if (is_bare) return has_equals ? std::string() : fmt::format("use =: {} = {}", key, value);
  return fmt::format("{}: {} = \"{}\"", has_equals ? "quote it" : "use = and quotes", key, value);
}

std::string_view line_of(std::string_view text, std::size_t number) {
  ByteCursor lines(without_byte_order_mark(text));
  while (const std::optional<std::string_view> line = lines.take_line()) {
    if (lines.line() == number) return *line;
  }
  return {};
}

// What toml++ has no answer to: it walks down a dotted key by calling itself, so that a.a.a.a... would end the stack,
// and looks some characters beyond ASCII up in a table that does not have them, unless they stand in quotes.
Expected<void> check_text(std::string_view text, const std::string& where) {
  constexpr std::ptrdiff_t kMostDots = 1000;
  // Texts of several lines may hold anything that looks like a comment, and end in it; nobody needs one here.
  const bool has_long_texts =
      text.find("\"\"\"") != std::string_view::npos || text.find("'''") != std::string_view::npos;
  ByteCursor lines(without_byte_order_mark(text));
  while (const std::optional<std::string_view> line = lines.take_line()) {
    const auto [before_comment, plain_is_ascii] = parts_of(*line);
    const std::string_view said = has_long_texts ? *line : before_comment;
    const std::string at = fmt::format("{}:{}", where, lines.line());
    if (const auto dots = std::count(said.begin(), said.end(), '.'); dots > kMostDots) {
      return fail(ErrorCode::kConfig, fmt::format("expected at most {} dots in a line, found {}", kMostDots, dots), at);
    }
    if (has_long_texts ? !std::all_of(said.begin(), said.end(), is_ascii) : !plain_is_ascii) {
      return fail(ErrorCode::kConfig, "expected ASCII outside quotes and comments, found other characters", at,
                  "a robot of such a name stands in quotes: T_body_sensor.\"NAME\" = \"x y z qx qy qz qw\"");
    }
  }
  return {};
}

}  // namespace

Expected<void> apply_config_text(std::string_view text, const std::string& where, Settings& settings) {
  if (auto fit = check_text(text, where); !fit) return fit;
  const toml::parse_result parsed = toml::parse(text);
  if (!parsed) {
    const toml::source_region& source = parsed.error().source();
    return fail(ErrorCode::kConfig, printable(parsed.error().description()), place(where, source),
                printable(meant_by(line_of(text, source.begin.line))));
  }
  for (const auto& [key, node] : parsed.table()) {
    if (key.str() != kSensorKey) {
      if (auto done = located(set_from_node(settings, key.str(), node), where, node); !done) return done;
      continue;
    }
    const toml::table* by_robot = node.as_table();
    if (by_robot == nullptr) {
      if (auto done = located(set_sensor(settings, "", node), where, node); !done) return done;
      continue;
    }
    for (const auto& [robot, pose] : *by_robot) {
      if (auto done = located(set_sensor(settings, std::string(robot.str()), pose), where, pose); !done) return done;
    }
  }
  return {};
}

Expected<void> apply_config_file(const std::filesystem::path& file, Settings& settings) {
  const Expected<ByteBuffer> bytes = read_file(file, kMaxConfigBytes);
  // A configuration that cannot be read is the command line's mistake, not the mission's.
  if (!bytes) return fail(ErrorCode::kConfig, bytes.error().message, bytes.error().where);
  return apply_config_text(bytes->view(), shown(file), settings);
}

}  // namespace kilter::app
