// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <bit>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "kilter/io/archive.h"
#include "kilter/io/archive_format.h"
#include "kilter/io/byte_cursor.h"
#include "kilter/io/file.h"
#include "kilter/io/result_file.h"
#include "kilter/io/result_outline.h"

namespace kilter {
namespace {

namespace format = archive_format;

constexpr const char* kHint = "kilter check writes result.kilter; run it again with the same sources";
constexpr const char* kTakes =
    "kilter report takes the output folder of kilter check (`kilter check SOURCE -o OUT` makes one), or its "
    "result.kilter";

// Takes numbers from one section. After the first failure everything else fails too, so callers may ask once.
class Section {
 public:
  Section(std::string_view payload, std::string where) : cursor_(payload), where_(std::move(where)) {}

  template <typename Word>
  Word word() {
    const auto bytes = take(sizeof(Word));
    Word value = 0;
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      value = static_cast<Word>(value | static_cast<Word>(static_cast<unsigned char>(bytes[i])) << (8 * i));
    }
    return value;
  }
  std::uint32_t u32() { return word<std::uint32_t>(); }

  double real() {
    const double value = std::bit_cast<double>(word<std::uint64_t>());
    if (!std::isfinite(value)) refuse("a number that is not finite");
    return std::isfinite(value) ? value : 0.0;
  }

  Eigen::Vector3d vector() {
    Eigen::Vector3d value;
    for (int axis = 0; axis < 3; ++axis) value[axis] = real();
    return value;
  }

  // A count of things that take at least `bytes_each`: more than the rest can hold is refused, and 0 returned.
  std::size_t count(std::size_t bytes_each) {
    const std::size_t things = u32();
    if (things <= cursor_.remaining() / bytes_each) return things;
    refuse(fmt::format("{} entries of at least {} bytes where {} bytes are left", things, bytes_each,
                       cursor_.remaining()));
    return 0;
  }

  std::string_view take(std::size_t size) {
    const auto bytes = error_ ? std::nullopt : cursor_.take(size);
    if (bytes) return *bytes;
    refuse(fmt::format("{} bytes where {} are needed", cursor_.remaining(), size));
    return {};
  }

  std::vector<std::uint8_t> bytes(std::size_t size) {
    const std::string_view taken = take(size);
    return {taken.begin(), taken.end()};
  }

  void refuse(const std::string& found) {
    if (error_) return;
    error_ = Error{ErrorCode::kParse, "this part of the archive is damaged: found " + found,
                   fmt::format("{}: byte {}", where_, cursor_.position()), kHint};
  }

  [[nodiscard]] bool failed() const { return error_.has_value(); }
  [[nodiscard]] const Error& error() const { return *error_; }
  // Everything must have been used.
  void close() {
    if (cursor_.remaining() > 0) refuse(fmt::format("{} bytes more than its counts say", cursor_.remaining()));
  }

 private:
  ByteCursor cursor_;
  std::string where_;
  std::optional<Error> error_;
};

void read_paths(Section& in, Picture& picture) {
  picture.max_distance_m = in.real();
  if (!(picture.max_distance_m > 0.0)) in.refuse("a search distance that is not above 0");
  const std::size_t robots = in.count(sizeof(std::uint32_t));
  for (std::size_t robot = 0; robot < robots && !in.failed(); ++robot) {
    const std::size_t points = in.count(3 * sizeof(double));
    std::vector<Eigen::Vector3d>& path = picture.paths.emplace_back();
    path.reserve(points);
    for (std::size_t i = 0; i < points; ++i) path.push_back(in.vector());
  }
}

CloudPicture read_cloud(Section& in) {
  CloudPicture cloud;
  cloud.voxels = in.word<std::uint64_t>();
  cloud.origin_m = in.vector();
  cloud.step_m = in.real();
  if (cloud.step_m < 0.0) in.refuse("a lattice whose step is below 0");
  const std::size_t points = in.count(format::kBytesPerPoint);
  if (points > cloud.voxels) in.refuse(fmt::format("{} points of {} voxels", points, cloud.voxels));
  cloud.points.resize(points);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string_view low = in.take(points);
    const std::string_view high = in.take(points);
    for (std::size_t i = 0; i < points && !in.failed(); ++i) {
      cloud.points[i][axis] =
          static_cast<std::uint16_t>(static_cast<unsigned char>(low[i]) | static_cast<unsigned char>(high[i]) << 8);
    }
  }
  cloud.misalignment = in.bytes(points);
  return cloud;
}

void read_clouds(Section& in, Picture& picture) {
  const std::size_t clouds = in.count(8 + 4 * sizeof(double) + 4);
  for (std::size_t i = 0; i < clouds && !in.failed(); ++i) picture.clouds.push_back(read_cloud(in));
}

SubmapId read_submap(Section& in, const Picture& picture) {
  const std::uint32_t number = in.u32();
  if (number >= picture.clouds.size()) {
    in.refuse(fmt::format("submap number {} of {}", number, picture.clouds.size()));
    return {};
  }
  return {static_cast<int>(number)};
}

// As many samples as the stride leaves of the points, or none.
std::size_t read_sample_count(Section& in, const Picture& picture, SubmapId submap, std::uint32_t stride) {
  const std::size_t samples = in.count(1);
  if (in.failed() || samples == 0) return 0;
  const std::size_t points = picture.clouds[static_cast<std::size_t>(submap.value)].points.size();
  const std::size_t expected = (points + stride - 1) / stride;
  if (samples != expected)
    in.refuse(fmt::format("{} samples where every {}. of {} points makes {}", samples, stride, points, expected));
  return samples;
}

DistanceHistogram read_histogram(Section& in) {
  DistanceHistogram histogram;
  histogram.width_m = in.real();
  if (!(histogram.width_m > 0.0)) in.refuse("a histogram whose bins are not wide");
  const std::size_t bins = in.count(sizeof(std::uint64_t));
  histogram.counts.reserve(bins);
  for (std::size_t i = 0; i < bins; ++i) {
    const std::uint64_t count = in.word<std::uint64_t>();
    if (count >> 53 != 0) in.refuse("a count beyond what a histogram holds");
    histogram.counts.push_back(static_cast<std::int64_t>(count));
  }
  return histogram;
}

PairPicture read_pair(Section& in, const Picture& picture) {
  PairPicture pair;
  pair.id.source = read_submap(in, picture);
  pair.id.target = read_submap(in, picture);
  if (pair.id.target >= pair.id.source) in.refuse("a pair whose target does not come before its source");
  pair.centre_world_m = in.vector();
  pair.stride = in.u32();
  if (pair.stride == 0) in.refuse("a stride of 0");
  if (in.failed()) return pair;
  const std::size_t of_source = read_sample_count(in, picture, pair.id.source, pair.stride);
  const std::size_t of_target = read_sample_count(in, picture, pair.id.target, pair.stride);
  const unsigned flags = in.word<std::uint8_t>();
  if (flags > (format::kHasAfter | format::kHasHistogram | format::kHasParent)) in.refuse("an unknown flag");
  if ((flags & format::kHasAfter) && of_source + of_target == 0) in.refuse("registered samples where there are none");
  if (flags & format::kHasHistogram) pair.registered_histogram = read_histogram(in);
  if (flags & format::kHasParent) {
    pair.registered_parent.emplace();
    pair.registered_parent->mu_m = in.real();
    pair.registered_parent->sigma_m = in.real();
  }
  const auto read = [&](std::size_t samples, SamplePicture& sample) {
    sample.before = in.bytes(samples);
    if (flags & format::kHasAfter) sample.after = in.bytes(samples);
  };
  read(of_source, pair.source);
  read(of_target, pair.target);
  return pair;
}

void read_pairs(Section& in, Picture& picture) {
  const std::size_t pairs = in.count(4 * 5 + 3 * sizeof(double) + 1);
  for (std::size_t i = 0; i < pairs && !in.failed(); ++i) picture.pairs.push_back(read_pair(in, picture));
}

template <typename Read>
Expected<void> read_section(std::string_view payload, std::string_view tag, const std::string& where, Read read) {
  Section in(payload, fmt::format("{}: section {}", where, tag));
  read(in);
  in.close();
  if (in.failed()) return pass_up(in.error());
  return {};
}

tl::unexpected<Error> cut_short(const std::string& where, std::size_t position) {
  return fail(ErrorCode::kTruncated, "the archive ends before its parts do",
              fmt::format("{}: byte {}", where, position), kHint);
}

// The sections' payloads in the order of kTags.
Expected<std::vector<std::string_view>> split(std::string_view bytes, const std::string& where) {
  ByteCursor cursor(bytes);
  const auto magic = cursor.take(format::kMagic.size());
  if (!magic || *magic != format::kMagic) {
    return fail(ErrorCode::kParse, "expected an archive of kilter: the first bytes are others", where, kTakes);
  }
  const auto head = cursor.take(8);
  if (!head) return cut_short(where, bytes.size());
  Section header(*head, where);
  const std::uint32_t version = header.u32();
  if (version != format::kVersion) {
    return fail(ErrorCode::kUnsupported, fmt::format("archive version {}; {} is read", version, format::kVersion),
                where, kHint);
  }
  if (header.u32() != format::kTags.size()) {
    return fail(ErrorCode::kParse, fmt::format("expected {} sections", format::kTags.size()), where, kHint);
  }
  std::vector<std::string_view> payloads;
  for (const std::string_view tag : format::kTags) {
    const std::string place = fmt::format("{}: byte {}", where, cursor.position());
    const auto frame = cursor.take(16);
    if (!frame) return cut_short(where, bytes.size());
    if (frame->substr(0, 4) != tag)
      return fail(ErrorCode::kParse, fmt::format("expected section {}", tag), place, kHint);
    Section numbers(frame->substr(4), place);
    const std::uint32_t expected = numbers.u32();
    const auto length = numbers.word<std::uint64_t>();
    if (length > cursor.remaining()) return cut_short(where, bytes.size());
    payloads.push_back(*cursor.take(static_cast<std::size_t>(length)));
    if (format::checksum(payloads.back()) != expected) {
      return fail(ErrorCode::kParse, fmt::format("section {} does not have the checksum written beside it", tag), place,
                  kHint);
    }
  }
  if (cursor.remaining() > 0) {
    return fail(ErrorCode::kParse, fmt::format("{} bytes after the last section", cursor.remaining()), where, kHint);
  }
  return payloads;
}

Expected<void> check_agreement(const Archive& archive, const std::string& where) {
  const auto outline = read_result_outline(archive.json, where + ": section JSON");
  if (!outline) return pass_up(outline.error());
  const Picture& picture = archive.picture;
  if (outline->robots == picture.paths.size() && outline->submaps == picture.clouds.size() &&
      outline->pairs == picture.pairs.size()) {
    return {};
  }
  return fail(ErrorCode::kParse,
              fmt::format("the result tells of {} robots, {} submaps and {} pairs, the picture of {}, {} and {}",
                          outline->robots, outline->submaps, outline->pairs, picture.paths.size(),
                          picture.clouds.size(), picture.pairs.size()),
              where, kHint);
}

}  // namespace

Expected<Archive> parse_archive(std::string_view bytes, const std::string& where) {
  const auto payloads = split(bytes, where);
  if (!payloads) return pass_up(payloads.error());
  Archive archive;
  archive.json = (*payloads)[0];
  using Reader = void (*)(Section&, Picture&);
  const std::array<Reader, 3> readers = {read_paths, read_clouds, read_pairs};
  for (std::size_t i = 0; i < readers.size(); ++i) {
    const auto read = [&](Section& in) { readers[i](in, archive.picture); };
    if (auto done = read_section((*payloads)[i + 1], format::kTags[i + 1], where, read); !done) {
      return pass_up(done.error());
    }
  }
  if (auto agree = check_agreement(archive, where); !agree) return pass_up(agree.error());
  return archive;
}

Expected<std::string> read_archive_bytes(const std::filesystem::path& result) {
  const auto file = find_result_file(result, "result.kilter", kTakes);
  if (!file) return pass_up(file.error());
  auto bytes = read_file(*file);
  if (!bytes) return pass_up(bytes.error());
  const auto archive = parse_archive(bytes->view(), shown(*file));
  if (!archive) return pass_up(archive.error());
  return std::string(bytes->view());
}

}  // namespace kilter
