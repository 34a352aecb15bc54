// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/pcd_reader.h"

#include <gtest/gtest.h>
#include <liblzf/lzf.h>

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "testing/allocation_watch.h"
#include "testing/cloud_bytes.h"
#include "testing/temp_folder.h"

namespace kilter {
namespace {

using kilter_testing::PcdBytes;
using kilter_testing::put;
using kilter_testing::put_all;
using kilter_testing::two_float_points;
using Points = std::vector<Eigen::Vector3f>;

const Points kTwoPoints = {{1, 2, 3}, {4, 5, 6}};

Expected<PointCloud> read(const PcdBytes& pcd) { return read_pcd(pcd.str(), "scan.pcd"); }

void expect_error(const PcdBytes& pcd, ErrorCode code, const std::string& message_part) {
  const auto cloud = read(pcd);
  ASSERT_FALSE(cloud) << message_part;
  EXPECT_EQ(error_code_name(cloud.error().code), error_code_name(code)) << to_string(cloud.error());
  EXPECT_NE(to_string(cloud.error()).find(message_part), std::string::npos) << to_string(cloud.error());
  EXPECT_EQ(cloud.error().where.substr(0, 8), "scan.pcd");
}

std::string compressed(const std::string& bytes) {
  std::string packed(bytes.size() + 64, '\0');
  const unsigned size = lzf_compress(bytes.data(), static_cast<unsigned>(bytes.size()), packed.data(),
                                     static_cast<unsigned>(packed.size()));
  EXPECT_GT(size, 0U);
  std::string block;
  put(block, static_cast<std::uint32_t>(size));
  put(block, static_cast<std::uint32_t>(bytes.size()));
  return block + packed.substr(0, size);
}

TEST(ReadPcd, ReadsAscii) { EXPECT_EQ(read({}).value().points_m, kTwoPoints); }

TEST(ReadPcd, ReadsBinary) {
  EXPECT_EQ(read({.data = "binary", .body = two_float_points()}).value().points_m, kTwoPoints);
}

TEST(ReadPcd, ReadsRecordsThatAreNotAligned) {
  std::string body;
  for (const float first : {1.0F, 4.0F}) {
    put_all<float>(body, std::endian::little, first, first + 1, first + 2, 0.5F);
    put<std::uint16_t>(body, 7);
    put_all<float>(body, std::endian::little, 0, 0, 1);
    put<std::int32_t>(body, -1);
  }
  ASSERT_EQ(body.size(), 68U);
  const PcdBytes pcd = {.fields = "x y z intensity ring normal_x normal_y normal_z label",
                        .size = "4 4 4 4 2 4 4 4 4",
                        .type = "F F F F U F F F I",
                        .count = "1 1 1 1 1 1 1 1 1",
                        .data = "binary",
                        .body = body};
  EXPECT_EQ(read(pcd).value().points_m, kTwoPoints);
}

TEST(ReadPcd, ReadsCompressedBlocksFieldByField) {
  std::string body;
  put_all<std::uint8_t>(body, std::endian::little, 9, 9);
  put_all<float>(body, std::endian::little, 3, 6, 1, 4, 2, 5);
  const PcdBytes pcd = {.fields = "ring z x y",
                        .size = "1 4 4 4",
                        .type = "U F F F",
                        .count = "",
                        .data = "binary_compressed",
                        .body = compressed(body)};
  EXPECT_EQ(read(pcd).value().points_m, kTwoPoints);
}

TEST(ReadPcd, ReadsCoordinatesOfEveryType) {
  std::string body;
  for (const int first : {1, 4}) {
    put<double>(body, first);
    put<std::int64_t>(body, first + 1);
    put<std::uint8_t>(body, static_cast<std::uint8_t>(first + 2));
  }
  const PcdBytes mixed = {.size = "8 8 1", .type = "F I U", .data = "binary", .body = body};
  EXPECT_EQ(read(mixed).value().points_m, kTwoPoints);

  body.clear();
  for (const int first : {-1, -4}) {
    put<std::int8_t>(body, static_cast<std::int8_t>(first));
    put<std::int16_t>(body, static_cast<std::int16_t>(first - 1));
    put<std::int32_t>(body, first - 2);
  }
  const PcdBytes small = {.size = "1 2 4", .type = "I I I", .data = "binary", .body = body};
  EXPECT_EQ(read(small).value().points_m, (Points{{-1, -2, -3}, {-4, -5, -6}}));

  body.clear();
  for (const unsigned first : {1U, 4U}) {
    put<std::uint16_t>(body, static_cast<std::uint16_t>(first));
    put<std::uint32_t>(body, first + 1);
    put<std::uint64_t>(body, first + 2);
  }
  const PcdBytes without_sign = {.size = "2 4 8", .type = "U U U", .data = "binary", .body = body};
  EXPECT_EQ(read(without_sign).value().points_m, kTwoPoints);
}

TEST(ReadPcd, StepsOverFieldsOfManyValuesOrNone) {
  const PcdBytes ascii = {.fields = "_ x rgb y z",
                          .size = "1 4 4 4 4",
                          .type = "U F F F F",
                          .count = "2 1 0 1 1",
                          .body = "7 7 1 2 3\n7 7 4 5 6\n"};
  EXPECT_EQ(read(ascii).value().points_m, kTwoPoints);
  PcdBytes binary = ascii;
  binary.data = "binary";
  binary.body.clear();
  for (const float first : {1.0F, 4.0F}) {
    put_all<std::uint8_t>(binary.body, std::endian::little, 7, 7);
    put_all<float>(binary.body, std::endian::little, first, first + 1, first + 2);
  }
  EXPECT_EQ(read(binary).value().points_m, kTwoPoints);
}

TEST(ReadPcd, ReadsOlderAndSparserHeaders) {
  EXPECT_EQ(read({.version = ".7", .count = ""}).value().points_m, kTwoPoints);
  EXPECT_EQ(read({.version = "0.6", .width = "", .height = ""}).value().points_m, kTwoPoints);
  EXPECT_EQ(read({.version = "", .height = "", .points = ""}).value().points_m, kTwoPoints);
  EXPECT_EQ(read({.width = "1", .height = "2"}).value().points_m, kTwoPoints);
}

TEST(ReadPcd, ReadsTextOfOtherSystems) {
  std::string crlf = "\xEF\xBB\xBF";
  for (const char c : PcdBytes{.body = "\n+1 2e0 3.0\n\n4 5 6"}.str()) crlf += c == '\n' ? "\r\n" : std::string(1, c);
  EXPECT_EQ(read_pcd(crlf, "scan.pcd").value().points_m, kTwoPoints);
}

TEST(ReadPcd, DropsAndCountsWhatIsNoPlace) {
  const PcdBytes pcd = {
      .width = "6", .points = "6", .body = "nan 0 0\n0 -inf 0\n1e400 0 0\n1e30 0 0\n0 0 1e300\n1 2 3\n"};
  const PointCloud cloud = read(pcd).value();
  EXPECT_EQ(cloud.points_m, (Points{{1, 2, 3}}));
  EXPECT_EQ(cloud.dropped_nonfinite, 3U);
  EXPECT_EQ(cloud.dropped_far, 2U);

  std::string body;
  put_all<double>(body, std::endian::little, std::numeric_limits<double>::quiet_NaN(), 0, 0, 1e300, 0, 0);
  const PointCloud doubles = read({.size = "8 8 8", .data = "binary", .body = body}).value();
  EXPECT_TRUE(doubles.points_m.empty());
  EXPECT_EQ(doubles.dropped_nonfinite, 1U);
  EXPECT_EQ(doubles.dropped_far, 1U);
}

TEST(ReadPcd, ReadsAnEmptyScanIfTheHeaderMeansIt) {
  for (const char* data : {"ascii", "binary", "binary_compressed"}) {
    const auto cloud = read({.width = "0", .points = "0", .data = data, .body = ""});
    ASSERT_TRUE(cloud) << data;
    EXPECT_TRUE(cloud->points_m.empty());
  }
}

TEST(ReadPcd, TellsHowManyPointsArePromisedAndThere) {
  expect_error({.body = "1 2 3\n"}, ErrorCode::kTruncated, "promises 2 points, but only 1");
  expect_error({.width = "3", .points = "3", .data = "binary", .body = two_float_points()}, ErrorCode::kTruncated,
               "promises 3 points of 12 bytes, but only 24 bytes");
  expect_error({.body = "1 2 3\n4 5 6\n7 8 9\n"}, ErrorCode::kCountMismatch, "scan.pcd:14");
  expect_error({.width = "1", .points = "1", .data = "binary", .body = two_float_points()}, ErrorCode::kCountMismatch,
               "promises 1 points");
}

TEST(ReadPcd, PassesOverZerosThatPadTheFile) {
  const PcdBytes pcd = {.data = "binary", .body = two_float_points() + std::string(3844, '\0')};
  EXPECT_EQ(read(pcd).value().points_m, kTwoPoints);
}

TEST(ReadPcd, NamesLineAndWordThatIsNoNumber) {
  expect_error({.body = "1 2 3\n4 five 6\n"}, ErrorCode::kParse, "scan.pcd:13: expected a number, found \"five\"");
  expect_error({.body = "1 2 3\n4 5\n"}, ErrorCode::kParse, "expected 3 numbers, found 2");
  expect_error({.body = "1 2 3 4\n4 5 6\n"}, ErrorCode::kParse, "expected 3 numbers, found 4");
  expect_error({.body = "1,2,3\n4,5,6\n"}, ErrorCode::kParse, "found \"1,2,3\"");
}

TEST(ReadPcd, RefusesCountsThatCannotBe) {
  for (const char* count : {"-1", "1e3", "2.0", "two", "99999999999999999999", "1 1"}) {
    expect_error({.width = count}, ErrorCode::kParse, "WIDTH must be one whole number");
    expect_error({.points = count}, ErrorCode::kParse, "POINTS must be one whole number");
  }
  expect_error({.width = "3"}, ErrorCode::kCountMismatch, "WIDTH 3 x HEIGHT 1 is 3, but POINTS is 2");
  expect_error({.width = "4294967296", .height = "4294967296", .points = ""}, ErrorCode::kCountMismatch, "64 bits");
  expect_error({.width = "", .points = ""}, ErrorCode::kParse, "neither POINTS nor WIDTH");
}

TEST(ReadPcd, RefusesClaimsThatTheBytesDoNotJustify) {
  for (const char* data : {"ascii", "binary"}) {
    expect_error({.width = "4000000000", .points = "4000000000", .data = data, .body = "1 2 3\n"},
                 ErrorCode::kTruncated, "promises 4000000000 points");
    expect_error({.width = "65536", .height = "65537", .points = "4295032832", .data = data, .body = "1 2 3\n"},
                 ErrorCode::kTruncated, "promises 4295032832 points");
  }
  const PcdBytes huge_records = {.fields = "x y z a",
                                 .size = "4 4 4 8",
                                 .type = "F F F F",
                                 .count = "1 1 1 2305843009213693951",
                                 .data = "binary",
                                 .body = two_float_points()};
  expect_error(huge_records, ErrorCode::kParse, "field \"a\": COUNT");
}

TEST(ReadPcd, RefusesFieldsThatCannotBe) {
  expect_error({.count = "1 1 -1"}, ErrorCode::kParse, "field \"z\": COUNT is \"-1\"");
  expect_error({.count = "1 1 2"}, ErrorCode::kParse, "exactly one field \"z\" of one value, found COUNT 2");
  expect_error({.count = "1 1"}, ErrorCode::kParse, "FIELDS names 3 fields, but COUNT has 2");
  expect_error({.size = "4 4 3"}, ErrorCode::kParse, "TYPE F with SIZE 3");
  expect_error({.size = "4 4 -4"}, ErrorCode::kParse, "SIZE -4");
  expect_error({.size = "4 4"}, ErrorCode::kParse, "SIZE has 2");
  expect_error({.type = "F F X"}, ErrorCode::kParse, "TYPE X");
  expect_error({.type = ""}, ErrorCode::kParse, "no TYPE line");
  expect_error({.fields = ""}, ErrorCode::kParse, "no FIELDS line");
  expect_error({.fields = "x y q"}, ErrorCode::kParse, "exactly one field \"z\" of one value, found 0");
  expect_error({.fields = "x x z"}, ErrorCode::kParse, "exactly one field \"x\" of one value, found 2");
}

TEST(ReadPcd, RefusesOtherFilesAndVersions) {
  EXPECT_EQ(read_pcd("", "scan.pcd").error().code, ErrorCode::kTruncated);
  EXPECT_EQ(read_pcd("ply\nformat ascii 1.0\n", "scan.pcd").error().code, ErrorCode::kParse);
  expect_error({.version = "0.8"}, ErrorCode::kUnsupported, "version \"0.8\"");
  expect_error({.data = "zipped"}, ErrorCode::kParse, "DATA must be ascii, binary or binary_compressed");
  expect_error({.data = ""}, ErrorCode::kParse, "expected a PCD header line, found \"1\"");
  expect_error({.data = "", .body = ""}, ErrorCode::kTruncated, "before the DATA line");
  expect_error({.points = "2\nPOINTS 2"}, ErrorCode::kParse, "POINTS is given twice");
  std::string names = "x y z";
  for (int i = 0; i < 2000; ++i) names += " a";
  expect_error({.fields = names}, ErrorCode::kUnsupported, "more than 1024 fields");
}

TEST(ReadPcd, RefusesMorePointsThanCompressedBytesJustify) {
  PcdBytes pcd = {.size = "1 1 1", .type = "I I I", .data = "binary_compressed"};
  pcd.width = pcd.points = "1048576";
  pcd.body = compressed(std::string(3 * 1048576, '\5'));
  ASSERT_TRUE(read(pcd));
  EXPECT_EQ(read(pcd)->points_m.size(), 1048576U);
  pcd.width = pcd.points = "1048577";
  pcd.body = compressed(std::string(3 * 1048577, '\5'));
  expect_error(pcd, ErrorCode::kUnsupported, "claim to hold 1048577 points; of so few at most 1048576 are unpacked");
}

TEST(ReadPcd, UnpacksNoMoreForOtherFieldsThanPointsMayTake) {
  constexpr std::uint32_t kPoints = 70'000;  // of a thousand bytes
  PcdBytes pcd = {.fields = "x y z more",
                  .size = "4 4 4 4",
                  .type = "F F F F",
                  .count = "1 1 1 247",
                  .width = std::to_string(kPoints),
                  .points = std::to_string(kPoints),
                  .data = "binary_compressed",
                  .body = compressed(std::string(std::size_t{kPoints} * 1000, '\0'))};
  kilter_testing::largest_allocation() = 0;
  expect_error(pcd, ErrorCode::kUnsupported, "claim to hold 70000000; of so few at most 67108864 are unpacked");
  EXPECT_LT(kilter_testing::largest_allocation(), std::size_t{8} << 20);
}

TEST(ReadPcd, RefusesCompressedBlocksThatLie) {
  const auto block = [](std::uint32_t packed, std::uint32_t unpacked, const std::string& bytes) {
    std::string body;
    put_all<std::uint32_t>(body, std::endian::little, packed, unpacked);
    return body + bytes;
  };
  const std::string bytes(16, '\0');
  PcdBytes pcd = {.data = "binary_compressed", .body = "1234567"};
  expect_error(pcd, ErrorCode::kTruncated, "before the sizes");
  pcd.body = block(17, 24, bytes);
  expect_error(pcd, ErrorCode::kTruncated, "17 bytes of compressed data are promised, 16 are there");
  pcd.body = block(16, 25, bytes);
  expect_error(pcd, ErrorCode::kCountMismatch, "2 points of 12 bytes do not make the 25 bytes");
  pcd.body = block(0, 24, bytes);
  expect_error(pcd, ErrorCode::kParse, "cannot hold");
  pcd.body = block(16, 24, bytes);
  expect_error(pcd, ErrorCode::kParse, "damaged");
  pcd.width = pcd.points = "357913941";  // 4 GiB less 4 bytes
  pcd.body = block(16, 4294967292U, bytes);
  expect_error(pcd, ErrorCode::kParse, "cannot hold");
}

// Long enough to be read in several blocks; point 20,000 is lost, and every 1000th lies too far.
PcdBytes long_pcd(int points) {
  PcdBytes pcd = {.fields = "intensity x y z", .size = "2 4 4 4", .type = "U F F F", .count = "1 1 1 1"};
  pcd.width = pcd.points = std::to_string(points);
  pcd.data = "binary";
  pcd.body.clear();
  for (int i = 0; i < points; ++i) {
    const float x = i == 20'000 ? std::numeric_limits<float>::quiet_NaN() : 0.001F * static_cast<float>(i);
    put<std::uint16_t>(pcd.body, 7);
    put_all<float>(pcd.body, std::endian::little, x, -x, i % 1000 == 999 ? 1e30F : 2.0F);
  }
  return pcd;
}

TEST(ReadPcdFile, ReadsAFileInBlocksAsItWouldFromMemory) {
  const kilter_testing::TempFolder folder;
  const std::string bytes = "\xEF\xBB\xBF" + long_pcd(50'000).str();
  const auto from_memory = read_pcd(bytes, "scan.pcd");
  const auto from_file = read_pcd_file(folder.write("scan.pcd", bytes));
  ASSERT_TRUE(from_memory && from_file);
  EXPECT_EQ(from_file->points_m.size(), 49'949U);
  EXPECT_EQ(from_file->dropped_nonfinite, 1U);
  EXPECT_EQ(from_file->dropped_far, 50U);
  EXPECT_EQ(from_file->points_m, from_memory->points_m);
  EXPECT_EQ(from_file->points_m[1], Eigen::Vector3f(0.001F, -0.001F, 2.0F));
  EXPECT_EQ(from_file->points_m.back(), Eigen::Vector3f(0.001F * 49'998.0F, 0.001F * -49'998.0F, 2.0F));
}

TEST(ReadPcdFile, RefusesWhatItWouldRefuseFromMemory) {
  const kilter_testing::TempFolder folder;
  const std::string whole = long_pcd(50'000).str();
  const std::string padded = whole + std::string(300'000, '\0');
  EXPECT_TRUE(read_pcd_file(folder.write("scan.pcd", padded)));
  for (const std::string& bytes : {whole.substr(0, whole.size() - 1), whole + whole.substr(0, 400), padded + "x"}) {
    const auto file = folder.write("scan.pcd", bytes);
    const auto from_memory = read_pcd(bytes, file.string());
    const auto from_file = read_pcd_file(file);
    ASSERT_FALSE(from_memory || from_file);
    EXPECT_EQ(to_string(from_file.error()), to_string(from_memory.error()));
  }
}

}  // namespace
}  // namespace kilter
