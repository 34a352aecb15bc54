// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/count_mismatch.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <set>

#include "kilter/io/pose_list.h"

namespace kilter {
namespace {

using ::testing::HasSubstr;

// Ten scans a second and their poses, but for some.
std::vector<std::string> scans_without(const std::set<int>& missing) {
  std::vector<std::string> files;
  for (int i = 0; i < 40; ++i) {
    if (!missing.contains(i)) files.push_back(fmt::format("{:06}.bin", i));
  }
  return files;
}

PoseTable poses_without(const std::set<int>& missing, double step_s = 0.1) {
  std::string text;
  for (int i = 0; i < 40; ++i) {
    if (!missing.contains(i)) text += fmt::format("{:.3f} {} 0 0 0 0 0 1\n", 1.7e9 + step_s * i, i);
  }
  return *read_pose_list(text, "poses.tum");
}

Error refused(const std::vector<std::string>& files, const PoseTable& poses) {
  return refuse_counts(files, poses, "a/poses.tum", "a/scans").value();
}

TEST(RefuseCounts, NamesTheLinesOfScansThatAreGone) {
  Error error = refused(scans_without({20}), poses_without({}));
  EXPECT_EQ(
      error.message,
      "40 poses in poses.tum, but 39 files in scans; the first missing one lies between 000019.bin and 000021.bin");
  EXPECT_THAT(error.hint, HasSubstr(": take out line 21 of poses.tum, headings and comments not counted"));
  error = refused(scans_without({3, 4, 20}), poses_without({}));
  EXPECT_THAT(error.hint, HasSubstr(": take out lines 4, 5, 21 of poses.tum"));
  error = refused(scans_without({3, 4, 20, 21, 22, 30, 31}), poses_without({}));
  EXPECT_THAT(error.hint, HasSubstr(": take out lines 4, 5, 21, 22, 23 and 2 more of poses.tum"));
}

TEST(RefuseCounts, NamesNoLineWhereTheNumbersDoNotTellAll) {
  EXPECT_EQ(refused(scans_without({20, 39}), poses_without({})).hint,
            "one pose per file, in the order of the files' names");
  EXPECT_EQ(refused(scans_without({39}), poses_without({})).hint,
            "one pose per file, in the order of the files' names");
}

TEST(RefuseCounts, NamesTheLargestGapOfStamps) {
  Error error = refused(scans_without({}), poses_without({20}));
  EXPECT_THAT(error.message, HasSubstr("000039.bin is the first without a pose, if they begin together; the stamps of "
                                       "the poses step by 0.1 s, but by 0.2 s from line 20 to 21"));
  EXPECT_THAT(error.hint, HasSubstr(": if poses are missing there, move 000020.bin away"));
  error = refused(scans_without({}), poses_without({20, 21, 22}));
  EXPECT_THAT(error.hint, HasSubstr("move 000020.bin away, and the 2 behind it"));
  error = refused(scans_without({}), poses_without({20, 30, 31}));
  EXPECT_THAT(error.message, HasSubstr("by 0.3 s from line 29 to 30")) << "the largest, which is not all";
  EXPECT_EQ(error.hint, "one pose per file, in the order of the files' names");
}

TEST(RefuseCounts, StampsWithoutAGapNameNone) {
  for (const PoseTable& poses : {poses_without({39}), poses_without({20}, 0.0)}) {
    const Error error = refused(scans_without({}), poses);
    EXPECT_TRUE(error.message.ends_with("000039.bin is the first without a pose")) << error.message;
  }
}

}  // namespace
}  // namespace kilter
