// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "apps/kilter/own_files.h"

#include <array>
#include <fstream>
#include <string>
#include <system_error>

#include "kilter/io/archive_format.h"
#include "kilter/io/file.h"

namespace kilter::app {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMarkOfResult = "\"kilter.result/";  // of any version
constexpr std::string_view kMarkOfMap = "\ncomment map ";

// Nothing is lost with a link or an empty file.
bool is_in_the_way(const fs::path& path) {
  std::error_code error;
  const fs::file_type found = fs::symlink_status(path, error).type();
  if (found == fs::file_type::not_found || found == fs::file_type::symlink) return false;
  return found != fs::file_type::regular || fs::file_size(path, error) != 0;
}

bool head_holds(const fs::path& path, std::string_view mark) {
  if (!is_file(path)) return false;
  std::array<char, 4096> head{};
  std::ifstream file(path, std::ios::binary);
  file.read(head.data(), head.size());
  return std::string_view(head.data(), static_cast<std::size_t>(file.gcount())).find(mark) != std::string_view::npos;
}

tl::unexpected<Error> refuse(const fs::path& path, const std::string& message, const std::string& other) {
  return fail(ErrorCode::kUsage, message, shown(path), "name another " + other + " with -o, or move it away");
}

}  // namespace

Expected<void> check_replaceable(const fs::path& file, std::string_view mark) {
  if (!is_in_the_way(file) || head_holds(file, mark)) return {};
  return refuse(file, "there is a file already, and it is not one that this command wrote", "file");
}

Expected<void> check_results_replaceable(const fs::path& folder, const std::vector<fs::path>& names) {
  const fs::path result = folder / "result.json";
  if (is_in_the_way(result) && !head_holds(result, kMarkOfResult)) {
    return refuse(result, "there is a file already, and it is no result of kilter's", "folder");
  }
  const bool is_ours = is_in_the_way(result) || head_holds(folder / "result.kilter", archive_format::kMagic);
  for (const fs::path& name : names) {
    const fs::path path = folder / name;
    if (!is_in_the_way(path)) continue;
    if (name.has_parent_path()) {
      if (head_holds(fs::path(path).replace_extension(".ply"), kMarkOfMap)) continue;
      return refuse(path, "there is a file already, and it is no map of kilter's", "folder");
    }
    if (is_ours) continue;
    return refuse(path, "there is a file already, and no result.json beside it says that it is kilter's", "folder");
  }
  return {};
}

}  // namespace kilter::app
