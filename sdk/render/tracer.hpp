// SPDX-License-Identifier: Apache-2.0
#pragma once
// What a ray meets first; the only file besides its .cpp that knows Embree.

#include <embree3/rtcore.h>

#include <memory>
#include <optional>

#include "surface.hpp"

namespace meso::picture {

class Tracer {
 public:
  /// Empty if memory does not suffice.
  [[nodiscard]] static std::optional<Tracer> over(const Surface& surface);

  /// What is left of the part: the points p with dot(normal, p) <= offset. Rays see nothing else.
  struct HalfSpace {
    Vec3 normal;
    double offset;
  };
  void keep_only(const HalfSpace& half) { kept_ = half; }
  /// REQUIRES: keep_only() was called.
  [[nodiscard]] Vec3 section_normal() const { return kept_->normal; }
  /// Where a ray comes to the kept half from outside it; empty: it starts inside, or there is no cut, or it never comes
  /// there.
  [[nodiscard]] std::optional<Vec3> entry(Vec3 origin, Vec3 direction) const;

  struct Hit {
    std::uint32_t triangle;
    double u, v;
  };
  [[nodiscard]] std::optional<Hit> first_hit(Vec3 origin, Vec3 direction) const;
  [[nodiscard]] bool blocked(Vec3 origin, Vec3 direction, double distance) const;

 private:
  struct Release {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
  };
  /// Distance at which a ray leaves the kept half; negative: it has left it before it starts.
  [[nodiscard]] double exit(Vec3 origin, Vec3 direction) const;

  std::optional<HalfSpace> kept_;
  std::unique_ptr<RTCDeviceTy, Release> device_;
  std::unique_ptr<RTCSceneTy, Release> scene_;
};

}  // namespace meso::picture
