// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/report/pictures_png.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include "kilter/report/coloured_ply.h"
#include "kilter/report/image.h"
#include "testing/results.h"

namespace kilter {
namespace {

using testing::small_result;

std::uint32_t big_endian(const std::string& bytes, std::size_t at) {
  std::uint32_t word = 0;
  for (std::size_t i = 0; i < 4; ++i) word = word << 8 | static_cast<unsigned char>(bytes[at + i]);
  return word;
}

// Reads what Image::png writes: one IDAT, no filters.
Image decoded(const std::string& png) {
  EXPECT_EQ(png.substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_EQ(png.substr(12, 4), "IHDR");
  const int width = static_cast<int>(big_endian(png, 16));
  const int height = static_cast<int>(big_endian(png, 20));
  const std::uint32_t packed = big_endian(png, 33);
  EXPECT_EQ(png.substr(37, 4), "IDAT");
  EXPECT_EQ(png.substr(png.size() - 8, 4), "IEND");
  std::string rows(static_cast<std::size_t>(height) * (3 * static_cast<std::size_t>(width) + 1), '\0');
  uLongf size = rows.size();
  EXPECT_EQ(::uncompress(reinterpret_cast<Bytef*>(rows.data()), &size, reinterpret_cast<const Bytef*>(png.data() + 41),
                         packed),
            Z_OK);
  Image image(width, height, {});
  std::size_t at = 0;
  for (int y = 0; y < height; ++y) {
    EXPECT_EQ(rows[at++], '\0');
    for (int x = 0; x < width; ++x, at += 3) {
      image.set(x, y,
                {static_cast<std::uint8_t>(rows[at]), static_cast<std::uint8_t>(rows[at + 1]),
                 static_cast<std::uint8_t>(rows[at + 2])});
    }
  }
  return image;
}

Result drawn_result() {
  Result result = small_result();
  Picture picture;
  picture.paths = {{{0.0, 0.0, 0.0}, {10.0, 0.0, 0.0}}, {{0.0, 5.0, 0.0}}};
  for (std::size_t i = 0; i < result.submaps.size(); ++i) {
    CloudPicture cloud;
    cloud.voxels = 2;
    cloud.step_m = 0.001;
    cloud.points = {{0, 0, 0}, {1000, 2000, 500}};
    cloud.misalignment = {0, 44};
    picture.clouds.push_back(cloud);
  }
  for (const PairResult& pair : result.pairs) {
    PairPicture drawn;
    drawn.id = pair.id;
    picture.pairs.push_back(drawn);
  }
  result.picture = picture;
  return result;
}

TEST(Image, DrawsOnlyInside) {
  Image image(4, 3, {9, 9, 9});
  image.fill(-5, -5, 100, 6, {1, 2, 3});
  image.line(-1e9, 1.0, 1e9, 1.0, 1, {4, 5, 6});
  image.digits(-2, 1, "8e+5", 3, {7, 7, 7});
  EXPECT_EQ(image.at(0, 0), (Rgb{1, 2, 3}));
  const Image again = decoded(image.png());
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 4; ++x) EXPECT_EQ(again.at(x, y), image.at(x, y));
  }
}

TEST(MatrixPng, ACellHasTheColourOfItsValueAndGreyWithoutOne) {
  const Result result = small_result();
  const std::map<PairId, double> cells = {{{{1}, {0}}, 10.0}, {{{2}, {0}}, 1000.0}, {{{2}, {1}}, -3.0}};
  const Image image = decoded(matrix_png(result, cells, {10.0, 1000.0, -3.0}));
  const int cell = (640 - 32) / 3;
  const auto middle = [&](int row, int column) {
    return image.at(16 + column * cell + cell / 2, 16 + row * cell + cell / 2);
  };
  EXPECT_EQ(middle(1, 0), scale_colour(0.0));
  EXPECT_EQ(middle(2, 0), scale_colour(1.0));
  EXPECT_EQ(middle(2, 1), below_scale_colour());
}

TEST(MatrixPng, ManySubmapsAndNoneAreDrawnToo) {
  Result result = testing::result_of({{"a", 500}});
  EXPECT_EQ(decoded(matrix_png(result, {}, {})).width(), 1032);
  result = testing::result_of({{"a", 2500}});
  const Image shared = decoded(matrix_png(result, {{{{2499}, {0}}, 10.0}}, {10.0}));
  EXPECT_EQ(shared.width(), 2 * 834 + 32);                    // three submaps to a cell
  EXPECT_EQ(shared.at(17, 16 + 2 * 833), scale_colour(0.5));  // the last row of pixels is the robot's border
  result = testing::result_of({});
  EXPECT_GT(decoded(matrix_png(result, {}, {})).width(), 100);
}

TEST(MapPng, ShowsTheInconsistentPair) {
  const Result result = drawn_result();
  const Image image = decoded(map_png(result));
  int bad = 0;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) bad += image.at(x, y) == verdict_colour(Verdict::kInconsistent);
  }
  EXPECT_GT(bad, 10);
  EXPECT_LE(image.width(), 1300);
}

// Clouds in world coordinates, as other programs write them: their poses tell of no robot.
TEST(MapPng, ShowsFinishedCloudsWhereverTheirPosesAre) {
  Result result = drawn_result();
  result.picture->paths = {{{0.0, 0.0, 0.0}}, {{0.0, 0.0, 0.0}}};
  for (RobotSummary& robot : result.robots) robot.finished_submaps = true;
  for (SubmapSummary& submap : result.submaps) {
    submap.scans.reset();
    submap.T_world_submap = Pose3();
    CloudPicture& cloud = result.picture->clouds[static_cast<std::size_t>(submap.id.value)];
    cloud.origin_m = {200.0 + 5.0 * submap.id.value, 100.0, 30.0};
    cloud.step_m = 0.01;
    cloud.points.clear();
    for (std::uint16_t x = 0; x < 1000; x += 10) {
      for (std::uint16_t z = 0; z <= 250; z += 25) cloud.points.push_back({x, static_cast<std::uint16_t>(x / 2), z});
    }
    cloud.misalignment.assign(cloud.points.size(), 0);
  }
  const Image image = decoded(map_png(result));
  int drawn = 0;
  int bad = 0;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      drawn += image.at(x, y) != Rgb{255, 255, 255};
      bad += image.at(x, y) == verdict_colour(Verdict::kInconsistent);
    }
  }
  EXPECT_GT(drawn, 300);
  EXPECT_GT(bad, 100);  // from the middle of one cloud to that of the other
}

TEST(ColouredPly, HoldsEveryPointWithItsRobotSubmapAndMisalignment) {
  const Result result = drawn_result();
  const std::string ply = coloured_ply(result, 0.1);
  const std::size_t body = ply.find("end_header\n") + 11;
  ASSERT_NE(ply.find("element vertex 6\n"), std::string::npos);
  EXPECT_NE(ply.find("comment misalignment 2.54 is that or more, -1 none known\n"), std::string::npos);
  EXPECT_EQ(ply.size() - body, 6U * 39U);
  const auto word = [&](std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i)
      value |= static_cast<std::uint32_t>(static_cast<unsigned char>(ply[at + i])) << (8 * i);
    return value;
  };
  const std::size_t last = body + 5 * 39;
  EXPECT_EQ(word(last + 27), 1U);  // robot b
  EXPECT_EQ(word(last + 31), 2U);  // the third submap
  EXPECT_FLOAT_EQ(std::bit_cast<float>(word(last + 35)), 0.43F);
  EXPECT_FLOAT_EQ(std::bit_cast<float>(word(body + 35)), -1.0F);
}

}  // namespace
}  // namespace kilter
