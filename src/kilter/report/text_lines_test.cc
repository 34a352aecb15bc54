// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/report/text_lines.h"

#include <gmock/gmock.h>

namespace kilter {
namespace {

using ::testing::ElementsAre;

TEST(TextLines, ColumnsCountCharactersNotBytes) {
  EXPECT_EQ(columns_of("caf\xC3\xA9"), 4U);
  EXPECT_EQ(cut_end("caf\xC3\xA9s", 5), "caf\xC3\xA9s");
  EXPECT_EQ(cut_end("caf\xC3\xA9s", 4), "caf~");
  EXPECT_EQ(cut_front("\xC3\xA9t\xC3\xA9/12", 4), "~/12");
  EXPECT_EQ(padded("\xC3\xA9", 3), "\xC3\xA9  ");
}

TEST(TextLines, BreaksAtBlanksAndIndentsWhatFollows) {
  EXPECT_THAT(wrapped("one two three", 7, 2, 9), ElementsAre("one two", "  three"));
  EXPECT_THAT(wrapped("Label  text goes on", 11, 7, 9), ElementsAre("Label  text", "       goes", "       on"));
  EXPECT_THAT(wrapped("", 10, 2, 9), ElementsAre());
}

TEST(TextLines, WhatDoesNotFitIsCutAndMarked) {
  EXPECT_THAT(wrapped("one two three", 6, 0, 2), ElementsAre("one", "two t~"));
  EXPECT_THAT(wrapped("one two three", 7, 0, 1), ElementsAre("one tw~"));
  EXPECT_THAT(wrapped("immeasurable", 6, 0, 2), ElementsAre("immea~"));
}

TEST(ShellWord, QuotesWhatAShellWouldTakeApart) {
  EXPECT_EQ(shell_word("runs/2026-11-28_a.bag"), "runs/2026-11-28_a.bag");
  EXPECT_EQ(shell_word("Gl\xC3\xBChlampe"), "Gl\xC3\xBChlampe");
  EXPECT_EQ(shell_word("of monday"), "'of monday'");
  EXPECT_EQ(shell_word("Ann's $HOME"), "'Ann'\\''s $HOME'");
  EXPECT_EQ(shell_word("~/a"), "'~/a'");
  EXPECT_EQ(shell_word(""), "''");
}

}  // namespace
}  // namespace kilter
