// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/oddity.h"

#include <algorithm>
#include <array>

namespace kilter {

std::span<const OddityTopic> oddity_catalog() {
  static constexpr std::array kTopics = {
      OddityTopic{"camera-frame",
                  "The sensor moves along its own z axis most of the way. That is how cameras look (x right, y down, z "
                  "ahead), not lidars. Poses of a camera with clouds of a lidar put every scan on its side.",
                  "give poses of the lidar, or the camera's place on it as T_body_sensor"},
      OddityTopic{"millimetres",
                  "Distances are hundreds of times larger than a lidar's. Files seem to be in millimetres (or feet, or "
                  "a map's grid), kilter reads metres.",
                  "write clouds and poses in metres"},
      OddityTopic{"identical-clouds",
                  "Two clouds in a row hold the same points: a recording that stood still, a cloud that was saved "
                  "twice, or one file under two names. Both count as evidence although only one was seen.",
                  "remove one of them and its pose"},
      OddityTopic{
          "damaged-clouds",
          "Files of clouds are empty, have no header, or are shorter than their header promises: an interrupted "
          "copy, or a disk that was full while recording. `kilter check` ends with status 3 when it comes to "
          "the first of them. Only sizes and headers were looked at; other damage shows when a file is read.",
          "copy them again, or remove each together with its pose"},
      OddityTopic{
          "unreadable-clouds",
          "Files of clouds cannot be opened: they belong to somebody else, or their disk does not answer. `kilter "
          "check` ends with status 3 when it comes to the first of them.",
          "make them readable (chmod), or remove each together with its pose"},
      OddityTopic{"identical-robots",
                  "Two robots have the same clouds: one folder was named twice. They would agree with each other "
                  "perfectly and prove nothing; under other poses they tell how these differ, and nothing of the map.",
                  "name each session once"},
      OddityTopic{"time-jump",
                  "Time runs backwards between two clouds, or stands for long: several recordings in one folder, a "
                  "clock that was set, or stamps in other units.",
                  "split it into one robot (NAME=PATH) for each recording"},
      OddityTopic{"pose-jump",
                  "Between two clouds the robot moved much farther than usual. Poses of another trajectory, a lost "
                  "odometry, or key frames far apart.",
                  "look at the poses there; a submap is cut at the jump if it is longer than submap_distance"},
      OddityTopic{"no-motion",
                  "All poses lie in one place: the poses are not these clouds', or clouds are in the world frame "
                  "already.",
                  "give each cloud its pose; one merged cloud is a submap of its own (NAME=FILE.pcd)"},
      OddityTopic{"no-turns",
                  "The robot's path turns, but every pose has the same rotation: rotations were not written, or were "
                  "left at the identity.",
                  "give poses with their rotations"},
      OddityTopic{"tumbles",
                  "The sensor's z axis swings far about the vertical. Sensors of robots that drive or hover stay about "
                  "level; quaternions that are written w first and read x first look like this.",
                  "write quaternions as qx qy qz qw, or name the columns"},
      OddityTopic{"upside-down",
                  "The sensor's z axis points down most of the way: a sensor that hangs, a world whose z axis points "
                  "down, or quaternions that are written w first.",
                  "if nothing hangs, write quaternions as qx qy qz qw, or name the columns"},
      OddityTopic{"clouds-in-world",
                  "Clouds meet each other without their poses, and not with them: they are in the map's frame already, "
                  "as most programs export them.",
                  "export clouds in the sensor's frame, or transform each by its inverse pose"},
      OddityTopic{"inverse-poses",
                  "Clouds meet each other if the poses are inverted, and not as they are: poses were written as "
                  "T_sensor_world.",
                  "write poses as T_world_sensor: where the sensor is in the map"},
      OddityTopic{"transposed-rotations",
                  "Clouds meet each other if rotations are transposed, and not as they are: positions are where the "
                  "sensor is in the world, rotations turn the world's axes into the sensor's.",
                  "write both as T_world_sensor"},
      OddityTopic{"scalar-first",
                  "Clouds meet each other if the first number of each quaternion is qw, and not as it was read.",
                  "write quaternions as qx qy qz qw, or name the columns"},
      OddityTopic{"swapped-poses",
                  "A robot's clouds meet each other under another robot's poses, and not under its own: folders or "
                  "files of two robots were exchanged.",
                  "give each robot its own poses"},
      OddityTopic{"shifted-poses",
                  "Clouds meet each other under the poses of clouds before or behind them, and not under their own: "
                  "first clouds or poses are missing, or stamps of both come from different clocks.",
                  "remove what has no partner, or mend the stamps"},
      OddityTopic{"turned-sensor",
                  "Clouds meet each other if their sensor looks another way than the poses, and not as they are: poses "
                  "are the vehicle's or another sensor's, and how this one is mounted was left out. The turn is known "
                  "to about two degrees; where the sensor sits cannot be told in this way.",
                  "give the sensor's place on the robot as T_body_sensor, `x y z` and a quaternion: that of the "
                  "mount or of a calibration, for this one is good to two degrees, which a map shows as decimetres (or "
                  "that of a T_body_sensor that is set, times this one)"},
      OddityTopic{"mirrored-poses",
                  "Clouds meet each other if axes of the poses are turned round or exchanged, and not as they are: one "
                  "of both has left-handed axes (game engines, y to the south, z down with x and y as before). A robot "
                  "that stays level looks the same with a sensor on its head.",
                  "write poses and clouds with right-handed axes, or a sensor on its head as T_body_sensor"},
      OddityTopic{
          "other-axes",
          "Clouds meet each other if positions have other axes than rotations, and not as they are: one of "
          "both was brought into another frame (east, north, up; north, east, down; a camera's), the other not.",
          "write positions and rotations in one frame"},
      OddityTopic{
          "poses-unfit",
          "Clouds meet the next ones where nothing is moved, but hardly those a few metres on where the poses put "
          "them. "
          "Either their paths and turns are not these clouds' (another sensor's, of other clouds), or most of what is "
          "seen goes along with the sensor: rings on bare ground, the robot's own body, profiles.",
          "if walls and trunks stand in the clouds, give the poses of these clouds, or T_body_sensor"},
      OddityTopic{"stamps-differ",
                  "Clouds were paired with poses in order, and their stamps, or those in their names, are not those of "
                  "the poses: a cloud or a pose is missing somewhere, and all behind it go with the wrong one.",
                  "remove what has no partner, or give poses with the clouds' stamps"},
      OddityTopic{
          "other-clock",
          "Clouds were paired with poses in order; their stamps, or those in their names, and those of the poses "
          "have no time in common, though they step alike: two clocks, or one that begins at zero. Nothing is "
          "wrong where the first pose is that of the first cloud, which stamps cannot tell here.",
          "see that the first pose is the first cloud's, or write both stamps by one clock"},
      OddityTopic{
          "equal-stamps",
          "All stamps of a robot are the same: they were not written, or with too few digits. What needs times, "
          "such as pairing clouds with poses by them and pauses, cannot be had.",
          "write the time of each cloud, with its decimals"},
      OddityTopic{
          "far-robot",
          "A robot's poses lie far from those of all others, so none of its submaps can meet theirs. Most often "
          "its frame is its own, not the map's.",
          "give all robots poses in one world frame"},
      OddityTopic{"poses-unmatched",
                  "Not every cloud found a pose, or not every pose a cloud. Those left over play no part.",
                  "compare the stamps or numbers of both lists"},
      OddityTopic{"few-points", "A cloud has so few points that its surfaces leave gaps between voxels.",
                  "use a coarser resolution, and min_scans or a longer submap_distance"},
      OddityTopic{"dropped-points",
                  "A tenth or more of a cloud is not finite or lies beyond any lidar's reach, and is left out.",
                  "look at the driver that wrote it; many write NaN where nothing came back, which is harmless"},
  };
  return kTopics;
}

std::string_view way_out_of(std::string_view code) {
  const std::span<const OddityTopic> topics = oddity_catalog();
  const auto found =
      std::find_if(topics.begin(), topics.end(), [&](const OddityTopic& topic) { return topic.code == code; });
  return found == topics.end() ? std::string_view() : found->way_out;
}

}  // namespace kilter
