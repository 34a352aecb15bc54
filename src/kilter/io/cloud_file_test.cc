// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/cloud_file.h"

#include <gtest/gtest.h>

#include <bit>
#include <map>
#include <string>

#include "testing/cloud_bytes.h"
#include "testing/las_bytes.h"
#include "testing/temp_folder.h"

namespace kilter {
namespace {

using namespace kilter_testing;  // bytes of clouds

std::map<std::string, std::string> whole_files() {
  const std::string two = two_float_points();
  const std::string big = two_float_points(std::endian::big);
  return {{"scan.bin", two + std::string(8, '\0')},
          {"ascii.pcd", PcdBytes{}.str()},
          {"binary.pcd", PcdBytes{.data = "binary", .body = two}.str()},
          {"ascii.ply", ply_bytes("ascii", "1 2 3\n4 5 6")},
          {"little.ply", ply_bytes("binary_little_endian", two)},
          {"big.ply", ply_bytes("binary_big_endian", big)},
          {"scan.las", LasBytes().str()}};
}

TEST(PeekCloudFile, CallsNoFileCutShortThatCanBeRead) {
  const TempFolder folder;
  for (const auto& [name, bytes] : whole_files()) {
    for (std::size_t size = 0; size <= bytes.size(); ++size) {
      const auto file = folder.write(name, bytes.substr(0, size));
      const auto peek = peek_cloud_file(file);
      ASSERT_TRUE(peek) << name;
      if (!peek->is_cut_short) continue;
      EXPECT_FALSE(read_cloud_file(file)) << name << ", " << size << " bytes";
    }
    EXPECT_EQ(peek_cloud_file(folder.write(name, bytes))->points, 2U) << name;
  }
}

TEST(PeekCloudFile, SeesThatBinaryFilesAreCutShort) {
  const TempFolder folder;
  for (const auto& [name, bytes] : whole_files()) {
    if (name == "scan.las" || name.starts_with("ascii")) continue;
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      if (name == "scan.bin" && size == 16) continue;  // one point
      EXPECT_TRUE(peek_cloud_file(folder.write(name, bytes.substr(0, size)))->is_cut_short) << name << ' ' << size;
    }
  }
  // Compressed data say how long they are before they begin.
  std::string sizes;
  put_all<std::uint32_t>(sizes, std::endian::little, 20, 24);
  const std::string packed = PcdBytes{.data = "binary_compressed", .body = sizes + std::string(20, 'x')}.str();
  EXPECT_FALSE(peek_cloud_file(folder.write("packed.pcd", packed))->is_cut_short);
  const std::string none =
      "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 0\nHEIGHT 1\nPOINTS 0\nDATA binary_compressed\n";
  ASSERT_TRUE(read_cloud_file(folder.write("none.pcd", none)));
  EXPECT_FALSE(peek_cloud_file(folder.path() / "none.pcd")->is_cut_short);
  EXPECT_TRUE(peek_cloud_file(folder.write("packed.pcd", packed.substr(0, packed.size() - 1)))->is_cut_short);
  EXPECT_TRUE(peek_cloud_file(folder.write("packed.pcd", packed.substr(0, packed.size() - 24)))->is_cut_short);
}

TEST(PeekCloudFile, BelievesNoCountThatWouldWrap) {
  const TempFolder folder;
  const std::string many = "1000000000000000000";
  const PcdBytes pcd{.width = many, .points = many, .data = "binary", .body = two_float_points()};
  EXPECT_TRUE(peek_cloud_file(folder.write("many.pcd", pcd.str()))->is_cut_short);
}

TEST(PeekCloudFile, LeavesALongHeaderToWhoReadsIt) {
  const TempFolder folder;
  std::string bytes = PcdBytes{}.str();
  bytes.insert(0, "# " + std::string(10'000, 'x') + '\n');
  const auto peek = peek_cloud_file(folder.write("long.pcd", bytes));
  EXPECT_FALSE(peek->points);
  EXPECT_FALSE(peek->is_cut_short);
}

}  // namespace
}  // namespace kilter
