// SPDX-License-Identifier: Apache-2.0
#include "elementary_faces.hpp"

#include <Adaptor3d_CurveOnSurface.hxx>
#include <BRep_CurveRepresentation.hxx>
#include <BRep_TEdge.hxx>
#include <Geom2dAdaptor_Curve.hxx>
#include <Geom2d_Line.hxx>
#include <Geom_SurfaceOfLinearExtrusion.hxx>
#include <Geom_SurfaceOfRevolution.hxx>
#include <TopTools_MapOfShape.hxx>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace meso::brep {
namespace {

constexpr double same_direction = 1e-9;
constexpr double same_area = 1e-4;  // areas of swept surfaces are integrated to 1e-6 or so
constexpr double turn = 2 * std::numbers::pi;

/// Points of a swept surface that belong to a face: v goes along the swept line or circle of a revolution, and along
/// the direction of an extrusion.
struct Window {
  double u_min, u_max, v_min, v_max;
};

/// The point (u, v) of the swept surface is the point (u, sign v) moved by `shift` of this one.
struct Elementary {
  Handle(Geom_Surface) surface;
  double sign = 1;
  gp_Vec2d shift{0, 0};

  [[nodiscard]] gp_Pnt2d parameters(double u, double v) const { return {u + shift.X(), sign * v + shift.Y()}; }
  [[nodiscard]] gp_Trsf2d motion() const {
    gp_Trsf2d mirrored, moved;
    if (sign < 0) mirrored.SetMirror(gp_Ax2d(gp_Pnt2d(0, 0), gp_Dir2d(1, 0)));
    moved.SetTranslation(shift);
    return moved * mirrored;
  }
};

/// Of a surface of revolution: x away from the axis, towards the middle of the meridian, and z along the axis.
struct Meridian {
  gp_Ax3 frame;
  double x, z;  ///< of the middle

  [[nodiscard]] double across(gp_Vec v) const { return v.Dot(gp_Vec(frame.XDirection())); }
  [[nodiscard]] double along(gp_Vec v) const { return v.Dot(gp_Vec(frame.Direction())); }
  [[nodiscard]] gp_Ax3 frame_at(double height) const { return frame.Translated(height * gp_Vec(frame.Direction())); }
};

Elementary shifted(Handle(Geom_Surface) surface, double sign, double v_shift) {
  return {std::move(surface), sign, {0, v_shift}};
}

std::optional<Elementary> of_line(const gp_Lin& line, const Meridian& m, double v_middle) {
  const double dx = m.across(line.Direction()), dz = m.along(line.Direction());
  const double sign = dz < 0 ? -1 : 1;
  if (std::fabs(dz) < same_direction) return {};  // a plane
  const double shift = -sign * v_middle;
  if (std::fabs(dx) < same_direction) return shifted(new Geom_CylindricalSurface(m.frame_at(m.z), m.x), sign, shift);
  return shifted(new Geom_ConicalSurface(m.frame_at(m.z), std::atan2(sign * dx, sign * dz), m.x), sign, shift);
}

std::optional<Elementary> of_circle(const gp_Circ& circle, const Meridian& m, double v_middle, double tolerance) {
  const gp_Vec centre(m.frame.Location(), circle.Location());
  const gp_Vec a(circle.XAxis().Direction()), b(circle.YAxis().Direction());
  const double start = std::atan2(m.along(a), m.across(a));
  const double sign = std::cos(start) * m.along(b) - std::sin(start) * m.across(b) < 0 ? -1 : 1;
  const gp_Ax3 frame = m.frame_at(m.along(centre));
  const double x = m.across(centre), r = circle.Radius();
  // Latitudes of the face, which is on the side of x, around 0.
  const double middle = start + sign * v_middle;
  const double shift = start - turn * std::nearbyint(middle / turn);
  if (std::fabs(x) <= tolerance) return shifted(new Geom_SphericalSurface(frame, r), sign, shift);
  if (x > r + tolerance) return shifted(new Geom_ToroidalSurface(frame, x, r), sign, shift);
  return {};
}

/// The curve itself, as far as it is trimmed only.
Handle(Geom_Curve) whole(Handle(Geom_Curve) curve) {
  while (const auto trimmed = Handle(Geom_TrimmedCurve)::DownCast(curve)) curve = trimmed->BasisCurve();
  return curve;
}

std::optional<Elementary> of_revolution(const Geom_SurfaceOfRevolution& swept, const Window& w, double tolerance) {
  const gp_Ax1 axis = swept.Axis();
  const double v_middle = (w.v_min + w.v_max) / 2;
  const gp_Vec to_middle(axis.Location(), swept.BasisCurve()->Value(v_middle));
  const double z = to_middle.Dot(gp_Vec(axis.Direction()));
  const gp_Vec away = to_middle - z * gp_Vec(axis.Direction());
  if (away.Magnitude() <= tolerance) return {};
  const Meridian m{gp_Ax3(axis.Location(), axis.Direction(), gp_Dir(away)), away.Magnitude(), z};
  const Handle(Geom_Curve) curve = whole(swept.BasisCurve());
  if (const auto line = Handle(Geom_Line)::DownCast(curve)) return of_line(line->Lin(), m, v_middle);
  if (const auto circle = Handle(Geom_Circle)::DownCast(curve))
    return of_circle(circle->Circ(), m, v_middle, tolerance);
  return {};
}

std::optional<Elementary> of_extrusion(const Geom_SurfaceOfLinearExtrusion& swept) {
  const auto circle = Handle(Geom_Circle)::DownCast(whole(swept.BasisCurve()));
  if (circle.IsNull()) return {};
  const gp_Ax3 frame(circle->Position());
  const double cosine = swept.Direction().Dot(frame.Direction());
  if (std::fabs(cosine) < 1 - same_direction) return {};
  return shifted(new Geom_CylindricalSurface(frame, circle->Radius()), cosine < 0 ? -1 : 1, 0);
}

/// Whether all of the face is where it was.
bool is_same(const Geom_Surface& swept, const Elementary& found, const Window& w, double tolerance) {
  constexpr int steps = 8;
  for (int i = 0; i <= steps; ++i)
    for (int k = 0; k <= steps; ++k) {
      const double u = w.u_min + (w.u_max - w.u_min) * i / steps, v = w.v_min + (w.v_max - w.v_min) * k / steps;
      const gp_Pnt2d p = found.parameters(u, v);
      if (swept.Value(u, v).Distance(found.surface->Value(p.X(), p.Y())) > tolerance) return false;
    }
  return true;
}

std::optional<Elementary> elementary(Handle(Geom_Surface) surface, const Window& w, double tolerance) {
  while (const auto trimmed = Handle(Geom_RectangularTrimmedSurface)::DownCast(surface))
    surface = trimmed->BasisSurface();
  std::optional<Elementary> found;
  if (const auto revolution = Handle(Geom_SurfaceOfRevolution)::DownCast(surface))
    found = of_revolution(*revolution, w, tolerance);
  else if (const auto extrusion = Handle(Geom_SurfaceOfLinearExtrusion)::DownCast(surface))
    found = of_extrusion(*extrusion);
  if (!found || !is_same(*surface, *found, w, tolerance)) return {};
  // Angles from 0.
  const auto whole_turns = [](double from) { return turn * std::floor(from / turn + 1e-9); };
  double v_shift = found->shift.Y();
  if (!Handle(Geom_ToroidalSurface)::DownCast(found->surface).IsNull())
    v_shift -= whole_turns(std::min(found->parameters(0, w.v_min).Y(), found->parameters(0, w.v_max).Y()));
  found->shift = {-whole_turns(w.u_min), v_shift};
  return found;
}

double area_of(const TopoDS_Face& face) {
  GProp_GProps properties;
  BRepGProp::SurfaceProperties(face, properties);
  return properties.Mass();
}

/// The curves of an edge in the parameters of a face: two if the face closes there.
struct FaceCurves {
  std::array<Handle(Geom2d_Curve), 2> curves;  ///< as the edge is used forward and backward
  double first = 0, last = 0;
  bool closes = false;
};

FaceCurves curves_of(const TopoDS_Edge& edge, const TopoDS_Face& face) {
  FaceCurves out;
  out.closes = BRep_Tool::IsClosed(edge, face);
  const TopoDS_Edge forward = TopoDS::Edge(edge.Oriented(TopAbs_FORWARD));
  out.curves[0] = BRep_Tool::CurveOnSurface(forward, face, out.first, out.last);
  if (out.closes)
    out.curves[1] = BRep_Tool::CurveOnSurface(TopoDS::Edge(forward.Reversed()), face, out.first, out.last);
  return out;
}

/// A line along one parameter that bends off by rounding is exactly so.
Handle(Geom2d_Curve) straightened(const Handle(Geom2d_Curve) & curve, double first, double last) {
  const auto line = Handle(Geom2d_Line)::DownCast(curve);
  if (line.IsNull()) return curve;
  const gp_Dir2d d = line->Direction();
  const gp_Pnt2d middle = line->Value((first + last) / 2);
  const bool along_u = std::fabs(d.Y()) * (last - first) < same_direction,
             along_v = std::fabs(d.X()) * (last - first) < same_direction;
  if (!along_u && !along_v) return curve;
  const gp_Dir2d exact = along_u ? gp_Dir2d(d.X() < 0 ? -1 : 1, 0) : gp_Dir2d(0, d.Y() < 0 ? -1 : 1);
  return new Geom2d_Line(middle.Translated(-(first + last) / 2 * gp_Vec2d(exact)), exact);
}

/// The line or circle that the edge is on the surface, if its own curve only comes near that.
Handle(Geom_Curve) exact_curve(const TopoDS_Edge& edge, const FaceCurves& on, const Elementary& surface) {
  if (BRep_Tool::Degenerated(edge)) return {};
  TopLoc_Location unused;
  double first = 0, last = 0;
  const Handle(Geom_Curve) own = BRep_Tool::Curve(edge, unused, first, last);
  if (own.IsNull() || Handle(Geom_BSplineCurve)::DownCast(own).IsNull() || first != on.first || last != on.last)
    return {};
  const Adaptor3d_CurveOnSurface curve(new Geom2dAdaptor_Curve(on.curves[0], first, last),
                                       new GeomAdaptor_Surface(surface.surface));
  Handle(Geom_Curve) exact;
  if (curve.GetType() == GeomAbs_Circle) exact = new Geom_Circle(curve.Circle());
  if (curve.GetType() == GeomAbs_Line) exact = new Geom_Line(curve.Line());
  constexpr int steps = 16;
  for (int i = 0; i <= steps && !exact.IsNull(); ++i) {
    const double t = first + (last - first) * i / steps;
    if (own->Value(t).Distance(exact->Value(t)) > 2 * BRep_Tool::Tolerance(edge)) exact.Nullify();
  }
  return exact;
}

bool is_of_one_face(const TopoDS_Edge& edge) {
  int faces = 0;
  for (const auto& curve : Handle(BRep_TEdge)::DownCast(edge.TShape())->Curves()) faces += curve->IsCurveOnSurface();
  return faces == 1;
}

void put_on(const TopoDS_Edge& edge, FaceCurves from, const Elementary& to, const TopLoc_Location& location) {
  const BRep_Builder builder;
  for (Handle(Geom2d_Curve) & curve : from.curves)
    if (!curve.IsNull())
      curve = straightened(Handle(Geom2d_Curve)::DownCast(curve->Transformed(to.motion())), from.first, from.last);
  if (const auto exact = exact_curve(edge, from, to); !exact.IsNull()) {
    builder.UpdateEdge(edge, exact, location, Precision::Confusion());
    if (is_of_one_face(edge)) Handle(BRep_TEdge)::DownCast(edge.TShape())->Tolerance(Precision::Confusion());
  }
  if (to.sign < 0) std::swap(from.curves[0], from.curves[from.closes ? 1 : 0]);  // loops are run backwards there
  if (from.closes)
    builder.UpdateEdge(edge, from.curves[0], from.curves[1], to.surface, location, BRep_Tool::Tolerance(edge));
  else
    builder.UpdateEdge(edge, from.curves[0], to.surface, location, BRep_Tool::Tolerance(edge));
  builder.Range(edge, to.surface, location, from.first, from.last);
}

/// Both without a place of their own, the face forward. Null if an edge has no curve in the face.
TopoDS_Face put_on(const TopoDS_Face& face, const Elementary& to, const TopLoc_Location& location) {
  TopTools_MapOfShape done;
  for (TopExp_Explorer it(face, TopAbs_EDGE); it.More(); it.Next())
    if (curves_of(TopoDS::Edge(it.Current()), face).curves[0].IsNull()) return {};
  for (TopExp_Explorer it(face, TopAbs_EDGE); it.More(); it.Next())
    if (const TopoDS_Edge edge = TopoDS::Edge(it.Current()); done.Add(edge.Oriented(TopAbs_FORWARD)))
      put_on(edge, curves_of(edge, face), to, location);
  const BRep_Builder builder;
  TopoDS_Face out;
  builder.MakeFace(out, to.surface, location, BRep_Tool::Tolerance(face));
  for (TopoDS_Iterator wire(face); wire.More(); wire.Next())
    builder.Add(out, to.sign < 0 ? wire.Value().Reversed() : wire.Value());
  if (to.sign < 0) out.Reverse();
  return out;
}

TopoDS_Shape with_elementary_surface(const TopoDS_Face& placed) {
  const TopoDS_Face face = TopoDS::Face(placed.Located(TopLoc_Location()).Oriented(TopAbs_FORWARD));
  TopLoc_Location location;
  const Handle(Geom_Surface) surface = BRep_Tool::Surface(face, location);
  if (surface.IsNull()) return placed;
  Window w{};
  BRepTools::UVBounds(face, w.u_min, w.u_max, w.v_min, w.v_max);
  const auto found = elementary(surface, w, Precision::Confusion());
  if (!found) return placed;
  TopoDS_Face out = put_on(face, *found, location);
  const double area = area_of(face);
  if (out.IsNull() || std::fabs(area_of(out) - area) > same_area * std::fabs(area)) return placed;
  out.Location(placed.Location());
  if (placed.Orientation() == TopAbs_REVERSED) out.Reverse();
  return out;
}

}  // namespace

TopoDS_Shape with_elementary_faces(const TopoDS_Shape& shape) {
  if (shape.ShapeType() == TopAbs_FACE) return with_elementary_surface(TopoDS::Face(shape));
  if (shape.ShapeType() > TopAbs_FACE) return shape;
  const BRep_Builder builder;
  TopoDS_Shape out = shape.EmptyCopied();
  out.Location(TopLoc_Location());
  out.Orientation(TopAbs_FORWARD);
  for (TopoDS_Iterator part(shape, false, false); part.More(); part.Next())
    builder.Add(out, with_elementary_faces(part.Value()));
  out.Closed(shape.Closed());
  out.Location(shape.Location());
  out.Orientation(shape.Orientation());
  return out;
}

}  // namespace meso::brep
