// SPDX-License-Identifier: Apache-2.0
#pragma once
// A box around a shape, without building it.
//
//   bounds(Shape{SphereShape{{0, 0, 0}, 1}});  // [-1, 1]^3
//
// Contains the shape; exact for boxes, spheres, ellipsoids, tori, extrusions, revolutions and polyhedra, else a little
// too large. Nothing for what only an engine knows: imports, parts, implicit bodies. Millimetres; linear in the size of
// the shape.

#include <optional>

#include "meso/eval/shape.hpp"

namespace meso::eval {

[[nodiscard]] std::optional<Box3> bounds(const Shape& shape);
/// The box around the image of a box.
[[nodiscard]] Box3 transformed(const Affine& map, const Box3& box);
[[nodiscard]] Box3 box_of(const BoxShape& box);

}  // namespace meso::eval
