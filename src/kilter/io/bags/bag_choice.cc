// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/bags/bag_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <tuple>
#include <utility>

#include "kilter/io/file.h"

namespace kilter {
namespace {

// What choosing and its messages need.
struct Context {
  const BagContents& contents;
  const WantedTopics& wanted;
  std::string robot;
  const std::string& where;
  std::vector<std::string>& notes;

  void note(const std::string& text) const { notes.push_back(fmt::format("robot {}: {}", robot, text)); }
  [[nodiscard]] bool wants(const std::string& topic) const {
    return std::find(wanted.begin(), wanted.end(), topic) != wanted.end();
  }
};

std::string seconds(std::int64_t ns) { return fmt::format("{:.3f}", static_cast<double>(ns) * 1e-9); }

std::string quoted_frame(const std::string& frame) {
  return frame.empty() ? "no frame" : fmt::format("frame {}", printable(frame, 80));
}

std::string label(const BagTopic& topic) {
  return fmt::format("{} ({})", printable(topic.name, 80), name_of(topic.ros_type));
}

std::string in_a_line(const Error& error) {
  return fmt::format("{}: {}: {}", error_code_name(error.code), error.where, error.message);
}

Expected<void> check_wanted(const Context& context) {
  for (const std::string& name : context.wanted) {
    const auto found = std::find_if(context.contents.topics.begin(), context.contents.topics.end(),
                                    [&](const BagTopic& topic) { return topic.name == name; });
    if (found != context.contents.topics.end() && found->ros_type != RosType::kOther) continue;
    return fail(ErrorCode::kNotFound,
                fmt::format("expected clouds or poses in the topic {}; {}", printable(name, 80),
                            list_topics(context.contents.topics)),
                context.where);
  }
  return {};
}

// Odd messages are worth a line each time.
void note_unusable(const Context& context, const BagTopic& topic, std::size_t other_frames, const Unusable& unusable) {
  if (other_frames > 0) {
    context.note(fmt::format("{} messages of {} are in another frame than the first and were left out", other_frames,
                             label(topic)));
  }
  if (unusable.messages > 0) {
    context.note(fmt::format("{} messages of {} could not be used; the first: {}", unusable.messages, label(topic),
                             in_a_line(*unusable.first)));
  }
}

bool has_fixed_name(const std::string& frame) {
  return is_frame(frame, "map") || is_frame(frame, "odom") || is_frame(frame, "world");
}

// Where clouds are drawn rather than seen.
bool is_in_world(const BagContents& contents, const std::string& frame) {
  if (frame.empty()) return false;
  const auto is_fixed = [&](const PoseTopic& poses) { return !poses.poses.empty() && poses.frame == frame; };
  if (std::any_of(contents.poses.begin(), contents.poses.end(), is_fixed)) return true;
  return has_fixed_name(frame);
}

tl::unexpected<Error> refuse_clouds(const Context& context) {
  for (const CloudTopic& topic : context.contents.clouds) {
    if (topic.unusable.first) return pass_up(*topic.unusable.first);
  }
  return fail(
      ErrorCode::kEmptyInput,
      fmt::format("expected clouds (sensor_msgs/PointCloud2), found none; {}", list_topics(context.contents.topics)),
      context.where, "clouds of another type have to be converted, and recorded as PointCloud2");
}

Expected<const CloudTopic*> choose_clouds(const Context& context) {
  const std::vector<CloudTopic>& all = context.contents.clouds;
  const std::vector<BagTopic>& topics = context.contents.topics;
  const bool is_choosy = std::any_of(topics.begin(), topics.end(), [&](const BagTopic& topic) {
    return topic.ros_type == RosType::kPointCloud2 && context.wants(topic.name);
  });
  const CloudTopic* best = nullptr;
  const auto worth = [&](const CloudTopic& topic) {
    return std::tuple(!is_in_world(context.contents, topic.frame), topic.clouds.size() + topic.unread);
  };
  for (const CloudTopic& topic : all) {
    if (topic.clouds.empty() || (is_choosy && !context.wants(topic.topic.name))) continue;
    const bool better = best == nullptr || worth(topic) > worth(*best) ||
                        (worth(topic) == worth(*best) && topic.topic.name < best->topic.name);
    if (better) best = &topic;
  }
  if (best == nullptr) return refuse_clouds(context);
  std::vector<std::string> others;
  for (const CloudTopic& topic : all) {
    if (&topic != best) others.push_back(fmt::format("{} ({})", topic.topic.name, topic.clouds.size()));
  }
  std::string text =
      fmt::format("{} clouds from {}, {}", best->clouds.size(), label(best->topic), quoted_frame(best->frame));
  if (!others.empty()) text += fmt::format("; not from {}: name one as PATH#/TOPIC", some_of(others));
  context.note(text);
  if (best->unread > 0) {
    context.note(
        fmt::format("only the first {} of {} clouds were looked at, since unpacking takes long; what is said of poses, "
                    "path, stamps and submaps is of these",
                    best->clouds.size(), best->clouds.size() + best->unread));
  }
  note_unusable(context, best->topic, best->other_frames, best->unusable);
  return best;
}

// When clouds were taken: by their headers, unless these were never filled in.
std::vector<std::int64_t> stamps_of(const Context& context, const CloudTopic& topic) {
  std::vector<std::int64_t> stamps;
  for (const CloudMessage& cloud : topic.clouds) stamps.push_back(cloud.stamp_ns);
  const bool are_zero = std::all_of(stamps.begin(), stamps.end(), [](std::int64_t stamp) { return stamp == 0; });
  if (!are_zero) return stamps;
  context.note(
      "the clouds' headers have no time; the time at which they were recorded is taken, which is somewhat later");
  std::transform(topic.clouds.begin(), topic.clouds.end(), stamps.begin(),
                 [](const CloudMessage& cloud) { return cloud.log_ns; });
  return stamps;
}

tl::unexpected<Error> refuse_poses(const Context& context, const std::vector<PoseSource>& sources,
                                   const std::string& cloud_frame, const std::vector<std::int64_t>& stamps) {
  if (!sources.empty()) {
    const auto [first, last] = std::minmax_element(stamps.begin(), stamps.end());
    const PoseSource& source = sources.front();
    return fail(
        ErrorCode::kCountMismatch,
        fmt::format("no cloud has a pose: clouds are from {} to {} s, poses of {} from {} to {} s", seconds(*first),
                    seconds(*last), label(source.topic), seconds(source.first_ns), seconds(source.last_ns)),
        context.where,
        "both have to be stamped by the same clock; a pose counts for half a second between two of them, and for "
        "20 ms beside one");
  }
  for (const PoseTopic& topic : context.contents.poses) {
    if (topic.unusable.first) return pass_up(*topic.unusable.first);
  }
  return fail(ErrorCode::kEmptyInput,
              fmt::format("expected poses in nav_msgs/Odometry, geometry_msgs/PoseStamped, nav_msgs/Path or transforms "
                          "from a fixed frame to \"{}\" (for clouds drawn in the world: in that frame), found none; {}",
                          printable(cloud_frame, 80), list_topics(context.contents.topics)),
              context.where, "record the SLAM's odometry or /tf and /tf_static beside the clouds");
}

bool wants_source(const Context& context, const PoseSource& source) {
  if (source.topic.ros_type != RosType::kTransforms) return context.wants(source.topic.name);
  const std::vector<std::string>& names = context.contents.transform_topics;
  return std::any_of(names.begin(), names.end(), [&](const std::string& name) { return context.wants(name); });
}

// The named topic is meant and no other, even if nothing in it is of use.
bool wants_poses(const Context& context) {
  const std::vector<BagTopic>& topics = context.contents.topics;
  return std::any_of(topics.begin(), topics.end(), [&](const BagTopic& topic) {
    return topic.ros_type != RosType::kPointCloud2 && context.wants(topic.name);
  });
}

// Of all sources those that are meant; for clouds in the world, those that speak of the same world.
std::vector<PoseSource> candidates_of(const Context& context, const std::vector<PoseSource>& sources,
                                      const std::string& cloud_frame) {
  const bool is_choosy = wants_poses(context);
  const bool in_world = has_fixed_name(cloud_frame);
  std::vector<PoseSource> candidates;
  std::copy_if(sources.begin(), sources.end(), std::back_inserter(candidates), [&](const PoseSource& source) {
    return (!is_choosy || wants_source(context, source)) && (!in_world || source.frame == cloud_frame);
  });
  return candidates;
}

void note_poses(const Context& context, const ChosenPoses& chosen, const std::vector<PoseSource>& sources,
                std::size_t clouds) {
  const PoseSource& source = chosen.source;
  std::string text = fmt::format("{} poses from {}, in {}; poses matched {} of {} clouds", source.poses,
                                 label(source.topic), quoted_frame(source.frame), chosen.match.clouds.size(), clouds);
  if (chosen.match.clouds.size() < clouds) text += ", the others have no pose close enough and are left out";
  std::vector<std::string> others;
  for (const PoseSource& other : sources) {
    if (other.topic.name != source.topic.name) others.push_back(other.topic.name);
  }
  if (!others.empty()) text += fmt::format("; not from {}: name one as PATH#/TOPIC", some_of(others));
  context.note(text);
  for (const PoseTopic& topic : context.contents.poses) {
    if (topic.topic.name == source.topic.name) {
      note_unusable(context, topic.topic, topic.other_frames, topic.unusable);
    }
  }
  const Unusable& transforms = context.contents.unusable_transforms;
  if (transforms.messages > 0) {
    context.note(fmt::format("{} messages of transforms could not be used; the first: {}", transforms.messages,
                             in_a_line(*transforms.first)));
  }
}

Expected<ChosenPoses> choose_wanted_poses(const Context& context, const std::string& cloud_frame,
                                          const std::vector<std::int64_t>& stamps) {
  const std::vector<PoseSource> sources = find_pose_sources(context.contents, cloud_frame);
  const std::vector<PoseSource> candidates = candidates_of(context, sources, cloud_frame);
  std::optional<ChosenPoses> chosen = choose_poses(candidates, stamps);
  if (!chosen) return refuse_poses(context, candidates, cloud_frame, stamps);
  note_poses(context, *chosen, sources, stamps.size());
  return *std::move(chosen);
}

// Poses of the vehicle become poses of the sensor where the bag says how it is mounted.
void move_to_clouds(const Context& context, const std::string& cloud_frame, ChosenPoses& poses) {
  const PoseSource& source = poses.source;
  if (source.frame == cloud_frame && !cloud_frame.empty()) {
    context.note(
        fmt::format("the clouds are drawn in the poses' own {}; each is brought back to where it was seen by its "
                    "pose",
                    quoted_frame(cloud_frame)));
    return;
  }
  if (source.child_frame == cloud_frame) return;
  if (source.child_frame.empty()) {
    context.note(
        fmt::format("{} does not say what its poses are of; they are taken as the clouds' own (else set "
                    "T_body_sensor)",
                    label(source.topic)));
    return;
  }
  const std::optional<Pose3> T_child_cloud = context.contents.frames.static_between(source.child_frame, cloud_frame);
  const std::string both =
      fmt::format("the poses are of {}, the clouds in {}", quoted_frame(source.child_frame), quoted_frame(cloud_frame));
  if (!T_child_cloud) {
    context.note(both + "; no static transform joins them, so they are taken as one (else set T_body_sensor)");
    return;
  }
  context.note(both + "; moved by the bag's static transforms (T_body_sensor would come on top)");
  for (Pose3& pose : poses.match.T_frame_child) pose = pose * *T_child_cloud;
}

}  // namespace

Expected<BagChoice> choose_from(const BagContents& contents, const WantedTopics& wanted, const std::string& robot,
                                const std::string& where, std::vector<std::string>& notes) {
  const Context context{contents, wanted, robot, where, notes};
  if (auto ok = check_wanted(context); !ok) return pass_up(ok.error());
  const auto clouds = choose_clouds(context);
  if (!clouds) return pass_up(clouds.error());
  BagChoice choice;
  choice.clouds = *clouds;
  choice.stamps_ns = stamps_of(context, **clouds);
  auto poses = choose_wanted_poses(context, (*clouds)->frame, choice.stamps_ns);
  if (!poses) return pass_up(poses.error());
  choice.clouds_in_world = !(*clouds)->frame.empty() && poses->source.frame == (*clouds)->frame;
  move_to_clouds(context, (*clouds)->frame, *poses);
  choice.poses_found = poses->source.poses;
  choice.matched = std::move(poses->match.clouds);
  choice.T_world_cloud = std::move(poses->match.T_frame_child);
  return choice;
}

}  // namespace kilter
