// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/bags/bag_reader.h"

#include <fmt/format.h>

#include <algorithm>

namespace kilter {

Expected<std::size_t> BagReader::find_or_add(BagTopic topic, const std::string& where) {
  const auto found = std::find_if(topics_.begin(), topics_.end(), [&](const BagTopic& known) {
    return known.name == topic.name && known.type == topic.type && known.encoding == topic.encoding;
  });
  if (found != topics_.end()) return static_cast<std::size_t>(found - topics_.begin());
  if (topics_.size() == kMaxTopics) {
    return fail(ErrorCode::kUnsupported, fmt::format("more than {} topics", kMaxTopics), where);
  }
  if (topic.encoding != MessageEncoding::kOther) topic.ros_type = ros_type_of(topic.type);
  topics_.push_back(std::move(topic));
  return topics_.size() - 1;
}

}  // namespace kilter
