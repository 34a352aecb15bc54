// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
// Any text handed to `--set key=value` is refused with a printable reason, or taken and read back unchanged.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <vector>

#include "kilter/base/option_table.h"

namespace {

// Stops the fuzzer with a stack trace, in every build type.
void demand(bool law_holds) {
  if (!law_holds) std::abort();
}

enum class Word { kFirst, kSecond };

struct Values {
  double length_m = 1.0;
  double angle_rad = 0.5;
  double any_number = 0.0;
  int count = 3;
  bool flag = false;
  Word word = Word::kFirst;
};

std::vector<kilter::OptionField> fields(Values& values) {
  using kilter::Unit;
  return {kilter::real_option("length", values.length_m, Unit::kMetre, 0.0, 100.0, "a length"),
          kilter::real_option("angle", values.angle_rad, Unit::kRadian, -4.0, 4.0, "an angle"),
          kilter::real_option("any", values.any_number, Unit::kNone, -HUGE_VAL, HUGE_VAL, "any number"),
          kilter::count_option("count", values.count, 1, 1000, "a count"),
          kilter::flag_option("flag", values.flag, "a flag"),
          kilter::choice_option("word", values.word, {"first", "second"}, "a word")};
}

bool is_printable(std::string_view text) {
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if ((byte < 0x20 && c != '\n') || byte == 0x7F) return false;
  }
  return true;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  Values values;
  for (const kilter::OptionField& field : fields(values)) {
    const kilter::Expected<void> assigned = field.assign(text);
    if (!assigned) {
      demand(is_printable(kilter::to_string(assigned.error())));
      continue;
    }
    const std::string once = field.text();
    demand(field.assign(once).has_value());
    demand(field.text() == once);
  }
  return 0;
}
