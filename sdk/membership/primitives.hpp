// SPDX-License-Identifier: Apache-2.0
#pragma once
// One inequality, or a few, for each kind of body. Private.

#include "meso/eval/shape.hpp"
#include "meso/membership/answer.hpp"

namespace meso::membership {

[[nodiscard]] bool contains(const eval::BoxShape& box, Vec3 p);
[[nodiscard]] bool contains(const eval::SphereShape& sphere, Vec3 p);
[[nodiscard]] bool contains(const eval::EllipsoidShape& ellipsoid, Vec3 p);
[[nodiscard]] bool contains(const eval::CylinderShape& cylinder, Vec3 p);
[[nodiscard]] bool contains(const eval::ConeShape& cone, Vec3 p);
[[nodiscard]] bool contains(const eval::TorusShape& torus, Vec3 p);
[[nodiscard]] bool contains(const eval::ExtrusionShape& extrusion, Vec3 p);
[[nodiscard]] bool contains(const eval::RevolutionShape& revolution, Vec3 p);
[[nodiscard]] bool contains(const eval::PolyhedronShape& polyhedron, Vec3 p);
[[nodiscard]] bool contains(const eval::BeamsShape& beams, Vec3 p);

/// By solving P(q) = p for the element's three coordinates; unknown where the system's axes allow no solution in
/// closed form.
[[nodiscard]] Answer answer_at(const eval::VolumeElementShape& element, Vec3 p);

}  // namespace meso::membership
