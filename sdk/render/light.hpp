// SPDX-License-Identifier: Apache-2.0
#pragma once
// The studio: a bright sky, one large lamp over the viewer's shoulder, calm blue-grey metal, light paper behind.

#include <cstdint>

#include "camera.hpp"
#include "surface.hpp"
#include "tracer.hpp"

namespace meso::picture {

/// Linear red, green, blue.
using Color = Vec3;

/// Points of an even, endless sequence in the unit square (Roberts' R2), shifted per pixel, so that neighbours do not
/// repeat.
class Samples {
 public:
  Samples(std::uint32_t x, std::uint32_t y);
  struct Point {
    double u, v;  ///< in [0, 1)
  };
  [[nodiscard]] Point next();

 private:
  std::uint32_t u_, v_;  ///< fractions of 2^32: exact, unlike sums of doubles
};

class Studio {
 public:
  Studio(const View& view, const Tracer& tracer);

  /// What the viewer sees at a spot; `to_viewer` is a unit vector.
  [[nodiscard]] Color shade(Surface::Spot spot, Vec3 to_viewer, Samples& samples) const;
  /// The paper at a height of the picture, 0 at the top, 1 at the bottom.
  [[nodiscard]] static Color paper(double height);

 private:
  [[nodiscard]] Color sky(Vec3 direction) const;
  [[nodiscard]] Color sky_light(const Surface::Spot& spot, Vec3 start, Samples& samples) const;
  [[nodiscard]] double lamp_light(const Surface::Spot& spot, Samples& samples) const;

  Vec3 vertical_, to_lamp_;
  const Tracer& tracer_;
};

}  // namespace meso::picture
