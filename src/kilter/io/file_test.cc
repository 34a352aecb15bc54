// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/file.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <limits>
#include <thread>
#include <vector>

#include "testing/temp_folder.h"

namespace kilter {
namespace {

using kilter_testing::bytes_of;
using kilter_testing::TempFolder;
namespace fs = std::filesystem;

TEST(ReadFile, GivesEveryByte) {
  const TempFolder folder;
  const std::string bytes("a\0b\r\n\xFF", 6);
  const auto read = read_file(folder.write("f", bytes));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->view(), bytes);
}

TEST(ReadFile, GivesEveryByteOfALargeFile) {
  const TempFolder folder;
  std::string bytes(std::size_t{9} << 20, '\0');
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i * 2654435761U >> 24);
  const auto read = read_file(folder.write("f", bytes));
  ASSERT_TRUE(read);
  EXPECT_TRUE(read->view() == bytes);
}

TEST(ReadFile, ReadsAnEmptyFileAsNothing) {
  const TempFolder folder;
  const auto read = read_file(folder.write("f", ""));
  ASSERT_TRUE(read);
  EXPECT_TRUE(read->view().empty());
}

TEST(ReadFile, SaysWhichFileIsNotThere) {
  const TempFolder folder;
  const auto read = read_file(folder.path() / "none");
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::kNotFound);
  EXPECT_EQ(read.error().where, (folder.path() / "none").string());
}

TEST(ReadFile, RefusesWhatIsNoRegularFileWithoutWaitingForIt) {
  const TempFolder folder;
  ASSERT_EQ(::mkfifo((folder.path() / "pipe").c_str(), 0600), 0);
  for (const fs::path& path : {folder.path(), folder.path() / "pipe", fs::path("/dev/zero")}) {
    const auto read = read_file(path);
    ASSERT_FALSE(read) << path;
    EXPECT_EQ(read.error().code, ErrorCode::kIo) << path;
  }
}

TEST(ReadFile, RefusesMoreThanItsLimitBeforeReading) {
  const TempFolder folder;
  const fs::path sparse = folder.write("sparse", "x");
  fs::resize_file(sparse, std::uint64_t{1} << 36);
  EXPECT_EQ(read_file(sparse).error().code, ErrorCode::kUnsupported);
  EXPECT_EQ(read_file(folder.write("five", "12345"), 4).error().code, ErrorCode::kUnsupported);
  EXPECT_TRUE(read_file(folder.path() / "five", 5));
}

TEST(ReadFile, TellsWhenAFileEndsBeforeItsSize) {
  // The kernel's own files say a page and hold a line, which is how a file that shrinks looks.
  const fs::path kernel_file = "/sys/kernel/mm/transparent_hugepage/enabled";
  std::error_code error;
  if (fs::file_size(kernel_file, error) == 0 || error) GTEST_SKIP() << "no " << kernel_file;
  const auto read = read_file(kernel_file);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::kTruncated);
}

TEST(ByteBuffer, ReportsMemoryThatIsNotToBeHad) {
  const auto buffer = ByteBuffer::allocate(std::numeric_limits<std::size_t>::max() / 4);
  ASSERT_FALSE(buffer);
  EXPECT_EQ(buffer.error().code, ErrorCode::kOutOfMemory);
}

TEST(WriteFile, ReplacesWhatWasThereAndLeavesNothingElse) {
  const TempFolder folder;
  const fs::path file = folder.write("result.json", "old");
  ASSERT_TRUE(write_file_atomically(file, "new"));
  EXPECT_EQ(bytes_of(file), "new");
  EXPECT_EQ(list_folder(folder.path()).value(), std::vector<std::string>{"result.json"});
}

TEST(WriteFile, ReplacesALinkInsteadOfFollowingIt) {
  const TempFolder folder;
  const fs::path victim = folder.write("victim", "keep");
  fs::create_symlink(victim, folder.path() / "link");
  ASSERT_TRUE(write_file_atomically(folder.path() / "link", "new"));
  EXPECT_EQ(bytes_of(victim), "keep");
  EXPECT_FALSE(fs::is_symlink(folder.path() / "link"));
  EXPECT_EQ(bytes_of(folder.path() / "link"), "new");
}

TEST(WriteFile, FailsWithoutTheFolderAndOverAFolder) {
  const TempFolder folder;
  fs::create_directories(folder.path() / "d" / "inside");
  EXPECT_EQ(write_file_atomically(folder.path() / "none" / "f", "x").error().code, ErrorCode::kIo);
  EXPECT_EQ(write_file_atomically(folder.path() / "d", "x").error().code, ErrorCode::kIo);
  EXPECT_EQ(list_folder(folder.path()).value(), std::vector<std::string>{"d"});
}

// Lets files of this process grow to `bytes` only, as a full disk or a quota would.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : old_handler_(::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &old_);
    const rlimit limit{bytes, old_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &old_);
    ::signal(SIGXFSZ, old_handler_);
  }

 private:
  rlimit old_{};
  void (*old_handler_)(int);
};

TEST(WriteFile, KeepsTheOldFileWhenThereIsNoRoom) {
  const TempFolder folder;
  const fs::path file = folder.write("result.json", "old");
  Expected<void> written;
  {
    const FileSizeLimit limit(1000);
    written = write_file_atomically(file, std::string(5000, 'x'));
  }
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, ErrorCode::kNoSpace);
  EXPECT_EQ(bytes_of(file), "old");
  EXPECT_EQ(list_folder(folder.path()).value().size(), 1U);
}

TEST(WriteFile, NeverShowsHalfAFileToAReader) {
  const TempFolder folder;
  const fs::path file = folder.path() / "f";
  const std::string a(100'000, 'a');
  const std::string b(200'000, 'b');
  ASSERT_TRUE(write_file_atomically(file, a));
  std::jthread writer([&](const std::stop_token& stop) {
    for (int i = 0; i < 20 && !stop.stop_requested(); ++i) {
      EXPECT_TRUE(write_file_atomically(file, i % 2 == 0 ? b : a));
    }
  });
  for (int i = 0; i < 100; ++i) {
    const auto read = read_file(file);
    ASSERT_TRUE(read);
    EXPECT_TRUE(read->view() == a || read->view() == b);
  }
}

TEST(ListFolder, SortsBytewise) {
  const TempFolder folder;
  for (const char* name : {"b", "a", "B", "10", "9", "\xC3\xA4"}) folder.write(name, "");
  const std::vector<std::string> sorted = {"10", "9", "B", "a", "b", "\xC3\xA4"};
  EXPECT_EQ(list_folder(folder.path()).value(), sorted);
}

TEST(ListFolder, TellsAMissingFolderFromAFile) {
  const TempFolder folder;
  EXPECT_EQ(list_folder(folder.path() / "none").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(list_folder(folder.write("f", "")).error().code, ErrorCode::kIo);
}

TEST(Shown, KeepsTerminalsSafe) { EXPECT_EQ(shown("a\x1B[2J/b"), "a?[2J/b"); }

}  // namespace
}  // namespace kilter
