// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <bit>
#include <string>
#include <string_view>

namespace kilter_testing {

/// Appends the bytes of a number.
template <typename T>
void put(std::string& bytes, T value, std::endian order = std::endian::little) {
  const auto* raw = reinterpret_cast<const char*>(&value);
  std::string text(raw, sizeof(T));
  if (order != std::endian::native) std::reverse(text.begin(), text.end());
  bytes += text;
}

/// Appends several numbers of one type.
template <typename T, typename... Values>
void put_all(std::string& bytes, std::endian order, Values... values) {
  (put(bytes, static_cast<T>(values), order), ...);
}

/// A PCD file by its lines: two points unless told otherwise. A line set to "" is left out.
struct PcdBytes {
  std::string version = "0.7";
  std::string fields = "x y z";
  std::string size = "4 4 4";
  std::string type = "F F F";
  std::string count = "1 1 1";
  std::string width = "2";
  std::string height = "1";
  std::string points = "2";
  std::string data = "ascii";
  std::string body = "1 2 3\n4 5 6\n";

  [[nodiscard]] std::string str() const {
    std::string text = "# .PCD v0.7 - Point Cloud Data file format\n";
    const auto line = [&](std::string_view key, const std::string& value) {
      if (!value.empty()) text += std::string(key) + " " + value + "\n";
    };
    line("VERSION", version);
    line("FIELDS", fields);
    line("SIZE", size);
    line("TYPE", type);
    line("COUNT", count);
    line("WIDTH", width);
    line("HEIGHT", height);
    line("VIEWPOINT", "0 0 0 1 0 0 0");
    line("POINTS", points);
    line("DATA", data);
    return text + body;
  }
};

/// Two records of x y z float32.
inline std::string two_float_points(std::endian order = std::endian::little) {
  std::string bytes;
  put_all<float>(bytes, order, 1, 2, 3, 4, 5, 6);
  return bytes;
}

/// A PLY file of two vertices x y z float32.
inline std::string ply_bytes(std::string_view format, const std::string& body, std::string_view before = "",
                             std::string_view after = "") {
  std::string text = "ply\nformat " + std::string(format) + " 1.0\ncomment made by a test\n";
  text += before;
  text += "element vertex 2\nproperty float x\nproperty float y\nproperty float z\n";
  text += after;
  return text + "end_header\n" + body;
}

}  // namespace kilter_testing
