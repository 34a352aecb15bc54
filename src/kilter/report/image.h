// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "kilter/report/palette.h"

namespace kilter {

/// A small picture of 8-bit colours; whatever falls outside is not drawn.
class Image {
 public:
  Image(int width, int height, Rgb paper)
      : width_(width), height_(height), pixels_(std::size_t(width) * height, paper) {}

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] Rgb at(int x, int y) const { return pixels_[index(x, y)]; }

  void set(int x, int y, Rgb colour) {
    if (x >= 0 && y >= 0 && x < width_ && y < height_) pixels_[index(x, y)] = colour;
  }
  /// Columns [x, x + width), rows [y, y + height).
  void fill(int x, int y, int width, int height, Rgb colour);
  /// A one-pixel frame inside that rectangle.
  void frame(int x, int y, int width, int height, Rgb colour);
  /// A straight line, `thick` pixels wide; `dash` pixels on and off by turns, 0 = unbroken. Precondition: finite ends.
  void line(double x0, double y0, double x1, double y1, int thick, Rgb colour, int dash = 0);
  /// Digits and a few signs (0-9 . - + e) of 3 x 5 dots, each `scale` pixels large; others stay blank.
  void digits(int x, int y, const std::string& text, int scale, Rgb colour);

  /// As a PNG file. Equal pictures give equal bytes.
  [[nodiscard]] std::string png() const;

 private:
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }

  int width_;
  int height_;
  std::vector<Rgb> pixels_;
};

}  // namespace kilter
