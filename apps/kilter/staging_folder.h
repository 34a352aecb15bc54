// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "kilter/base/expected.h"

namespace kilter::app {

/// A hidden folder inside an output folder, where a run writes everything before anything gets its final name. What is
/// still in it when it goes, is removed; and so are the output folder and those above it, if they were made for this
/// and nothing came of it.
class StagingFolder {
 public:
  /// Makes `folder` where it is missing, and the hidden one in it. \return kIo, kNoSpace.
  [[nodiscard]] static Expected<StagingFolder> make_in(const std::filesystem::path& folder);

  StagingFolder(const StagingFolder&) = delete;
  StagingFolder(StagingFolder&& other) noexcept;
  StagingFolder& operator=(const StagingFolder&) = delete;
  StagingFolder& operator=(StagingFolder&&) = delete;
  ~StagingFolder();

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  /// Whether a file of that name can wait here: long ones, and two of which one is the other's folder, cannot.
  /// \return kIo, kNoSpace with the final name.
  [[nodiscard]] Expected<void> try_name(const std::filesystem::path& name) const;

  /// Writes a file that waits for its name, relative to the output folder. \return kIo, kNoSpace with the final name.
  [[nodiscard]] Expected<void> write(const std::filesystem::path& name, std::string_view bytes) const;

  /// Gives what waits its final names, in the order given, once `earlier` is moved away. Files and symlinks that stand
  /// there are replaced, folders are not; folders above are made. What was there before goes with the hidden folder.
  /// \return kIo, kNoSpace; the output folder is as it was then. Should even that be refused, the hidden folder stays
  /// if it holds what was replaced, and the error says so.
  [[nodiscard]] Expected<void> publish(const std::vector<std::filesystem::path>& names,
                                       const std::vector<std::filesystem::path>& earlier = {});

 private:
  StagingFolder(std::filesystem::path folder, std::filesystem::path path, std::filesystem::path first_made);

  std::filesystem::path folder_;
  std::filesystem::path path_;        // empty: moved away
  std::filesystem::path first_made_;  // the output folder or one above it; empty: it was there
};

}  // namespace kilter::app
