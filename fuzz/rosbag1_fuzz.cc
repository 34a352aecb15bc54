// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
// Any bytes named .bag are refused with a printable reason, or give a robot whose clouds can be asked for.
#include "bag_laws.h"
#include "kilter/io/bags/rosbag1.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = kilter_fuzz::text_of(data, size);
  kilter_fuzz::demand_lawful_bag(kilter::open_rosbag1(kilter::RandomAccessFile::over(bytes, "fuzz")), size);
  return 0;
}
