// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "apps/kilter/signals.h"

#include <csignal>
#include <initializer_list>

#include <signal.h>  // NOLINT(modernize-deprecated-headers): POSIX, sigaction is not in <csignal>

namespace kilter::app {
namespace {

std::atomic<bool> stop{false};
std::atomic<int> signal_number{0};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free,
              "a signal handler may touch nothing else");

void remember(int number) {
  signal_number.store(number);
  stop.store(true);
}

}  // namespace

void catch_stop_signals() {
  struct sigaction action {};
  action.sa_handler = remember;
  sigemptyset(&action.sa_mask);
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    // Back to the default after the first, so that a second Ctrl-C is not swallowed; but where a connection is lost,
    // the shell and the system both send SIGHUP.
    action.sa_flags = SA_RESTART | (number == SIGHUP ? 0 : static_cast<int>(SA_RESETHAND));
    struct sigaction before {};
    // Who starts us in the background with `&` has asked for SIGINT to be ignored, who starts us by nohup for SIGHUP.
    if (sigaction(number, nullptr, &before) == 0 && before.sa_handler == SIG_IGN) continue;
    sigaction(number, &action, nullptr);
  }
}

const std::atomic<bool>& stop_flag() { return stop; }

int caught_signal() { return signal_number.load(); }

Error stopped() { return {ErrorCode::kCancelled, "stopped on request; nothing was written", {}, {}}; }

}  // namespace kilter::app
