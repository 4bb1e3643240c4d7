// SPDX-License-Identifier: Apache-2.0
#include "geometry_values.hpp"

#include <Precision.hxx>

namespace meso::brep {
namespace {

AxisFrame to_frame(const gp_Ax3& axes) {
  return {to_vec(axes.Location()), to_vec(axes.Direction()), to_vec(axes.XDirection())};
}
AxisFrame to_frame(const gp_Ax2& axes) {
  return {to_vec(axes.Location()), to_vec(axes.Direction()), to_vec(axes.XDirection())};
}

// A negative angle opens downwards: the same cone seen along -z.
ConeSurface to_cone(const gp_Cone& cone) {
  ConeSurface value{to_frame(cone.Position()), cone.RefRadius(), cone.SemiAngle()};
  if (value.half_angle < 0) {
    value.half_angle = -value.half_angle;
    value.frame.z = -value.frame.z;
  }
  return value;
}

template <typename Array>
std::vector<double> to_doubles(const Array& array) {
  return {array.begin(), array.end()};
}
template <typename Array>
std::vector<int> to_ints(const Array& array) {
  return {array.begin(), array.end()};
}

BSplineSurface to_bspline(const Handle(Geom_BSplineSurface) & spline) {
  BSplineSurface value;
  value.u_degree = spline->UDegree();
  value.v_degree = spline->VDegree();
  value.u_closed = spline->IsUClosed();
  value.v_closed = spline->IsVClosed();
  value.u_count = static_cast<std::size_t>(spline->NbUPoles());
  value.v_count = static_cast<std::size_t>(spline->NbVPoles());
  const bool rational = spline->IsURational() || spline->IsVRational();
  for (int i = 1; i <= spline->NbUPoles(); ++i)
    for (int j = 1; j <= spline->NbVPoles(); ++j) {
      value.poles.push_back(to_vec(spline->Pole(i, j)));
      if (rational) value.weights.push_back(spline->Weight(i, j));
    }
  value.u_knots = to_doubles(spline->UKnots());
  value.v_knots = to_doubles(spline->VKnots());
  value.u_multiplicities = to_ints(spline->UMultiplicities());
  value.v_multiplicities = to_ints(spline->VMultiplicities());
  return value;
}

BSplineSurface to_bspline(const Handle(Geom_Surface) & surface, const UvBounds& bounds) {
  Handle(Geom_BSplineSurface) spline = Handle(Geom_BSplineSurface)::DownCast(surface);
  if (spline.IsNull())
    spline = GeomConvert::SurfaceToBSplineSurface(
        new Geom_RectangularTrimmedSurface(surface, bounds.u_min, bounds.u_max, bounds.v_min, bounds.v_max));
  spline = Handle(Geom_BSplineSurface)::DownCast(spline->Copy());
  // Readers differ on periodic knot vectors; clamped ones mean the same to all.
  if (spline->IsUPeriodic()) spline->SetUNotPeriodic();
  if (spline->IsVPeriodic()) spline->SetVNotPeriodic();
  if (spline->UMultiplicity(1) <= spline->UDegree() || spline->VMultiplicity(1) <= spline->VDegree()) {
    UvBounds all;
    spline->Bounds(all.u_min, all.u_max, all.v_min, all.v_max);
    spline->Segment(all.u_min, all.u_max, all.v_min, all.v_max);
  }
  return to_bspline(spline);
}

BSplineCurve to_bspline(const Handle(Geom_Curve) & curve, double first, double last) {
  Handle(Geom_BSplineCurve) spline = Handle(Geom_BSplineCurve)::DownCast(curve);
  if (spline.IsNull()) {
    spline = GeomConvert::CurveToBSplineCurve(new Geom_TrimmedCurve(curve, first, last));
  } else {
    spline = Handle(Geom_BSplineCurve)::DownCast(spline->Copy());
    const bool whole = std::abs(spline->FirstParameter() - first) <= Precision::PConfusion() &&
                       std::abs(spline->LastParameter() - last) <= Precision::PConfusion();
    if (!whole) spline->Segment(first, last);
  }
  if (spline->IsPeriodic()) spline->SetNotPeriodic();
  // What was periodic goes on beyond its first and last parameter; a value's curve ends at its first and last knot.
  if (spline->Multiplicity(1) <= spline->Degree()) spline->Segment(spline->FirstParameter(), spline->LastParameter());
  BSplineCurve value;
  value.degree = spline->Degree();
  value.closed = spline->IsClosed();
  for (int i = 1; i <= spline->NbPoles(); ++i) {
    value.poles.push_back(to_vec(spline->Pole(i)));
    if (spline->IsRational()) value.weights.push_back(spline->Weight(i));
  }
  value.knots = to_doubles(spline->Knots());
  value.multiplicities = to_ints(spline->Multiplicities());
  return value;
}

}  // namespace

SurfaceValue to_surface(const Handle(Geom_Surface) & surface, const UvBounds& bounds) {
  if (const auto trimmed = Handle(Geom_RectangularTrimmedSurface)::DownCast(surface); !trimmed.IsNull())
    return to_surface(trimmed->BasisSurface(), bounds);
  if (const auto plane = Handle(Geom_Plane)::DownCast(surface); !plane.IsNull())
    return {Plane{to_frame(plane->Position())}, !plane->Position().Direct()};
  if (const auto cylinder = Handle(Geom_CylindricalSurface)::DownCast(surface); !cylinder.IsNull())
    return {CylinderSurface{to_frame(cylinder->Position()), cylinder->Radius()}, !cylinder->Position().Direct()};
  if (const auto cone = Handle(Geom_ConicalSurface)::DownCast(surface); !cone.IsNull()) {
    // Beyond the apex the radius is negative and the normal turns over: left to the B-spline.
    const double v_middle = (bounds.v_min + bounds.v_max) / 2;
    if (cone->RefRadius() + v_middle * std::sin(cone->SemiAngle()) > 0)
      return {to_cone(cone->Cone()), !cone->Position().Direct()};
  }
  if (const auto sphere = Handle(Geom_SphericalSurface)::DownCast(surface); !sphere.IsNull())
    return {SphereSurface{to_frame(sphere->Position()), sphere->Radius()}, !sphere->Position().Direct()};
  if (const auto torus = Handle(Geom_ToroidalSurface)::DownCast(surface); !torus.IsNull())
    return {TorusSurface{to_frame(torus->Position()), torus->MajorRadius(), torus->MinorRadius()},
            !torus->Position().Direct()};
  return {to_bspline(surface, bounds), false};
}

Curve to_curve(const Handle(Geom_Curve) & curve, double first, double last) {
  if (const auto trimmed = Handle(Geom_TrimmedCurve)::DownCast(curve); !trimmed.IsNull())
    return to_curve(trimmed->BasisCurve(), first, last);
  if (const auto line = Handle(Geom_Line)::DownCast(curve); !line.IsNull())
    return Line{to_vec(line->Position().Location()), to_vec(line->Position().Direction())};
  if (const auto circle = Handle(Geom_Circle)::DownCast(curve); !circle.IsNull())
    return Circle{to_frame(circle->Position()), circle->Radius()};
  if (const auto ellipse = Handle(Geom_Ellipse)::DownCast(curve); !ellipse.IsNull())
    return Ellipse{to_frame(ellipse->Position()), ellipse->MajorRadius(), ellipse->MinorRadius()};
  return to_bspline(curve, first, last);
}

}  // namespace meso::brep
