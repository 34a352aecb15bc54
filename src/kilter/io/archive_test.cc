// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/archive.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kilter/base/rng.h"
#include "kilter/io/archive_format.h"
#include "testing/allocation_watch.h"
#include "testing/archives.h"
#include "testing/temp_folder.h"

namespace kilter {
namespace {

using kilter_testing::small_archive;
using ::testing::HasSubstr;

// Writes `word` little-endian over the bytes at `at`.
template <typename Word>
void overwrite(std::string& bytes, std::size_t at, Word word) {
  for (std::size_t i = 0; i < sizeof(Word); ++i) bytes[at + i] = static_cast<char>((word >> (8 * i)) & 0xFF);
}

std::size_t section_at(const std::string& bytes, std::string_view tag) { return bytes.find(tag, 16); }

// Makes all checksums fit again, so that damage reaches the reader behind them.
void mend_checksums(std::string& bytes) {
  std::size_t at = 16;
  while (at + 16 <= bytes.size()) {
    std::uint64_t length = 0;
    for (std::size_t i = 0; i < 8; ++i) {
      length |= static_cast<std::uint64_t>(static_cast<unsigned char>(bytes[at + 8 + i])) << (8 * i);
    }
    if (length > bytes.size() - at - 16) return;
    const std::string_view payload = std::string_view(bytes).substr(at + 16, length);
    overwrite(bytes, at + 4, archive_format::checksum(payload));
    at += 16 + length;
  }
}

TEST(Archive, ReadsBackWhatWasWritten) {
  const std::string bytes = archive_bytes(small_archive());
  const auto archive = parse_archive(bytes, "f");
  ASSERT_TRUE(archive.has_value()) << to_string(archive.error());
  EXPECT_EQ(archive->json, small_archive().json);
  EXPECT_EQ(archive->picture.clouds[0].points, small_archive().picture.clouds[0].points);
  EXPECT_EQ(archive->picture.pairs[0].target.after, small_archive().picture.pairs[0].target.after);
  EXPECT_EQ(archive_bytes(*archive), bytes);
}

TEST(Archive, EveryTruncationIsRefused) {
  const std::string bytes = archive_bytes(small_archive());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    std::string cut = bytes.substr(0, size);
    EXPECT_FALSE(parse_archive(cut, "f").has_value()) << size;
    mend_checksums(cut);
    EXPECT_FALSE(parse_archive(cut, "f").has_value()) << size;
  }
  EXPECT_FALSE(parse_archive(bytes + '\0', "f").has_value());
}

TEST(Archive, EveryFlippedByteIsRefused) {
  const std::string bytes = archive_bytes(small_archive());
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    std::string wrong = bytes;
    wrong[i] = static_cast<char>(wrong[i] ^ 0x5A);
    const auto archive = parse_archive(wrong, "f");
    ASSERT_FALSE(archive.has_value()) << i;
    EXPECT_TRUE(archive.error().where.starts_with("f")) << i;
    EXPECT_FALSE(archive.error().hint.empty()) << i;
  }
}

// Damage whose checksum fits: an answer, and one that can be written again, but never more memory than bytes.
TEST(Archive, NoMutationBehindAFittingChecksumDoesHarm) {
  const std::string bytes = archive_bytes(small_archive());
  Rng rng(7, 0);
  for (int round = 0; round < 20000; ++round) {
    std::string wrong = bytes;
    const std::size_t at = static_cast<std::size_t>(rng.uniform() * static_cast<double>(bytes.size()));
    const double kind = rng.uniform();
    if (kind < 0.5) {
      wrong[at] = static_cast<char>(static_cast<int>(rng.uniform() * 256.0));
    } else if (at + 8 <= bytes.size()) {
      overwrite(wrong, at, kind < 0.75 ? 0xFFFFFFFFU : 0x7FFFFFFFU);
    }
    mend_checksums(wrong);
    kilter_testing::largest_allocation() = 0;
    const auto archive = parse_archive(wrong, "f");
    EXPECT_LE(kilter_testing::largest_allocation(), 4 * bytes.size() + 4096) << "round " << round;
    if (archive) {
      EXPECT_EQ(archive_bytes(*archive), wrong) << "round " << round;
    }
  }
}

TEST(Archive, PartsThatDoNotFitEachOtherAreRefused) {
  Archive archive = small_archive();
  archive.picture.paths.pop_back();
  const auto parsed = parse_archive(archive_bytes(archive), "f");
  ASSERT_FALSE(parsed.has_value());
  EXPECT_THAT(parsed.error().message, HasSubstr("2 robots, 2 submaps and 1 pairs, the picture of 1, 2 and 1"));

  archive = small_archive();
  archive.picture.pairs[0].source.before.push_back(1);
  archive.picture.pairs[0].source.after.push_back(1);
  EXPECT_THAT(parse_archive(archive_bytes(archive), "f").error().message, HasSubstr("3 samples"));

  archive = small_archive();
  std::swap(archive.picture.pairs[0].id.source, archive.picture.pairs[0].id.target);
  EXPECT_FALSE(parse_archive(archive_bytes(archive), "f").has_value());

  for (const char* json : {"", "{", "[]", "{}", R"({"schema": "kilter.result/2"})", R"({"schema": 1})",
                           R"({"schema": "kilter.result/1", "robots": 3})"}) {
    archive = small_archive();
    archive.json = json;
    EXPECT_FALSE(parse_archive(archive_bytes(archive), "f").has_value()) << json;
  }
}

TEST(Archive, DeepNestingIsNoTrouble) {
  Archive archive = small_archive();
  archive.json.insert(1, R"("deep": )" + std::string(200000, '[') + std::string(200000, ']') + ", ");
  EXPECT_TRUE(parse_archive(archive_bytes(archive), "f").has_value());
}

TEST(Archive, OthersFilesAndLaterVersionsAreNamedForWhatTheyAre) {
  const auto other = parse_archive("ply\nformat ascii 1.0\n", "f");
  EXPECT_EQ(other.error().code, ErrorCode::kParse);
  EXPECT_THAT(other.error().hint, HasSubstr("result.kilter"));
  std::string later = archive_bytes(small_archive());
  overwrite(later, 8, std::uint32_t{2});
  EXPECT_EQ(parse_archive(later, "f").error().code, ErrorCode::kUnsupported);
  std::string named = archive_bytes(small_archive());
  const std::size_t at = section_at(named, "CLDS");
  overwrite(named, at, std::uint32_t{0x41414141});
  EXPECT_THAT(parse_archive(named, "f").error().message, HasSubstr("expected section CLDS"));
}

TEST(Archive, AFolderStandsForTheArchiveInIt) {
  const kilter_testing::TempFolder folder;
  const std::string bytes = archive_bytes(small_archive());
  const auto file = folder.write("result.kilter", bytes);
  EXPECT_EQ(*read_archive_bytes(folder.path()), bytes);
  EXPECT_EQ(*read_archive_bytes(file), bytes);
  EXPECT_EQ(read_archive_bytes(folder.path() / "absent").error().code, ErrorCode::kNotFound);
}

}  // namespace
}  // namespace kilter
