// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/report/result_json.h"

#include <array>
#include <cstdint>
#include <numbers>
#include <span>

#include <fmt/format.h>

#include "kilter/base/version.h"
#include "kilter/report/json_writer.h"

namespace kilter {
namespace {

using Layout = JsonWriter::Layout;

template <typename T>
void write_map(JsonWriter& json, std::string_view name, const std::map<std::string, T>& values) {
  json.key(name).open_object(Layout::kCompact);
  for (const auto& [key, value] : values) json.field(key, value);
  json.close();
}

void write_option(JsonWriter& json, const OptionField& option) {
  json.key(option.name);
  switch (option.kind) {
    case OptionField::Kind::kReal:
      json.value(*option.real);
      return;
    case OptionField::Kind::kInteger:
      json.value(*option.integer);
      return;
    case OptionField::Kind::kBoolean:
      json.value(*option.boolean);
      return;
    case OptionField::Kind::kChoice:
      json.value(option.get_choice());
      return;
  }
}

void write_config(JsonWriter& json, const ConfigEcho& config) {
  json.open_object();
  for (const OptionField& option : config.options) write_option(json, option);
  write_map(json, "T_body_sensor", config.T_body_sensor);
  json.close();
}

void write_run(JsonWriter& json, const Result& result, const RunInfo& run) {
  json.key("run").open_object();
  json.key("sources").open_list(Layout::kCompact);
  for (const std::string& source : run.sources) json.value(source);
  json.close();
  json.field("poses", run.poses)
      .field("cuts", run.cuts)
      .field("submap_poses", run.submap_poses)
      .field("jobs", run.jobs);
  write_map(json, "seconds", result.seconds);
  json.field("peak_memory", run.peak_memory_bytes).field("date", run.date).close();
}

void write_robot(JsonWriter& json, const RobotSummary& robot) {
  json.open_object(Layout::kCompact)
      .field("name", robot.name)
      .field("scans", robot.scans)
      .field("path_length_m", robot.path_length_m)
      .field("submaps", robot.submaps)
      .close();
}

void write_submap(JsonWriter& json, const SubmapSummary& submap) {
  std::optional<std::size_t> first, last;
  if (submap.scans) {
    first = submap.scans->first;
    last = submap.scans->last;
  }
  json.open_object(Layout::kCompact)
      .field("id", submap.name)
      .field("robot", submap.robot)
      .field("index", submap.index)
      .field("first_scan", first)
      .field("last_scan", last)
      .field("T_world_submap", submap.T_world_submap)
      .field("occupied", submap.occupied)
      .field("bytes", submap.bytes)
      .field("dropped_points", submap.dropped_points)
      .close();
}

void write_histogram(JsonWriter& json, const std::optional<DistanceHistogram>& histogram) {
  json.key("histogram");
  if (!histogram) {
    json.null();
    return;
  }
  json.open_object(Layout::kCompact).field("width", histogram->width_m).key("counts").open_list();
  for (const std::int64_t count : histogram->counts) json.value(count);
  json.close().close();
}

void write_statistics(JsonWriter& json, const PairResult& pair) {
  std::optional<double> mu_m, sigma_m, mu_t_m, var_t_m2, gamma, gamma_literal, theta;
  if (pair.score) {
    const DistributionFit& fit = pair.score->fit;
    if (fit.parent) {
      mu_m = fit.parent->mu_m;
      sigma_m = fit.parent->sigma_m;
    }
    mu_t_m = fit.mu_t_m;
    var_t_m2 = fit.var_t_m2;
    gamma = pair.score->gamma_per_m3;
    gamma_literal = pair.score->gamma_literal_per_m3;
  }
  if (pair.registered_score) theta = pair.registered_score->gamma_per_m3;
  json.field("mu", mu_m).field("sigma", sigma_m).field("mu_t", mu_t_m).field("var_t", var_t_m2);
  json.field("gamma", gamma).field("gamma_literal", gamma_literal);
  json.field("theta", theta).field("theta_oicp", pair.theta_oicp_per_m3).field("verified", pair.verified);
}

void write_evidence(JsonWriter& json, const std::map<std::string, Evidence>& evidence) {
  json.key("evidence").open_object();
  for (const auto& [name, piece] : evidence) {
    json.key(name).open_object(Layout::kCompact);
    json.field("value", piece.value).field("null", piece.null).field("log_ratio", piece.log_ratio).close();
  }
  json.close();
}

void write_unobservable(JsonWriter& json, const PairResult& pair) {
  json.key("unobservable");
  // An empty list says that the scene fixes every direction; without a registration nobody knows.
  if (pair.verdict.unobservable.empty() && !pair.T_target_source_registered) {
    json.null();
    return;
  }
  json.open_list(Layout::kCompact);
  for (const Vector6& twist : pair.verdict.unobservable) json.value(std::span<const double>(twist.data(), 6));
  json.close();
}

void write_offset(JsonWriter& json, const PairVerdict& verdict) {
  std::optional<double> offset_deg;
  std::optional<std::span<const double>> interval_m, vector_m;
  if (verdict.offset_rad) offset_deg = *verdict.offset_rad * 180.0 / std::numbers::pi;
  if (verdict.offset_interval_m) interval_m = std::span<const double>(*verdict.offset_interval_m);
  if (verdict.offset_vector_m) vector_m = std::span<const double>(verdict.offset_vector_m->data(), 3);
  json.field("offset_m", verdict.offset_m).field("offset_interval_m", interval_m).field("offset_deg", offset_deg);
  json.field("offset_vector", vector_m).field("gap_m", verdict.gap_m);
  json.field("minimum_detectable_m", verdict.minimum_detectable_m);
}

void write_pair(JsonWriter& json, const Result& result, const PairResult& pair) {
  const PairVerdict& verdict = pair.verdict;
  json.open_object();
  json.field("target", result.submap(pair.id.target).name);
  json.field("source", result.submap(pair.id.source).name);
  json.field("kind", to_string(pair.kind)).field("overlap", pair.overlap).field("matched", pair.matched);
  json.field("d", pair.max_distance_m);
  write_histogram(json, pair.histogram);
  write_statistics(json, pair);
  write_evidence(json, verdict.evidence);
  write_offset(json, verdict);
  write_unobservable(json, pair);
  json.field("p_value", verdict.p_value).field("log_odds", verdict.log_odds);
  json.field("p_inconsistent", verdict.p_inconsistent);
  json.field("verdict", to_string(verdict.verdict)).field("reason", verdict.reason);
  json.field("T_target_source", pair.T_target_source);
  json.field("T_target_source_registered", pair.T_target_source_registered);
  json.key("covariance");
  if (pair.covariance) {
    const Eigen::Matrix<double, 6, 6, Eigen::RowMajor> rows = *pair.covariance;
    json.value(std::span<const double>(rows.data(), 36));
  } else {
    json.null();
  }
  json.close();
}

void write_log_probability(JsonWriter& json, const LogProbability& log_probability) {
  json.key("log_probability").open_object();
  json.field("total", log_probability.total).field("per_pair", log_probability.per_pair);
  write_map(json, "sequential", log_probability.sequential);
  write_map(json, "local", log_probability.local);
  write_map(json, "global", log_probability.global);
  json.close();
}

void write_frame(JsonWriter& json, const Result& result, const FrameOffset& frame) {
  const auto name = [&](int robot) -> const std::string& {
    return result.robots[static_cast<std::size_t>(robot)].name;
  };
  const auto numbers = [](const Eigen::Vector3d& vector) { return std::span<const double>(vector.data(), 3); };
  json.open_object(Layout::kCompact).field("target", name(frame.target_robot));
  json.field("source", name(frame.source_robot)).field("T_world_correction", frame.T_world_correction);
  json.field("middle", numbers(frame.middle_world_m)).field("shift", numbers(frame.shift_m));
  json.field("offset_m", frame.offset_m).field("agreeing", frame.agreeing).field("witnesses", frame.witnesses).close();
}

void write_system(JsonWriter& json, const Result& result) {
  const MapVerdict& system = result.system;
  json.key("system").open_object();
  json.field("verdict", to_string(system.state)).field("consistent", system.state == MapState::kConsistent);
  json.field("reason", system.reason).field("certificate_m", system.certificate_m);
  const auto write_pair = [&](const PairId& id) {
    json.open_list(Layout::kCompact).value(result.submap(id.target).name);
    json.value(result.submap(id.source).name).close();
  };
  json.key("certificate_of");
  if (system.certificate_of) {
    write_pair(*system.certificate_of);
  } else {
    json.null();
  }
  json.key("certificate_excludes").open_list();
  for (const PairId& id : system.certificate_excludes) write_pair(id);
  json.close();
  write_log_probability(json, system.log_probability);
  json.field("tested", system.tested).field("inconsistent", system.inconsistent);
  json.field("unverified", system.unverified);
  json.field("candidates", result.candidates).field("too_little_overlap", result.too_little_overlap);
  json.key("decided").open_object(Layout::kCompact);
  json.field("sequential", system.decided.sequential).field("local", system.decided.local);
  write_map(json, "global", system.decided.global);
  json.close();
  json.key("cycles").open_object(Layout::kCompact);
  json.field("closed", result.cycles.closed).field("nees_median", result.cycles.nees_median);
  json.field("covariance_scale", result.cycles.covariance_scale).close();
  json.key("frames").open_list();
  for (const FrameOffset& frame : result.frames) write_frame(json, result, frame);
  json.close().close();
}

}  // namespace

std::string config_digest(const ConfigEcho& config) {
  JsonWriter json;
  write_config(json, config);
  const std::string text = json.take().append(kResultSchema);
  std::uint64_t hash = 0xcbf29ce484222325ULL;  // FNV-1a
  for (const char c : text) {
    hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  }
  return fmt::format("{:016x}", hash);
}

namespace {

std::string whole_json(const Result& result, const ConfigEcho& config, const RunInfo* run) {
  JsonWriter json;
  json.open_object().field("schema", kResultSchema).field("version", kVersion);
  json.key("config");
  write_config(json, config);
  json.field("config_digest", config_digest(config));
  if (run != nullptr) write_run(json, result, *run);
  json.key("robots").open_list();
  for (const RobotSummary& robot : result.robots) write_robot(json, robot);
  json.close().key("submaps").open_list();
  for (const SubmapSummary& submap : result.submaps) write_submap(json, submap);
  json.close().key("pairs").open_list();
  for (const PairResult& pair : result.pairs) write_pair(json, result, pair);
  json.close();
  write_system(json, result);
  return json.close().take();
}

}  // namespace

std::string result_json(const Result& result, const ConfigEcho& config, const RunInfo& run) {
  return whole_json(result, config, &run);
}

std::string result_json_without_run(const Result& result, const ConfigEcho& config) {
  return whole_json(result, config, nullptr);
}

}  // namespace kilter
