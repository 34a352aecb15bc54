// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/simulation/ray_caster.h"

#if KILTER_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>

namespace kilter {
namespace {

using Eigen::Vector3d;

// Triangles of one rigid thing and Embree's tree over them.
struct RigidMesh {
  TriangleMesh mesh;
  RTCScene scene = nullptr;
  Eigen::AlignedBox3d box_m{};           // round it, along its own axes
  Vector3d center_m = Vector3d::Zero();  // of a ball round it
  double radius_m = 0.0;
};

RigidMesh with_ball(const TriangleMesh& mesh, RTCScene scene) {
  RigidMesh rigid{mesh, scene};
  for (const Eigen::Vector3f& vertex : mesh.vertices_m) rigid.box_m.extend(vertex.cast<double>().eval());
  rigid.center_m = rigid.box_m.center();
  rigid.radius_m = 0.5 * rigid.box_m.diagonal().norm();
  return rigid;
}

Error device_error(RTCDevice device) {
  const RTCError code = rtcGetDeviceError(device);
  if (code == RTC_ERROR_OUT_OF_MEMORY) {
    return {ErrorCode::kOutOfMemory, "the simulated world does not fit into memory", {}, "use a smaller --scale"};
  }
  return {
      ErrorCode::kInternal, "the ray caster could not be set up (Embree error " + std::to_string(code) + ")", {}, {}};
}

Expected<RTCScene> build_tree(RTCDevice device, const TriangleMesh& mesh) {
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  constexpr std::size_t kVertexBytes = 3 * sizeof(float);
  constexpr std::size_t kTriangleBytes = 3 * sizeof(std::uint32_t);
  void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, kVertexBytes,
                                           mesh.vertices_m.size());
  void* triangles = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, kTriangleBytes,
                                            mesh.triangles.size());
  if (vertices == nullptr || triangles == nullptr) {
    rtcReleaseGeometry(geometry);
    return pass_up(device_error(device));
  }
  auto* coordinate = static_cast<float*>(vertices);
  for (const Eigen::Vector3f& vertex : mesh.vertices_m) coordinate = std::copy_n(vertex.data(), 3, coordinate);
  std::memcpy(triangles, mesh.triangles.data(), kTriangleBytes * mesh.triangles.size());
  rtcCommitGeometry(geometry);
  const RTCScene scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);  // no leaks between triangles that share an edge
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene);
  if (rtcGetDeviceError(device) != RTC_ERROR_NONE) {
    rtcReleaseScene(scene);
    return pass_up(device_error(device));
  }
  return scene;
}

// The ray given in the mesh's frame; the hit's normal stays in that frame.
std::optional<RayHit> hit_mesh(const RigidMesh& rigid, const Vector3d& origin_m, const Vector3d& direction,
                               double max_range_m) {
  RTCRayHit query{};
  query.ray.org_x = static_cast<float>(origin_m.x());
  query.ray.org_y = static_cast<float>(origin_m.y());
  query.ray.org_z = static_cast<float>(origin_m.z());
  query.ray.dir_x = static_cast<float>(direction.x());
  query.ray.dir_y = static_cast<float>(direction.y());
  query.ray.dir_z = static_cast<float>(direction.z());
  query.ray.tfar = static_cast<float>(max_range_m);
  query.ray.mask = ~0U;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
#if KILTER_EMBREE_MAJOR >= 4
  rtcIntersect1(rigid.scene, &query);
#else
  RTCIntersectContext context{};
  rtcInitIntersectContext(&context);
  rtcIntersect1(rigid.scene, &context, &query);
#endif
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;

  const auto& [a, b, c] = rigid.mesh.triangles[query.hit.primID];
  const Vector3d corner = rigid.mesh.vertices_m[a].cast<double>();
  const Vector3d edge1 = rigid.mesh.vertices_m[b].cast<double>() - corner;
  const Vector3d edge2 = rigid.mesh.vertices_m[c].cast<double>() - corner;
  Vector3d normal = edge1.cross(edge2).normalized();
  double slope = normal.dot(direction);
  if (slope > 0.0) {
    normal = -normal;
    slope = -slope;
  }
  if (slope > -1e-6) return std::nullopt;  // along the surface: no light comes back
  return RayHit{normal.dot(corner - origin_m) / slope, normal, rigid.mesh.materials[query.hit.primID]};
}

// The ball's centre given relative to the ray's origin.
bool may_meet_ball(const Vector3d& center_m, const Vector3d& direction, double radius_m, double max_range_m) {
  const double along_m = center_m.dot(direction);
  if (along_m < -radius_m || along_m > max_range_m + radius_m) return false;
  return (center_m - along_m * direction).squaredNorm() <= radius_m * radius_m;
}

}  // namespace

struct RayCaster::Scenes {
  RTCDevice device = nullptr;
  RigidMesh fixed;
  std::vector<MovingObject> moving;
  std::vector<RigidMesh> moving_meshes;

  Scenes() = default;
  Scenes(const Scenes&) = delete;
  Scenes(Scenes&&) = delete;
  Scenes& operator=(const Scenes&) = delete;
  Scenes& operator=(Scenes&&) = delete;
  ~Scenes() {
    if (fixed.scene != nullptr) rtcReleaseScene(fixed.scene);
    for (const RigidMesh& rigid : moving_meshes) rtcReleaseScene(rigid.scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }
};

RayCaster::RayCaster(std::unique_ptr<Scenes> scenes) : scenes_(std::move(scenes)) {}
RayCaster::~RayCaster() = default;
RayCaster::RayCaster(RayCaster&&) noexcept = default;
RayCaster& RayCaster::operator=(RayCaster&&) noexcept = default;

Expected<RayCaster> RayCaster::build(const TriangleWorld& world) {
  if (world.fixed.triangles.empty()) {
    return fail(ErrorCode::kInvalidArgument, "a world needs at least one triangle to cast rays at");
  }
  auto scenes = std::make_unique<Scenes>();
  scenes->device = rtcNewDevice("threads=1");
  if (scenes->device == nullptr) return pass_up(device_error(nullptr));
  const Expected<RTCScene> fixed = build_tree(scenes->device, world.fixed);
  if (!fixed) return pass_up(fixed.error());
  scenes->fixed = with_ball(world.fixed, *fixed);
  scenes->moving = world.moving;
  for (const MovingObject& object : world.moving) {
    const Expected<RTCScene> tree = build_tree(scenes->device, object.mesh);
    if (!tree) return pass_up(tree.error());
    scenes->moving_meshes.push_back(with_ball(object.mesh, *tree));
  }
  return RayCaster(std::move(scenes));
}

RayCaster::Moment RayCaster::at(double time_s) const {
  Moment moment;
  moment.caster_ = this;
  for (std::size_t i = 0; i < scenes_->moving.size(); ++i) {
    const MovingObject& object = scenes_->moving[i];
    if (object.is_there(time_s)) moment.placed_.push_back({i, object.pose_at(time_s).inverse()});
  }
  return moment;
}

std::optional<RayHit> RayCaster::Moment::first_hit(const Vector3d& origin_m, const Vector3d& direction,
                                                   double max_range_m) const {
  const Scenes& scenes = *caster_->scenes_;
  std::optional<RayHit> best = hit_mesh(scenes.fixed, origin_m, direction, max_range_m);
  for (const auto& [object, T_object_world] : placed_) {
    const double limit_m = best ? best->range_m : max_range_m;
    const RigidMesh& rigid = scenes.moving_meshes[object];
    const Vector3d origin_object_m = T_object_world * origin_m;
    if (rigid.box_m.contains(origin_object_m)) continue;  // it would have driven round the sensor
    const Vector3d direction_object = T_object_world.rotation() * direction;
    const Vector3d to_ball_m = rigid.center_m - origin_object_m;
    if (!may_meet_ball(to_ball_m, direction_object, rigid.radius_m, limit_m)) continue;
    std::optional<RayHit> hit = hit_mesh(rigid, origin_object_m, direction_object, limit_m);
    if (!hit || (best && hit->range_m >= best->range_m)) continue;
    hit->normal = T_object_world.rotation().conjugate() * hit->normal;
    best = hit;
  }
  return best;
}

}  // namespace kilter
