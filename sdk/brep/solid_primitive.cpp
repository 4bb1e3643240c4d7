// SPDX-License-Identifier: Apache-2.0
#include "solid_primitive.hpp"

#include <BRepBuilderAPI_MakeVertex.hxx>
#include <algorithm>
#include <initializer_list>
#include <string_view>

#include "boolean.hpp"
#include "ellipsoid.hpp"
#include "meso/base/number.hpp"
#include "meso/base/polygon.hpp"

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

TopoDS_Shape unit_sphere() { return BRepPrimAPI_MakeSphere(gp_Ax2(gp::Origin(), gp::DZ()), 1).Solid(); }

TopoDS_Face plane_face(const std::vector<Vec3>& polygon) {
  std::vector<TopoDS_Vertex> vertices;
  vertices.reserve(polygon.size());
  for (const Vec3 p : polygon) vertices.push_back(BRepBuilderAPI_MakeVertex(to_pnt(p)));
  BRepBuilderAPI_MakeWire wire;
  for (std::size_t i = 0; i < vertices.size(); ++i)
    wire.Add(BRepBuilderAPI_MakeEdge(vertices[i], vertices[(i + 1) % vertices.size()]).Edge());
  return BRepBuilderAPI_MakeFace(wire.Wire(), true).Face();
}

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
  std::vector<Vec3> corners;
  for (const Vec3 p : polygon) corners.push_back(map * p);
  const Vec3 s = map.linear * sweep;
  return outward(BRepPrimAPI_MakePrism(plane_face(corners), gp_Vec(s.x, s.y, s.z)).Shape());
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
  std::vector<Vec3> polygon;
  for (const auto& [x, y] : extrusion.points) polygon.push_back({x, y, extrusion.z});
  if (const auto fault = polygon_fault(extrusion.points, smallest_size)) {
    context.report(Code::geometry_profile, where, {*fault});
    return {};
  }
  return prism(polygon, {0, 0, extrusion.height}, map);
}

OptionalSolid primitive_solid(const eval::RevolutionShape& revolution, const Affine& map, ElementId where,
                              const SolidContext& context) {
  std::vector<Vec3> polygon;
  for (const auto& [r, z] : revolution.points) {
    if (!positions_hold({{r, 0, z}}, where, context)) return {};
    if (r != 0 && !sizes_hold({{"a distance from the axis, unless it is 0,", r}}, where, context)) return {};
    polygon.push_back({r, 0, z});
  }
  if (const auto fault = polygon_fault(revolution.points, smallest_size)) {
    context.report(Code::geometry_profile, where, {*fault});
    return {};
  }
  return mapped(outward(BRepPrimAPI_MakeRevol(plane_face(polygon), gp_Ax1(gp::Origin(), gp::DZ())).Shape()), map);
}

}  // namespace meso::brep
