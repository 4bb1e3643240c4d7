// SPDX-License-Identifier: Apache-2.0
// Volume elements: all P(q) with three coordinates between limits. Straight axes span a parallelepiped; one circular
// axis revolves a plane quadrilateral; two revolve a plane sector. Nothing else has faces that a solid can name.
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <algorithm>
#include <numbers>

#include "solid_primitive.hpp"

namespace meso::brep {
namespace {

using eval::CoordinateAxis;

struct Range {
  CoordinateAxis axis;
  double low = 0, high = 0;
};

struct Element {
  std::vector<Range> straight;  ///< linear and distance axes
  std::vector<Range> circular;  ///< in document order: the first turns last
};

constexpr double angle_tolerance = 1e-9;
constexpr double full_turn = 2 * std::numbers::pi;

bool is_zero(double sine) { return std::fabs(sine) < 1e-9; }

gp_Ax1 axis_of(const Range& range) { return {gp::Origin(), to_dir(range.axis.direction)}; }

TopoDS_Shape revolved(const TopoDS_Shape& profile, const Range& turn) {
  if (turn.high - turn.low > full_turn - angle_tolerance)
    return outward(BRepPrimAPI_MakeRevol(profile, axis_of(turn)).Shape());
  gp_Trsf start;
  start.SetRotation(axis_of(turn), turn.low);
  return outward(
      BRepPrimAPI_MakeRevol(profile.Moved(TopLoc_Location(start)), axis_of(turn), turn.high - turn.low).Shape());
}

/// Corners low-low, high-low, high-high, low-high of the two ranges; equal neighbours merged.
std::vector<Vec3> quadrilateral(const Range& a, const Range& b) {
  std::vector<Vec3> corners;
  for (const auto& [s, t] : {std::pair{a.low, b.low}, {a.high, b.low}, {a.high, b.high}, {a.low, b.high}})
    corners.push_back(s * a.axis.direction + t * b.axis.direction);
  return corners;
}

TopoDS_Shape polygon_face(const std::vector<Vec3>& corners) {
  BRepBuilderAPI_MakePolygon polygon;
  for (const Vec3 p : corners) polygon.Add(to_pnt(p));
  polygon.Close();
  return BRepBuilderAPI_MakeFace(polygon.Wire(), true).Face();
}

/// The sector between two radii and two angles about `turn`'s axis, from the unit direction `zero`.
TopoDS_Shape sector_face(const Range& distance, const Range& turn, Vec3 centre_axis) {
  const Vec3 zero = distance.axis.direction;
  const auto at = [&](double radius, double angle) { return radius * (rotation(centre_axis, angle) * zero); };
  const auto arc = [&](double radius, double from, double to) {
    const gp_Circ circle(gp_Ax2(gp::Origin(), to_dir(centre_axis), to_dir(zero)), radius);
    return BRepBuilderAPI_MakeEdge(circle, from, to).Edge();
  };
  const auto segment = [](Vec3 a, Vec3 b) { return BRepBuilderAPI_MakeEdge(to_pnt(a), to_pnt(b)).Edge(); };
  const double r0 = distance.low, r1 = distance.high, a0 = turn.low, a1 = turn.high;
  BRepBuilderAPI_MakeWire wire(arc(r1, a0, a1));
  if (r0 > smallest_size) {
    wire.Add(segment(at(r1, a1), at(r0, a1)));
    wire.Add(arc(r0, a0, a1));
    wire.Add(segment(at(r0, a0), at(r1, a0)));
  } else if (std::fabs(a1 - a0 - std::numbers::pi) < angle_tolerance) {
    wire.Add(segment(at(r1, a1), at(r1, a0)));  // a half disc: the diameter is one edge
  } else {
    wire.Add(segment(at(r1, a1), {}));
    wire.Add(segment({}, at(r1, a0)));
  }
  return BRepBuilderAPI_MakeFace(wire.Wire(), true).Face();
}

using Fault = std::optional<std::string>;

Fault straight_fault(const Element& element) {
  const auto& s = element.straight;
  const double det = dot(s[0].axis.direction, cross(s[1].axis.direction, s[2].axis.direction));
  if (is_zero(det)) return "has no volume: its axes are not independent";
  return {};
}

Fault revolved_fault(const Element& element) {
  const Vec3 a = element.straight[0].axis.direction, b = element.straight[1].axis.direction;
  const Vec3 turn = element.circular[0].axis.direction;
  if (is_zero(norm(cross(a, b)))) return "has no volume: its straight axes are parallel";
  for (const Range& range : element.straight)
    if (range.axis.kind == AxisKind::linear && !is_zero(norm(cross(range.axis.direction, turn))))
      return "needs a linear axis along its circular axis; others sweep surfaces that are not realised";
  if (!is_zero(dot(turn, cross(a, b))))
    return "needs its straight axes in one plane with the circular axis; others sweep surfaces that are not realised";
  const Vec3 radial = cross(turn, cross(a, b));  // in the profile's plane, across the circular axis
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (const Vec3 corner : quadrilateral(element.straight[0], element.straight[1])) {
    low = std::min(low, dot(corner, radial) / norm(radial));
    high = std::max(high, dot(corner, radial) / norm(radial));
  }
  if (low < -smallest_size && high > smallest_size) return "crosses its circular axis and reaches points twice";
  if (high - low < smallest_size) return "has no volume: it stands on its circular axis";
  return {};
}

Fault twice_revolved_fault(const Element& element) {
  const Range &outer = element.circular[0], &inner = element.circular[1], &distance = element.straight[0];
  if (distance.axis.kind == AxisKind::linear) return "has no volume: circular axes turn distance axes only";
  if (!is_zero(dot(inner.axis.direction, distance.axis.direction)) ||
      !is_zero(dot(inner.axis.direction, outer.axis.direction)))
    return "needs its second circular axis at right angles to the first and to the distance axis; others sweep "
           "surfaces that are not realised";
  // Heights of the profile above the outer axis: of one sign, or points are reached twice.
  const Vec3 radial = cross(inner.axis.direction, outer.axis.direction);
  double low = HUGE_VAL, high = -HUGE_VAL;
  constexpr int samples =
      64;  // a sine with one sign at 65 points of at most one turn has it everywhere but near its zeros
  for (int i = 0; i <= samples; ++i) {
    const double angle = inner.low + (inner.high - inner.low) * i / samples;
    const double height = dot(rotation(inner.axis.direction, angle) * distance.axis.direction, radial);
    low = std::min(low, height);
    high = std::max(high, height);
  }
  if (inner.high - inner.low > std::numbers::pi + angle_tolerance || (low < -1e-9 && high > 1e-9))
    return "crosses its first circular axis and reaches points twice";
  return {};
}

Fault fault_of(const Element& element, std::size_t scalars) {
  if (scalars > 0) return "has a range on a scalar axis, which has no direction";
  for (const auto* ranges : {&element.straight, &element.circular})
    for (const Range& r : *ranges)
      if (!std::isfinite(r.low) || !std::isfinite(r.high) || r.high - r.low <= smallest_size)
        return "has no extent along axis '" + r.axis.name + "'";
  for (const Range& r : element.straight)
    if (r.axis.kind == AxisKind::distance && r.low < -smallest_size)
      return "reaches below 0 along distance axis '" + r.axis.name + "'";
  for (const Range& r : element.circular)
    if (r.high - r.low > full_turn + angle_tolerance) return "turns more than once about axis '" + r.axis.name + "'";
  switch (element.circular.size()) {
    case 0:
      return straight_fault(element);
    case 1:
      return revolved_fault(element);
    case 2:
      return twice_revolved_fault(element);
    default:
      return "has no volume: three circular axes";
  }
}

TopoDS_Shape build(const Element& element, const Affine& map) {
  const auto& [straight, circular] = element;
  if (circular.empty()) {
    std::vector<Vec3> base = quadrilateral(straight[0], straight[1]);
    for (Vec3& p : base) p += straight[2].low * straight[2].axis.direction;
    return prism(base, (straight[2].high - straight[2].low) * straight[2].axis.direction, map);
  }
  const TopoDS_Shape profile = circular.size() == 1 ? polygon_face(quadrilateral(straight[0], straight[1]))
                                                    : sector_face(straight[0], circular[1], circular[1].axis.direction);
  return mapped(revolved(profile, circular[0]), map);
}

}  // namespace

OptionalSolid primitive_solid(const eval::VolumeElementShape& shape, const Affine& map, ElementId where,
                              const SolidContext& context) {
  Element element;
  std::size_t scalars = 0;
  std::vector<std::size_t> order{0, 1, 2};
  std::ranges::sort(order, {}, [&](std::size_t i) { return shape.axes[i]; });
  for (const std::size_t i : order) {
    const Range range{shape.system->axes()[shape.axes[i]], std::min(shape.from[i], shape.to[i]),
                      std::max(shape.from[i], shape.to[i])};
    switch (range.axis.kind) {
      case AxisKind::linear:
      case AxisKind::distance:
        element.straight.push_back(range);
        break;
      case AxisKind::circular:
        element.circular.push_back(range);
        break;
      case AxisKind::scalar:
        ++scalars;
        break;
    }
  }
  if (const Fault fault = fault_of(element, scalars)) {
    const bool only_not_realised = fault->find("not realised") != std::string::npos;
    if (only_not_realised)
      context.report(Code::brep_not_realised, where, {"a volume element that " + *fault});
    else
      context.report(Code::geometry_volume_element, where, {*fault});
    return {};
  }
  return build(element, map * shape.system->world_from_system());
}

}  // namespace meso::brep
