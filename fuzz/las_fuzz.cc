// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
// Any bytes named .las are refused with a printable reason, or give points that can be used.
#include "kilter/io/las_reader.h"
#include "reader_laws.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  kilter_fuzz::demand_usable(kilter::read_las(kilter_fuzz::text_of(data, size), "fuzz"), size);
  return 0;
}
