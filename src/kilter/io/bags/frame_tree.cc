// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/bags/frame_tree.h"

#include <algorithm>
#include <limits>
#include <set>

namespace kilter {
namespace {

// Numbers are sent as they are, so what is computed anew differs by rounding at most.
constexpr double kSame = 1e-9;

// What all samples say, if there are several and they agree.
std::optional<Pose3> same_in_all(const std::vector<StampedPose>& samples) {
  if (samples.size() < 2) return std::nullopt;
  const Pose3& first = samples.front().T_world_body;
  const bool agree = std::all_of(samples.begin(), samples.end(), [&](const StampedPose& sample) {
    return (first.inverse() * sample.T_world_body).log().norm() <= kSame;
  });
  return agree ? std::optional(first) : std::nullopt;
}

// Where nothing at all moves, a transform that was sent twice says little of later.
bool holds_always(const FrameTree::Edge& edge, bool others_move) {
  return edge.constant && (edge.is_static || others_move);
}

}  // namespace

bool is_frame(std::string_view frame, std::string_view name) { return frame.substr(frame.rfind('/') + 1) == name; }

void FrameTree::add(const RosPose& transform, bool is_static) {
  Edge& edge = parents_of_[transform.child_frame][transform.header.frame];
  // Static ones are sent again and again, and the last one counts.
  if (is_static) edge.samples.clear();
  edge.is_static = is_static;
  edge.is_correction = is_frame(transform.child_frame, "odom");
  edge.samples.push_back({transform.header.stamp_ns, transform.T_frame_child});
}

void FrameTree::finish() {
  for (auto& [child, parents] : parents_of_) {
    for (auto& [parent, edge] : parents) {
      edge.constant = edge.is_static ? std::optional(edge.samples.back().T_world_body) : same_in_all(edge.samples);
      if (!edge.is_static) edge.over_time.emplace(std::move(edge.samples));
    }
  }
}

std::vector<FrameTree::Step> FrameTree::static_steps(const std::string& start) const {
  std::vector<Step> steps = {{start, Pose3()}};
  while (steps.size() <= kMaxChain) {
    const auto parents = parents_of_.find(steps.back().frame);
    if (parents == parents_of_.end()) break;
    const auto edge = std::find_if(parents->second.begin(), parents->second.end(),
                                   [](const auto& entry) { return entry.second.constant.has_value(); });
    if (edge == parents->second.end()) break;
    steps.push_back({edge->first, *edge->second.constant * steps.back().T_frame_start});
  }
  return steps;
}

std::optional<Pose3> FrameTree::static_between(const std::string& a, const std::string& b) const {
  const std::vector<Step> above_a = static_steps(a);
  const std::vector<Step> above_b = static_steps(b);
  for (const Step& step : above_a) {
    const auto common =
        std::find_if(above_b.begin(), above_b.end(), [&](const Step& other) { return other.frame == step.frame; });
    if (common != above_b.end()) return step.T_frame_start.inverse() * common->T_frame_start;
  }
  return std::nullopt;
}

const std::pair<const std::string, FrameTree::Edge>* FrameTree::parent_of(const std::string& frame) const {
  const auto parents = parents_of_.find(frame);
  if (parents == parents_of_.end()) return nullptr;
  const auto sent = [](const Edge& edge) { return edge.over_time ? edge.over_time->poses().size() : 1; };
  return &*std::max_element(parents->second.begin(), parents->second.end(),
                            [&](const auto& x, const auto& y) { return sent(x.second) < sent(y.second); });
}

std::optional<FrameTree::Chain> FrameTree::chain_from(const std::string& frame) const {
  // Everything above the frame, and the first place above which something moves.
  std::vector<std::string> above = {frame};
  std::set<std::string> met = {frame};
  std::size_t first_moved = 0;
  while (above.size() <= kMaxChain) {
    const auto* parent = parent_of(above.back());
    if (parent == nullptr || !met.insert(parent->first).second) break;
    above.push_back(parent->first);
    if (first_moved == 0 && !parent->second.is_static) first_moved = above.size() - 1;
  }
  if (first_moved == 0) return std::nullopt;
  std::size_t fixed = above.size() - 1;
  for (const std::string_view name : {"world", "odom", "map"}) {
    for (std::size_t i = above.size() - 1; i >= first_moved; --i) {
      if (is_frame(above[i], name)) fixed = i;
    }
  }
  Chain chain{above[fixed], {}, 0, std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::max()};
  for (std::size_t i = 0; i < fixed; ++i) chain.edges.push_back(&parent_of(above[i])->second);
  chain.moves = std::any_of(chain.edges.begin(), chain.edges.end(), [](const Edge* edge) { return !edge->constant; });
  for (const Edge* edge : chain.edges) {
    if (holds_always(*edge, chain.moves)) continue;
    const auto poses = edge->over_time->poses();
    chain.samples = std::max(chain.samples, poses.size());
    chain.first_ns = std::max(chain.first_ns, poses.front().stamp_ns);
    chain.last_ns = std::min(chain.last_ns, poses.back().stamp_ns);
  }
  return chain;
}

std::optional<Pose3> FrameTree::at(const Chain& chain, std::int64_t stamp_ns, std::int64_t max_gap_ns,
                                   std::int64_t slack_ns) const {
  Pose3 T_frame_start;
  for (const Edge* edge : chain.edges) {
    const std::int64_t older_ns = edge->is_correction ? kMaxCorrectionGap_ns : 0;
    const std::optional<Pose3> T_parent_child =
        holds_always(*edge, chain.moves)
            ? edge->constant
            : edge->over_time->at(stamp_ns, std::max(max_gap_ns, older_ns), std::max(slack_ns, older_ns));
    if (!T_parent_child) return std::nullopt;
    T_frame_start = *T_parent_child * T_frame_start;
  }
  return T_frame_start;
}

}  // namespace kilter
