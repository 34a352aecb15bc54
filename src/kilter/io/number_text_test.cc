// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/number_text.h"

#include <gtest/gtest.h>

#include <clocale>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "kilter/io/byte_cursor.h"

namespace kilter {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

TEST(ParseReal, ReadsDecimalsWithEitherSign) {
  EXPECT_EQ(parse_real("0"), 0.0);
  EXPECT_EQ(parse_real("+1.5"), 1.5);
  EXPECT_EQ(parse_real("-2e-3"), -2e-3);
  EXPECT_EQ(parse_real(".5"), 0.5);
  EXPECT_EQ(parse_real("5."), 5.0);
  EXPECT_EQ(parse_real("1E+2"), 100.0);
  EXPECT_EQ(parse_real("0.1"), 0.1);
}

TEST(ParseReal, ReadsWhatIsNotFinite) {
  EXPECT_TRUE(std::isnan(parse_real("nan").value()));
  EXPECT_TRUE(std::isnan(parse_real("-NaN").value()));
  EXPECT_EQ(parse_real("inf"), kInf);
  EXPECT_EQ(parse_real("-Infinity"), -kInf);
}

TEST(ParseReal, TurnsWhatNoDoubleHoldsIntoInfinityOrZero) {
  EXPECT_EQ(parse_real("1e400"), kInf);
  EXPECT_EQ(parse_real("-1e400"), -kInf);
  EXPECT_EQ(parse_real("1" + std::string(400, '0')), kInf);
  EXPECT_EQ(parse_real("1" + std::string(800, '0') + "e-400"), kInf);
  EXPECT_EQ(parse_real("0." + std::string(10, '0') + "1e500"), kInf);
  EXPECT_EQ(parse_real("1e99999999999999999999"), kInf);
  EXPECT_EQ(parse_real("1e+99999999999999999999"), kInf);
  EXPECT_EQ(parse_real("1e-400"), 0.0);
  EXPECT_EQ(parse_real("0." + std::string(400, '0') + "1"), 0.0);
  EXPECT_EQ(parse_real("0." + std::string(800, '0') + "1e400"), 0.0);
  EXPECT_EQ(parse_real("1e-99999999999999999999"), 0.0);
}

TEST(ParseReal, RefusesWhatIsNotOneNumber) {
  for (const char* word : {"", "+", "-", "x", "1x", "1,5", "1 2", "++1", "+-1", "0x10", "1e", "--1", "1.2.3"}) {
    EXPECT_FALSE(parse_real(word)) << word;
  }
}

TEST(ParseReal, DoesNotHeedTheLocale) {
  const char* german = std::setlocale(LC_NUMERIC, "de_DE.UTF-8");
  EXPECT_EQ(parse_real("1.5"), 1.5);
  EXPECT_FALSE(parse_real("1,5"));
  if (german != nullptr) std::setlocale(LC_NUMERIC, "C");
}

TEST(ParseCount, ReadsDigitsOnly) {
  EXPECT_EQ(parse_count("0"), 0U);
  EXPECT_EQ(parse_count("+7"), 7U);
  EXPECT_EQ(parse_count("18446744073709551615"), std::numeric_limits<std::uint64_t>::max());
  for (const char* word : {"", "-1", "1.0", "1e3", "18446744073709551616", "0x1", "+-1", "one"}) {
    EXPECT_FALSE(parse_count(word)) << word;
  }
}

TEST(CheckedArithmetic, NeverWraps) {
  constexpr std::uint64_t kMost = std::numeric_limits<std::uint64_t>::max();
  EXPECT_EQ(checked_product(65536, 65537), 4295032832U);
  EXPECT_EQ(checked_product(kMost, 1), kMost);
  EXPECT_EQ(checked_product(kMost, 0), 0U);
  EXPECT_FALSE(checked_product(std::uint64_t{1} << 32, std::uint64_t{1} << 32));
  EXPECT_EQ(checked_sum(kMost - 1, 1), kMost);
  EXPECT_FALSE(checked_sum(kMost, 1));
}

TEST(TakeWord, SplitsAtBlanksAndIfAskedAtCommas) {
  std::string_view line = "  a\tb,c ";
  EXPECT_EQ(take_word(line), "a");
  EXPECT_EQ(take_word(line), "b,c");
  EXPECT_EQ(take_word(line), "");
  line = "a, b,,c";
  EXPECT_EQ(take_word<Separators::kBlanksAndCommas>(line), "a");
  EXPECT_EQ(take_word<Separators::kBlanksAndCommas>(line), "b");
  EXPECT_EQ(take_word<Separators::kBlanksAndCommas>(line), "c");
  EXPECT_EQ(take_word<Separators::kBlanksAndCommas>(line), "");
}

TEST(ByteCursor, TakesLinesOfBothSystemsAndAnUnendedLast) {
  ByteCursor cursor("a\r\nb\n\nc");
  std::vector<std::string> lines;
  while (const auto line = cursor.take_line()) lines.emplace_back(*line);
  EXPECT_EQ(lines, (std::vector<std::string>{"a", "b", "", "c"}));
  EXPECT_EQ(cursor.line(), 4U);
  EXPECT_EQ(cursor.position(), 7U);
}

TEST(ByteCursor, TakesNothingBeyondTheEnd) {
  ByteCursor cursor("abc");
  EXPECT_EQ(cursor.take(2), "ab");
  EXPECT_FALSE(cursor.take(2));
  EXPECT_FALSE(cursor.take(std::numeric_limits<std::size_t>::max()));
  EXPECT_EQ(cursor.rest(), "c");
}

TEST(ByteOrderMark, IsPassedOver) {
  EXPECT_EQ(without_byte_order_mark("\xEF\xBB\xBFply"), "ply");
  EXPECT_EQ(without_byte_order_mark("ply"), "ply");
}

}  // namespace
}  // namespace kilter
