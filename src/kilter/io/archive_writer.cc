// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include <bit>
#include <cstring>

#include <zlib.h>

#include "kilter/io/archive.h"
#include "kilter/io/archive_format.h"

namespace kilter {
namespace {

class Bytes {
 public:
  template <typename Word>
  void word(Word value) {
    for (std::size_t i = 0; i < sizeof(Word); ++i) text_ += static_cast<char>((value >> (8 * i)) & 0xFF);
  }
  void u32(std::size_t value) { word(static_cast<std::uint32_t>(value)); }
  void real(double value) { word(std::bit_cast<std::uint64_t>(value)); }
  void vector(const Eigen::Vector3d& value) {
    for (int axis = 0; axis < 3; ++axis) real(value[axis]);
  }
  void bytes(const std::vector<std::uint8_t>& values) {
    text_.append(reinterpret_cast<const char*>(values.data()), values.size());
  }
  void byte(unsigned value) { text_ += static_cast<char>(value); }
  void text(std::string_view value) { text_ += value; }
  void reserve(std::size_t more) { text_.reserve(text_.size() + more); }
  [[nodiscard]] const std::string& view() const { return text_; }

 private:
  std::string text_;
};

void write_paths(Bytes& out, const Picture& picture) {
  out.real(picture.max_distance_m);
  out.u32(picture.paths.size());
  for (const auto& path : picture.paths) {
    out.u32(path.size());
    for (const Eigen::Vector3d& point_m : path) out.vector(point_m);
  }
}

// A plane per byte of each coordinate: neighbours share their high bytes, and packers like that.
void write_cloud(Bytes& out, const CloudPicture& cloud) {
  out.word(cloud.voxels);
  out.vector(cloud.origin_m);
  out.real(cloud.step_m);
  out.u32(cloud.points.size());
  out.reserve(archive_format::kBytesPerPoint * cloud.points.size());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const auto& point : cloud.points) out.byte(point[axis] & 0xFFU);
    for (const auto& point : cloud.points) out.byte(point[axis] >> 8U);
  }
  out.bytes(cloud.misalignment);
}

void write_pair(Bytes& out, const PairPicture& pair) {
  out.u32(static_cast<std::size_t>(pair.id.source.value));
  out.u32(static_cast<std::size_t>(pair.id.target.value));
  out.vector(pair.centre_world_m);
  out.u32(pair.stride);
  out.u32(pair.source.before.size());
  out.u32(pair.target.before.size());
  unsigned flags = 0;
  if (!pair.source.after.empty() || !pair.target.after.empty()) flags |= archive_format::kHasAfter;
  if (pair.registered_histogram) flags |= archive_format::kHasHistogram;
  if (pair.registered_parent) flags |= archive_format::kHasParent;
  out.byte(flags);
  if (pair.registered_histogram) {
    out.real(pair.registered_histogram->width_m);
    out.u32(pair.registered_histogram->counts.size());
    for (const std::int64_t count : pair.registered_histogram->counts) out.word(static_cast<std::uint64_t>(count));
  }
  if (pair.registered_parent) {
    out.real(pair.registered_parent->mu_m);
    out.real(pair.registered_parent->sigma_m);
  }
  out.bytes(pair.source.before);
  out.bytes(pair.source.after);
  out.bytes(pair.target.before);
  out.bytes(pair.target.after);
}

void add_section(Bytes& out, std::string_view tag, std::string_view payload) {
  out.text(tag);
  out.u32(archive_format::checksum(payload));
  out.word(static_cast<std::uint64_t>(payload.size()));
  out.text(payload);
}

}  // namespace

std::uint32_t archive_format::checksum(std::string_view bytes) {
  return static_cast<std::uint32_t>(::crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

std::string archive_bytes(const Archive& archive) {
  Bytes paths, clouds, pairs, out;
  write_paths(paths, archive.picture);
  clouds.u32(archive.picture.clouds.size());
  for (const CloudPicture& cloud : archive.picture.clouds) write_cloud(clouds, cloud);
  pairs.u32(archive.picture.pairs.size());
  for (const PairPicture& pair : archive.picture.pairs) write_pair(pairs, pair);
  out.text(archive_format::kMagic);
  out.u32(archive_format::kVersion);
  out.u32(archive_format::kTags.size());
  add_section(out, archive_format::kTags[0], archive.json);
  add_section(out, archive_format::kTags[1], paths.view());
  add_section(out, archive_format::kTags[2], clouds.view());
  add_section(out, archive_format::kTags[3], pairs.view());
  return out.view();
}

}  // namespace kilter
