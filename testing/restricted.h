// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <system_error>

#include "testing/temp_folder.h"

namespace kilter_testing {

/// While it lives, a path in a temporary folder has other permissions, and they hold for the process: root, to whom
/// they mean nothing, is an ordinary user.
class Restricted {
 public:
  Restricted(const TempFolder& folder, const std::filesystem::path& relative, int mode)
      : path_(folder.path() / relative), before_(std::filesystem::status(path_).permissions()) {
    std::filesystem::permissions(folder.path(), static_cast<std::filesystem::perms>(0755));
    std::filesystem::permissions(path_, static_cast<std::filesystem::perms>(mode));
    constexpr uid_t kNobody = 65534;
    if (was_root_ && ::seteuid(kNobody) != 0) ADD_FAILURE() << "still root";
  }
  Restricted(const Restricted&) = delete;
  Restricted& operator=(const Restricted&) = delete;
  ~Restricted() {
    if (was_root_ && ::seteuid(0) != 0) ADD_FAILURE() << "not root again";
    std::error_code ignored;
    std::filesystem::permissions(path_, before_, ignored);
  }

 private:
  std::filesystem::path path_;
  std::filesystem::perms before_;
  bool was_root_ = ::geteuid() == 0;
};

}  // namespace kilter_testing
