// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "apps/kilter/staging_folder.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "kilter/io/file.h"
#include "testing/temp_folder.h"

namespace kilter::app {
namespace {

using kilter_testing::TempFolder;
namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
  const Expected<ByteBuffer> bytes = read_file(file);
  return bytes ? std::string(bytes->view()) : bytes.error().message;
}

// Publishes new files a and maps/m, and b, in whose place a folder stands.
void expect_refused(const fs::path& folder, const std::vector<fs::path>& earlier) {
  Expected<StagingFolder> staging = StagingFolder::make_in(folder);
  ASSERT_TRUE(staging);
  for (const char* name : {"a", "maps/m", "b"}) ASSERT_TRUE(staging->write(name, "new"));
  const Expected<void> published = staging->publish({"a", "maps/m", "b"}, earlier);
  ASSERT_FALSE(published);
  EXPECT_EQ(published.error().code, ErrorCode::kIo);
  EXPECT_EQ(published.error().message, "cannot be written: Is a directory");
  EXPECT_EQ(published.error().where, (folder / "b").string());
  EXPECT_EQ(published.error().hint, "");
  EXPECT_FALSE(fs::exists(staging->path() / ".earlier"));
}

TEST(StagingFolder, PublishesAllOrNothing) {
  const TempFolder folder;
  folder.write("a", "old");
  folder.write("b/c", "old");
  for (const std::vector<fs::path>& earlier : {std::vector<fs::path>{}, {"a"}}) {
    expect_refused(folder.path(), earlier);
    EXPECT_EQ(text_of(folder.path() / "a"), "old");
    EXPECT_EQ(text_of(folder.path() / "b" / "c"), "old");
    EXPECT_EQ(list_folder(folder.path()).value(), (std::vector<std::string>{"a", "b"}));
  }
  fs::remove(folder.path() / "a");
  expect_refused(folder.path(), {});
  EXPECT_EQ(list_folder(folder.path()).value(), std::vector<std::string>{"b"});
}

TEST(StagingFolder, ReplacesLinksAndMovesEarlierFilesAway) {
  const TempFolder folder;
  folder.write("target", "old");
  folder.write("earlier", "old");
  fs::create_symlink("target", folder.path() / "a");
  {
    Expected<StagingFolder> staging = StagingFolder::make_in(folder.path());
    ASSERT_TRUE(staging);
    ASSERT_TRUE(staging->write("a", "new"));
    ASSERT_TRUE(staging->publish({"a"}, {"earlier"}));
  }
  EXPECT_EQ(text_of(folder.path() / "a"), "new");
  EXPECT_EQ(text_of(folder.path() / "target"), "old");
  EXPECT_EQ(list_folder(folder.path()).value(), (std::vector<std::string>{"a", "target"}));
}

}  // namespace
}  // namespace kilter::app
