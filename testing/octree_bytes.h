// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "testing/cloud_bytes.h"

namespace kilter_testing {

/// An OctoMap file by its lines. A line set to "" is left out.
struct OctreeBytes {
  std::string first_line = "# Octomap OcTree file";
  std::string id = "OcTree";
  std::string size;
  std::string res = "0.1";
  std::string body;

  [[nodiscard]] static OctreeBytes binary() {
    OctreeBytes tree;
    tree.first_line = "# Octomap OcTree binary file";
    tree.size = "6";
    return tree;
  }

  [[nodiscard]] std::string str() const {
    std::string text = first_line + "\n# made by a test\n";
    const auto line = [&](const std::string& key, const std::string& value) {
      if (!value.empty()) text += key + " " + value + "\n";
    };
    line("id", id);
    line("size", size);
    line("res", res);
    return text + "data\n" + body;
  }
};

/// A node of an `.ot`: its log-odds and which children follow, child i in bit i.
inline std::string octree_node(float log_odds, unsigned children) {
  std::string bytes;
  put(bytes, log_odds);
  return bytes + static_cast<char>(children);
}

/// An `.ot` of 18 nodes: an occupied cell at index (0, 0, 0) and a free one at (1, 0, 1), under one chain of 15 nodes.
inline OctreeBytes full_octree() {
  OctreeBytes tree;
  tree.size = "18";
  tree.body = octree_node(0.85F, 0b10000000);
  for (int level = 15; level > 1; --level) tree.body += octree_node(0.85F, 0b00000001);
  tree.body += octree_node(0.85F, 0b00100001) + octree_node(0.85F, 0) + octree_node(-0.4F, 0);
  return tree;
}

/// A `.bt` of 6 nodes: leaves of levels 15 and 14.
inline OctreeBytes binary_octree() {
  OctreeBytes tree = OctreeBytes::binary();
  tree.body = std::string("\xC9\x80\x10\x00", 4);
  return tree;
}

}  // namespace kilter_testing
