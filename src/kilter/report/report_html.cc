// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/report/report_html.h"

#include <cstdint>

#include "kilter/report/deflate.h"
#include "kilter/report/palette.h"
#include "kilter/report/viewer_page.h"

namespace kilter {
namespace {

constexpr std::string_view kWithoutViewer =
    "<!DOCTYPE html>\n<html lang=\"en\">\n<head><meta charset=\"utf-8\">\n"
    "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'\">\n<title>kilter</title></head>\n"
    "<body><h1>No report here</h1>\n<p>This kilter was built without its viewer (node and npm were missing, or "
    "KILTER_VIEWER was OFF).</p>\n<p>The numbers are in result.json and pairs.csv, pictures in the PNG files. A kilter "
    "with the viewer makes this page from result.kilter: kilter report RESULT -o report.html</p></body>\n</html>\n";

std::string base64(std::string_view bytes) {
  static constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  const auto at = [&](std::size_t i) -> std::uint32_t {
    return i < bytes.size() ? static_cast<unsigned char>(bytes[i]) : 0U;
  };
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::uint32_t word = at(i) << 16 | at(i + 1) << 8 | at(i + 2);
    text += kDigits[word >> 18];
    text += kDigits[word >> 12 & 63];
    text += i + 1 < bytes.size() ? kDigits[word >> 6 & 63] : '=';
    text += i + 2 < bytes.size() ? kDigits[word & 63] : '=';
  }
  return text;
}

void put(std::string& page, std::string_view mark, std::string_view text) {
  const std::size_t at = page.find(mark);
  if (at != std::string::npos) page.replace(at, mark.size(), text);
}

}  // namespace

std::string report_html(std::string_view archive) {
  std::string page = viewer_page();
  if (page.empty()) return std::string(kWithoutViewer);
  put(page, "@PALETTE@", palette_json());
  put(page, "@ARCHIVE@", base64(deflated(archive)));
  return page;
}

}  // namespace kilter
