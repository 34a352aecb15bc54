// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include "apps/kilter/commands.h"
#include "apps/kilter/terminal.h"

namespace kilter::app {

// Built in the place of simulate_command.cc where Embree was not found.
void add_simulate_command(CLI::App& program, int& status) {
  CLI::App* app = program.add_subcommand("simulate", "not in this build: it needs Embree");
  app->allow_extras();
  app->callback([&status] {
    status = print_error({ErrorCode::kMissingDependency,
                          "this kilter was built without the simulator",
                          {},
                          "install libembree-dev and build again"});
  });
}

}  // namespace kilter::app
