// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The simulator as a program of its own, until the sub-command is in `kilter`.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <thread>

#include "apps/kilter/simulate.h"

int main(int argc, char** argv) {
  kilter::SimulateRequest request;
  std::string format = "bin";
  int jobs = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  CLI::App app("Makes a mission with known truth.");
  app.add_option("scene", request.scene)->required();
  app.add_option("-o,--out", request.writer.folder)->required();
  app.add_option("--seed", request.options.seed);
  app.add_option("--robots", request.options.robots);
  app.add_option("--scale", request.options.scale);
  app.add_option("--beams", request.beams);
  app.add_option("--columns", request.columns)->check(CLI::Range(36, 7200));
  app.add_option("--range-noise", request.range_noise_m)->check(CLI::Range(0.0, 1.0));
  app.add_option("--motion-residual", request.motion_residual)->check(CLI::Range(0.0, 1.0));
  app.add_option("--scan-step", request.scan_step_m)->check(CLI::Range(0.0, 100.0));
  app.add_option("--fault", request.faults);
  app.add_option("--format", format)->check(CLI::IsMember({"bin", "pcd"}));
  app.add_flag("--replace", request.writer.replace);
  app.add_option("--jobs", jobs)->check(CLI::Range(1, 1024));
  CLI11_PARSE(app, argc, argv);
  request.writer.format = format == "pcd" ? kilter::ScanFormat::kPcd : kilter::ScanFormat::kBin;
  request.writer.scene = request.scene;
  request.writer.seed = request.options.seed;
  kilter::RunContext run{.threads = jobs};
  run.progress = [](std::size_t done, std::size_t total) { fmt::print(stderr, "\r{}/{} scans", done, total); };
  const auto summary = kilter::simulate(request, run);
  fmt::print(stderr, "\n");
  if (!summary) {
    fmt::print(stderr, "{}\n", kilter::to_string(summary.error()));
    return summary.error().code == kilter::ErrorCode::kUsage ? 2 : 5;
  }
  for (const kilter::Fault& fault : summary->faults) {
    fmt::print("{} robot {} scan {}: {:.2f} m, {:.3f} rad\n", kilter::to_string(fault.kind), fault.robot, fault.scan,
               fault.size_m, fault.size_rad);
  }
  return 0;
}
