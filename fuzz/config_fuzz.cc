// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
// Any text of a configuration is refused with a printable reason, or sets values within their ranges.
#include "apps/kilter/settings.h"
#include "reader_laws.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  kilter::app::Settings settings;
  const auto done = kilter::app::apply_config_text(kilter_fuzz::text_of(data, size), "fuzz", settings);
  if (!done) kilter_fuzz::demand_printable(done.error());
  for (const kilter::OptionField& field : kilter::fields(settings.check)) {
    kilter_fuzz::demand(field.assign(field.text()).has_value());
  }
  return 0;
}
