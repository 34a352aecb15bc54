// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
// Any bytes handed to `kilter report` are refused with a printable reason, or are an archive that is written back as
// the same bytes. Checksums are mended first: a fuzzer would never get past them.
#include "kilter/io/archive.h"
#include "kilter/io/archive_format.h"
#include "reader_laws.h"

namespace {

void mend_checksums(std::string& bytes) {
  std::size_t at = 16;
  while (at + 16 <= bytes.size()) {
    std::uint64_t length = 0;
    for (std::size_t i = 0; i < 8; ++i) {
      length |= static_cast<std::uint64_t>(static_cast<unsigned char>(bytes[at + 8 + i])) << (8 * i);
    }
    if (length > bytes.size() - at - 16) return;
    const std::uint32_t sum =
        kilter::archive_format::checksum(std::string_view(bytes).substr(at + 16, static_cast<std::size_t>(length)));
    for (std::size_t i = 0; i < 4; ++i) bytes[at + 4 + i] = static_cast<char>((sum >> (8 * i)) & 0xFF);
    at += 16 + static_cast<std::size_t>(length);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string bytes(kilter_fuzz::text_of(data, size));
  mend_checksums(bytes);
  const auto archive = kilter::parse_archive(bytes, "fuzz");
  if (!archive) {
    kilter_fuzz::demand_printable(archive.error());
    return 0;
  }
  kilter_fuzz::demand(kilter::archive_bytes(*archive) == bytes);
  return 0;
}
