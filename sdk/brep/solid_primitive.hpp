// SPDX-License-Identifier: Apache-2.0
#pragma once
// Primitives as OpenCASCADE solids. Private. OpenCASCADE accepts NaN radii and zero heights without a word, so every
// number is checked here first; a fault is GEOMETRY_SIZE, GEOMETRY_PROFILE or GEOMETRY_VOLUME_ELEMENT.
// All functions may throw Standard_Failure.

#include <optional>

#include "meso/eval/shape.hpp"
#include "solid_context.hpp"

namespace meso::brep {

/// Sizes below this are no sizes (millimetres).
inline constexpr double smallest_size = 1e-6;
/// Beyond it doubles do not resolve what OpenCASCADE takes to be one point, and its algorithms may not end.
inline constexpr double largest_size = 1e8;

/// The polygon swept by `sweep`, every point mapped: any affine map keeps the faces plane. Either sense.
[[nodiscard]] TopoDS_Shape prism(const std::vector<Vec3>& polygon, Vec3 sweep, const Affine& map);
/// The solid under an affine map: moved, scaled, or, where the map changes angles, as B-splines.
[[nodiscard]] TopoDS_Shape mapped(const TopoDS_Shape& solid, const Affine& map);
/// The solid, turned inside out if its volume is negative.
[[nodiscard]] TopoDS_Shape outward(const TopoDS_Shape& solid);

/// True if `map` keeps angles (rigid, mirrored or uniformly scaled).
[[nodiscard]] bool is_similarity(const Affine& map);

/// A cylinder or cone between two points; no check.
[[nodiscard]] TopoDS_Shape frustum(Vec3 from, Vec3 to, double radius_from, double radius_to);

using OptionalSolid = std::optional<TopoDS_Shape>;
[[nodiscard]] OptionalSolid primitive_solid(const eval::BoxShape& box, const Affine& map, ElementId where,
                                            const SolidContext& context);
[[nodiscard]] OptionalSolid primitive_solid(const eval::SphereShape& sphere, const Affine& map, ElementId where,
                                            const SolidContext& context);
[[nodiscard]] OptionalSolid primitive_solid(const eval::EllipsoidShape& ellipsoid, const Affine& map, ElementId where,
                                            const SolidContext& context);
[[nodiscard]] OptionalSolid primitive_solid(const eval::CylinderShape& cylinder, const Affine& map, ElementId where,
                                            const SolidContext& context);
[[nodiscard]] OptionalSolid primitive_solid(const eval::ConeShape& cone, const Affine& map, ElementId where,
                                            const SolidContext& context);
[[nodiscard]] OptionalSolid primitive_solid(const eval::TorusShape& torus, const Affine& map, ElementId where,
                                            const SolidContext& context);
[[nodiscard]] OptionalSolid primitive_solid(const eval::ExtrusionShape& extrusion, const Affine& map, ElementId where,
                                            const SolidContext& context);
[[nodiscard]] OptionalSolid primitive_solid(const eval::RevolutionShape& revolution, const Affine& map, ElementId where,
                                            const SolidContext& context);
[[nodiscard]] OptionalSolid primitive_solid(const eval::VolumeElementShape& element, const Affine& map, ElementId where,
                                            const SolidContext& context);

/// One solid for each outer shell, with the cavities in it.
[[nodiscard]] std::optional<Solids> polyhedron_solids(const eval::PolyhedronShape& shape, const Affine& map,
                                                      ElementId where, const SolidContext& context);

}  // namespace meso::brep
