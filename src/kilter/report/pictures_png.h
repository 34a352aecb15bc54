// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <vector>

#include "kilter/pipeline/result.h"

namespace kilter {

/// A matrix as the report draws it: a row for each source, a column for each target, logarithmic colours from dark
/// (small) to bright (large) with the ends written at the colour bar; grey = not above zero, bare = not tested; the
/// bars beside it and the lines across it part the robots. Of more than 1000 submaps neighbours share a cell, which
/// shows the last one's value.
/// \param cells   as matrix_csv takes them.
/// \param scaled  whose values span the colours: those of Gamma and Theta together for either of the two.
[[nodiscard]] std::string matrix_png(const Result& result, const std::map<PairId, double>& cells,
                                     const std::vector<double>& scaled);

/// The map from above: points about as high as the sensor coloured by robot, the robots' ways, and a line for each
/// pair: thick where inconsistent, dashed where unverified. Precondition: the result has its picture.
[[nodiscard]] std::string map_png(const Result& result);

}  // namespace kilter
