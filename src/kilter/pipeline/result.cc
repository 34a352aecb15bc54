// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/pipeline/result.h"

namespace kilter {
namespace {

ConsistencyMatrix matrix_of(const Result& result, std::optional<PairScore> PairResult::*score) {
  ConsistencyMatrix matrix(static_cast<int>(result.submaps.size()));
  for (const PairResult& pair : result.pairs) {
    const std::optional<PairScore>& value = pair.*score;
    if (value && value->gamma_per_m3) matrix.set(pair.id, *value->gamma_per_m3);
  }
  return matrix;
}

}  // namespace

std::optional<Eigen::Vector3d> offset_rotation_rad(const PairResult& pair) {
  if (!pair.verdict.offset_rad || !pair.T_target_source_registered) return std::nullopt;
  return (*pair.T_target_source_registered * pair.T_target_source.inverse()).log().tail<3>();
}

ConsistencyMatrix gamma_matrix(const Result& result) { return matrix_of(result, &PairResult::score); }

ConsistencyMatrix theta_matrix(const Result& result) { return matrix_of(result, &PairResult::registered_score); }

InconsistencyMatrix verified_matrix(const Result& result) {
  return verified(theta_matrix(result), gamma_matrix(result));
}

}  // namespace kilter
