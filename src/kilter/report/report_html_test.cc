// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/report/report_html.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kilter/report/deflate.h"
#include "kilter/report/palette.h"
#include "kilter/report/viewer_page.h"

namespace kilter {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(ReportHtml, LetsNothingIn) {
  const std::string html = report_html("anything");
  EXPECT_THAT(html, HasSubstr("default-src 'none'"));
  for (const char* door : {"<link", "<img", "<iframe", "src=\"http", "href=\"http", "@import", "'unsafe-inline'"}) {
    EXPECT_THAT(html, Not(HasSubstr(door)));
  }
}

TEST(ReportHtml, EqualArchivesGiveEqualBytes) {
  EXPECT_EQ(report_html("one archive"), report_html("one archive"));
  if (!viewer_page().empty()) {
    EXPECT_NE(report_html("one archive"), report_html("another one"));
  }
}

TEST(ReportHtml, NoNameIsEverReadAsHtml) {
  const std::string hostile = "</script><img src=x onerror=alert(1)>";
  EXPECT_THAT(report_html(hostile), Not(HasSubstr("onerror=alert(1)>")));
}

TEST(ReportHtml, EveryMarkOfThePageIsFilled) {
  if (viewer_page().empty()) GTEST_SKIP() << "built without the viewer";
  const std::string html = report_html("anything");
  for (const char* mark : {"@PALETTE@", "@ARCHIVE@", "@SCRIPT@", "@STYLE@", "@POLICY@"}) {
    EXPECT_THAT(html, Not(HasSubstr(mark)));
  }
  EXPECT_THAT(html, HasSubstr(R"({"robots": [[31, 105, 179])"));
}

TEST(Palette, TheScaleGetsBrighterAllTheWay) {
  const auto brightness = [](Rgb c) { return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]; };
  for (int i = 1; i <= 100; ++i) {
    EXPECT_GT(brightness(scale_colour(i / 100.0)), brightness(scale_colour((i - 1) / 100.0)) - 1.0) << i;
  }
  EXPECT_GT(brightness(scale_colour(1.0)), brightness(scale_colour(0.0)) + 150.0);
  EXPECT_EQ(scale_colour(-3.0), scale_colour(0.0));
  EXPECT_EQ(scale_colour(3.0), scale_colour(1.0));
}

TEST(Palette, MisalignmentAtTheToleranceIsTheMiddleOfItsScale) {
  EXPECT_EQ(misalignment_colour(11, 0.1), (Rgb{235, 185, 40}));  // 10 cm
  EXPECT_EQ(misalignment_colour(0, 0.1), (Rgb{150, 156, 162}));
  EXPECT_EQ(misalignment_colour(255, 0.1), (Rgb{190, 0, 50}));
}

}  // namespace
}  // namespace kilter
