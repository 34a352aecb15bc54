// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/report/unverified_causes.h"

#include <gmock/gmock.h>

#include "testing/results.h"

namespace kilter {
namespace {

using ::testing::ElementsAre;
using ::testing::Pair;

TEST(CauseOf, IsShortWholeAndWithoutNumbers) {
  EXPECT_EQ(cause_of("too little overlap: 4 % of the voxels match, 10 % are needed"), "too little overlap");
  EXPECT_EQ(cause_of("too little overlap: of 812 voxels that match, 31 show a side that both saw, and no free space "
                     "speaks against the map: the places may differ"),
            "sees too few common sides");
  EXPECT_EQ(cause_of("offset 3.1 cm (1.0 to 5.2 cm), but a direction that nothing in the scene fixes could hide 40 cm"),
            "an open direction hides more than the tolerance");
  EXPECT_EQ(cause_of("offset 31 cm (20 to 42 cm); it was found where a neighbour's correction would put it, and no "
                     "registration around it confirms it; only 12 % show a side that both saw: the map's verdict does "
                     "not wait for it"),
            "a neighbour's pose, not confirmed");
  EXPECT_EQ(cause_of("offset 31 cm (20 to 42 cm), 35 cm apart with what no rigid motion mends: not told from the "
                     "tolerance of 10.0 cm over the whole map"),
            "bent inside, too near the tolerance to be told from it");
}

TEST(CauseOf, OfAReasonThatItDoesNotKnowIsTheReasonWithDotsForNumbers) {
  EXPECT_EQ(cause_of("offset 3 cm (2 to 4 cm), but 7.5 of 12 moons shine; 3 do not"), ".. of .. moons shine");
  EXPECT_EQ(cause_of("log10 Gamma 1.20 is low for this map (from 1.51)"),
            "log10 Gamma .. is low for this map (from ..)");
}

TEST(UnverifiedCauses, AreCountedTheCommonestFirst) {
  Result result = testing::result_of({{"a", 5}});
  testing::add_empty_pair(result, 1, 0).verdict.reason = "offset 3.1 cm (2.0 to 4.2 cm): too uncertain to be told";
  testing::add_empty_pair(result, 2, 0).verdict.reason = "too little overlap: 7 % match";
  testing::add_empty_pair(result, 3, 0).verdict.reason = "too little overlap: 9 % match";
  testing::add_measured_pair(result, 4, 0);
  EXPECT_THAT(unverified_causes(result),
              ElementsAre(Pair("too little overlap", 2U), Pair("too uncertain to be told from the tolerance", 1U)));
}

}  // namespace
}  // namespace kilter
