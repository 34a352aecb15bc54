// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/temporary_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <mutex>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include "kilter/io/file.h"
#include "kilter/io/open_file.h"

namespace kilter {
namespace {

tl::unexpected<Error> refuse(int error, const std::filesystem::path& folder) {
  const bool full = error == ENOSPC || error == EDQUOT || error == EFBIG;
  return fail(full ? ErrorCode::kNoSpace : ErrorCode::kIo,
              fmt::format("no temporary file can be written there: {}", reason(error)), shown(folder));
}

// A file that no name leads to. \return its number, or -1 and errno.
int open_nameless(const std::filesystem::path& folder) {
  const int nameless = open_retrying(folder, O_RDWR | O_TMPFILE | O_EXCL, 0600);
  if (nameless >= 0 || (errno != EOPNOTSUPP && errno != EISDIR && errno != EINVAL)) return nameless;
  std::string name = (folder / "kilter-XXXXXX").string();  // a file system without O_TMPFILE
  const int named = ::mkostemp(name.data(), O_CLOEXEC);
  if (named >= 0) ::unlink(name.c_str());
  return named;
}

class TemporaryFile final : public SpillSpace {
 public:
  explicit TemporaryFile(std::filesystem::path folder) : folder_(std::move(folder)) {}

  Expected<SpillPlace> write(std::span<const std::byte> bytes) override;
  Expected<void> read(const SpillPlace& place, std::span<std::byte> bytes) override;

 private:
  Expected<int> open();  // mutex_ held

  std::filesystem::path folder_;
  std::mutex mutex_;
  std::optional<Descriptor> file_;  // absent until something is written
  std::uint64_t end_ = 0;
};

Expected<int> TemporaryFile::open() {
  if (!file_) {
    const int number = open_nameless(folder_);
    if (number < 0) return refuse(errno, folder_);
    file_.emplace(number);
  }
  return file_->number();
}

Expected<SpillPlace> TemporaryFile::write(std::span<const std::byte> bytes) {
  SpillPlace place{0, bytes.size()};
  int number = -1;
  {
    const std::scoped_lock lock(mutex_);
    const Expected<int> file = open();
    if (!file) return pass_up(file.error());
    number = *file;
    place.offset = end_;
    end_ += bytes.size();
  }
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t step = ::pwrite(number, bytes.data() + done, std::min(bytes.size() - done, kMaxStep),
                                  static_cast<off_t>(place.offset + done));
    if (step < 0 && errno == EINTR) continue;
    if (step < 0) return refuse(errno, folder_);
    done += static_cast<std::size_t>(step);
  }
  return place;
}

Expected<void> TemporaryFile::read(const SpillPlace& place, std::span<std::byte> bytes) {
  int number = -1;
  {
    const std::scoped_lock lock(mutex_);
    if (file_) number = file_->number();
  }
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t step = ::pread(number, bytes.data() + done, std::min(bytes.size() - done, kMaxStep),
                                 static_cast<off_t>(place.offset + done));
    if (step < 0 && errno == EINTR) continue;
    if (step < 0) {
      return fail(ErrorCode::kIo, fmt::format("the temporary file cannot be read: {}", reason(errno)), shown(folder_));
    }
    if (step == 0) return fail(ErrorCode::kTruncated, "the temporary file is shorter than it was", shown(folder_));
    done += static_cast<std::size_t>(step);
  }
  return {};
}

}  // namespace

std::filesystem::path folder_for_large_temporary_files() {
  if (const char* asked = std::getenv("TMPDIR"); asked != nullptr && *asked != '\0') return asked;
  if (::access("/var/tmp", W_OK | X_OK) == 0) return "/var/tmp";
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::temp_directory_path(error);
  return error ? std::filesystem::path("/tmp") : folder;
}

std::unique_ptr<SpillSpace> temporary_file_in(std::filesystem::path folder) {
  return std::make_unique<TemporaryFile>(std::move(folder));
}

}  // namespace kilter
