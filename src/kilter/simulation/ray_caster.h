// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/simulation/triangle_world.h"

namespace kilter {

/// Where a ray first meets the world.
struct RayHit {
  double range_m = 0.0;
  Eigen::Vector3d normal;  ///< unit, world frame, facing the ray's origin
  Material material = Material::kPlaster;
};

/// Finds first hits in a world that does not change except for its moving objects. Embree finds the triangle; the
/// range is then computed here in double precision, so it does not depend on the processor's vector width.
class RayCaster {
 public:
  /// The world is copied. \return kInvalidArgument for a world without triangles, kOutOfMemory, kInternal.
  [[nodiscard]] static Expected<RayCaster> build(const TriangleWorld& world);

  ~RayCaster();
  RayCaster(RayCaster&&) noexcept;
  RayCaster& operator=(RayCaster&&) noexcept;
  RayCaster(const RayCaster&) = delete;
  RayCaster& operator=(const RayCaster&) = delete;

  /// The world at one moment: moving objects stand still. One in whose box a ray begins is not there for that ray: a
  /// car does not drive through the sensor, and from inside it nothing else would be seen. Cheap; valid while the
  /// caster lives; for one thread.
  class Moment {
   public:
    /// \param origin_m     world frame
    /// \param direction    unit, world frame
    /// \param max_range_m  hits beyond it are not looked for
    [[nodiscard]] std::optional<RayHit> first_hit(const Eigen::Vector3d& origin_m, const Eigen::Vector3d& direction,
                                                  double max_range_m) const;

   private:
    friend class RayCaster;
    const RayCaster* caster_ = nullptr;
    struct Placed {
      std::size_t object = 0;  ///< index into TriangleWorld::moving
      Pose3 T_object_world;
    };
    std::vector<Placed> placed_;
  };

  /// Safe from several threads at once.
  [[nodiscard]] Moment at(double time_s) const;

 private:
  struct Scenes;
  explicit RayCaster(std::unique_ptr<Scenes> scenes);
  std::unique_ptr<Scenes> scenes_;
};

}  // namespace kilter
