// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "apps/kilter/progress.h"
#include "apps/kilter/settings.h"
#include "kilter/base/expected.h"

namespace CLI {  // NOLINT(readability-identifier-naming): the library's name
class App;
}

namespace kilter::app {

/// What every command takes.
struct CommonOptions {
  std::string config_file;            ///< --config; empty = none
  std::vector<std::string> settings;  ///< --set key=value, in the order given
  int jobs = 1;                       ///< --jobs; the machine's threads unless given
  std::string memory;                 ///< --memory; empty = not given
  bool quiet = false;
  bool verbose = false;
  bool json = false;
  bool no_color = false;

  [[nodiscard]] Progress::Style progress_style() const;
};

void add_common_options(CLI::App& command, CommonOptions& options);

/// Defaults (or the seed's, if asked), then the configuration file, then each --set: what comes later wins.
[[nodiscard]] Expected<Settings> read_settings(const CommonOptions& options, bool seed_preset = false);

/// "512M", "4G", "1.5GiB", plain bytes; powers of 1024. Empty is 0: not given. \return kUsage.
[[nodiscard]] Expected<std::size_t> parse_memory(const std::string& text);

}  // namespace kilter::app
