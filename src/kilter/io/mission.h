// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/geometry/pose3.h"
#include "kilter/submap/robot_log.h"

namespace kilter {

/// How the robots of a mission are read.
struct MissionOptions {
  /// Other poses for the same scans: DIR/ROBOT/poses.* takes the place of each robot's own. (`--poses`)
  std::optional<std::filesystem::path> poses_folder;
  /// Where poses are the vehicle's: the sensor's place on it, by robot; "" stands for all others.
  std::map<std::string, Pose3> T_body_sensor;
  /// Whether the beginning is enough of a source of which reading all takes long, a bag packed by bzip2 for example:
  /// RobotLog::clouds_unread. Not together with other poses, which are for all of it.
  bool glance = false;
};

/// What one command-line source turned out to be.
struct SourceSummary {
  std::string source;  ///< as it was given
  std::string kind;    ///< "GLIM dump"
  std::size_t robots = 0;
  std::size_t clouds = 0;
  std::size_t clouds_unread = 0;  ///< beyond what a glance took in
  bool finished_submaps = false;
};

/// "GLIM dump, 214 submaps, 1 robot".
[[nodiscard]] std::string describe(const SourceSummary& source);

/// All robots that share one world frame.
struct Mission {
  std::vector<RobotLog> robots;        ///< at least one, sorted bytewise by name
  std::vector<SourceSummary> sources;  ///< in the order of the command line
  std::vector<std::string> notes;      ///< what a person should know before any work; may be empty
};

/// What a person should know where finished submaps bring cells of another size than the voxels they become.
[[nodiscard]] std::vector<std::string> notes_on_cells(const Mission& mission, double resolution_m);

/// Opens the robots that command-line sources name; poses are read, points are not.
///
/// A source is one robot's folder or file of any kind that kilter knows (sources/source_kind.h; its name is the
/// robot's), a folder of such folders (what else lies beside them is passed over, unless a robot seems to be in it:
/// sources/missed_robot.h), or NAME=PATH with the path of one robot. In a folder of folders, those with `scans/` or
/// `submaps/` are the robots if there are any. What stands before the first '=' is a name unless it holds a '/': write
/// ./a=b for a folder a=b. What stands behind "#/" of a bag's path are topics to take: run.bag#/points#/odom.
/// \return  the mission; or kUsage (no source, a name given twice, a bad NAME), kConfig (T_body_sensor for an unknown
///          robot), kNotFound, kEmptyInput (no robot in a folder), kUnsupported (a file of no known kind; a folder's
///          name that cannot be a robot's: with a comma, a control character or not UTF-8), or what the kind's reader
///          fails with.
[[nodiscard]] Expected<Mission> open_mission(const std::vector<std::string>& sources,
                                             const MissionOptions& options = {});

}  // namespace kilter
