// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "kilter/base/expected.h"
#include "kilter/io/bags/ros_type.h"
#include "kilter/io/scalar.h"

namespace kilter {

/// Takes the fields of a ROS message off its bytes, one by one, in either encoding. Nothing is taken that is not there:
/// from the first field that is not, all are zero or empty, and `ok` is false.
class MessageCursor {
 public:
  /// \return  a cursor at the first field; or kUnsupported (an encapsulation other than plain CDR), kTruncated.
  [[nodiscard]] static Expected<MessageCursor> open(std::string_view bytes, MessageEncoding encoding,
                                                    const std::string& where);

  [[nodiscard]] bool ok() const { return ok_; }
  [[nodiscard]] MessageEncoding encoding() const { return encoding_; }
  [[nodiscard]] std::endian order() const { return order_; }
  /// Bytes not yet taken.
  [[nodiscard]] std::size_t remaining() const { return bytes_.size() - position_; }

  /// A number of 1, 2, 4 or 8 bytes, aligned to its size in CDR.
  template <typename T>
  T take() {
    align(sizeof(T));
    const std::string_view bytes = take_bytes(sizeof(T));
    return bytes.empty() ? T{} : load<T>(bytes.data(), order_);
  }

  /// A string without the zero that ends it in CDR; points into the message.
  std::string_view take_text();

  /// `count` bytes as they are; empty where there are fewer.
  std::string_view take_bytes(std::size_t count);

  /// The length in front of a list. Not ok where `min_bytes` for each element are not left.
  std::uint32_t take_count(std::size_t min_bytes);

 private:
  MessageCursor(std::string_view bytes, MessageEncoding encoding, std::endian order)
      : bytes_(bytes), encoding_(encoding), order_(order) {}

  void align(std::size_t size);

  std::string_view bytes_;  // behind the encapsulation, where alignment counts from
  MessageEncoding encoding_;
  std::endian order_;
  std::size_t position_ = 0;
  bool ok_ = true;
};

}  // namespace kilter
