// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kilter/geometry/pose3.h"

namespace kilter {

/// The shortest text that reads back to the same double: "0.1", "1e+20", "-0.0". Precondition: finite.
[[nodiscard]] std::string number_text(double value);

/// `text` as a JSON string, quotes included. Bytes that are not UTF-8, and controls that steer terminals, become '?'.
[[nodiscard]] std::string json_string(std::string_view text);

/// Writes JSON front to back, keys in the order of the calls. Objects and lists go over several lines; lists of
/// numbers and compact objects stay on one, so that results can be read and compared line by line.
///
/// The caller opens and closes in matching order, and names every value inside an object by key().
class JsonWriter {
 public:
  enum class Layout { kLines, kCompact };

  JsonWriter& open_object(Layout layout = Layout::kLines);
  JsonWriter& open_list(Layout layout = Layout::kLines);
  /// Ends the innermost object or list.
  JsonWriter& close();

  /// Names the next value. Precondition: inside an object.
  JsonWriter& key(std::string_view name);

  JsonWriter& null();
  JsonWriter& value(bool flag);
  /// NaN and infinity have no JSON: they become null.
  JsonWriter& value(double number);
  JsonWriter& value(std::int64_t number);
  JsonWriter& value(std::size_t number) { return value(static_cast<std::int64_t>(number)); }
  JsonWriter& value(int number) { return value(static_cast<std::int64_t>(number)); }
  JsonWriter& value(std::string_view text);
  JsonWriter& value(const char* text) { return value(std::string_view(text)); }
  JsonWriter& value(std::span<const double> numbers);
  /// [x, y, z, qx, qy, qz, qw]
  JsonWriter& value(const Pose3& pose);

  /// Absent is null.
  template <typename T>
  JsonWriter& value(const std::optional<T>& maybe) {
    return maybe ? value(*maybe) : null();
  }

  /// key() and value() in one.
  template <typename T>
  JsonWriter& field(std::string_view name, const T& what) {
    return key(name).value(what);
  }

  /// What was written, with a line end behind it. Precondition: everything is closed.
  [[nodiscard]] std::string take();

 private:
  struct Level {
    char end = '}';
    Layout layout{};
    bool empty = true;
  };

  // Comma, line and indent before a value or key.
  void separate();
  JsonWriter& open(char begin, char end, Layout layout);
  JsonWriter& raw(std::string_view text);

  std::string text_;
  std::vector<Level> levels_;
  bool after_key_ = false;
};

}  // namespace kilter
