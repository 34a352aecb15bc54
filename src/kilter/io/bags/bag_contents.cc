// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/bags/bag_contents.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <tuple>

#include "kilter/io/bags/decompress.h"
#include "kilter/io/bags/ros_messages.h"

namespace kilter {
namespace {

// The newest message of a path's topic.
struct LastPath {
  std::size_t topic = 0;  // index into BagContents::poses
  std::int64_t log_ns = 0;
  std::uint32_t file = 0;
  MessagePlace place;
};

// Sorts messages by what they are as the walk goes on.
class Collector {
 public:
  explicit Collector(const BagFiles& files) : files_(files) {}

  Expected<void> collect(std::uint32_t file, UnpackingBudget& budget);
  Expected<BagContents> finish();

 private:
  void take(std::uint32_t file, const BagTopic& topic, const PassingMessage& message);
  void take_cloud(std::uint32_t file, const BagTopic& topic, const PassingMessage& message, std::string_view bytes,
                  const std::string& where);
  void take_pose(const BagTopic& topic, const PassingMessage& message, std::string_view bytes,
                 const std::string& where);
  void take_transforms(const BagTopic& topic, std::string_view bytes, const std::string& where);
  void note_path(std::uint32_t file, const BagTopic& topic, const PassingMessage& message);
  static void add_pose(PoseTopic& topic, const RosPose& pose);
  Expected<void> read_path(const LastPath& path);

  template <typename Topics>
  std::size_t index_in(Topics& topics, const PassingMessage& message, const BagTopic& topic);

  static constexpr std::size_t kUnknown = SIZE_MAX;
  const BagFiles& files_;
  BagContents contents_;
  std::vector<LastPath> paths_;
  std::vector<std::size_t> index_of_;  // a topic of the file at hand: where its clouds or poses are collected
};

bool same_topic(const BagTopic& a, const BagTopic& b) {
  return a.name == b.name && a.type == b.type && a.encoding == b.encoding;
}

// Topics go on in the next file under another number.
template <typename Topics>
std::size_t Collector::index_in(Topics& topics, const PassingMessage& message, const BagTopic& topic) {
  index_of_.resize(std::max(index_of_.size(), message.topic + 1), kUnknown);
  std::size_t& index = index_of_[message.topic];
  if (index != kUnknown) return index;
  const auto found =
      std::find_if(topics.begin(), topics.end(), [&](const auto& known) { return same_topic(known.topic, topic); });
  index = static_cast<std::size_t>(found - topics.begin());
  if (found == topics.end()) topics.emplace_back().topic = topic;
  return index;
}

void Collector::take_cloud(std::uint32_t file, const BagTopic& topic, const PassingMessage& message,
                           std::string_view bytes, const std::string& where) {
  CloudTopic& clouds = contents_.clouds[index_in(contents_.clouds, message, topic)];
  auto head = read_cloud_head(bytes, topic.encoding, where);
  if (!head) return clouds.unusable.add(std::move(head.error()));
  if (clouds.clouds.empty()) clouds.frame = head->header.frame;
  if (clouds.frame != head->header.frame) {
    ++clouds.other_frames;
    return;
  }
  clouds.clouds.push_back({head->header.stamp_ns, message.log_ns, file, message.place, head->points});
}

void Collector::add_pose(PoseTopic& topic, const RosPose& pose) {
  if (topic.poses.empty()) {
    topic.frame = pose.header.frame;
    topic.child_frame = pose.child_frame;
  }
  if (topic.frame != pose.header.frame || topic.child_frame != pose.child_frame) {
    ++topic.other_frames;
    return;
  }
  topic.poses.push_back({pose.header.stamp_ns, pose.T_frame_child});
}

void Collector::take_pose(const BagTopic& topic, const PassingMessage& message, std::string_view bytes,
                          const std::string& where) {
  PoseTopic& poses = contents_.poses[index_in(contents_.poses, message, topic)];
  auto pose = read_ros_pose(bytes, topic.ros_type, topic.encoding, where);
  if (!pose) return poses.unusable.add(std::move(pose.error()));
  add_pose(poses, *pose);
}

void Collector::take_transforms(const BagTopic& topic, std::string_view bytes, const std::string& where) {
  std::vector<std::string>& names = contents_.transform_topics;
  if (std::find(names.begin(), names.end(), topic.name) == names.end()) names.push_back(topic.name);
  const bool is_static = is_frame(topic.name, "tf_static");
  auto transforms = read_ros_poses(bytes, topic.ros_type, topic.encoding, where);
  if (!transforms) return contents_.unusable_transforms.add(std::move(transforms.error()));
  for (const RosPose& transform : transforms->poses) contents_.frames.add(transform, is_static);
  if (transforms->invalid > 0) {
    contents_.unusable_transforms.add({ErrorCode::kInvalidPose,
                                       fmt::format("{} transforms are not finite or no rotations", transforms->invalid),
                                       where,
                                       {}});
  }
}

void Collector::note_path(std::uint32_t file, const BagTopic& topic, const PassingMessage& message) {
  const LastPath path{index_in(contents_.poses, message, topic), message.log_ns, file, message.place};
  const auto found =
      std::find_if(paths_.begin(), paths_.end(), [&](const LastPath& known) { return known.topic == path.topic; });
  if (found == paths_.end()) {
    paths_.push_back(path);
  } else if (found->log_ns <= path.log_ns) {
    *found = path;
  }
}

void Collector::take(std::uint32_t file, const BagTopic& topic, const PassingMessage& message) {
  if (topic.ros_type == RosType::kPath) return note_path(file, topic, message);
  std::string_view bytes = message.bytes;
  Expected<MessageBytes> unpacked;
  const std::string where = files_[file]->where(message.place);
  if (topic.encoding == MessageEncoding::kCdr && is_zstd_frame(bytes)) {
    unpacked = read_message(*files_[file], message.place, topic.encoding);
    // Without bytes it is told to end too early, which is not worth another way.
    bytes = unpacked ? unpacked->bytes : std::string_view();
  }
  if (topic.ros_type == RosType::kPointCloud2) return take_cloud(file, topic, message, bytes, where);
  if (topic.ros_type == RosType::kTransforms) return take_transforms(topic, bytes, where);
  take_pose(topic, message, bytes, where);
}

Expected<void> Collector::collect(std::uint32_t file, UnpackingBudget& budget) {
  BagReader& reader = *files_[file];
  index_of_.clear();
  auto done =
      reader.walk([&](const PassingMessage& message) { take(file, reader.topics()[message.topic], message); }, budget);
  if (!done) return done;
  for (const BagTopic& topic : reader.topics()) {
    const auto found = std::find_if(contents_.topics.begin(), contents_.topics.end(),
                                    [&](const BagTopic& known) { return same_topic(known, topic); });
    if (found == contents_.topics.end()) {
      contents_.topics.push_back(topic);
    } else {
      found->messages += topic.messages;
    }
  }
  return {};
}

Expected<void> Collector::read_path(const LastPath& path) {
  PoseTopic& poses = contents_.poses[path.topic];
  const BagReader& file = *files_[path.file];
  const auto message = read_message(file, path.place, poses.topic.encoding);
  if (!message) return pass_up(message.error());
  auto all = read_ros_poses(message->bytes, RosType::kPath, poses.topic.encoding, file.where(path.place));
  if (!all) {
    poses.unusable.add(std::move(all.error()));
    return {};
  }
  for (const RosPose& pose : all->poses) add_pose(poses, pose);
  if (all->invalid > 0) {
    poses.unusable.add({ErrorCode::kInvalidPose,
                        fmt::format("{} poses are not finite or no rotations", all->invalid),
                        file.where(path.place),
                        {}});
  }
  return {};
}

Expected<BagContents> Collector::finish() {
  for (const LastPath& path : paths_) {
    if (auto ok = read_path(path); !ok) return pass_up(ok.error());
  }
  contents_.frames.finish();
  std::sort(contents_.topics.begin(), contents_.topics.end(),
            [](const BagTopic& a, const BagTopic& b) { return std::tie(a.name, a.type) < std::tie(b.name, b.type); });
  for (CloudTopic& clouds : contents_.clouds) {
    const auto topic = std::find_if(contents_.topics.begin(), contents_.topics.end(),
                                    [&](const BagTopic& known) { return same_topic(known, clouds.topic); });
    clouds.unread = topic->messages - clouds.clouds.size() - clouds.other_frames - clouds.unusable.messages;
    std::stable_sort(clouds.clouds.begin(), clouds.clouds.end(),
                     [](const CloudMessage& a, const CloudMessage& b) { return a.stamp_ns < b.stamp_ns; });
  }
  return std::move(contents_);
}

}  // namespace

Expected<BagContents> read_contents(const BagFiles& files, UnpackingBudget budget) {
  Collector collector(files);
  for (std::uint32_t file = 0; file < files.size(); ++file) {
    if (auto ok = collector.collect(file, budget); !ok) return pass_up(ok.error());
  }
  return collector.finish();
}

Expected<MessageBytes> read_message(const BagReader& file, const MessagePlace& place, MessageEncoding encoding) {
  Expected<MessageBytes> message = file.read(place);
  if (!message || encoding != MessageEncoding::kCdr || !is_zstd_frame(message->bytes)) return message;
  Expected<ByteBuffer> bytes = unpack_zstd_frame(message->bytes, file.where(place));
  if (!bytes) return pass_up(bytes.error());
  auto owner = std::make_shared<const ByteBuffer>(*std::move(bytes));
  return MessageBytes{owner, owner->view(), std::min<std::uint64_t>(message->packed_bytes, message->bytes.size())};
}

std::string list_topics(std::span<const BagTopic> topics) {
  constexpr std::size_t kListed = 40;
  if (topics.empty()) return "it holds no topics at all";
  std::string text = "its topics are";
  for (std::size_t i = 0; i < std::min(kListed, topics.size()); ++i) {
    text += fmt::format("{} {} ({}, {} message{})", i == 0 ? "" : ",", printable(topics[i].name, 80),
                        printable(topics[i].type, 80), topics[i].messages, topics[i].messages == 1 ? "" : "s");
  }
  return topics.size() > kListed ? fmt::format("{}, and {} more", text, topics.size() - kListed) : text;
}

}  // namespace kilter
