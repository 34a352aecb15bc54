// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/base/expected.h"

#include <gtest/gtest.h>

#include <set>

#include "kilter/base/error_catalog.h"

namespace kilter {
namespace {

TEST(Error, TextNamesCodePlaceMessageAndHint) {
  const Error error{ErrorCode::kCountMismatch, "12 poses but 11 scans", "mission/a", "remove the last pose"};
  EXPECT_EQ(to_string(error), "count-mismatch: mission/a: 12 poses but 11 scans\n  try: remove the last pose");
}

TEST(ErrorCatalog, HasOneEntryPerCodeWithItsOwnName) {
  std::set<std::string_view> names;
  for (int code = 0; code <= static_cast<int>(ErrorCode::kInternal); ++code) {
    const auto& entry = error_catalog()[static_cast<std::size_t>(code)];
    EXPECT_EQ(static_cast<int>(entry.code), code);
    EXPECT_FALSE(entry.explanation.empty());
    EXPECT_TRUE(names.insert(entry.name).second) << entry.name;
  }
}

TEST(Printable, KeepsUtf8AndReplacesWhatSteersTerminals) {
  EXPECT_EQ(printable("Gl\xC3\xBChlampe"), "Gl\xC3\xBChlampe");
  EXPECT_EQ(printable("a\x1B[31mb\n"), "a?[31mb?");
  EXPECT_EQ(printable("\xFF\xC0\x80"), "???");
  EXPECT_EQ(printable("\xC2\x9B"), "??");
}

TEST(Printable, CutsLongText) { EXPECT_EQ(printable("abcdef", 3), "abc..."); }

}  // namespace
}  // namespace kilter
