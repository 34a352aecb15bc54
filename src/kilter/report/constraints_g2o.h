// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kilter/geometry/pose3.h"
#include "kilter/pipeline/result.h"

namespace kilter {

/// Who reads the file. The same six numbers of error mean different things to each.
enum class G2oDialect {
  kG2o,    ///< g2o itself: (x y z qx qy qz) of measured^-1 * estimated, the vector part of a quaternion: half the angle
  kGtsam,  ///< GTSAM's readG2o: the rotation vector, whole angle, in the source's frame; it reorders the blocks itself
  kCeres,  ///< Ceres' pose_graph_3d: estimated less measured position, twice the vector of measured * estimated^-1,
           ///< both along the target's axes; multiplied by the lower Cholesky factor L of what it reads, which weighs
           ///< by L^T L and not by L L^T: in the file stands what makes that the information
};

/// The information matrix that goes into the file for a covariance of T_target_source * Exp(xi), xi = (x y z rx ry rz):
/// (J covariance J^T)^-1 with J = d(reader's error) / d xi. For g2o, which takes the vector part of a quaternion, J is
/// diag(1, 1, 1, 1/2, 1/2, 1/2): rotation blocks count four times, mixed ones twice.
/// \return  absent when the covariance is not finite, not positive definite, or too close to singular to invert.
[[nodiscard]] std::optional<Matrix6> information_for(G2oDialect dialect, const Matrix6& covariance,
                                                     const Pose3& T_target_source);

/// VERTEX_SE3:QUAT for each submap: its id, T_world_submap, and its name in a comment before it.
[[nodiscard]] std::string submaps_g2o(const std::vector<SubmapSummary>& submaps);

/// The pose graph that the map's submaps and trusted registrations make, as g2o text.
///
/// VERTEX_SE3:QUAT for each submap (ids from 0 in global numbering, T_world_submap, name in a comment) and
/// EDGE_SE3:QUAT target source (T_target_source as registered, 21 upper-triangular information numbers) for each pair
/// that is trusted. An edge whose covariance cannot be inverted is left out, with a comment that says so.
[[nodiscard]] std::string constraints_g2o(const Result& result, G2oDialect dialect = G2oDialect::kG2o);

}  // namespace kilter
