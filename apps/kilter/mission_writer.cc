// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "apps/kilter/mission_writer.h"

#include <fmt/format.h>

#include <bit>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "apps/kilter/earlier_mission.h"
#include "apps/kilter/staging_folder.h"
#include "kilter/io/file.h"

namespace kilter {
namespace {

namespace fs = std::filesystem;

static_assert(std::endian::native == std::endian::little, "both scan formats hold little-endian numbers");

tl::unexpected<Error> io_failure(const std::string& what, int code, const fs::path& path) {
  const bool full = code == ENOSPC || code == EDQUOT || code == EFBIG;
  return fail(full ? ErrorCode::kNoSpace : ErrorCode::kIo, what + ": " + std::strerror(code), printable(path.string()));
}

// Where a mission waits until it is whole, and where it is going, which is what messages name.
struct Place {
  fs::path waiting;
  fs::path going;
};

Expected<void> write_bytes(const Place& place, const fs::path& name, std::string_view bytes) {
  errno = 0;
  std::ofstream file(place.waiting / name, std::ios::binary | std::ios::trunc);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) return io_failure("cannot write", errno, place.going / name);
  return {};
}

Expected<void> make_folder(const Place& place, const fs::path& name) {
  std::error_code status;
  fs::create_directories(place.waiting / name, status);
  if (status) return io_failure("cannot make the folder", status.value(), place.going / name);
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
  std::memcpy(raw, &value, sizeof raw);
  bytes.append(raw, sizeof raw);
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

constexpr const char* kParts[] = {"truth", "mission"};

Expected<void> publish(app::StagingFolder& staging, const MissionWriterOptions& options) {
  // Somebody may have put something there since.
  if (Expected<void> fit = check_room_for_mission(options.folder, options.replace); !fit) return fit;
  std::vector<fs::path> earlier;
  for (const char* part : kParts) {
    std::error_code status;
    if (fs::exists(fs::symlink_status(options.folder / part, status))) earlier.emplace_back(part);
  }
  return staging.publish({std::begin(kParts), std::end(kParts)}, earlier);
}

Expected<void> write_robot(const SimulatedMission& mission, std::size_t r, const Place& place, ScanFormat format,
                           const RunContext& run) {
  const SimulatedRobot& robot = mission.robots()[r];
  const fs::path folder = fs::path("mission") / robot.name;
  const fs::path truth = fs::path("truth") / robot.name;
  for (const fs::path& path : {folder / "scans", truth}) {
    if (Expected<void> made = make_folder(place, path); !made) return made;
  }
  const char* suffix = format == ScanFormat::kPcd ? "pcd" : "bin";
  const auto take = [&](std::size_t i, const SimulatedScan& scan) {
    return write_bytes(place, folder / "scans" / fmt::format("{:06}.{}", i, suffix), scan_bytes(scan, format));
  };
  if (Expected<void> written = for_each_scan(mission, r, run, take); !written) return written;
  const std::string poses = tum_text(robot.stamp_s, robot.T_world_sensor);
  if (Expected<void> written = write_bytes(place, folder / "poses.tum", poses); !written) return written;
  return write_bytes(place, truth / "poses.tum", tum_text(robot.stamp_s, robot.T_world_sensor_true));
}

std::vector<double> numbers_of(const Eigen::Vector3d& vector) { return {vector.x(), vector.y(), vector.z()}; }

// The motion along the world's axes that the fault made of a scan, as the map has the scan that it is compared with.
struct Displacement {
  Eigen::Vector3d shift_m;
  Eigen::Vector3d turn_rad;
};

Displacement displacement_of(const SimulatedMission& mission, const Fault& fault) {
  const SimulatedRobot& robot = mission.robots()[static_cast<std::size_t>(fault.robot)];
  const SimulatedRobot& other = mission.robots()[static_cast<std::size_t>(fault.against_robot)];
  const Pose3& T_world_scan = robot.T_world_sensor[fault.scan];
  const Pose3 T_against_scan =
      other.T_world_sensor_true[fault.against_scan].inverse() * robot.T_world_sensor_true[fault.scan];
  const Pose3 T_world_belongs = other.T_world_sensor[fault.against_scan] * T_against_scan;
  return {T_world_scan.translation_m() - T_world_belongs.translation_m(),
          (T_world_scan * T_world_belongs.inverse()).log().tail<3>()};
}

}  // namespace

std::string faults_json(const SimulatedMission& mission, const std::string& scene, std::uint64_t seed) {
  const auto name = [&](int robot) { return mission.robots()[static_cast<std::size_t>(robot)].name; };
  nlohmann::ordered_json faults = nlohmann::ordered_json::array();
  for (const Fault& fault : mission.faults()) {
    const Displacement displacement = displacement_of(mission, fault);
    faults.push_back({{"kind", to_string(fault.kind)},
                      {"robot", name(fault.robot)},
                      {"scan", fault.scan},
                      {"first_scan", fault.first_scan},
                      {"against_robot", name(fault.against_robot)},
                      {"against_scan", fault.against_scan},
                      {"size_m", fault.size_m},
                      {"size_rad", fault.size_rad},
                      {"shift_m", numbers_of(displacement.shift_m)},
                      {"turn_rad", numbers_of(displacement.turn_rad)}});
  }
  nlohmann::ordered_json document = {{"schema", kFaultsSchema}, {"scene", scene}, {"seed", seed}, {"faults", faults}};
  return document.dump(2) + "\n";
}

Expected<void> write_mission(const SimulatedMission& mission, const MissionWriterOptions& options,
                             const RunContext& run) {
  if (Expected<void> fit = check_room_for_mission(options.folder, options.replace); !fit) return fit;
  Expected<app::StagingFolder> staging = app::StagingFolder::make_in(options.folder);
  if (!staging) return pass_up(staging.error());
  const Place place{staging->path(), options.folder};
  const std::size_t total = mission.scan_count();
  std::size_t before = 0;
  for (std::size_t r = 0; r < mission.robots().size(); ++r) {
    const RunContext part = part_of(run, before, total);
    if (Expected<void> written = write_robot(mission, r, place, options.format, part); !written) return written;
    before += mission.robots()[r].stamp_s.size();
  }
  const std::string faults = faults_json(mission, options.scene, options.seed);
  if (Expected<void> written = write_bytes(place, fs::path("truth") / "faults.json", faults); !written) return written;
  return publish(*staging, options);
}

}  // namespace kilter
