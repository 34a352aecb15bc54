// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace CLI {
class App;
}

namespace kilter::app {

// Each adds one command to the program. When the command was called, parsing ends by running it, and `status` becomes
// the program's exit status.
void add_check_command(CLI::App& program, int& status);
void add_config_command(CLI::App& program, int& status);
void add_explain_command(CLI::App& program, int& status);
void add_info_command(CLI::App& program, int& status);
void add_register_command(CLI::App& program, int& status);
void add_report_command(CLI::App& program, int& status);
void add_simulate_command(CLI::App& program, int& status);
void add_submaps_command(CLI::App& program, int& status);

}  // namespace kilter::app
