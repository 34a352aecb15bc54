// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/bags/bag_log.h"

#include <fmt/format.h>

#include <memory>
#include <utility>

#include "kilter/base/contract.h"
#include "kilter/io/bags/point_cloud2.h"
#include "kilter/io/packed_points.h"

namespace kilter {
namespace {

// What reading clouds needs, for as long as anyone may ask.
struct OpenBag {
  BagFiles files;
  MessageEncoding encoding = MessageEncoding::kRos1;
  std::vector<CloudMessage> clouds;   // with a pose
  std::vector<Pose3> T_sensor_cloud;  // where clouds are drawn in the world; else empty
};

Expected<PointCloud> read_cloud(const OpenBag& bag, std::size_t i) {
  KILTER_EXPECTS(i < bag.clouds.size());
  const CloudMessage& cloud = bag.clouds[i];
  const BagReader& file = *bag.files[cloud.file];
  const auto message = read_message(file, cloud.place, bag.encoding);
  if (!message) return pass_up(message.error());
  // A head that promises more than its message holds is refused for that.
  if (cloud.points <= message->bytes.size()) {
    const auto ok = check_packed_points(cloud.points, message->packed_bytes, file.where(cloud.place));
    if (!ok) return pass_up(ok.error());
  }
  Expected<PointCloud> points = read_point_cloud2(message->bytes, bag.encoding, file.where(cloud.place));
  if (!points || bag.T_sensor_cloud.empty()) return points;
  for (Eigen::Vector3f& point_m : points->points_m) {
    point_m = (bag.T_sensor_cloud[i] * point_m.cast<double>().eval()).cast<float>();
  }
  return points;
}

// Equal clouds taken twice have other stamps, so that the stamp is as good a digest as any.
CloudPeek peek_cloud(const OpenBag& bag, std::size_t i) {
  KILTER_EXPECTS(i < bag.clouds.size());
  const CloudMessage& cloud = bag.clouds[i];
  // A head may promise more than its message holds; where SQLite knows the size, nobody asked it.
  const bool can_be = cloud.place.size == 0 || cloud.points <= cloud.place.size;
  return {can_be ? std::optional(cloud.points) : std::nullopt, cloud.place.size,
          static_cast<std::uint64_t>(cloud.stamp_ns)};
}

}  // namespace

Expected<RobotLog> make_bag_log(std::string name, BagFiles files, const WantedTopics& wanted, const std::string& where,
                                std::vector<std::string>& notes, UnpackingBudget budget) {
  const auto contents = read_contents(files, budget);
  if (!contents) return pass_up(contents.error());
  std::string first_note;
  for (const auto& file : files) {
    for (const std::string& note : file->notes()) notes.push_back(fmt::format("robot {}: {}", name, note));
    if (first_note.empty() && !file->notes().empty()) first_note = file->notes().front();
  }
  auto choice = choose_from(*contents, wanted, name, where, notes);
  if (!choice) {
    // Notes are told with a result only, and what was cut off may be what is missed.
    Error error = std::move(choice.error());
    if (!first_note.empty()) error.hint += (error.hint.empty() ? "" : "; ") + first_note;
    return pass_up(std::move(error));
  }
  const auto bag = std::make_shared<OpenBag>();
  bag->files = std::move(files);
  bag->encoding = choice->clouds->topic.encoding;
  RobotLog log;
  log.name = std::move(name);
  log.clouds_found = choice->stamps_ns.size();
  log.poses_found = choice->poses_found;
  log.poses_are_a_trajectory = true;
  log.clouds_in_world = choice->clouds_in_world;
  log.stamp_unit = "ns";  // as all of ROS
  log.clouds_unread = choice->clouds->unread;
  for (const std::size_t i : choice->matched) {
    bag->clouds.push_back(choice->clouds->clouds[i]);
    log.stamps_ns.push_back(choice->stamps_ns[i]);
  }
  if (choice->clouds_in_world) {
    for (const Pose3& T_world_sensor : choice->T_world_cloud) bag->T_sensor_cloud.push_back(T_world_sensor.inverse());
  }
  log.T_world_cloud = std::move(choice->T_world_cloud);
  log.peek_cloud = [bag](std::size_t i) { return std::optional(peek_cloud(*bag, i)); };
  log.read_cloud = [bag](std::size_t i) { return read_cloud(*bag, i); };
  log.cloud_name = [bag](std::size_t i) { return bag->files[bag->clouds[i].file]->where(bag->clouds[i].place); };
  return log;
}

}  // namespace kilter
