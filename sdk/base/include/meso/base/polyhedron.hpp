// SPDX-License-Identifier: Apache-2.0
#pragma once
// A body between plane faces, and whether it is one.
//
//   Polyhedron p{.vertices = {...}, .faces = {{0, 1, 2}, ...}};
//   if (auto fault = polyhedron_fault(p)) report(fault->code, element_of_face(fault->face), fault->args);
//
// Any length unit: every tolerance is a share of the body's size. Faces counter-clockwise seen from outside. Cost:
// microseconds a face, and a comparison with each face that stands beside it along x.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "meso/base/diagnostic.hpp"
#include "meso/base/polygon.hpp"
#include "meso/base/vec.hpp"

namespace meso {

struct Polyhedron {
  std::vector<Vec3> vertices;
  std::vector<std::vector<std::size_t>> faces;
};

struct PolyhedronFault {
  Code code{};
  std::size_t face = 0;
  std::vector<std::string> args;
};

/// The first thing that keeps it from being a body; nothing if it is one.
[[nodiscard]] std::optional<PolyhedronFault> polyhedron_fault(const Polyhedron& polyhedron);

/// How far, as a share of the diagonal of the body's box, a corner may stand off its face's plane.
inline constexpr double polyhedron_flatness = 1e-6;

/// dot(normal, p) == offset; the normal, of length 1, points outwards.
struct FacePlane {
  Vec3 normal;
  double offset = 0;
};
// The rest REQUIRES a polyhedron without fault.

/// By Newell's sum over all corners.
[[nodiscard]] FacePlane plane_of(const Polyhedron& polyhedron, std::size_t face);
/// For each face the number of the shell it belongs to: faces that hang together by edges. From 0, in order of faces.
[[nodiscard]] std::vector<std::size_t> shells_of(const Polyhedron& polyhedron);
/// Of some of the faces, those of whole shells: negative for the wall of a cavity.
[[nodiscard]] double volume_of(const Polyhedron& polyhedron, const std::vector<std::size_t>& faces);
/// How often the shells of these faces go round p.
[[nodiscard]] double winding_of(const Polyhedron& polyhedron, const std::vector<std::size_t>& faces, Vec3 p);
/// The face's corners seen along the axis that its normal is nearest to.
[[nodiscard]] std::vector<Point2> flattened(const Polyhedron& polyhedron, std::size_t face);

}  // namespace meso
