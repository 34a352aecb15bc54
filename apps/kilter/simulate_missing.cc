// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Stands in for simulate.cc where kilter was built without Embree.
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include "apps/kilter/commands.h"
#include "apps/kilter/terminal.h"

namespace kilter::app {

void add_simulate_command(CLI::App& program, int& status) {
  CLI::App* app = program.add_subcommand("simulate", "make a mission whose truth and faults are known (not built in)");
  app->allow_extras();
  app->callback([&status] {
    status = print_error({ErrorCode::kMissingDependency,
                          "this kilter was built without its simulator",
                          {},
                          "install Embree 3 (Debian: libembree-dev) and build again"});
  });
}

}  // namespace kilter::app
