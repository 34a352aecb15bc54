// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <fmt/format.h>

#include "apps/kilter/commands.h"
#include "apps/kilter/common_options.h"
#include "apps/kilter/exit_status.h"
#include "apps/kilter/fine_voxels.h"
#include "apps/kilter/output_folder.h"
#include "apps/kilter/own_files.h"
#include "apps/kilter/terminal.h"
#include "kilter/io/cloud_file.h"
#include "kilter/io/file.h"
#include "kilter/io/octree_reader.h"
#include "kilter/io/sources/foreign_file.h"
#include "kilter/io/usable_points.h"
#include "kilter/pipeline/register_clouds.h"
#include "kilter/registration/uncertainty.h"
#include "kilter/report/cloud_ply.h"
#include "kilter/report/json_writer.h"
#include "kilter/verification/judge.h"

namespace kilter::app {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

constexpr std::array<std::string_view, 1> kMarksOfAligned = {"\ncomment frame target, metres\n"};

struct RegisterCommand {
  CommonOptions common;
  std::string target;
  std::string source;
  std::optional<std::string> init;
  std::optional<std::string> aligned;
  bool scans = false;
};

std::array<double, 7> numbers_of(const Pose3& pose) {
  const Eigen::Vector3d& t = pose.translation_m();
  const Eigen::Quaterniond& q = pose.rotation();
  return {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
}

// With the bend in it where one rigid motion does not mend the pair, as in what check hands on.
Matrix6 covariance_of(const RegistrationResult& registration, bool rigid) {
  return constraint_covariance(registration, rigid, 1.0);
}

std::string as_json(const PairEvidence& pair, bool rigid) {
  const RegistrationResult& r = *pair.registration;
  JsonWriter json;
  json.open_object().field("schema", "kilter.registration/1").field("converged", r.converged());
  json.field("stop", to_string(r.stop)).field("searched", r.searched);
  json.field("T_target_source_init", pair.T_target_source);
  json.field("T_target_source", r.converged() ? std::optional(r.T_target_source) : std::nullopt);
  const auto if_converged = [&](double number) { return r.converged() ? std::optional(number) : std::nullopt; };
  json.field("matches", r.matches).field("residual_rms_m", if_converged(r.residual_rms_m));
  json.field("overlap", pair.registered ? std::optional(pair.registered->overlap) : std::nullopt);
  const bool saw_free_space = pair.registered && pair.registered->conflict.known() > 0;
  json.field("conflict", saw_free_space ? std::optional(pair.registered->conflict.share()) : std::nullopt);
  json.field("bend_m", if_converged(r.bend.rms_m)).field("ambiguity", r.ambiguity);
  json.key("unobservable");
  if (r.converged()) {
    json.open_list();
    for (const Vector6& twist : r.unobservable) json.value(std::span<const double>(twist.data(), 6));
    json.close();
  } else {
    json.null();  // an empty list would say that everything is fixed
  }
  json.key("covariance");
  if (r.converged()) {
    const Eigen::Matrix<double, 6, 6, Eigen::RowMajor> rows = covariance_of(r, rigid);
    json.value(std::span<const double>(rows.data(), 36));
  } else {
    json.null();
  }
  return json.close().take();
}

std::string as_text(const PairEvidence& pair, bool rigid) {
  const RegistrationResult& r = *pair.registration;
  if (!r.converged()) {
    return fmt::format("not registered: {} ({} matches)\n", to_string(r.stop), r.matches);
  }
  const auto [x, y, z, qx, qy, qz, qw] = numbers_of(r.T_target_source);
  std::string text =
      fmt::format("T_target_source  {:.4f} {:.4f} {:.4f}  {:.6f} {:.6f} {:.6f} {:.6f}\n", x, y, z, qx, qy, qz, qw);
  const Pose3 moved = r.T_target_source * pair.T_target_source.inverse();
  const Eigen::Vector3d from_m = moved.inverse() * r.centre_target_m;
  text += fmt::format("moved            {:.1f} cm, {:.2f} deg from the start{}\n",
                      100.0 * (r.centre_target_m - from_m).norm(), kDegrees * moved.angle_rad(),
                      r.searched ? ", by the wide search" : "");
  text += fmt::format("matches          {} voxels, residual {:.1f} cm, overlap {:.0f} %\n", r.matches,
                      100.0 * r.residual_rms_m, 100.0 * pair.registered->overlap);
  const Vector6 sigma = covariance_of(r, rigid).diagonal().cwiseMax(0.0).cwiseSqrt();
  text += fmt::format("sigma            {:.1f} {:.1f} {:.1f} cm, {:.2f} {:.2f} {:.2f} deg along the source's axes\n",
                      100.0 * sigma[0], 100.0 * sigma[1], 100.0 * sigma[2], kDegrees * sigma[3], kDegrees * sigma[4],
                      kDegrees * sigma[5]);
  if (!rigid) {
    text += fmt::format("bend             {:.1f} cm stay apart whatever the pose: one of the two is bent inside\n",
                        100.0 * r.bend.rms_m);
  }
  if (pair.registered->conflict.known() > 0) {
    text += fmt::format("conflict         {:.1f} % of what both saw\n", 100.0 * pair.registered->conflict.share());
  }
  if (r.ambiguity) {
    text += fmt::format("ambiguity        the next best pose fits {:.0f} % as well\n", 100.0 * *r.ambiguity);
  }
  for (const Vector6& twist : r.unobservable) {
    text += fmt::format("not fixed        along {:.2f} {:.2f} {:.2f}, about {:.2f} {:.2f} {:.2f} (target's axes)\n",
                        twist[0], twist[1], twist[2], twist[3], twist[4], twist[5]);
  }
  return text;
}

Expected<void> check_name(const std::string& file) {
  const Expected<std::filesystem::file_type> type = type_at(file);
  if (!type) return pass_up(type.error());
  if (*type != std::filesystem::file_type::directory && (has_octree_name(file) || cloud_format_of(file))) return {};
  if (const std::string way_out = way_out_of_foreign({{file}}); !way_out.empty()) {
    return fail(ErrorCode::kUnsupported, "this is a format that kilter does not read", shown(file), way_out);
  }
  const bool folder = *type == std::filesystem::file_type::directory;
  return fail(ErrorCode::kUnsupported,
              fmt::format("expected a file that ends in .bin, .pcd, .ply, .las, .ot or .bt{}",
                          folder ? ", found a folder" : ""),
              shown(file));
}

// Of a tree the occupied cells' centres, and the cells themselves.
Expected<PointCloud> read_file_of_points(const std::string& file, std::optional<OccupancyCells>& tree) {
  if (auto fit = check_name(file); !fit) return pass_up(fit.error());
  if (!has_octree_name(file)) return read_cloud_file(file);
  Expected<OccupancyCells> cells = read_octree_file(file);
  if (!cells) return pass_up(cells.error());
  tree = *std::move(cells);
  return occupied_centres(*tree);
}

Expected<PointCloud> read_points(const std::string& file, std::optional<OccupancyCells>& tree) {
  Expected<PointCloud> cloud = read_file_of_points(file, tree);
  if (!cloud) return cloud;
  if (auto usable = check_usable(*cloud, shown(file)); !usable) return pass_up(usable.error());
  return cloud;
}

Expected<CloudPair> read_clouds(const RegisterCommand& command) {
  CloudPair clouds;
  Expected<PointCloud> target = read_points(command.target, clouds.target_cells);
  if (!target) return pass_up(target.error());
  Expected<PointCloud> source = read_points(command.source, clouds.source_cells);
  if (!source) return pass_up(source.error());
  clouds.target = *std::move(target);
  clouds.source = *std::move(source);
  clouds.scans = command.scans;
  clouds.target_name = shown(command.target);
  clouds.source_name = shown(command.source);
  if (command.init) {
    const Expected<Pose3> init = parse_pose(*command.init, "--init");
    if (!init) return fail(ErrorCode::kUsage, init.error().message, {}, "metres, then a quaternion of length 1");
    clouds.T_target_source_init = *init;
  }
  return clouds;
}

void print_notes_before(const RegisterCommand& command, const OccupancyOptions& options) {
  if (command.common.quiet) return;
  if (const auto note = note_on_fine_voxels(options)) print_note(*note);
  // Without an origin there is no range.
  const OccupancyOptions usual;
  const bool set = options.min_range_m != usual.min_range_m || options.max_range_m != usual.max_range_m;
  if (set && !command.scans) print_note("min_range and max_range apply to scans, and are not used without --scans");
}

int run_register(const RegisterCommand& command) {
  const Expected<Settings> settings = read_settings(command.common);
  if (!settings) return print_error(settings.error());
  if (command.aligned) {
    const auto fit = check_output_file(*command.aligned, ".ply", {command.target, command.source});
    if (!fit) return print_error(fit.error());
    if (auto fits = probe_output_file(*command.aligned); !fits) {
      print_error(fits.error());
      return exit_status_of_output(fits.error().code);
    }
    if (auto ours = check_replaceable(*command.aligned, kMarksOfAligned); !ours) return print_error(ours.error());
  }
  const Expected<CloudPair> clouds = read_clouds(command);
  if (!clouds) return print_error(clouds.error());
  print_notes_before(command, settings->check.submap.occupancy);
  Progress progress(command.common.progress_style());
  const RunContext run{
      .threads = command.common.jobs,
      .progress = [&](std::size_t done, std::size_t total) { progress.update("registration", done, total); },
      .memory_bytes = parse_memory(command.common.memory).value_or(0)};
  const Expected<PairMeasurement> pair = register_clouds(*clouds, settings->check, run);
  progress.finish();
  if (!pair) return print_error(pair.error());
  const PairEvidence& evidence = pair->evidence;
  if (command.aligned && !evidence.registration->converged()) {
    if (!command.common.quiet) {
      print_note(fmt::format("{} is not written: the source was not brought onto the target", shown(*command.aligned)));
    }
  } else if (command.aligned) {
    const std::string ply = cloud_ply(clouds->source.points_m, evidence.registration->T_target_source, "target");
    if (auto done = write_file_atomically(*command.aligned, ply); !done) {
      print_error(done.error());
      return exit_status_of_output(done.error().code);
    }
  }
  const bool rigid = is_rigid(*evidence.registration, settings->check.judge);
  const Expected<void> done = print_out(command.common.json ? as_json(evidence, rigid) : as_text(evidence, rigid));
  if (done) return kExitGood;
  print_error(done.error());
  return exit_status_of_output(done.error().code);
}

}  // namespace

void add_register_command(CLI::App& program, int& status) {
  const auto command = std::make_shared<RegisterCommand>();
  CLI::App* app = program.add_subcommand("register", "bring one cloud onto another: pose, covariance, observability");
  app->add_option("TARGET", command->target, "a cloud: .bin, .pcd, .ply or .las; or a tree: .ot or .bt")->required();
  app->add_option("SOURCE", command->source, "the cloud that is moved")->required();
  app->add_option("--init", command->init, "where to start, as T_target_source; the identity unless given")
      ->option_text("\"x y z qx qy qz qw\"");
  app->add_option("-o,--output", command->aligned, "write the source, moved onto the target, as PLY")
      ->option_text("FILE.ply");
  app->add_flag("--scans", command->scans, "both are single scans taken from their origin: trace free space");
  add_common_options(*app, command->common);
  app->callback([command, &status] { status = run_register(*command); });
}

}  // namespace kilter::app
