// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "apps/kilter/mission_writer.h"

#include <bit>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "kilter/io/file.h"
#include "kilter/report/json_writer.h"

namespace kilter::app {
namespace {

namespace fs = std::filesystem;

static_assert(std::endian::native == std::endian::little, "both scan formats hold little-endian numbers");

tl::unexpected<Error> refuse(const std::string& what, int code, const fs::path& path) {
  const ErrorCode kind = code == ENOSPC || code == EDQUOT ? ErrorCode::kNoSpace : ErrorCode::kIo;
  return fail(kind, fmt::format("{}: {}", what, std::strerror(code)), shown(path));
}

// Hundreds of scans need not each be synced: the mission is whole once faults.json is there.
Expected<void> write_scan(const fs::path& path, std::string_view bytes) {
  errno = 0;
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) return refuse("cannot be written", errno == 0 ? EIO : errno, path);
  return {};
}

Expected<void> make_folder(const fs::path& path) {
  std::error_code status;
  fs::create_directories(path, status);
  if (status) return refuse("cannot be made", status.value(), path);
  return {};
}

// One pose a line: t x y z qx qy qz qw; every number reads back to the same double.
std::string tum_text(const std::vector<double>& stamp_s, const std::vector<Pose3>& poses) {
  std::string text;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Eigen::Vector3d& t = poses[i].translation_m();
    const Eigen::Quaterniond& q = poses[i].rotation();
    fmt::format_to(std::back_inserter(text), "{} {} {} {} {} {} {} {}\n", stamp_s[i], t.x(), t.y(), t.z(), q.x(), q.y(),
                   q.z(), q.w());
  }
  return text;
}

void append_float(std::string& bytes, float value) {
  char raw[sizeof(float)];
  std::memcpy(raw, &value, sizeof(raw));
  bytes.append(raw, sizeof(raw));
}

std::string scan_bytes(const SimulatedScan& scan, ScanFormat format) {
  const std::size_t count = scan.cloud.points_m.size();
  std::string bytes;
  if (format == ScanFormat::kPcd) {
    bytes = fmt::format(
        "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z intensity\nSIZE 4 4 4 4\n"
        "TYPE F F F F\nCOUNT 1 1 1 1\nWIDTH {0}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {0}\nDATA binary\n",
        count);
  }
  bytes.reserve(bytes.size() + 16 * count);
  for (std::size_t i = 0; i < count; ++i) {
    for (int axis = 0; axis < 3; ++axis) append_float(bytes, scan.cloud.points_m[i][axis]);
    append_float(bytes, scan.intensity[i]);
  }
  return bytes;
}

// A second mission in the same folder must not leave scans of the first between its own.
Expected<void> clear_way(const MissionWriterOptions& options) {
  for (const char* part : {"mission", "truth"}) {
    const fs::path path = options.folder / part;
    std::error_code status;
    if (!fs::exists(path, status)) continue;
    if (!options.replace) {
      return fail(ErrorCode::kUsage, "exists already", shown(path), "name another folder, or give --replace");
    }
    fs::remove_all(path, status);
    if (status) return refuse("cannot be removed", status.value(), path);
  }
  return {};
}

Expected<void> write_robot(const SimulatedMission& mission, std::size_t r, const MissionWriterOptions& options,
                           const RunContext& run) {
  const SimulatedRobot& robot = mission.robots()[r];
  const fs::path folder = options.folder / "mission" / robot.name;
  const fs::path truth = options.folder / "truth" / robot.name;
  for (const fs::path& path : {folder / "scans", truth}) {
    if (auto made = make_folder(path); !made) return made;
  }
  const char* suffix = options.format == ScanFormat::kPcd ? "pcd" : "bin";
  const auto take = [&](std::size_t i, const SimulatedScan& scan) {
    return write_scan(folder / "scans" / fmt::format("{:06}.{}", i, suffix), scan_bytes(scan, options.format));
  };
  if (auto done = for_each_scan(mission, r, run, take); !done) return done;
  const std::string estimate = tum_text(robot.stamp_s, robot.T_world_sensor);
  if (auto done = write_file_atomically(folder / "poses.tum", estimate); !done) return done;
  return write_file_atomically(truth / "poses.tum", tum_text(robot.stamp_s, robot.T_world_sensor_true));
}

}  // namespace

std::string faults_json(const SimulatedMission& mission, const MissionWriterOptions& options) {
  const auto name = [&](int robot) { return mission.robots()[static_cast<std::size_t>(robot)].name; };
  JsonWriter json;
  json.open_object().field("schema", "kilter.faults/1").field("scene", options.scene);
  json.field("seed", static_cast<std::int64_t>(options.seed)).key("faults").open_list();
  for (const Fault& fault : mission.faults()) {
    json.open_object(JsonWriter::Layout::kCompact).field("kind", to_string(fault.kind));
    json.field("robot", name(fault.robot)).field("first_scan", fault.first_scan).field("scan", fault.scan);
    json.field("against_robot", name(fault.against_robot)).field("against_scan", fault.against_scan);
    json.field("size_m", fault.size_m).field("size_rad", fault.size_rad).close();
  }
  return json.close().close().take();
}

Expected<void> write_mission(const SimulatedMission& mission, const MissionWriterOptions& options,
                             const RunContext& run) {
  if (auto clear = clear_way(options); !clear) return clear;
  const std::size_t total = mission.scan_count();
  std::size_t before = 0;
  for (std::size_t r = 0; r < mission.robots().size(); ++r) {
    RunContext part = run;
    if (run.progress) {
      part.progress = [&run, before, total](std::size_t done, std::size_t) { run.progress(before + done, total); };
    }
    if (auto done = write_robot(mission, r, options, part); !done) return done;
    before += mission.robots()[r].stamp_s.size();
  }
  return write_file_atomically(options.folder / "truth" / "faults.json", faults_json(mission, options));
}

}  // namespace kilter::app
