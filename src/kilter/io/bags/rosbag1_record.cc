// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/bags/rosbag1_record.h"

#include <fmt/format.h>

#include "kilter/io/byte_cursor.h"
#include "kilter/io/scalar.h"

namespace kilter {
namespace {

// Headers hold a topic, a type, a definition's text; the text has its own limit of a record's length.
constexpr std::uint32_t kMaxHeaderBytes = 1U << 24;

std::uint32_t load_u32(const char* bytes) { return load<std::uint32_t>(bytes, std::endian::little); }

template <typename T>
bool set_number(std::optional<T>& field, std::string_view value) {
  if (value.size() != sizeof(T)) return false;
  field = load<T>(value.data(), std::endian::little);
  return true;
}

bool set_text(std::optional<std::string>& field, std::string_view value) {
  field = std::string(value);
  return true;
}

bool set_time(std::optional<std::int64_t>& field, std::string_view value) {
  if (value.size() != 8) return false;
  // 2^32 seconds and as many nanoseconds do not overflow.
  field = std::int64_t{1'000'000'000} * load_u32(value.data()) + load_u32(value.data() + 4);
  return true;
}

// \return whether the value has the length of its name's number.
bool set_field(Rosbag1Fields& fields, std::string_view name, std::string_view value) {
  if (name == "op") return set_number(fields.op, value);
  if (name == "conn") return set_number(fields.connection, value);
  if (name == "count") return set_number(fields.count, value);
  if (name == "size") return set_number(fields.size, value);
  if (name == "index_pos") return set_number(fields.index_position, value);
  if (name == "conn_count") return set_number(fields.connection_count, value);
  if (name == "time") return set_time(fields.time_ns, value);
  if (name == "topic") return set_text(fields.topic, value);
  if (name == "type") return set_text(fields.type, value);
  if (name == "compression") return set_text(fields.compression, value);
  if (name == "encryptor") return set_text(fields.encryptor, value);
  return true;
}

}  // namespace

Expected<Rosbag1Fields> parse_rosbag1_fields(std::string_view bytes, const std::string& where) {
  Rosbag1Fields fields;
  ByteCursor cursor(bytes);
  while (cursor.remaining() > 0) {
    const auto length = cursor.take(4);
    const auto field = length ? cursor.take(load_u32(length->data())) : std::nullopt;
    if (!field) return fail(ErrorCode::kParse, "a field of the record's header is longer than the header", where);
    const std::size_t equals = field->find('=');
    if (equals == std::string_view::npos) {
      return fail(ErrorCode::kParse, "expected name=value in the record's header, found no '='", where);
    }
    if (!set_field(fields, field->substr(0, equals), field->substr(equals + 1))) {
      return fail(ErrorCode::kParse,
                  fmt::format("the field \"{}\" has {} bytes, which is not the length of its number",
                              printable(field->substr(0, equals), 40), field->size() - equals - 1),
                  where);
    }
  }
  return fields;
}

Expected<Rosbag1Record> read_rosbag1_record(ByteWindow& window, std::uint64_t position) {
  Expected<std::string_view> bytes = window.look(position, 4);
  if (!bytes) return pass_up(bytes.error());
  const std::uint32_t header_bytes = load_u32(bytes->data());
  if (header_bytes > kMaxHeaderBytes) {
    return fail(ErrorCode::kParse,
                fmt::format("a record's header claims {} bytes; expected some hundred", header_bytes),
                window.where(position), "the bag is damaged here; `rosbag fix` or `rosbag reindex` may save the rest");
  }
  bytes = window.look(position + 4, std::uint64_t{header_bytes} + 4);
  if (!bytes) return pass_up(bytes.error());
  Rosbag1Record record;
  record.data_size = load_u32(bytes->data() + header_bytes);
  record.data_begin = position + header_bytes + 8;
  auto fields = parse_rosbag1_fields(bytes->substr(0, header_bytes), window.where(position));
  if (!fields) return pass_up(fields.error());
  record.fields = *std::move(fields);
  if (!record.fields.op) {
    return fail(ErrorCode::kParse, "a record's header has no field \"op\"", window.where(position));
  }
  return record;
}

}  // namespace kilter
