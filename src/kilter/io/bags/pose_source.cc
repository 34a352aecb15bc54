// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/bags/pose_source.h"

#include <algorithm>
#include <memory>
#include <tuple>

namespace kilter {
namespace {

// Kinds in the order in which they are asked.
int rank_of(RosType type) {
  switch (type) {
    case RosType::kOdometry:
      return 0;
    case RosType::kPoseStamped:
    case RosType::kPoseWithCovarianceStamped:
      return 1;
    case RosType::kPath:
      return 2;
    case RosType::kTransforms:
    case RosType::kPointCloud2:
    case RosType::kOther:
      break;
  }
  return 3;
}

PoseSource source_of(const PoseTopic& topic) {
  PoseSource source;
  source.topic = topic.topic;
  source.frame = topic.frame;
  source.child_frame = topic.child_frame;
  const auto trajectory = std::make_shared<const StampedTrajectory>(topic.poses);
  source.poses = topic.poses.size();
  source.first_ns = trajectory->poses().front().stamp_ns;
  source.last_ns = trajectory->poses().back().stamp_ns;
  source.at = [trajectory](std::int64_t stamp_ns) { return trajectory->at(stamp_ns, kMaxPoseGap_ns, kPoseSlack_ns); };
  source.has = [trajectory](std::int64_t stamp_ns) { return trajectory->at(stamp_ns, 0, 0).has_value(); };
  return source;
}

PoseSource source_of(const BagContents& contents, const FrameTree::Chain& chain, const std::string& cloud_frame) {
  PoseSource source;
  const std::vector<std::string>& topics = contents.transform_topics;
  const auto moving =
      std::find_if(topics.begin(), topics.end(), [](const std::string& name) { return !is_frame(name, "tf_static"); });
  source.topic = {moving == topics.end() ? topics.front() : *moving, std::string(name_of(RosType::kTransforms)),
                  MessageEncoding::kOther, RosType::kTransforms, chain.samples};
  source.frame = chain.fixed_frame;
  source.child_frame = cloud_frame;
  source.poses = chain.samples;
  source.first_ns = chain.first_ns;
  source.last_ns = chain.last_ns;
  const FrameTree* tree = &contents.frames;
  source.at = [tree, chain](std::int64_t stamp_ns) { return tree->at(chain, stamp_ns, kMaxPoseGap_ns, kPoseSlack_ns); };
  source.has = [tree, chain](std::int64_t stamp_ns) { return tree->at(chain, stamp_ns, 0, 0).has_value(); };
  return source;
}

}  // namespace

std::vector<PoseSource> find_pose_sources(const BagContents& contents, const std::string& cloud_frame) {
  std::vector<PoseSource> sources;
  for (const PoseTopic& topic : contents.poses) {
    if (!topic.poses.empty()) sources.push_back(source_of(topic));
  }
  if (const auto chain = contents.frames.chain_from(cloud_frame); chain && !contents.transform_topics.empty()) {
    sources.push_back(source_of(contents, *chain, cloud_frame));
  }
  std::stable_sort(sources.begin(), sources.end(), [](const PoseSource& a, const PoseSource& b) {
    const int rank_a = rank_of(a.topic.ros_type);
    const int rank_b = rank_of(b.topic.ros_type);
    return std::tie(rank_a, a.topic.name) < std::tie(rank_b, b.topic.name);
  });
  return sources;
}

PoseMatch match_poses(const PoseSource& source, const std::vector<std::int64_t>& stamps_ns) {
  PoseMatch match;
  for (std::size_t i = 0; i < stamps_ns.size(); ++i) {
    const std::optional<Pose3> T_frame_child = source.at(stamps_ns[i]);
    if (!T_frame_child) continue;
    match.clouds.push_back(i);
    match.T_frame_child.push_back(*T_frame_child);
    if (source.has(stamps_ns[i])) ++match.exact;
  }
  return match;
}

std::optional<ChosenPoses> choose_poses(const std::vector<PoseSource>& sources,
                                        const std::vector<std::int64_t>& stamps_ns) {
  std::vector<PoseMatch> matches;
  std::size_t most = 0;
  for (const PoseSource& source : sources) {
    matches.push_back(match_poses(source, stamps_ns));
    most = std::max(most, matches.back().clouds.size());
  }
  const auto worth = [&](std::size_t i) {
    return std::tuple(-rank_of(sources[i].topic.ros_type), matches[i].clouds.size(), matches[i].exact,
                      sources[i].poses);
  };
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const std::size_t placed = matches[i].clouds.size();
    if (placed == 0 || 2 * placed < most) continue;
    if (!best || worth(i) > worth(*best)) best = i;
  }
  if (!best) return std::nullopt;
  return ChosenPoses{sources[*best], std::move(matches[*best])};
}

}  // namespace kilter
