// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/sources/foreign_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "kilter/io/file.h"
#include "kilter/io/number_text.h"

namespace kilter {
namespace {

constexpr std::array kForeign = {
    ForeignFormat{".laz", "compressed LAS",
                  "decompress each file: `laszip -i IN.laz -o OUT.las`, or `pdal translate IN.laz OUT.las`"},
    ForeignFormat{
        ".e57", "an E57 scan file",
        "save each scan on its own: `pdal translate IN.e57 OUT.ply`, or CloudCompare's -O IN.e57 -SAVE_CLOUDS"},
    ForeignFormat{".pbstream", "a Cartographer state",
                  "write clouds and poses with cartographer_ros's assets writer (write_pcd per trajectory), or export "
                  "the trajectory and keep the bag as the source of scans"},
    ForeignFormat{".db", "a database, most likely RTAB-Map's",
                  "export it: `rtabmap-export --scan --poses --poses_format 11 FILE.db`, then name the folder"},
};

const ForeignFormat* format_of(std::string_view file_name) {
  const std::string name = lower_case(file_name);
  const auto found = std::find_if(kForeign.begin(), kForeign.end(),
                                  [&](const ForeignFormat& format) { return name.ends_with(format.extension); });
  return found == kForeign.end() ? nullptr : &*found;
}

}  // namespace

const ForeignFormat* find_foreign(std::span<const std::string> names) {
  const auto found =
      std::find_if(names.begin(), names.end(), [](const std::string& name) { return format_of(name) != nullptr; });
  return found == names.end() ? nullptr : format_of(*found);
}

std::string way_out_of_foreign(std::span<const std::string> names) {
  const ForeignFormat* format = find_foreign(names);
  return format == nullptr ? std::string() : std::string(format->way_out);
}

bool is_foreign_file(const std::filesystem::path& path) {
  return is_file(path) && format_of(path.filename().native()) != nullptr;
}

Expected<RobotLog> refuse_foreign_file(const SourceRequest& request, std::vector<std::string>& /*notes*/) {
  const ForeignFormat* format = format_of(request.path.filename().native());
  if (format == nullptr) return fail(ErrorCode::kUnsupported, "not a format that kilter reads", shown(request.path));
  return fail(ErrorCode::kUnsupported, fmt::format("this is {}, which kilter does not read", format->what),
              shown(request.path), std::string(format->way_out));
}

}  // namespace kilter
