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

struct ForeignFormat {
  std::string_view extension;
  std::string_view what;
  std::string_view way_out;
};

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

const ForeignFormat* find_foreign(const std::filesystem::path& path) {
  const std::string name = lower_case(path.filename().native());
  const auto found = std::find_if(kForeign.begin(), kForeign.end(),
                                  [&](const ForeignFormat& format) { return name.ends_with(format.extension); });
  return found == kForeign.end() ? nullptr : &*found;
}

}  // namespace

bool is_foreign_file(const std::filesystem::path& path) { return is_file(path) && find_foreign(path) != nullptr; }

Expected<RobotLog> refuse_foreign_file(const SourceRequest& request, std::vector<std::string>& /*notes*/) {
  const ForeignFormat* format = find_foreign(request.path);
  if (format == nullptr) return fail(ErrorCode::kUnsupported, "not a format that kilter reads", shown(request.path));
  return fail(ErrorCode::kUnsupported, fmt::format("this is {}, which kilter does not read", format->what),
              shown(request.path), std::string(format->way_out));
}

}  // namespace kilter
