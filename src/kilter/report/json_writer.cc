// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/report/json_writer.h"

#include <array>
#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "kilter/base/contract.h"
#include "kilter/base/expected.h"

namespace kilter {
namespace {

bool needs_escape(char c) { return static_cast<unsigned char>(c) < 0x20 || c == '"' || c == '\\'; }

void append_escaped(std::string& out, char c) {
  switch (c) {
    case '"':
      out += "\\\"";
      return;
    case '\\':
      out += "\\\\";
      return;
    case '\n':
      out += "\\n";
      return;
    case '\t':
      out += "\\t";
      return;
    default:
      fmt::format_to(std::back_inserter(out), "\\u{:04x}", static_cast<unsigned>(c));
  }
}

}  // namespace

std::string number_text(double value) {
  KILTER_EXPECTS(std::isfinite(value));
  // "-0" would be read as an integer, which has no sign to keep.
  if (value == 0.0 && std::signbit(value)) return "-0.0";
  return fmt::format("{}", value);
}

std::string json_string(std::string_view text) {
  std::string out = "\"";
  while (!text.empty()) {
    std::size_t plain = 0;
    while (plain < text.size() && !needs_escape(text[plain])) ++plain;
    out += printable(text.substr(0, plain), std::string_view::npos);
    if (plain < text.size()) append_escaped(out, text[plain++]);
    text.remove_prefix(plain);
  }
  out += '"';
  return out;
}

void JsonWriter::separate() {
  if (std::exchange(after_key_, false) || levels_.empty()) return;
  Level& level = levels_.back();
  const bool first = std::exchange(level.empty, false);
  if (!first) text_ += ',';
  if (level.layout == Layout::kLines) {
    text_ += '\n';
    text_.append(levels_.size(), ' ');
  } else if (!first) {
    text_ += ' ';
  }
}

JsonWriter& JsonWriter::raw(std::string_view text) {
  separate();
  text_ += text;
  return *this;
}

JsonWriter& JsonWriter::open(char begin, char end, Layout layout) {
  separate();
  text_ += begin;
  // What is inside something compact is compact too.
  const bool compact = !levels_.empty() && levels_.back().layout == Layout::kCompact;
  levels_.push_back({end, compact ? Layout::kCompact : layout});
  return *this;
}

JsonWriter& JsonWriter::open_object(Layout layout) { return open('{', '}', layout); }

JsonWriter& JsonWriter::open_list(Layout layout) { return open('[', ']', layout); }

JsonWriter& JsonWriter::close() {
  KILTER_EXPECTS(!levels_.empty() && !after_key_);
  const Level level = levels_.back();
  levels_.pop_back();
  if (level.layout == Layout::kLines && !level.empty) {
    text_ += '\n';
    text_.append(levels_.size(), ' ');
  }
  text_ += level.end;
  return *this;
}

JsonWriter& JsonWriter::key(std::string_view name) {
  KILTER_EXPECTS(!levels_.empty() && levels_.back().end == '}' && !after_key_);
  separate();
  text_ += json_string(name);
  text_ += ": ";
  after_key_ = true;
  return *this;
}

JsonWriter& JsonWriter::null() { return raw("null"); }

JsonWriter& JsonWriter::value(bool flag) { return raw(flag ? "true" : "false"); }

JsonWriter& JsonWriter::value(double number) { return std::isfinite(number) ? raw(number_text(number)) : null(); }

JsonWriter& JsonWriter::value(std::int64_t number) { return raw(fmt::format_int(number).c_str()); }

JsonWriter& JsonWriter::value(std::string_view text) { return raw(json_string(text)); }

JsonWriter& JsonWriter::value(std::span<const double> numbers) {
  open_list(Layout::kCompact);
  for (const double number : numbers) value(number);
  return close();
}

JsonWriter& JsonWriter::value(const Pose3& pose) {
  const Eigen::Vector3d& t = pose.translation_m();
  const Eigen::Quaterniond& q = pose.rotation();
  return value(std::span<const double>(std::array{t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}));
}

std::string JsonWriter::take() {
  KILTER_EXPECTS(levels_.empty());
  text_ += '\n';
  return std::exchange(text_, {});
}

}  // namespace kilter
