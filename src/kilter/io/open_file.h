// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>

#include "kilter/base/expected.h"

namespace kilter {

/// An open file of the operating system's, closed with its owner.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(const Descriptor&) = delete;
  Descriptor& operator=(Descriptor&&) = delete;
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }

  [[nodiscard]] int number() const { return number_; }
  [[nodiscard]] bool is_open() const { return number_ >= 0; }
  /// For writers, who must know whether the last bytes arrived. \return 0 or errno.
  int close() { return ::close(std::exchange(number_, -1)) == 0 ? 0 : errno; }

 private:
  int number_;
};

/// Linux moves at most 2 GiB a call; smaller steps also keep a signal's delay short.
inline constexpr std::size_t kMaxStep = std::size_t{1} << 28;

/// `open` with O_CLOEXEC, again after signals. \return the number, or -1 and errno.
[[nodiscard]] int open_retrying(const std::filesystem::path& path, int flags, mode_t mode = 0);

/// What the operating system calls an errno.
[[nodiscard]] std::string reason(int error);

/// The failure to read `path` with an errno: kNotFound or kIo.
[[nodiscard]] tl::unexpected<Error> refuse_input(int error, const std::filesystem::path& path);

/// A regular file open for reading, and its size.
struct OpenFile {
  Descriptor descriptor;
  std::uint64_t size = 0;
};

/// Opens a regular file without waiting for anything. \return kNotFound, kIo (not a regular file, not readable).
[[nodiscard]] Expected<OpenFile> open_regular_file(const std::filesystem::path& path);

}  // namespace kilter
