// SPDX-License-Identifier: Apache-2.0
#include "solid_primitive.hpp"

#include <BRepBuilderAPI_MakeVertex.hxx>
#include <algorithm>
#include <initializer_list>
#include <string_view>

#include "boolean.hpp"
#include "ellipsoid.hpp"
#include "meso/base/number.hpp"

namespace meso::brep {
namespace {

struct NamedSize {
  std::string_view name;
  double value;
};

bool all_near(std::initializer_list<Vec3> points) {
  return std::ranges::all_of(points, [](Vec3 p) { return norm(p) < largest_size; });
}

bool sizes_hold(std::initializer_list<NamedSize> sizes, ElementId where, const SolidContext& context) {
  for (const auto& [name, value] : sizes) {
    if (value > smallest_size && value < largest_size) continue;
    context.report(Code::geometry_size, where, {std::string(name), format_number(value)});
    return false;
  }
  return true;
}

bool positions_hold(std::initializer_list<Vec3> points, ElementId where, const SolidContext& context) {
  if (all_near(points)) return true;
  context.report(Code::geometry_size, where, {"a distance from the origin", "more, or not a number"});
  return false;
}

struct Point2 {
  double x, y;
};

double turn(Point2 a, Point2 b, Point2 c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

bool on_segment(Point2 a, Point2 b, Point2 p) {
  return std::min(a.x, b.x) <= p.x && p.x <= std::max(a.x, b.x) && std::min(a.y, b.y) <= p.y &&
         p.y <= std::max(a.y, b.y);
}

bool segments_meet(Point2 a, Point2 b, Point2 c, Point2 d) {
  const double abc = turn(a, b, c), abd = turn(a, b, d), cda = turn(c, d, a), cdb = turn(c, d, b);
  if (((abc > 0 && abd < 0) || (abc < 0 && abd > 0)) && ((cda > 0 && cdb < 0) || (cda < 0 && cdb > 0))) return true;
  return (abc == 0 && on_segment(a, b, c)) || (abd == 0 && on_segment(a, b, d)) || (cda == 0 && on_segment(c, d, a)) ||
         (cdb == 0 && on_segment(c, d, b));
}

/// What is wrong with a polygon, or nothing.
std::optional<std::string> polygon_fault(const std::vector<Point2>& p) {
  const std::size_t n = p.size();
  if (n < 3) return "needs at least three points";
  double area = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Point2 a = p[i], b = p[(i + 1) % n], c = p[(i + 2) % n];
    if (!std::isfinite(a.x) || !std::isfinite(a.y)) return "has a point that is not finite";
    if (std::hypot(b.x - a.x, b.y - a.y) <= smallest_size)
      return "has two neighbouring points that coincide (point " + std::to_string(i + 1) + ")";
    if (turn(a, b, c) == 0 && (b.x - a.x) * (c.x - b.x) + (b.y - a.y) * (c.y - b.y) < 0)
      return "turns back on itself at point " + std::to_string((i + 1) % n + 1);
    area += a.x * b.y - a.y * b.x;
  }
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 2; j < n; ++j) {
      if (i == 0 && j == n - 1) continue;  // neighbours around the end
      if (segments_meet(p[i], p[i + 1], p[j], p[(j + 1) % n]))
        return "crosses or touches itself (edges " + std::to_string(i + 1) + " and " + std::to_string(j + 1) + ")";
    }
  if (std::fabs(area) / 2 <= smallest_size * smallest_size) return "encloses no area";
  return {};
}

TopoDS_Shape unit_sphere() { return BRepPrimAPI_MakeSphere(gp_Ax2(gp::Origin(), gp::DZ()), 1).Solid(); }

gp_Trsf to_trsf(const Affine& a) {
  gp_Trsf t;
  const auto& m = a.linear.m;
  t.SetValues(m[0], m[1], m[2], a.translation.x, m[3], m[4], m[5], a.translation.y, m[6], m[7], m[8], a.translation.z);
  return t;
}

}  // namespace

bool is_similarity(const Affine& map) {
  const Mat3 gram = transposed(map.linear) * map.linear;
  const double scale2 = std::cbrt(determinant(gram));
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c)
      if (std::fabs(gram(r, c) - (r == c ? scale2 : 0)) > 1e-12 * scale2) return false;
  return true;
}

TopoDS_Shape outward(const TopoDS_Shape& solid) { return volume_of(solid) < 0 ? solid.Reversed() : solid; }

TopoDS_Shape mapped(const TopoDS_Shape& solid, const Affine& map) {
  if (map == Affine{}) return solid;
  if (is_similarity(map)) {
    const gp_Trsf t = to_trsf(map);
    const bool rigid = std::fabs(t.ScaleFactor() - 1) < 1e-12;
    if (rigid) {
      gp_Trsf exact = t;
      exact.SetScaleFactor(1);  // a location must not scale, not by rounding either
      return solid.Moved(TopLoc_Location(exact));
    }
    return outward(BRepBuilderAPI_Transform(solid, t, true).Shape());
  }
  gp_GTrsf t;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c)
      t.SetValue(r + 1, c + 1, map.linear(static_cast<std::size_t>(r), static_cast<std::size_t>(c)));
    t.SetValue(r + 1, 4, map.translation[static_cast<std::size_t>(r)]);
  }
  return outward(BRepBuilderAPI_GTransform(solid, t, true).Shape());
}

TopoDS_Shape prism(const std::vector<Vec3>& polygon, Vec3 sweep, const Affine& map) {
  std::vector<TopoDS_Vertex> vertices;
  vertices.reserve(polygon.size());
  for (const Vec3 p : polygon) vertices.push_back(BRepBuilderAPI_MakeVertex(to_pnt(map * p)));
  BRepBuilderAPI_MakeWire wire;
  for (std::size_t i = 0; i < vertices.size(); ++i)
    wire.Add(BRepBuilderAPI_MakeEdge(vertices[i], vertices[(i + 1) % vertices.size()]).Edge());
  const TopoDS_Face face = BRepBuilderAPI_MakeFace(wire.Wire(), true).Face();
  const Vec3 s = map.linear * sweep;
  return outward(BRepPrimAPI_MakePrism(face, gp_Vec(s.x, s.y, s.z)).Shape());
}

TopoDS_Shape frustum(Vec3 from, Vec3 to, double radius_from, double radius_to) {
  const double length = norm(to - from);
  const gp_Ax2 frame(to_pnt(from), to_dir((to - from) / length));
  if (std::fabs(radius_from - radius_to) <= 1e-9 * length)
    return BRepPrimAPI_MakeCylinder(frame, radius_from, length).Solid();
  return BRepPrimAPI_MakeCone(frame, radius_from, radius_to, length).Solid();
}

OptionalSolid primitive_solid(const eval::BoxShape& box, const Affine& map, ElementId where,
                              const SolidContext& context) {
  const Vec3 c = box.corner, s = box.size;
  if (!positions_hold({c}, where, context) || !sizes_hold({{"dx", s.x}, {"dy", s.y}, {"dz", s.z}}, where, context))
    return {};
  return prism({c, c + Vec3{s.x, 0, 0}, c + Vec3{s.x, s.y, 0}, c + Vec3{0, s.y, 0}}, {0, 0, s.z}, map);
}

OptionalSolid primitive_solid(const eval::SphereShape& sphere, const Affine& map, ElementId where,
                              const SolidContext& context) {
  if (!positions_hold({sphere.center}, where, context) || !sizes_hold({{"radius", sphere.radius}}, where, context))
    return {};
  if (is_similarity(map)) return mapped(BRepPrimAPI_MakeSphere(to_pnt(sphere.center), sphere.radius).Solid(), map);
  const double r = sphere.radius;
  return ellipsoid_solid(map * Affine{Mat3::from_columns({r, 0, 0}, {0, r, 0}, {0, 0, r}), sphere.center});
}

OptionalSolid primitive_solid(const eval::EllipsoidShape& ellipsoid, const Affine& map, ElementId where,
                              const SolidContext& context) {
  const Vec3 r = ellipsoid.radii;
  if (!positions_hold({ellipsoid.center}, where, context) ||
      !sizes_hold({{"rx", r.x}, {"ry", r.y}, {"rz", r.z}}, where, context))
    return {};
  const Affine stretch{Mat3::from_columns({r.x, 0, 0}, {0, r.y, 0}, {0, 0, r.z}), ellipsoid.center};
  const Affine whole = map * stretch;
  return is_similarity(whole) ? mapped(unit_sphere(), whole) : ellipsoid_solid(whole);
}

OptionalSolid primitive_solid(const eval::CylinderShape& cylinder, const Affine& map, ElementId where,
                              const SolidContext& context) {
  if (!positions_hold({cylinder.from, cylinder.to}, where, context) ||
      !sizes_hold({{"radius", cylinder.radius}, {"the height", norm(cylinder.to - cylinder.from)}}, where, context))
    return {};
  return mapped(frustum(cylinder.from, cylinder.to, cylinder.radius, cylinder.radius), map);
}

OptionalSolid primitive_solid(const eval::ConeShape& cone, const Affine& map, ElementId where,
                              const SolidContext& context) {
  const double small = std::min(cone.radius_from, cone.radius_to), large = std::max(cone.radius_from, cone.radius_to);
  if (!positions_hold({cone.from, cone.to}, where, context) ||
      !sizes_hold({{"the larger radius", large}, {"the height", norm(cone.to - cone.from)}}, where, context))
    return {};
  if (small != 0 && !sizes_hold({{"the smaller radius, unless it is 0,", small}}, where, context)) return {};
  return mapped(frustum(cone.from, cone.to, cone.radius_from, cone.radius_to), map);
}

OptionalSolid primitive_solid(const eval::TorusShape& torus, const Affine& map, ElementId where,
                              const SolidContext& context) {
  const double length = norm(torus.axis);
  if (!positions_hold({torus.center, torus.axis}, where, context) ||
      !sizes_hold({{"minorRadius", torus.minor_radius},
                   {"the length of the axis", length},
                   {"majorRadius minus minorRadius", torus.major_radius - torus.minor_radius}},
                  where, context))
    return {};
  const gp_Ax2 frame(to_pnt(torus.center), to_dir(torus.axis / length));
  return mapped(BRepPrimAPI_MakeTorus(frame, torus.major_radius, torus.minor_radius).Solid(), map);
}

OptionalSolid primitive_solid(const eval::ExtrusionShape& extrusion, const Affine& map, ElementId where,
                              const SolidContext& context) {
  if (!positions_hold({{0, 0, extrusion.z}}, where, context) ||
      !sizes_hold({{"height", extrusion.height}}, where, context))
    return {};
  std::vector<Point2> points;
  std::vector<Vec3> polygon;
  for (const auto& [x, y] : extrusion.points) {
    points.push_back({x, y});
    polygon.push_back({x, y, extrusion.z});
  }
  if (const auto fault = polygon_fault(points)) {
    context.report(Code::geometry_profile, where, {*fault});
    return {};
  }
  return prism(polygon, {0, 0, extrusion.height}, map);
}

}  // namespace meso::brep
