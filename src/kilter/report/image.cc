// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/report/image.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <zlib.h>

#include "kilter/report/deflate.h"

namespace kilter {
namespace {

void append_big_endian(std::string& bytes, std::uint32_t word) {
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(word >> shift & 0xFF);
}

void append_chunk(std::string& bytes, std::string_view type, std::string_view data) {
  append_big_endian(bytes, static_cast<std::uint32_t>(data.size()));
  const std::string body = std::string(type) + std::string(data);
  bytes += body;
  append_big_endian(bytes,
                    static_cast<std::uint32_t>(::crc32_z(0, reinterpret_cast<const Bytef*>(body.data()), body.size())));
}

// Three bits a row, the leftmost highest, top row first.
std::array<std::uint8_t, 5> glyph(char c) {
  static constexpr std::string_view kSigns = "0123456789.-+e";
  static constexpr std::array<std::array<std::uint8_t, 5>, 14> kDots = {{{7, 5, 5, 5, 7},
                                                                         {2, 6, 2, 2, 7},
                                                                         {7, 1, 7, 4, 7},
                                                                         {7, 1, 3, 1, 7},
                                                                         {5, 5, 7, 1, 1},
                                                                         {7, 4, 7, 1, 7},
                                                                         {7, 4, 7, 5, 7},
                                                                         {7, 1, 1, 2, 2},
                                                                         {7, 5, 7, 5, 7},
                                                                         {7, 5, 7, 1, 7},
                                                                         {0, 0, 0, 0, 2},
                                                                         {0, 0, 7, 0, 0},
                                                                         {0, 2, 7, 2, 0},
                                                                         {0, 7, 7, 4, 7}}};
  const std::size_t place = kSigns.find(c);
  return place == std::string_view::npos ? std::array<std::uint8_t, 5>{} : kDots[place];
}

}  // namespace

void Image::fill(int x, int y, int width, int height, Rgb colour) {
  for (int row = std::max(0, y); row < std::min(height_, y + height); ++row) {
    for (int column = std::max(0, x); column < std::min(width_, x + width); ++column) {
      pixels_[index(column, row)] = colour;
    }
  }
}

void Image::frame(int x, int y, int width, int height, Rgb colour) {
  fill(x, y, width, 1, colour);
  fill(x, y + height - 1, width, 1, colour);
  fill(x, y, 1, height, colour);
  fill(x + width - 1, y, 1, height, colour);
}

void Image::line(double x0, double y0, double x1, double y1, int thick, Rgb colour, int dash) {
  const double length = std::max(std::abs(x1 - x0), std::abs(y1 - y0));
  // A line that runs far outside would be walked for nothing.
  const int steps = static_cast<int>(std::min(length, 20000.0)) + 1;
  for (int i = 0; i <= steps; ++i) {
    if (dash > 0 && i / dash % 2 == 1) continue;
    const double share = static_cast<double>(i) / steps;
    const int x = static_cast<int>(std::lround(std::clamp(x0 + share * (x1 - x0), -1e6, 1e6)));
    const int y = static_cast<int>(std::lround(std::clamp(y0 + share * (y1 - y0), -1e6, 1e6)));
    fill(x - thick / 2, y - thick / 2, thick, thick, colour);
  }
}

void Image::digits(int x, int y, const std::string& text, int scale, Rgb colour) {
  for (const char c : text) {
    const auto rows = glyph(c);
    for (int row = 0; row < 5; ++row) {
      for (int column = 0; column < 3; ++column) {
        if (rows[static_cast<std::size_t>(row)] >> (2 - column) & 1) {
          fill(x + column * scale, y + row * scale, scale, scale, colour);
        }
      }
    }
    x += 4 * scale;
  }
}

std::string Image::png() const {
  std::string rows;
  rows.reserve(static_cast<std::size_t>(height_) * (static_cast<std::size_t>(width_) * 3 + 1));
  for (int y = 0; y < height_; ++y) {
    rows += '\0';  // no filter
    for (int x = 0; x < width_; ++x) {
      for (const std::uint8_t channel : at(x, y)) rows += static_cast<char>(channel);
    }
  }
  std::string header;
  append_big_endian(header, static_cast<std::uint32_t>(width_));
  append_big_endian(header, static_cast<std::uint32_t>(height_));
  header += std::string("\x08\x02\x00\x00\x00", 5);  // 8 bits, red green blue
  std::string bytes = "\x89PNG\r\n\x1a\n";
  append_chunk(bytes, "IHDR", header);
  append_chunk(bytes, "IDAT", deflated(rows));
  append_chunk(bytes, "IEND", {});
  return bytes;
}

}  // namespace kilter
