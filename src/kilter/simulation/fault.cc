// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/simulation/fault.h"

#include <array>
#include <utility>

namespace kilter {
namespace {

constexpr std::array<std::pair<FaultKind, std::string_view>, 6> kNames = {{
    {FaultKind::kSlip, "slip"},
    {FaultKind::kMissedClosure, "missed-closure"},
    {FaultKind::kFrameOffset, "frame-offset"},
    {FaultKind::kFrameDrift, "frame-drift"},
    {FaultKind::kWrongClosure, "wrong-closure"},
    {FaultKind::kMistakenPlace, "mistaken-place"},
}};

}  // namespace

std::string_view to_string(FaultKind kind) {
  for (const auto& [known, name] : kNames) {
    if (known == kind) return name;
  }
  return "";
}

std::optional<FaultKind> fault_kind_from(std::string_view name) {
  for (const auto& [kind, known] : kNames) {
    if (known == name) return kind;
  }
  return std::nullopt;
}

}  // namespace kilter
