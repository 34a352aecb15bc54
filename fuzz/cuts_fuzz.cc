// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
// Any text handed to --cuts is refused with a printable reason, or gives ranges without gaps.
#include "kilter/io/cuts.h"
#include "reader_laws.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto cuts = kilter::parse_cuts(kilter_fuzz::text_of(data, size), "fuzz");
  if (!cuts) {
    kilter_fuzz::demand_printable(cuts.error());
    return 0;
  }
  for (const auto& [robot, ranges] : *cuts) {
    std::size_t next = 0;
    for (const kilter::ScanRange& range : ranges) {
      kilter_fuzz::demand(range.first == next && range.last >= range.first);
      next = range.last + 1;
    }
  }
  return 0;
}
