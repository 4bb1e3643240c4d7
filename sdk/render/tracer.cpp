// SPDX-License-Identifier: Apache-2.0
#include "tracer.hpp"

#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>

namespace meso::picture {
namespace {

// The same kernels on every x86-64 machine since 2008: which of two triangles wins on their common edge then does not
// depend on the processor's vector width.
constexpr const char* device_settings = "isa=sse4.2";

template <typename Ray>
void aim(Ray& ray, Vec3 origin, Vec3 direction, float distance) {
  ray.org_x = static_cast<float>(origin.x);
  ray.org_y = static_cast<float>(origin.y);
  ray.org_z = static_cast<float>(origin.z);
  ray.dir_x = static_cast<float>(direction.x);
  ray.dir_y = static_cast<float>(direction.y);
  ray.dir_z = static_cast<float>(direction.z);
  ray.tnear = 0;
  ray.tfar = distance;
  ray.mask = ~0U;
  ray.flags = 0;
  ray.time = 0;
}

}  // namespace

std::optional<Tracer> Tracer::over(const Surface& surface) {
  Tracer tracer;
  tracer.device_.reset(rtcNewDevice(device_settings));
  if (!tracer.device_) return std::nullopt;
  const RTCDevice device = tracer.device_.get();

  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* points = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                             3 * sizeof(float), surface.points().size()));
  auto* corners = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), surface.triangles().size()));
  if (points && corners) {
    for (const Vec3& p : surface.points())
      for (std::size_t i = 0; i < 3; ++i) *points++ = static_cast<float>(p[i]);
    for (const auto& t : surface.triangles())
      for (const std::uint32_t i : t) *corners++ = i;
    rtcCommitGeometry(geometry);
    tracer.scene_.reset(rtcNewScene(device));
    rtcSetSceneFlags(tracer.scene_.get(), RTC_SCENE_FLAG_ROBUST);  // no light through the seams of a closed mesh
    rtcAttachGeometry(tracer.scene_.get(), geometry);
    // One thread builds the tree, so that its order, and with it the winner among equal hits, is always the same.
    tbb::task_arena(1).execute([&] { rtcCommitScene(tracer.scene_.get()); });
  }
  rtcReleaseGeometry(geometry);
  if (rtcGetDeviceError(device) != RTC_ERROR_NONE) return std::nullopt;
  return tracer;
}

std::optional<Vec3> Tracer::entry(Vec3 origin, Vec3 direction) const {
  if (!kept_ || dot(kept_->normal, origin) <= kept_->offset) return std::nullopt;
  const double slope = dot(kept_->normal, direction);
  if (slope >= 0) return std::nullopt;
  return origin + ((kept_->offset - dot(kept_->normal, origin)) / slope) * direction;
}

double Tracer::exit(Vec3 origin, Vec3 direction) const {
  if (!kept_) return HUGE_VAL;
  const double slope = dot(kept_->normal, direction), left = kept_->offset - dot(kept_->normal, origin);
  return slope > 0 ? left / slope : HUGE_VAL;
}

std::optional<Tracer::Hit> Tracer::first_hit(Vec3 origin, Vec3 direction) const {
  const double end = exit(origin, direction);
  if (end < 0) return std::nullopt;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit ray{};
  aim(ray.ray, origin, direction, static_cast<float>(end));
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(scene_.get(), &context, &ray);
  if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  return Hit{ray.hit.primID, ray.hit.u, ray.hit.v};
}

bool Tracer::blocked(Vec3 origin, Vec3 direction, double distance) const {
  const double end = std::min(distance, exit(origin, direction));
  if (end < 0) return false;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay ray{};
  aim(ray, origin, direction, static_cast<float>(end));
  rtcOccluded1(scene_.get(), &context, &ray);
  return ray.tfar < 0;  // Embree's sign for "blocked"
}

}  // namespace meso::picture
