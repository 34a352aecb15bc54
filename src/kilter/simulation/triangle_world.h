// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "kilter/base/rng.h"
#include "kilter/geometry/pose3.h"

namespace kilter {

/// What a surface is made of; decides how much light comes back.
enum class Material : std::uint8_t { kPlaster, kConcrete, kAsphalt, kWood, kMetal, kPaint, kFabric, kFoliage };

/// Share of the laser's light that a surface sends back at normal incidence, in (0, 1].
[[nodiscard]] double reflectivity(Material material);

/// An upright box. `center_m` is its middle; `yaw_rad` turns it about the vertical.
struct Box {
  Eigen::Vector3d center_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d size_m = Eigen::Vector3d::Ones();
  double yaw_rad = 0.0;
};

/// Triangles with a material each, in one frame. Only ever grows.
struct TriangleMesh {
  std::vector<Eigen::Vector3f> vertices_m;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices into vertices_m
  std::vector<Material> materials;                      ///< one per triangle

  void add_triangle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c, Material material);

  /// Corners in order round the quadrilateral, which must be flat.
  void add_quad(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c, const Eigen::Vector3d& d,
                Material material);

  void add_box(const Box& box, Material material);

  /// A horizontal rectangle [x0, x1] x [y0, y1] at height z.
  void add_floor(double x0, double y0, double x1, double y1, double z, Material material);

  /// An upright prism that stands for a cylinder or, with `top_radius_m` 0, a cone. `sides` >= 3.
  void add_prism(const Eigen::Vector3d& base_m, double radius_m, double top_radius_m, double height_m, int sides,
                 Material material);

  /// Ground of cells `step_m` wide over [x0, x1] x [y0, y1] at `height(x, y)`.
  void add_terrain(double x0, double y0, double x1, double y1, double step_m,
                   const std::function<double(double, double)>& height, Material material);

  /// A ball of loose leaves: `count` small triangles, so that beams end at many depths.
  void add_leaves(const Eigen::Vector3d& center_m, const Eigen::Vector3d& radii_m, int count, Rng& rng);

  /// Adds another mesh, moved by T.
  void append(const TriangleMesh& other, const Pose3& T);
};

/// From one moment to another; both included.
struct TimeSpan {
  double from_s = 0.0;
  double to_s = 0.0;
};

/// A car or a person: a mesh that goes round a closed polyline at constant speed, looking ahead. Or a door: no
/// circuit, and gone while it is open.
struct MovingObject {
  TriangleMesh mesh;                       ///< object frame: x ahead, origin on the ground
  std::vector<Eigen::Vector3d> circuit_m;  ///< >= 2 distinct corners; the last leads back to the first. Empty: stays
  double speed_mps = 1.0;
  double start_m = 0.0;  ///< how far along the circuit it is at time 0
  std::vector<TimeSpan> absent = {};

  /// T_world_object at a time.
  [[nodiscard]] Pose3 pose_at(double time_s) const;
  [[nodiscard]] bool is_there(double time_s) const;
};

/// Everything that a beam can hit. World frame: z up, metres.
struct TriangleWorld {
  TriangleMesh fixed;
  std::vector<MovingObject> moving;
};

}  // namespace kilter
