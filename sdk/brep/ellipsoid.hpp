// SPDX-License-Identifier: Apache-2.0
#pragma once
// Ellipsoids, exactly: OpenCASCADE knows them only as rational B-splines, whose box, area and mesh it searches for
// (25 ms). Here they are what they are, the affine image of the unit sphere, and all of it is a formula (20 us).
// Private.
//
//   const TopoDS_Shape solid = ellipsoid_solid(world_from_unit_sphere);
//   if (const auto ellipsoid = ellipsoid_of(face)) box = box_of(*ellipsoid);   // known again by its poles
//
// Thread rule: pure.

#include <optional>

#include "meso/brep/body.hpp"
#include "occt.hpp"

namespace meso::brep {

struct Ellipsoid {
  Affine map;           ///< world_from_unit_sphere; its determinant is not 0
  bool outward = true;  ///< false for the face of a void
};

/// Outward; one face, a rational B-spline of degree 2, without error. May throw Standard_Failure.
[[nodiscard]] TopoDS_Shape ellipsoid_solid(const Affine& map);

/// The ellipsoid or sphere of which the face is the whole surface; empty for any other face.
[[nodiscard]] std::optional<Ellipsoid> ellipsoid_of(const TopoDS_Face& face);

[[nodiscard]] Box3 box_of(const Ellipsoid& ellipsoid);
[[nodiscard]] FaceMoments moments_of(const Ellipsoid& ellipsoid);
/// Half axes, the longest first.
[[nodiscard]] Vec3 radii_of(const Ellipsoid& ellipsoid);
/// Triangles whose corners lie on the surface, at most `deflection` away from it and turning by at most `angle`
/// (radians) from one chord to the next; closed.
[[nodiscard]] Triangulation mesh_of(const Ellipsoid& ellipsoid, double deflection, double angle);

}  // namespace meso::brep
