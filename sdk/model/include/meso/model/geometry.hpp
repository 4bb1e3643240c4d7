// SPDX-License-Identifier: Apache-2.0
#pragma once
// Bodies that are described, not patterned: CSG trees, imports, beams, implicit bodies.
// Lengths are expressions in the document's unit, angles in radians. Absent optional = the default named in the
// comment.

#include <variant>

#include "meso/base/unit.hpp"
#include "meso/model/element.hpp"

namespace meso {

struct CoordinateSystem;
struct Part;

/// 3x4 row-major affine as twelve comma-separated expressions; determinant > 0 unless mirror is true.
struct Placement : Element {
  ExpressionList matrix;
  std::optional<bool> mirror;  ///< false
  friend bool operator==(const Placement&, const Placement&) = default;
};

// Primitives. Solid, closed, positive volume.

struct BoxPrimitive : Element {
  std::optional<Expression> x, y, z;  ///< corner, 0
  Expression dx, dy, dz;              ///< size, > 0
  friend bool operator==(const BoxPrimitive&, const BoxPrimitive&) = default;
};
struct SpherePrimitive : Element {
  std::optional<Expression> x, y, z;  ///< centre, 0
  Expression radius;
  friend bool operator==(const SpherePrimitive&, const SpherePrimitive&) = default;
};
struct EllipsoidPrimitive : Element {
  std::optional<Expression> x, y, z;  ///< centre, 0
  Expression rx, ry, rz;              ///< semi-axes
  friend bool operator==(const EllipsoidPrimitive&, const EllipsoidPrimitive&) = default;
};
struct CylinderPrimitive : Element {
  Expression x1, y1, z1, x2, y2, z2;  ///< centres of the two end discs
  Expression radius;
  friend bool operator==(const CylinderPrimitive&, const CylinderPrimitive&) = default;
};
struct ConePrimitive : Element {
  Expression x1, y1, z1, x2, y2, z2;
  Expression radius1, radius2;  ///< one of them may be 0
  friend bool operator==(const ConePrimitive&, const ConePrimitive&) = default;
};
struct TorusPrimitive : Element {
  std::optional<Expression> x, y, z;     ///< centre, 0
  std::optional<Expression> ax, ay, az;  ///< axis, (0, 0, 1)
  Expression major_radius, minor_radius;
  friend bool operator==(const TorusPrimitive&, const TorusPrimitive&) = default;
};
struct ProfilePoint : Element {
  Expression x, y;
  friend bool operator==(const ProfilePoint&, const ProfilePoint&) = default;
};
/// A simple polygon in the plane z, swept along +z by `height`.
struct ExtrusionPrimitive : Element {
  std::optional<Expression> z;  ///< 0
  Expression height;
  std::vector<ProfilePoint> points;  ///< >= 3, either sense
  friend bool operator==(const ExtrusionPrimitive&, const ExtrusionPrimitive&) = default;
};
/// A box whose top, at z + dz, is another rectangle along the axes.
struct WedgePrimitive : Element {
  std::optional<Expression> x, y, z;         ///< corner, 0
  Expression dx, dy, dz;                     ///< size of the bottom and height, > 0
  std::optional<Expression> top_x, top_y;    ///< of the top's corner from the bottom's, 0
  std::optional<Expression> top_dx, top_dy;  ///< size of the top, >= 0: dx, dy
  friend bool operator==(const WedgePrimitive&, const WedgePrimitive&) = default;
};
struct MeridianPoint : Element {
  Expression r, z;  ///< r >= 0
  friend bool operator==(const MeridianPoint&, const MeridianPoint&) = default;
};
/// A simple polygon in the half plane r >= 0, turned once about z.
struct RevolutionPrimitive : Element {
  std::vector<MeridianPoint> points;  ///< >= 3, either sense
  friend bool operator==(const RevolutionPrimitive&, const RevolutionPrimitive&) = default;
};
struct PolyhedronVertex : Element {
  Expression x, y, z;
  friend bool operator==(const PolyhedronVertex&, const PolyhedronVertex&) = default;
};
struct PolyhedronFace : Element {
  ExpressionList vertices;  ///< whole numbers from 0, counter-clockwise seen from outside
  friend bool operator==(const PolyhedronFace&, const PolyhedronFace&) = default;
};
/// What plane faces enclose.
struct PolyhedronPrimitive : Element {
  std::vector<PolyhedronVertex> vertices;  ///< >= 4
  std::vector<PolyhedronFace> faces;       ///< >= 4
  friend bool operator==(const PolyhedronPrimitive&, const PolyhedronPrimitive&) = default;
};
struct AxisRange : Element {
  Name axis;
  Expression from, to;
  friend bool operator==(const AxisRange&, const AxisRange&) = default;
};
/// All points P(q) with q between from and to on three axes of a coordinate system: a box, a polar or a spherical
/// sector.
struct VolumeElementPrimitive : Element {
  Ref<CoordinateSystem> coordinate_system;
  std::vector<AxisRange> ranges;
  friend bool operator==(const VolumeElementPrimitive&, const VolumeElementPrimitive&) = default;
};

struct CsgNode;

/// <union>, <intersection>, <difference>: of all operands; a difference takes the others from the first.
enum class BooleanOperation { union_, intersection, difference };

template <BooleanOperation Operation>
struct CsgBoolean : Element {
  std::vector<CsgNode> operands;
  friend bool operator==(const CsgBoolean&, const CsgBoolean&) = default;
};
using CsgUnion = CsgBoolean<BooleanOperation::union_>;
using CsgIntersection = CsgBoolean<BooleanOperation::intersection>;
using CsgDifference = CsgBoolean<BooleanOperation::difference>;

// Transforms of the union of their operands.
struct CsgTransform : Element {
  ExpressionList matrix;
  std::optional<bool> mirror;
  std::vector<CsgNode> operands;
  friend bool operator==(const CsgTransform&, const CsgTransform&) = default;
};
struct CsgTranslate : Element {
  std::optional<Expression> x, y, z;
  std::vector<CsgNode> operands;
  friend bool operator==(const CsgTranslate&, const CsgTranslate&) = default;
};
struct CsgRotate : Element {
  Expression x, y, z, angle;  ///< axis through the origin, right-handed
  std::vector<CsgNode> operands;
  friend bool operator==(const CsgRotate&, const CsgRotate&) = default;
};
struct CsgScale : Element {
  std::optional<Expression> x, y, z;  ///< three factors > 0, 1 each ...
  std::optional<Expression> factor;   ///< ... or one
  std::vector<CsgNode> operands;
  friend bool operator==(const CsgScale&, const CsgScale&) = default;
};

struct CsgNode {
  std::variant<BoxPrimitive, SpherePrimitive, EllipsoidPrimitive, CylinderPrimitive, ConePrimitive, TorusPrimitive,
               ExtrusionPrimitive, WedgePrimitive, RevolutionPrimitive, PolyhedronPrimitive, VolumeElementPrimitive,
               CsgUnion, CsgIntersection, CsgDifference, CsgTransform, CsgTranslate, CsgRotate, CsgScale>
      value;
  friend bool operator==(const CsgNode&, const CsgNode&) = default;
};

/// <csg>: the union of its operands.
struct CsgBody : Element {
  std::vector<CsgNode> operands;
  friend bool operator==(const CsgBody&, const CsgBody&) = default;
};

/// A body in a foreign file. `unit` is mandatory for formats that have none (STL, OBJ, PLY, OFF, BREP) and refused for
/// STEP and IGES.
struct ImportBody : Element {
  Href href;
  std::optional<std::string> sha256;
  std::optional<LengthUnit> unit;
  std::optional<Placement> transform;  ///< of a unit cell: entries are expressions of the cell's parameters
  friend bool operator==(const ImportBody&, const ImportBody&) = default;
};

enum class BeamCap { sphere, hemisphere, butt };

struct BeamNode : Element {
  Name name;
  Expression x, y, z;
  std::optional<Expression> radius;  ///< of the ball; the beams' nodeRadius
  friend bool operator==(const BeamNode&, const BeamNode&) = default;
};
struct Beam : Element {
  Name from, to;
  std::optional<Expression> radius, radius1, radius2;  ///< the beams' radius; radius1 at `from`
  std::optional<BeamCap> cap1, cap2;                   ///< the beams' cap
  friend bool operator==(const Beam&, const Beam&) = default;
};
/// Struts between nodes, radii everywhere. A superset of the 3MF beam lattice.
struct BeamsBody : Element {
  std::optional<Expression> radius;
  std::optional<Expression>
      node_radius;             ///< absent: no ball; "auto": largest r / sin(theta/2) over the strut pairs of a node
  std::optional<BeamCap> cap;  ///< sphere
  std::vector<BeamNode> nodes;
  std::vector<Beam> beams;
  friend bool operator==(const BeamsBody&, const BeamsBody&) = default;
};

/// The function so far becomes (1 - weight) of it and weight of this one: an expression of x y z or a surface by name.
struct ImplicitBlend : Element {
  std::optional<Expression> field;
  std::optional<std::string> surface;
  Expression weight;  ///< from 0 to 1
  friend bool operator==(const ImplicitBlend&, const ImplicitBlend&) = default;
};

enum class ImplicitKind { endoskeleton, exoskeleton, shell, eccentric_shell };
/// The cell's axes along which its second half is the mirror image of its first.
enum class ImplicitMirror { x, y, z, xy, xz, yz, xyz };
/// An expression of x y z (negative inside) or a surface by name; always cut to the cell's box.
struct ImplicitBody : Element {
  std::optional<Expression> field;
  std::optional<std::string> surface;
  std::optional<ImplicitKind> kind;  ///< endoskeleton
  std::optional<Expression> isovalue, lower, upper, thickness;
  std::optional<Expression> density;  ///< share of the box that the body fills; in place of a level
  std::optional<Expression> wall;     ///< of a shell, a length; in place of thickness, which is a difference of levels
  std::optional<ImplicitMirror> mirror;
  std::vector<ImplicitBlend> blends;
  friend bool operator==(const ImplicitBody&, const ImplicitBody&) = default;
};

/// Another part as a unit cell.
struct PartBody : Element {
  Ref<Part> part;
  friend bool operator==(const PartBody&, const PartBody&) = default;
};

}  // namespace meso
