// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "apps/kilter/progress.h"

#include <algorithm>

#include <fmt/format.h>

#include "apps/kilter/terminal.h"

namespace kilter::app {
namespace {

std::size_t share_of(std::size_t done, std::size_t total, std::size_t whole) {
  return total == 0 ? whole
                    : static_cast<std::size_t>(static_cast<double>(done) / static_cast<double>(total) *
                                               static_cast<double>(whole));
}

}  // namespace

std::string progress_bar(std::string_view stage, std::size_t done, std::size_t total) {
  constexpr std::size_t kCells = 30;
  const std::size_t filled = share_of(done, total, kCells);
  return fmt::format("{:<14} [{}{}] {:>3} %  {} of {}", stage, std::string(filled, '#'),
                     std::string(kCells - filled, ' '), share_of(done, total, 100), done, total);
}

void Progress::update(std::string_view stage, std::size_t done, std::size_t total) {
  const std::lock_guard lock(mutex_);
  if (style_ == Style::kSilent) return;
  // Robots go through the same stage one after the other.
  const bool is_new = stage != stage_ || total != total_ || (done_ == total_ && done < total);
  if (is_new) {
    stage_ = stage;
    done_ = 0;
  }
  const std::size_t before = done_;
  done_ = std::max(done_, std::min(done, total));  // reports overtake each other
  total_ = total;
  const bool has_ended = done_ == total_ && before < done_;
  const auto now = std::chrono::steady_clock::now();
  const bool is_due = now - last_shown_ >= (style_ == Style::kBar ? kBarPause : std::chrono::milliseconds(kLinePause));
  if (!is_due && !(style_ == Style::kEvery && (is_new || has_ended))) return;
  last_shown_ = now;
  show(false);
}

void Progress::finish() {
  const std::lock_guard lock(mutex_);
  show(true);
  style_ = Style::kSilent;
}

void Progress::show(bool is_last) {
  if (style_ == Style::kBar) {
    if (is_last && !bar_drawn_) return;
    print_message("\r\x1b[K" + (is_last ? "" : progress_bar(stage_, done_, total_)));
    bar_drawn_ = !is_last;
  } else if (!is_last) {
    print_message(fmt::format("{}: {} of {} ({} %)\n", stage_, done_, total_, share_of(done_, total_, 100)));
  }
}

}  // namespace kilter::app
