// SPDX-License-Identifier: Apache-2.0
#include "face_moments.hpp"

#include <BRepTopAdaptor_FClass2d.hxx>
#include <BndLib_Add3dCurve.hxx>
#include <Geom2dAdaptor_Curve.hxx>
#include <Geom2d_Curve.hxx>
#include <GeomAdaptor_Curve.hxx>
#include <algorithm>
#include <numbers>
#include <optional>

#include "ellipsoid.hpp"
#include "u_integral.hpp"

namespace meso::brep {
namespace {

/// Where an edge runs in the parameters of a face. Of planes, quadrics and tori it is the curve in space that tells,
/// the pcurve only which turn around the axis is meant: pcurves that OpenCASCADE's reader has made are approximations,
/// and those of two faces that share an edge leave a gap between them. Of other surfaces it is the pcurve.
class EdgeOnSurface {
 public:
  EdgeOnSurface(const TopoDS_Edge& edge, const TopoDS_Face& forward, const GeomAdaptor_Surface& surface)
      : type_(surface.GetType()) {
    double first = 0, last = 0;
    const Handle(Geom2d_Curve) pcurve = BRep_Tool::CurveOnSurface(edge, forward, first, last);
    if (pcurve.IsNull()) return;
    pcurve_.Load(pcurve, first, last);
    is_on_face_ = true;
    double begin = 0, end = 0;
    const Handle(Geom_Curve) curve = BRep_Tool::Curve(edge, begin, end);
    const double rounding = 1e-9 * (last - first);
    if (curve.IsNull() || std::abs(begin - first) > rounding || std::abs(end - last) > rounding || !set_frame(surface))
      return;
    curve_.Load(curve, first, last);
    has_curve_ = true;
  }
  [[nodiscard]] bool is_on_face() const { return is_on_face_; }

  [[nodiscard]] std::vector<double> spans() const {
    const Standard_Integer count = has_curve_ ? curve_.NbIntervals(GeomAbs_CN) : pcurve_.NbIntervals(GeomAbs_CN);
    TColStd_Array1OfReal knots(1, count + 1);
    has_curve_ ? curve_.Intervals(knots, GeomAbs_CN) : pcurve_.Intervals(knots, GeomAbs_CN);
    return {knots.begin(), knots.end()};
  }

  struct Point {
    double u = 0, v = 0;
    double dv = 0;  ///< by the curve's parameter
  };
  [[nodiscard]] Point operator()(double t) const {
    gp_Pnt2d uv;
    gp_Vec2d tangent;
    pcurve_.D1(t, uv, tangent);
    if (!has_curve_) return {uv.X(), uv.Y(), tangent.Y()};
    gp_Pnt p;
    gp_Vec d;
    curve_.D1(t, p, d);
    const gp_XYZ at = p.XYZ() - frame_.Location().XYZ();
    const double x = at * frame_.XDirection().XYZ(), y = at * frame_.YDirection().XYZ(),
                 z = at * frame_.Direction().XYZ();
    const double dx = d.XYZ() * frame_.XDirection().XYZ(), dy = d.XYZ() * frame_.YDirection().XYZ(),
                 dz = d.XYZ() * frame_.Direction().XYZ();
    if (type_ == GeomAbs_Plane) return {x, y, dy};
    const double u = same_turn(std::atan2(y, x), uv.X());
    if (type_ == GeomAbs_Cylinder) return {u, z, dz};
    if (type_ == GeomAbs_Cone) return {u, z / cosine_, dz / cosine_};
    const double off = std::hypot(x, y), across = off - ring_;  // of the section's centre, a torus' ring
    const double doff = off > 0 ? (x * dx + y * dy) / off : 0;
    const double square = across * across + z * z;
    if (square == 0) return {uv.X(), uv.Y(), tangent.Y()};
    return {u, same_turn(std::atan2(z, across), uv.Y()), (across * dz - z * doff) / square};
  }

 private:
  bool set_frame(const GeomAdaptor_Surface& surface) {
    switch (type_) {
      case GeomAbs_Plane:
        return frame_ = surface.Plane().Position(), true;
      case GeomAbs_Cylinder:
        return frame_ = surface.Cylinder().Position(), true;
      case GeomAbs_Cone:
        cosine_ = std::cos(surface.Cone().SemiAngle());
        return frame_ = surface.Cone().Position(), true;
      case GeomAbs_Sphere:
        return frame_ = surface.Sphere().Position(), true;
      case GeomAbs_Torus:
        ring_ = surface.Torus().MajorRadius();
        return frame_ = surface.Torus().Position(), ring_ > surface.Torus().MinorRadius();
      default:
        return false;
    }
  }
  static double same_turn(double angle, double like) {
    constexpr double turn = 2 * std::numbers::pi;
    return angle + turn * std::round((like - angle) / turn);
  }

  GeomAbs_SurfaceType type_;
  Geom2dAdaptor_Curve pcurve_;
  GeomAdaptor_Curve curve_;
  bool is_on_face_ = false, has_curve_ = false;
  gp_Ax3 frame_;
  double cosine_ = 1, ring_ = 0;
};

// Green's theorem in parameter space: the integral of f over the face is that of F dv around its boundary, F the
// integral of f from u_min to u.
class BoundaryIntegral {
 public:
  explicit BoundaryIntegral(const TopoDS_Face& face) : surface_(BRep_Tool::Surface(face)) {
    double u_min = 0, u_max = 0, v_min = 0, v_max = 0;
    BRepTools::UVBounds(face, u_min, u_max, v_min, v_max);
    along_u_.emplace(surface_, u_min, u_max);
    for (const double u : {u_min, (u_min + u_max) / 2, u_max})
      for (const double v : {v_min, v_max}) reach_ = std::max(reach_, surface_.Value(u, v).XYZ().Modulus());
    patch_ = std::abs(v_max - v_min) * (*along_u_)(u_max, (v_min + v_max) / 2)[0];
    for (TopExp_Explorer it(face.Oriented(TopAbs_FORWARD), TopAbs_EDGE); it.More(); it.Next())
      add_edge(TopoDS::Edge(it.Current()), face);
  }
  [[nodiscard]] const Moments& total() const { return total_; }

 private:
  void add_edge(const TopoDS_Edge& edge, const TopoDS_Face& face) {
    if (edge.Orientation() == TopAbs_INTERNAL || edge.Orientation() == TopAbs_EXTERNAL) return;
    const EdgeOnSurface curve(edge, TopoDS::Face(face.Oriented(TopAbs_FORWARD)), surface_);
    if (!curve.is_on_face()) return;
    const double sign = edge.Orientation() == TopAbs_REVERSED ? -1 : 1;
    const std::vector<double> spans = curve.spans();
    for (std::size_t i = 0; i + 1 < spans.size(); ++i) add_span(curve, spans[i], spans[i + 1], sign);
  }

  void add_span(const EdgeOnSurface& curve, double a, double b, double sign) {
    refine(curve, a, b, integrate(curve, a, b), sign, 0);
  }

  // Halving until the halves agree with the whole, in units of the area within the bounds and the distance from the
  // origin: many of the sums cancel to nothing, so their own size is no measure.
  void refine(const EdgeOnSurface& curve, double a, double b, const Moments& whole, double sign, int depth) {
    const double middle = (a + b) / 2;
    const Moments left = integrate(curve, a, middle), right = integrate(curve, middle, b);
    bool agrees = true;
    for (std::size_t i = 0; i < moment_count; ++i)
      agrees = agrees && std::abs(left[i] + right[i] - whole[i]) <= 1e-12 * patch_ * unit_of(i);
    if (agrees || depth == 8) {
      add(total_, sign, left);
      add(total_, sign, right);
      return;
    }
    refine(curve, a, middle, left, sign, depth + 1);
    refine(curve, middle, b, right, sign, depth + 1);
  }

  [[nodiscard]] double unit_of(std::size_t component) const {
    const bool is_volume = component >= 1 && component <= 3, is_centroid = component >= 7;
    return is_volume ? reach_ : is_centroid ? reach_ * reach_ : 1;
  }

  [[nodiscard]] Moments integrate(const EdgeOnSurface& curve, double a, double b) const {
    Moments sum{};
    gauss(a, b, [&](double t, double weight) {
      const EdgeOnSurface::Point at = curve(t);
      if (at.dv != 0) add(sum, weight * at.dv, (*along_u_)(at.u, at.v));  // zero: along u
    });
    return sum;
  }

  GeomAdaptor_Surface surface_;
  std::optional<UIntegral> along_u_;
  double reach_ = 0;  // of the face from the origin, roughly
  double patch_ = 0;  // area within the bounds, roughly
  Moments total_{};
};

void extend(Box3& box, const Bnd_Box& other) {
  if (other.IsVoid()) return;
  box.extend(to_vec(other.CornerMin()));
  box.extend(to_vec(other.CornerMax()));
}

// Points of a sphere or torus where a coordinate is extreme: its normal is along an axis. They bound the face from
// inside; everything else is extreme on the edges.
void extend_by_poles(Box3& box, const TopoDS_Face& face, const GeomAdaptor_Surface& surface) {
  const bool is_sphere = surface.GetType() == GeomAbs_Sphere;
  const gp_Ax3 frame = is_sphere ? surface.Sphere().Position() : surface.Torus().Position();
  BRepTopAdaptor_FClass2d classifier(face, 0);
  for (int axis = 0; axis < 3; ++axis) {
    const gp_XYZ e(axis == 0, axis == 1, axis == 2);
    const double x = e.Dot(frame.XDirection().XYZ()), y = e.Dot(frame.YDirection().XYZ()),
                 z = e.Dot(frame.Direction().XYZ());
    const double u = std::atan2(y, x), v = std::atan2(z, std::hypot(x, y));
    const double pi = std::numbers::pi;
    for (const auto& [pu, pv] :
         {std::pair{u, v}, std::pair{u + pi, -v}, std::pair{u, pi - v}, std::pair{u + pi, pi + v}}) {
      if (is_sphere && std::abs(pv) > pi / 2) continue;
      if (classifier.Perform(gp_Pnt2d(pu, pv)) != TopAbs_OUT) box.extend(to_vec(surface.Value(pu, pv)));
    }
  }
}

}  // namespace

FaceMoments face_moments(const TopoDS_Face& face) {
  if (const auto ellipsoid = ellipsoid_of(face)) return moments_of(*ellipsoid);
  const BoundaryIntegral integral(face);
  const Moments& c = integral.total();
  // A left-handed surface needs no special case: du x dv is the normal that FORWARD means.
  const double sign = face.Orientation() == TopAbs_REVERSED ? -1 : 1;
  return {c[0], sign * Vec3{c[1], c[2], c[3]}, sign * Vec3{c[4], c[5], c[6]}, sign * Vec3{c[7], c[8], c[9]}};
}

Box3 face_box(const TopoDS_Face& face) {
  if (const auto ellipsoid = ellipsoid_of(face)) return box_of(*ellipsoid);
  Box3 box;
  const GeomAdaptor_Surface surface(BRep_Tool::Surface(face));
  Bnd_Box bounds;
  switch (surface.GetType()) {
    case GeomAbs_Plane:
    case GeomAbs_Cylinder:
    case GeomAbs_Cone:
      break;
    case GeomAbs_Sphere:
    case GeomAbs_Torus:
      extend_by_poles(box, face, surface);
      break;
    default:
      BRepBndLib::AddOptimal(face, bounds, Standard_False, Standard_False);
      extend(box, bounds);
  }
  for (TopExp_Explorer it(face, TopAbs_EDGE); it.More(); it.Next()) {
    const TopoDS_Edge& edge = TopoDS::Edge(it.Current());
    for (TopExp_Explorer ends(edge, TopAbs_VERTEX); ends.More(); ends.Next())
      box.extend(to_vec(BRep_Tool::Pnt(TopoDS::Vertex(ends.Current()))));
    if (BRep_Tool::Degenerated(edge)) continue;
    Bnd_Box curve_box;
    BndLib_Add3dCurve::AddOptimal(BRepAdaptor_Curve(edge), 0, curve_box);
    extend(box, curve_box);
  }
  return box;
}

}  // namespace meso::brep
