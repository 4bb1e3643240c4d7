// SPDX-License-Identifier: Apache-2.0
#pragma once
// A shape as a question: a box, and what is inside it. Private.

#include <functional>

#include "box_tree.hpp"
#include "meso/eval/shape.hpp"
#include "meso/membership/membership.hpp"

namespace meso::membership {

struct Solid {
  Box3 box;
  std::function<Answer(Vec3)> test;  ///< asked for points in the box only

  [[nodiscard]] Answer at(Vec3 p) const { return holds(box, p) ? test(p) : Answer::outside; }
};

/// What a shape can refer to and does not contain.
struct Surroundings {
  ImportReader imports;
  std::function<Solid(const Part*)> part;
};

[[nodiscard]] Solid make_solid(const eval::Shape& shape, const Surroundings& surroundings);
[[nodiscard]] Solid moved(Solid solid, const Affine& map);

}  // namespace meso::membership
