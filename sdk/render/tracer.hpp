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
  std::unique_ptr<RTCDeviceTy, Release> device_;
  std::unique_ptr<RTCSceneTy, Release> scene_;
};

}  // namespace meso::picture
