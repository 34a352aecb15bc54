// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/ply_reader.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "kilter/io/bin_reader.h"
#include "testing/cloud_bytes.h"

namespace kilter {
namespace {

using kilter_testing::ply_bytes;
using kilter_testing::put;
using kilter_testing::put_all;
using kilter_testing::two_float_points;
using Points = std::vector<Eigen::Vector3f>;

const Points kTwoPoints = {{1, 2, 3}, {4, 5, 6}};
constexpr const char* kAsciiBody = "1 2 3\n4 5 6\n";

void expect_error(const std::string& bytes, ErrorCode code, const std::string& message_part) {
  const auto cloud = read_ply(bytes, "scan.ply");
  ASSERT_FALSE(cloud) << message_part;
  EXPECT_EQ(error_code_name(cloud.error().code), error_code_name(code)) << to_string(cloud.error());
  EXPECT_NE(to_string(cloud.error()).find(message_part), std::string::npos) << to_string(cloud.error());
  EXPECT_EQ(cloud.error().where.substr(0, 8), "scan.ply");
}

// A header of free text in front of a body.
std::string ply(const std::string& header, const std::string& body = "") {
  return "ply\n" + header + "end_header\n" + body;
}

TEST(ReadPly, ReadsAllThreeFormats) {
  EXPECT_EQ(read_ply(ply_bytes("ascii", kAsciiBody), "").value().points_m, kTwoPoints);
  EXPECT_EQ(read_ply(ply_bytes("binary_little_endian", two_float_points()), "").value().points_m, kTwoPoints);
  EXPECT_EQ(read_ply(ply_bytes("binary_big_endian", two_float_points(std::endian::big)), "").value().points_m,
            kTwoPoints);
}

TEST(ReadPly, SkipsOtherElementsAndLists) {
  const std::string faces = "element face 2\nproperty list uchar int vertex_indices\nproperty uchar red\n";
  const std::string camera = "element camera 1\nproperty double fov\nproperty short id\n";
  const std::string nothing = "element nothing 4000000000\n";
  std::string bytes;
  put_all<std::uint8_t>(bytes, std::endian::big, 2);
  put_all<std::int32_t>(bytes, std::endian::big, 0, 1);
  put_all<std::uint8_t>(bytes, std::endian::big, 255, 0, 255);  // red, an empty list, red
  put_all<double>(bytes, std::endian::big, 1.5);
  put_all<std::int16_t>(bytes, std::endian::big, 3);
  const std::string before = faces + camera + nothing;
  EXPECT_EQ(
      read_ply(ply_bytes("binary_big_endian", bytes + two_float_points(std::endian::big), before), "").value().points_m,
      kTwoPoints);
  EXPECT_EQ(
      read_ply(ply_bytes("ascii", "2 0 1 255\n0 255\n1.5 3\n" + std::string(kAsciiBody), before), "").value().points_m,
      kTwoPoints);
  EXPECT_EQ(
      read_ply(ply_bytes("ascii", kAsciiBody + std::string("3 0 1 1 9\nrubbish\n"), "", faces), "").value().points_m,
      kTwoPoints);
}

TEST(ReadPly, ReadsVerticesThatHoldLists) {
  const std::string list = "property list ushort double weights\n";
  std::string bytes;
  for (const float first : {1.0F, 4.0F}) {
    put_all<float>(bytes, std::endian::little, first, first + 1, first + 2);
    put_all<std::uint16_t>(bytes, std::endian::little, 2);
    put_all<double>(bytes, std::endian::little, 8, 9);
  }
  EXPECT_EQ(read_ply(ply_bytes("binary_little_endian", bytes, "", list), "").value().points_m, kTwoPoints);
  EXPECT_EQ(read_ply(ply_bytes("ascii", "1 2 3 0\n4 5 6 2 0.5 0.5\n", "", list), "").value().points_m, kTwoPoints);
  expect_error(ply_bytes("ascii", "1 2 3 0\n", "", list), ErrorCode::kTruncated, "2 rows of element \"vertex\"");
  expect_error(ply_bytes("ascii", "1 2 3 -1\n4 5 6 0\n", "", list), ErrorCode::kParse, "length of list \"weights\"");
  expect_error(ply_bytes("ascii", "1 2 3 4000000000 1\n4 5 6 0\n", "", list), ErrorCode::kParse,
               "expected a number for \"weights\"");
  expect_error(ply_bytes("ascii", "1 2 3 0 7\n4 5 6 0\n", "", list), ErrorCode::kParse, "more numbers");
}

TEST(ReadPly, ReadsOldAndNewTypeNamesInAnyOrder) {
  std::string bytes;
  for (const int first : {1, 4}) {
    put_all<std::int16_t>(bytes, std::endian::little, first + 2);
    put_all<double>(bytes, std::endian::little, first);
    put_all<std::uint8_t>(bytes, std::endian::little, 9);
    put_all<std::uint32_t>(bytes, std::endian::little, first + 1);
  }
  for (const std::string types : {"short double uchar uint", "int16 float64 uint8 uint32"}) {
    std::string header = "format binary_little_endian 1.0\nobj_info a scanner\nelement vertex 2\n";
    std::string rest = types;
    for (const char* name : {"z", "x", "red", "y"}) {
      const std::size_t space = rest.find(' ');
      header += "property " + rest.substr(0, space) + " " + name + "\n";
      rest = space == std::string::npos ? "" : rest.substr(space + 1);
    }
    EXPECT_EQ(read_ply(ply(header, bytes), "").value().points_m, kTwoPoints) << types;
  }
}

TEST(ReadPly, DropsAndCountsWhatIsNoPlace) {
  const PointCloud cloud = read_ply(ply_bytes("ascii", "nan 0 0\n0 1e30 0\n"), "").value();
  EXPECT_TRUE(cloud.points_m.empty());
  EXPECT_EQ(cloud.dropped_nonfinite, 1U);
  EXPECT_EQ(cloud.dropped_far, 1U);
}

TEST(ReadPly, ReadsAnEmptyCloudIfTheHeaderMeansIt) {
  const std::string header = "element vertex 0\nproperty float x\nproperty float y\nproperty float z\n";
  for (const std::string format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    const auto cloud = read_ply(ply("format " + format + " 1.0\n" + header), "");
    ASSERT_TRUE(cloud) << format;
    EXPECT_TRUE(cloud->points_m.empty());
  }
}

TEST(ReadPly, ReadsTextOfOtherSystems) {
  std::string crlf = "\xEF\xBB\xBF";
  for (const char c : ply_bytes("ascii", "1 2 3\n\n4 5 6")) crlf += c == '\n' ? "\r\n" : std::string(1, c);
  EXPECT_EQ(read_ply(crlf, "").value().points_m, kTwoPoints);
}

TEST(ReadPly, TellsHowManyRowsArePromisedAndThere) {
  expect_error(ply_bytes("ascii", "1 2 3\n"), ErrorCode::kTruncated, "promises 2 points, but only 1");
  expect_error(ply_bytes("ascii", "1 2 3\n4 5 6\n7 8 9\n"), ErrorCode::kCountMismatch, "more lines follow");
  expect_error(ply_bytes("binary_little_endian", two_float_points().substr(1)), ErrorCode::kTruncated,
               "2 rows of 12 bytes of element \"vertex\", but only 23 bytes follow (1 rows)");
  expect_error(ply_bytes("binary_little_endian", two_float_points() + two_float_points()), ErrorCode::kCountMismatch,
               "24 bytes more");
  const std::string table = "element t 3\nproperty int a\n";
  expect_error(ply_bytes("binary_little_endian", "1234567", table), ErrorCode::kTruncated, "3 rows of 4 bytes");
  expect_error(ply_bytes("ascii", "1\n2\n", table), ErrorCode::kTruncated, "3 rows of element \"t\", but only 2");
  const std::string faces = "element face 2\nproperty list char int i\n";
  expect_error(ply_bytes("binary_little_endian", std::string(3, '\x7F'), faces), ErrorCode::kTruncated,
               "row 0 of 2 of element \"face\"");
  expect_error(ply_bytes("binary_little_endian", std::string(3, '\xFF'), faces), ErrorCode::kTruncated, "row 0 of 2");
}

TEST(ReadPly, NamesLineAndWordThatIsNoNumber) {
  expect_error(ply_bytes("ascii", "1 2 3\n4 x 6\n"), ErrorCode::kParse, "scan.ply:10: expected a number, found \"x\"");
  expect_error(ply_bytes("ascii", "1 2 3\n4 5\n"), ErrorCode::kParse, "expected 3 numbers, found 2");
}

TEST(ReadPly, RefusesClaimsThatTheBytesDoNotJustify) {
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
  for (const std::string count : {"4000000000", "1000000000000000000", "18446744073709551615"}) {
    for (const std::string format : {"ascii", "binary_little_endian"}) {
      const std::string header = "format " + format + " 1.0\n";
      expect_error(ply(header + "element vertex " + count + "\n" + xyz), ErrorCode::kTruncated, "promises " + count);
      expect_error(ply(header + "element a " + count + "\nproperty int i\nelement vertex 1\n" + xyz),
                   ErrorCode::kTruncated, count);
    }
  }
  const std::string faces = "element face 1\nproperty list uint double v\n";
  expect_error(ply_bytes("binary_little_endian", "\xFF\xFF\xFF\xFF" + two_float_points(), faces), ErrorCode::kTruncated,
               "row 0 of 1 of element \"face\"");
}

TEST(ReadPly, RefusesHeadersThatCannotBe) {
  const std::string format = "format ascii 1.0\n";
  const std::string vertex = "element vertex 1\n";
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
  EXPECT_EQ(read_ply("", "").error().code, ErrorCode::kTruncated);
  expect_error("ply\n" + format + vertex + xyz, ErrorCode::kTruncated, "before the end_header line");
  expect_error("VERSION 0.7\n", ErrorCode::kParse, "begins with \"ply\"");
  expect_error(ply(vertex + xyz), ErrorCode::kParse, "no format line");
  expect_error(ply(format + format + vertex + xyz), ErrorCode::kParse, "second format line");
  expect_error(ply("format text 1.0\n"), ErrorCode::kParse, "found \"text\"");
  expect_error(ply("format ascii 2.0\n"), ErrorCode::kUnsupported, "version \"2.0\"");
  expect_error(ply(format), ErrorCode::kParse, "no element \"vertex\"");
  expect_error(ply(format + "property float x\n"), ErrorCode::kParse, "before the first element");
  expect_error(ply(format + "element vertex -1\n" + xyz), ErrorCode::kParse, "found \"-1\"");
  expect_error(ply(format + "element vertex many\n" + xyz), ErrorCode::kParse, "found \"many\"");
  expect_error(ply(format + "element vertex\n" + xyz), ErrorCode::kParse, "found \"\"");
  expect_error(ply(format + vertex + xyz + vertex), ErrorCode::kParse, "declared twice");
  expect_error(ply(format + vertex + "property float x\nproperty float y\n"), ErrorCode::kParse, "number \"z\"");
  expect_error(ply(format + vertex + xyz + "property int x\n"), ErrorCode::kParse,
               "number \"x\" among its properties, found 2");
  expect_error(ply(format + vertex + "property list uchar float x\n"), ErrorCode::kParse, "number \"x\"");
  expect_error(ply(format + vertex + "property half x\n"), ErrorCode::kParse, "found \"half\"");
  expect_error(ply(format + vertex + "property float\n"), ErrorCode::kParse, "property's name");
  expect_error(ply(format + vertex + "property list float int x\n"), ErrorCode::kParse, "integer type");
  expect_error(ply(format + "vertices 1\n"), ErrorCode::kParse, "found \"vertices\"");
  std::string many = format;
  for (int i = 0; i < 300; ++i) many += "element e" + std::to_string(i) + " 1\n";
  expect_error(ply(many), ErrorCode::kUnsupported, "more than 256 elements");
  many = format + vertex;
  for (int i = 0; i < 1100; ++i) many += "property float p\n";
  expect_error(ply(many), ErrorCode::kUnsupported, "more than 1024 properties");
}

TEST(ReadBin, ReadsWholeRecords) {
  std::string bytes;
  put_all<float>(bytes, std::endian::little, 1, 2, 3, 0.5, 4, 5, 6, 0.5);
  EXPECT_EQ(read_bin(bytes, "").value().points_m, kTwoPoints);
}

TEST(ReadBin, CountsWhatIsNoPlace) {
  std::string bytes;
  put_all<float>(bytes, std::endian::little, 1e30, 0, 0, 0, 0, 0, std::numeric_limits<float>::quiet_NaN(), 0);
  const PointCloud cloud = read_bin(bytes, "").value();
  EXPECT_TRUE(cloud.points_m.empty());
  EXPECT_EQ(cloud.dropped_far, 1U);
  EXPECT_EQ(cloud.dropped_nonfinite, 1U);
}

TEST(ReadBin, RefusesPartsOfRecordsAndNothing) {
  const auto part = read_bin(std::string(40, '\0'), "scan.bin");
  ASSERT_FALSE(part);
  EXPECT_EQ(part.error().code, ErrorCode::kTruncated);
  EXPECT_EQ(part.error().message, "40 bytes are 2 points of 16 bytes and 8 bytes more");
  EXPECT_EQ(read_bin("", "scan.bin").error().code, ErrorCode::kTruncated);
}

// nuScenes has x y z intensity ring, others x y z alone; four points of 12 bytes are three of 16.
TEST(ReadBin, RefusesRecordsOfOtherSizes) {
  for (const int columns : {3, 5, 6}) {
    std::string bytes;
    for (int i = 0; i < 400; ++i) {
      const auto k = static_cast<float>(i);
      put_all<float>(bytes, std::endian::little, 10.0F * std::cos(k), 10.0F * std::sin(k), 0.01F * k - 2.0F);
      for (int more = 3; more < columns; ++more) put_all<float>(bytes, std::endian::little, 0.5F);
    }
    ASSERT_EQ(bytes.size() % 16, 0U);
    const auto cloud = read_bin(bytes, "scan.bin");
    ASSERT_FALSE(cloud) << columns;
    EXPECT_EQ(cloud.error().code, ErrorCode::kUnsupported);
    EXPECT_NE(cloud.error().message.find("fourth number"), std::string::npos);
  }
}

TEST(ReadBin, TakesIntensitiesThatScatterAboutZero) {
  std::string bytes;
  for (int i = 0; i < 400; ++i) {
    const auto k = static_cast<float>(i);
    put_all<float>(bytes, std::endian::little, std::cos(k), std::sin(k), 1.0F, 0.9F * std::sin(3.0F * k));
  }
  EXPECT_EQ(read_bin(bytes, "scan.bin").value().points_m.size(), 400U);
}

}  // namespace
}  // namespace kilter
