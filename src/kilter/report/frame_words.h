// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "kilter/pipeline/result.h"

namespace kilter {

/// What mends a robot that lies off another as a whole, for people: "b as a whole, its middle shifted by x-9 y+38 z+4
/// cm in world axes and all turned by +0.3 deg, would meet a in 41 of 41 pairs". A turn counts as positive to the left,
/// seen from above; one that is not about the vertical has no sign.
[[nodiscard]] std::string frame_words(const Result& result, const FrameOffset& frame);

}  // namespace kilter
