// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/simulation/triangle_world.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "kilter/base/contract.h"

namespace kilter {
namespace {

using Eigen::Vector3d;

constexpr double kTwoPi = 2.0 * std::numbers::pi;

double circuit_length_m(const std::vector<Vector3d>& circuit_m) {
  double length_m = 0.0;
  for (std::size_t i = 0; i < circuit_m.size(); ++i) {
    length_m += (circuit_m[(i + 1) % circuit_m.size()] - circuit_m[i]).norm();
  }
  return length_m;
}

}  // namespace

double reflectivity(Material material) {
  switch (material) {
    case Material::kPlaster:
      return 0.75;
    case Material::kConcrete:
      return 0.45;
    case Material::kAsphalt:
      return 0.20;
    case Material::kWood:
      return 0.50;
    case Material::kMetal:
      return 0.35;
    case Material::kPaint:
      return 0.55;
    case Material::kFabric:
      return 0.25;
    case Material::kFoliage:
      return 0.40;
  }
  return 0.5;
}

void TriangleMesh::add_triangle(const Vector3d& a, const Vector3d& b, const Vector3d& c, Material material) {
  const auto first = static_cast<std::uint32_t>(vertices_m.size());
  for (const Vector3d& corner : {a, b, c}) vertices_m.push_back(corner.cast<float>());
  triangles.push_back({first, first + 1, first + 2});
  materials.push_back(material);
}

void TriangleMesh::add_quad(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d,
                            Material material) {
  add_triangle(a, b, c, material);
  add_triangle(a, c, d, material);
}

void TriangleMesh::add_box(const Box& box, Material material) {
  const Eigen::AngleAxisd turn(box.yaw_rad, Vector3d::UnitZ());
  const auto corner = [&](int x, int y, int z) -> Vector3d {
    return box.center_m + turn * (0.5 * Vector3d(x * box.size_m.x(), y * box.size_m.y(), z * box.size_m.z()));
  };
  for (const int s : {-1, 1}) {
    add_quad(corner(s, -1, -1), corner(s, 1, -1), corner(s, 1, 1), corner(s, -1, 1), material);
    add_quad(corner(-1, s, -1), corner(1, s, -1), corner(1, s, 1), corner(-1, s, 1), material);
    add_quad(corner(-1, -1, s), corner(1, -1, s), corner(1, 1, s), corner(-1, 1, s), material);
  }
}

void TriangleMesh::add_floor(double x0, double y0, double x1, double y1, double z, Material material) {
  add_quad({x0, y0, z}, {x1, y0, z}, {x1, y1, z}, {x0, y1, z}, material);
}

void TriangleMesh::add_prism(const Vector3d& base_m, double radius_m, double top_radius_m, double height_m, int sides,
                             Material material) {
  KILTER_EXPECTS(sides >= 3);
  const Vector3d top_m = base_m + Vector3d(0.0, 0.0, height_m);
  const auto rim = [&](int i, double radius) {
    const double angle = kTwoPi * i / sides;
    return Vector3d(radius * std::cos(angle), radius * std::sin(angle), 0.0);
  };
  for (int i = 0; i < sides; ++i) {
    const Vector3d low0 = base_m + rim(i, radius_m);
    const Vector3d low1 = base_m + rim(i + 1, radius_m);
    const Vector3d high0 = top_m + rim(i, top_radius_m);
    const Vector3d high1 = top_m + rim(i + 1, top_radius_m);
    add_triangle(low0, low1, high1, material);
    if (top_radius_m <= 0.0) continue;
    add_triangle(low0, high1, high0, material);
    add_triangle(top_m, high0, high1, material);
  }
}

void TriangleMesh::add_terrain(double x0, double y0, double x1, double y1, double step_m,
                               const std::function<double(double, double)>& height, Material material) {
  const int columns = std::max(1, static_cast<int>(std::ceil((x1 - x0) / step_m)));
  const int rows = std::max(1, static_cast<int>(std::ceil((y1 - y0) / step_m)));
  const auto vertex = [&](int i, int j) {
    const double x = x0 + (x1 - x0) * i / columns;
    const double y = y0 + (y1 - y0) * j / rows;
    return Vector3d(x, y, height(x, y));
  };
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      add_triangle(vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), material);
      add_triangle(vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1), material);
    }
  }
}

void TriangleMesh::add_leaves(const Vector3d& center_m, const Vector3d& radii_m, int count, Rng& rng) {
  const auto scatter = [&rng](double spread) {
    const double x = rng.normal();
    const double y = rng.normal();
    const double z = rng.normal();
    return Vector3d(spread * x, spread * y, spread * z);
  };
  for (int i = 0; i < count; ++i) {
    // Cube root: leaves fill the ball evenly instead of crowding its middle.
    const Vector3d inside = std::cbrt(rng.uniform()) * scatter(1.0).normalized();
    const Vector3d at = center_m + inside.cwiseProduct(radii_m);
    const Vector3d a = at + scatter(0.08);
    const Vector3d b = at + scatter(0.08);
    const Vector3d c = at + scatter(0.08);
    add_triangle(a, b, c, Material::kFoliage);
  }
}

void TriangleMesh::append(const TriangleMesh& other, const Pose3& T) {
  const auto first = static_cast<std::uint32_t>(vertices_m.size());
  for (const Eigen::Vector3f& vertex : other.vertices_m) {
    vertices_m.push_back((T * vertex.cast<double>().eval()).cast<float>());
  }
  for (const auto& [a, b, c] : other.triangles) triangles.push_back({first + a, first + b, first + c});
  materials.insert(materials.end(), other.materials.begin(), other.materials.end());
}

Pose3 MovingObject::pose_at(double time_s) const {
  if (circuit_m.empty()) return {};
  KILTER_EXPECTS(circuit_m.size() >= 2);
  const double length_m = circuit_length_m(circuit_m);
  double left_m = std::fmod(start_m + speed_mps * time_s, length_m);
  if (left_m < 0.0) left_m += length_m;
  std::size_t i = 0;
  Vector3d leg = circuit_m[1] - circuit_m[0];
  while (left_m > leg.norm() && i + 1 < circuit_m.size()) {
    left_m -= leg.norm();
    ++i;
    leg = circuit_m[(i + 1) % circuit_m.size()] - circuit_m[i];
  }
  const Vector3d at = circuit_m[i] + leg.normalized() * left_m;
  return {Eigen::Quaterniond(Eigen::AngleAxisd(std::atan2(leg.y(), leg.x()), Vector3d::UnitZ())), at};
}

bool MovingObject::is_there(double time_s) const {
  return std::none_of(absent.begin(), absent.end(),
                      [time_s](const TimeSpan& span) { return time_s >= span.from_s && time_s <= span.to_s; });
}

}  // namespace kilter
