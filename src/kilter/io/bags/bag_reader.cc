// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/bags/bag_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace kilter {

bool UnpackingBudget::take(Packing packing, std::uint64_t unpacked_bytes) {
  constexpr std::uint64_t kFaster = 30;
  const bool was_left = left_ > 0;
  const std::uint64_t cost = packing == Packing::kBz2 ? unpacked_bytes : unpacked_bytes / kFaster + 1;
  left_ -= std::min(left_, cost);
  return was_left;
}

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

tl::unexpected<Error> BagReader::refuse_to_pass_over(std::string where) {
  return fail(ErrorCode::kUnsupported,
              "too much has to be unpacked for a glance, and no index tells what a chunk holds", std::move(where));
}

}  // namespace kilter
