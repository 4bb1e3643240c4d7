// SPDX-License-Identifier: Apache-2.0
#pragma once
// A body with every number known: what evaluation hands to the engines. Millimetres, radians, no expressions left.
// A Shape of a unit cell stands in cell coordinates; PlacedCell::world_from_cell puts it into the world.

#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "meso/base/polyhedron.hpp"
#include "meso/base/vec.hpp"
#include "meso/eval/coordinates.hpp"
#include "meso/model/document.hpp"
#include "meso/resource/resource.hpp"

namespace meso::eval {

struct Shape;

struct BoxShape {
  Vec3 corner, size;
};
struct SphereShape {
  Vec3 center;
  double radius = 0;
};
struct EllipsoidShape {
  Vec3 center, radii;
};
struct CylinderShape {
  Vec3 from, to;
  double radius = 0;
};
struct ConeShape {
  Vec3 from, to;
  double radius_from = 0, radius_to = 0;
};
struct TorusShape {
  Vec3 center, axis{0, 0, 1};
  double major_radius = 0, minor_radius = 0;
};
struct ExtrusionShape {
  double z = 0, height = 0;
  std::vector<std::pair<double, double>> points;
};
/// A simple polygon of (r, z), r >= 0, turned once about z.
struct RevolutionShape {
  std::vector<std::pair<double, double>> points;
};
/// Without fault: plane faces that enclose a volume, in one shell or more. Wedges are polyhedra, too.
struct PolyhedronShape {
  Polyhedron body;
};
/// All P(q) with q[axis] between from[axis] and to[axis] for three axes, 0 on the others.
struct VolumeElementShape {
  std::shared_ptr<const CoordinateFrame> system;
  std::array<std::size_t, 3> axes{};  ///< positions of the three axes in the system
  std::array<double, 3> from{}, to{};
};
/// A file, unread. `scale` gives millimetres (1 for STEP, which knows its unit).
struct ImportShape {
  Resource file;
  std::optional<std::string> sha256;
  double scale = 1;
  Affine transform;
};
struct StrutNode {
  Vec3 position;
  double ball_radius = 0;  ///< 0: no ball
};
struct Strut {
  std::size_t from = 0, to = 0;  ///< nodes
  double radius_from = 0, radius_to = 0;
  BeamCap cap_from = BeamCap::sphere, cap_to = BeamCap::sphere;
};
struct BeamsShape {
  std::vector<StrutNode> nodes;
  std::vector<Strut> struts;
};
/// Union, intersection or difference (first minus the rest) of the operands.
struct BooleanShape {
  BooleanOperation operation = BooleanOperation::union_;
  std::vector<Shape> operands;
};
/// The union of the operands under an affine map.
struct TransformedShape {
  Affine map;
  std::vector<Shape> operands;
};
struct ImplicitShape {
  const ImplicitBody* body = nullptr;
};
struct PartShape {
  const Part* part = nullptr;
};

struct Shape {
  std::variant<BoxShape, SphereShape, EllipsoidShape, CylinderShape, ConeShape, TorusShape, ExtrusionShape,
               RevolutionShape, PolyhedronShape, VolumeElementShape, ImportShape, BeamsShape, BooleanShape,
               TransformedShape, ImplicitShape, PartShape>
      value;
  ElementId source{};  ///< the element it comes from, for diagnostics
};

}  // namespace meso::eval
