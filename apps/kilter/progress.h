// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>
#include <string>
#include <string_view>

namespace kilter::app {

/// Shows on standard error how far the work is: a bar that is drawn over itself on a terminal, otherwise a line now and
/// then, so that logs stay short. May be told from any thread, in any order.
class Progress {
 public:
  enum class Style {
    kSilent,
    kBar,
    kLines,  ///< at most one line in kLinePause; short runs print none
    kEvery,  ///< kLines, and a line when each stage begins and ends
  };
  static constexpr std::chrono::seconds kLinePause{5};
  static constexpr std::chrono::milliseconds kBarPause{100};

  explicit Progress(Style style) : style_(style), last_shown_(std::chrono::steady_clock::now()) {}
  Progress(const Progress&) = delete;
  Progress(Progress&&) = delete;
  Progress& operator=(const Progress&) = delete;
  Progress& operator=(Progress&&) = delete;
  ~Progress() { finish(); }

  void update(std::string_view stage, std::size_t done, std::size_t total);

  /// Takes the bar away; nothing is shown after it.
  void finish();

 private:
  void show(bool is_last);

  std::mutex mutex_;
  Style style_;
  std::string stage_;
  std::size_t done_ = 0;
  std::size_t total_ = 0;
  bool bar_drawn_ = false;
  std::chrono::steady_clock::time_point last_shown_;
};

/// The line that is shown: "pairs  [#####     ]  50 %  120 of 240". Precondition: done <= total.
[[nodiscard]] std::string progress_bar(std::string_view stage, std::size_t done, std::size_t total);

}  // namespace kilter::app
