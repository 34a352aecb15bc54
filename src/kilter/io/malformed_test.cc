// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What every reader promises about bytes that nobody meant to write: an answer, never a crash, and no memory that
// the bytes do not justify.
#include <gtest/gtest.h>
#include <liblzf/lzf.h>

#include <functional>
#include <iterator>
#include <string>
#include <vector>

#include "kilter/base/rng.h"
#include "kilter/io/bin_reader.h"
#include "kilter/io/cuts.h"
#include "kilter/io/g2o_reader.h"
#include "kilter/io/las_reader.h"
#include "kilter/io/octree_reader.h"
#include "kilter/io/pcd_reader.h"
#include "kilter/io/ply_reader.h"
#include "kilter/io/pose_list.h"
#include "kilter/io/pose_reader.h"
#include "kilter/io/sources/glim_dump.h"
#include "kilter/io/sources/hdl_dump.h"
#include "kilter/io/sources/kitti_sequence.h"
#include "testing/allocation_watch.h"
#include "testing/cloud_bytes.h"
#include "testing/las_bytes.h"
#include "testing/octree_bytes.h"

namespace kilter {
namespace {

using kilter_testing::largest_allocation;
using kilter_testing::PcdBytes;
using kilter_testing::ply_bytes;
using kilter_testing::put;
using kilter_testing::put_all;
using kilter_testing::two_float_points;

// A valid file, and a reader that says whether it accepts some bytes.
struct Sample {
  std::string name;
  std::string bytes;
  std::function<bool(const std::string&)> accepts;
  /// Bytes at the end without which the file is still whole: a line end, or digits of the last number.
  std::size_t spare = 0;
};

std::string compressed_body() {
  std::string fields;
  put_all<float>(fields, std::endian::little, 1, 1, 1, 1, 1, 1);
  std::string packed(100, '\0');
  packed.resize(lzf_compress(fields.data(), 24, packed.data(), 100));
  std::string body;
  put_all<std::uint32_t>(body, std::endian::little, packed.size(), 24);
  return body + packed;
}

std::vector<Sample> samples() {
  const auto pcd = [](const std::string& b) { return read_pcd(b, "f").has_value(); };
  const auto ply = [](const std::string& b) { return read_ply(b, "f").has_value(); };
  const auto poses = [](const std::string& b) { return read_poses(b, "f").has_value(); };
  const auto bin = [](const std::string& b) { return read_bin(b, "f").has_value(); };
  const auto las = [](const std::string& b) { return read_las(b, "f").has_value(); };
  const auto octree = [](const std::string& b) { return read_octree(b, "f").has_value(); };
  const auto cuts = [](const std::string& b) { return parse_cuts(b, "f").has_value(); };
  const std::string list = "element face 1\nproperty list uchar int i\nproperty char c\n";
  std::string face;
  put_all<std::uint8_t>(face, std::endian::little, 1);
  put_all<std::int32_t>(face, std::endian::little, 5);
  put_all<std::uint8_t>(face, std::endian::little, 5);
  std::string record;
  put_all<float>(record, std::endian::little, 1, 2, 3, 4);
  return {
      {"pcd ascii", PcdBytes{.body = "1 2 3\n4 5 6\n"}.str(), pcd, 1},
      {"pcd binary", PcdBytes{.data = "binary", .body = two_float_points()}.str(), pcd},
      {"pcd compressed", PcdBytes{.data = "binary_compressed", .body = compressed_body()}.str(), pcd},
      {"ply ascii", ply_bytes("ascii", "1 0 5\n1 2 3\n4 5 6\n", list), ply, 1},
      {"ply little", ply_bytes("binary_little_endian", face + two_float_points(), list), ply},
      {"ply big", ply_bytes("binary_big_endian", two_float_points(std::endian::big)), ply},
      {"bin", record, bin},
      {"las 1.2", kilter_testing::LasBytes().str(), las},
      {"las 1.4", kilter_testing::LasBytes::version_1_4().str(), las},
      {"ot", kilter_testing::full_octree().str(), octree},
      {"bt", kilter_testing::binary_octree().str(), octree},
      {"tum", "# t x y z qx qy qz qw\n0 1.5 2 -3e0 0 0 0 1\n", poses, 1},
      {"kitti", "1 0 0 1 0 1 0 2 0 0 1 3\n", poses, 1},
      {"cuts", R"({"schema":"kilter.result/1","submaps":[{"robot":"a","first_scan":0,"last_scan":3}],"pairs":[]})",
       cuts},
      {"g2o", "FIX 0\nVERTEX_SE3:QUAT 0 1 2 3 0 0 0 1\n",
       [](const auto& b) { return read_g2o_vertices(b, "f").has_value(); }, 1},
      {"pose table", "t,x,y,z,qx,qy,qz,qw\n0.5,1,2,3,0,0,0,1\n",
       [](const auto& b) { return read_pose_list(b, "f").has_value(); }, 1},
      {"glim data.txt", "id: 0\nT_world_origin: \n1 0 0 5\n0 1 0 6\n0 0 1 7\n0 0 0 1\n",
       [](const auto& b) { return parse_glim_submap(b, "f").has_value(); }, 1},
      {"glim points", record.substr(0, 12), [](const auto& b) { return read_glim_points(b, true, "f").has_value(); }},
      {"hdl data", "stamp 1 2\nestimate\n1 0 0 5\n0 1 0 6\n0 0 1 7\n0 0 0 1\n",
       [](const auto& b) {
         const auto frame = parse_hdl_key_frame(b, "f");
         return frame && frame->estimate;
       },
       1},
      {"kitti calib.txt", "P0: 1\nTr: 1 0 0 1 0 1 0 2 0 0 1 3\n",
       [](const auto& b) { return parse_kitti_calibration(b, "f").has_value(); }, 1},
  };
}

// One to four small accidents: bits, bytes, numbers, pieces.
std::string damaged(std::string bytes, Rng& rng) {
  constexpr const char* kPieces[] = {"-1", "4000000000",       "65537", "nan", "1e400", "\n",
                                     " ",  "\xFF\xFF\xFF\xFF", "0",     "x"};
  const auto place = [&] { return rng.below(bytes.size() + 1); };
  for (std::uint64_t i = 0, times = 1 + rng.below(4); i < times; ++i) {
    const std::size_t at = place();
    switch (rng.below(5)) {
      case 0:
        if (at < bytes.size()) bytes[at] = static_cast<char>(bytes[at] ^ (1 << rng.below(8)));
        break;
      case 1:
        if (at < bytes.size()) bytes[at] = static_cast<char>(rng.below(256));
        break;
      case 2:
        bytes.insert(at, kPieces[rng.below(std::size(kPieces))]);
        break;
      case 3:
        bytes.erase(at, rng.below(12));
        break;
      default:
        bytes.insert(place(), bytes.substr(at, rng.below(40)));
    }
  }
  return bytes;
}

TEST(EveryReader, AcceptsItsSample) {
  for (const Sample& sample : samples()) EXPECT_TRUE(sample.accepts(sample.bytes)) << sample.name;
}

TEST(EveryReader, RefusesEveryFileCutShort) {
  for (const Sample& sample : samples()) {
    for (std::size_t length = 0; length + sample.spare < sample.bytes.size(); ++length) {
      EXPECT_FALSE(sample.accepts(sample.bytes.substr(0, length))) << sample.name << " cut to " << length << " bytes";
    }
  }
}

TEST(EveryReader, AnswersDamagedFilesWithinTheirMemory) {
  for (std::size_t s = 0; s < samples().size(); ++s) {
    const Sample sample = samples()[s];
    Rng rng(20240229, s);
    int refused = 0;
    for (int i = 0; i < 3000; ++i) {
      const std::string bytes = damaged(sample.bytes, rng);
      largest_allocation() = 0;
      if (!sample.accepts(bytes)) ++refused;
      // LZF may expand 88 times; everything else stays below that. The first term is messages and tables.
      ASSERT_LE(largest_allocation(), 4096 + 100 * bytes.size()) << sample.name << ":\n" << bytes;
    }
    EXPECT_GT(refused, 100) << sample.name;
  }
}

TEST(EveryReader, AnswersNoise) {
  for (const Sample& sample : samples()) {
    Rng rng(7, 7);
    for (std::size_t length = 0; length < 300; ++length) {
      std::string noise(length, '\0');
      for (char& c : noise) c = static_cast<char>(rng.below(256));
      largest_allocation() = 0;
      const bool accepted = sample.accepts(noise);
      EXPECT_TRUE(!accepted || sample.name == "bin" || sample.name == "glim points")
          << sample.name;  // any 16 bytes are a point, or any 12
      EXPECT_LE(largest_allocation(), 4096 + 100 * length) << sample.name;
    }
  }
}

TEST(EveryReader, AllocatesNothingForClaimsOfBillions) {
  const std::vector<std::string> bombs = {
      PcdBytes{.width = "4000000000", .points = "4000000000"}.str(),
      PcdBytes{.width = "65536", .height = "65537", .points = "4295032832"}.str(),
      PcdBytes{.width = "4000000000", .points = "4000000000", .data = "binary", .body = two_float_points()}.str(),
      PcdBytes{.width = "357913941",
               .points = "357913941",
               .data = "binary_compressed",
               .body = std::string("\x10\0\0\0\xFC\xFF\xFF\xFF", 8) + std::string(16, '\0')}
          .str(),
      PcdBytes{.count = "1 1 4000000000"}.str(),
  };
  for (const std::string& bomb : bombs) {
    largest_allocation() = 0;
    EXPECT_FALSE(read_pcd(bomb, "f"));
    EXPECT_LE(largest_allocation(), 4096U) << bomb;
  }
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\n"
      "property float z\nend_header\n1 2 3\n";
  largest_allocation() = 0;
  EXPECT_FALSE(read_ply(ply, "f"));
  EXPECT_LE(largest_allocation(), 4096U);
}

}  // namespace
}  // namespace kilter
