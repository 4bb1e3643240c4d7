// SPDX-License-Identifier: Apache-2.0
#pragma once
// Primitives as tests place them.

#include "primitive.hpp"

namespace meso::implicit {

inline Primitive strut(Vec3 from, Vec3 to, double radius) {
  Primitive p{.capsule = capsule(from, to, radius)};
  for (const Vec3 end : {from, to}) {
    p.box.extend(end - Vec3{radius, radius, radius});
    p.box.extend(end + Vec3{radius, radius, radius});
  }
  return p;
}

}  // namespace meso::implicit
