// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/sources/foreign_file.h"

#include <gtest/gtest.h>

#include <string>

#include "testing/source_folder.h"

namespace kilter {
namespace {

using kilter_testing::expect_source_error;
using kilter_testing::open_source;
using kilter_testing::TempFolder;

TEST(ForeignFile, IsAnsweredInFoldersToo) {
  const TempFolder folder;
  folder.write("flat/1.LAZ", "LASF");
  folder.write("flat/poses.txt", "0 0 0 0 0 0 0 1\n");
  folder.write("robot/scans/1.laz", "LASF");
  folder.write("robot/poses.txt", "0 0 0 0 0 0 0 1\n");
  for (const std::string name : {"", "r="}) {
    for (const char* const inside : {"flat", "robot"}) {
      const auto mission = open_mission({name + (folder.path() / inside).string()});
      ASSERT_FALSE(mission) << name << inside;
      EXPECT_NE(mission.error().hint.find("laszip"), std::string::npos) << to_string(mission.error());
    }
  }
  folder.write("states/map.pbstream", "");
  expect_source_error(open_source(folder.path() / "states"), ErrorCode::kUnsupported, "a Cartographer state");
  folder.write("scanner/1.e57", "ASTM-E57");
  expect_source_error(open_source(folder.path() / "scanner"), ErrorCode::kUnsupported, "an E57 scan file");
}

}  // namespace
}  // namespace kilter
