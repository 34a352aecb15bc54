// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "apps/kilter/own_files.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <system_error>

#include "kilter/io/archive_format.h"
#include "kilter/io/file.h"
#include "kilter/io/random_access_file.h"

namespace kilter::app {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 1> kMarksOfArchive = {archive_format::kMagic};
constexpr std::array<std::string_view, 1> kMarksOfMap = {"\ncomment map "};

// Nothing is lost with a link or an empty file.
bool is_in_the_way(const fs::path& path) {
  std::error_code error;
  const fs::file_type found = fs::symlink_status(path, error).type();
  if (found == fs::file_type::not_found || found == fs::file_type::symlink) return false;
  return found != fs::file_type::regular || fs::file_size(path, error) != 0;
}

Expected<ByteBuffer> read_head(const fs::path& path) {
  constexpr std::uint64_t kMostBytes = 4096;
  const Expected<RandomAccessFile> file = RandomAccessFile::open(path);
  if (!file) return pass_up(file.error());
  return file->read(0, std::min(file->size(), kMostBytes));
}

bool head_holds(const fs::path& path, std::span<const std::string_view> marks) {
  const Expected<ByteBuffer> head = read_head(path);
  return head && std::any_of(marks.begin(), marks.end(),
                             [&](std::string_view mark) { return head->view().find(mark) != std::string_view::npos; });
}

// `"schema": "kilter.result/1"`, of any version and however it is spaced.
bool names_our_schema(std::string_view json) {
  constexpr std::string_view kKey = "\"schema\"";
  constexpr std::string_view kSpace = " \t\r\n";
  const auto pass_space = [&] { json.remove_prefix(std::min(json.find_first_not_of(kSpace), json.size())); };
  for (std::size_t at = json.find(kKey); at != std::string_view::npos; at = json.find(kKey)) {
    json.remove_prefix(at + kKey.size());
    pass_space();
    if (!json.starts_with(':')) continue;
    json.remove_prefix(1);
    pass_space();
    if (json.starts_with("\"kilter.result/")) return true;
  }
  return false;
}

// In all of the file: who sorts its keys finds the schema after the pairs.
bool is_result(const fs::path& path) {
  const Expected<ByteBuffer> json = read_file(path);
  return json && names_our_schema(json->view());
}

tl::unexpected<Error> refuse(const fs::path& path, const std::string& what, const std::string& other) {
  const Expected<ByteBuffer> head = read_head(path);
  return fail(ErrorCode::kUsage, "there is a file already, and it " + (head ? what : head.error().message), shown(path),
              "name another " + other + " with -o, or move it away");
}

}  // namespace

Expected<void> check_replaceable(const fs::path& file, std::span<const std::string_view> marks) {
  if (!is_in_the_way(file) || head_holds(file, marks)) return {};
  return refuse(file, "is not one that this command wrote", "file");
}

Expected<void> check_results_replaceable(const fs::path& folder, const std::vector<fs::path>& names) {
  const fs::path json = folder / "result.json";
  const bool has_result = is_result(json);
  if (is_in_the_way(json) && !has_result) return refuse(json, "is no result of kilter's", "folder");
  const bool is_ours = has_result || head_holds(folder / "result.kilter", kMarksOfArchive) ||
                       head_holds(folder / "report.html", kMarksOfReport);
  for (const fs::path& name : names) {
    const fs::path path = folder / name;
    if (!is_in_the_way(path)) continue;
    if (name.has_parent_path()) {
      if (head_holds(fs::path(path).replace_extension(".ply"), kMarksOfMap)) continue;
      return refuse(path, "is no map of kilter's", "folder");
    }
    if (is_ours) continue;
    return refuse(path, "has no result of kilter's beside it that says whose it is", "folder");
  }
  return {};
}

}  // namespace kilter::app
