// SPDX-License-Identifier: Apache-2.0
#include "lattice/crossing_filler.hpp"

#include <BOPDS_DS.hxx>
#include <BOPDS_Iterator.hxx>
#include <BOPDS_Tools.hxx>
#include <BndLib_Add3dCurve.hxx>
#include <GeomAPI_ProjectPointOnSurf.hxx>

#include "lattice/curve_fit.hpp"

namespace meso::brep {
namespace {

// Radians. OpenCASCADE takes a plane for one that touches up to a distance of 1e-7 mm, and returns the very line of
// contact; beyond that two lines, along which the angle is ten times as much even on a radius of two metres.
constexpr double parallel = 1e-6;

// Of the cell. OpenCASCADE knows vertices no better than some 1e-7 mm, and looks for those on a curve.
constexpr double well_known = 1e-6;

Vec3 normal_at(const TopoDS_Face& face, const gp_Pnt& p, const Handle(IntTools_Context) & context) {
  GeomAPI_ProjectPointOnSurf& foot = context->ProjPS(face);
  foot.Perform(p);
  if (foot.NbPoints() == 0) return {};
  double u = 0, v = 0;
  foot.LowerDistanceParameters(u, v);
  gp_Pnt at;
  gp_Vec du, dv;
  context->SurfaceAdaptor(face).D1(u, v, at, du, dv);
  const Vec3 across = to_vec(du.Crossed(dv).XYZ());
  const double area = norm(across);
  return area > 0 ? across / area : Vec3{};
}

/// Angle between two faces at a point of both, as its sine; nothing beyond the parameters of one of them.
std::optional<double> angle_at(const TopoDS_Face& a, const TopoDS_Face& b, const gp_Pnt& p,
                               const Handle(IntTools_Context) & context) {
  const Vec3 n = normal_at(a, p, context), m = normal_at(b, p, context);
  if (norm(n) == 0 || norm(m) == 0) return {};
  return norm(cross(n, m));
}

/// From the points that its surfaces share. What OpenCASCADE calls a tolerance is how far it is from the surfaces,
/// which is less where they meet at a small angle. Endless where they nearly touch.
double distance_of(const SharedCurve& on, double size) {
  const auto spline = Handle(Geom_BSplineCurve)::DownCast(on.curve);
  const int samples = spline.IsNull() ? 16 : 4 * spline->NbKnots();
  double most = 0;
  for (int i = 0; i < samples; ++i) {
    const double t = on.at(i, samples);
    Foot a(on.a, on.on_a->Value(t)), b(on.b, on.on_b->Value(t));
    const Vec3 p = to_vec(on.curve->Value(t));
    const auto met = meet(a, b, p, 0.1 * well_known * size);
    if (!met) return HUGE_VAL;
    most = std::fmax(most, norm(*met - p));
  }
  return most;
}

class NearPairs : public BOPDS_Iterator {
 public:
  NearPairs(const Handle(NCollection_BaseAllocator) & memory, const TopTools_MapOfShape& away)
      : BOPDS_Iterator(memory), away_(away) {}

 protected:
  void Intersect(const Handle(IntTools_Context) & context, Standard_Boolean oriented_boxes,
                 Standard_Real fuzzy) override {
    BOPDS_Iterator::Intersect(context, oriented_boxes, fuzzy);
    BOPDS_VectorOfPair& pairs = myLists(BOPDS_Tools::TypeToInteger(TopAbs_EDGE, TopAbs_FACE));
    BOPDS_VectorOfPair near;
    for (const BOPDS_Pair& pair : pairs) {
      Standard_Integer a = 0, b = 0;
      pair.Indices(a, b);
      if (!away_.Contains(myDS->Shape(a)) && !away_.Contains(myDS->Shape(b))) near.Append(pair);
    }
    pairs = near;
  }

 private:
  const TopTools_MapOfShape& away_;
};

}  // namespace

bool touch_along(const TopoDS_Face& a, const TopoDS_Face& b, const CurveSpan& span,
                 const Handle(IntTools_Context) & context) {
  constexpr int places = 16;  // a curve may go on beyond its faces, and far
  int told = 0;
  for (int i = 1; i < places && told < 3; ++i) {
    const double at = static_cast<double>(i * 5 % places) / places;
    const auto angle = angle_at(a, b, span.curve->Value((1 - at) * span.from + at * span.to), context);
    if (angle && *angle > parallel) return false;
    told += angle.has_value();
  }
  return told > 0;
}

void CrossingFiller::Init(const Message_ProgressRange& range) {
  BOPAlgo_PaveFiller::Init(range);
  if (HasErrors() || away_.IsEmpty()) return;
  delete myIterator;
  myIterator = new NearPairs(myAllocator, away_);
  myIterator->SetRunParallel(myRunParallel);
  myIterator->SetDS(myDS);
  myIterator->Prepare(myContext, myUseOBB, myFuzzyValue);
}

void CrossingFiller::PerformFF(const Message_ProgressRange& range) {
  BOPAlgo_PaveFiller::PerformFF(range);
  if (HasErrors()) return;
  auto& pairs = myDS->InterfFF();
  for (int i = 0; i < pairs.Length(); ++i) {
    Standard_Integer a = 0, b = 0;
    pairs(i).Indices(a, b);
    BOPDS_VectorOfCurve& curves = pairs.ChangeValue(i).ChangeCurves();
    BOPDS_VectorOfCurve crossing;
    for (const BOPDS_Curve& curve : curves) {
      CurveSpan span{curve.Curve().Curve(), 0, 0};
      gp_Pnt start, end;
      const bool is_bounded = curve.Curve().Bounds(span.from, span.to, start, end);
      if (!is_bounded || !touch_along(TopoDS::Face(myDS->Shape(a)), TopoDS::Face(myDS->Shape(b)), span, myContext))
        crossing.Append(is_bounded ? fitted(curve, a, b) : curve);
    }
    curves = crossing;
  }
}

BOPDS_Curve CrossingFiller::fitted(const BOPDS_Curve& curve, int a, int b) const {
  const IntTools_Curve& known = curve.Curve();
  if (known.Type() != GeomAbs_BSplineCurve || known.FirstCurve2d().IsNull() || known.SecondCurve2d().IsNull())
    return curve;
  SharedCurve on;
  gp_Pnt start, end;
  (void)known.Bounds(on.first, on.last, start, end);
  on.a.Load(BRep_Tool::Surface(TopoDS::Face(myDS->Shape(a))));
  on.b.Load(BRep_Tool::Surface(TopoDS::Face(myDS->Shape(b))));
  on.curve = known.Curve();
  on.on_a = known.FirstCurve2d();
  on.on_b = known.SecondCurve2d();
  const double before = distance_of(on, size_);
  if (before <= well_known * size_) return curve;
  const auto on_both = [&](double at, const gp_Pnt& near) {
    Foot foot_a(on.a, on.on_a->Value(at)), foot_b(on.b, on.on_b->Value(at));
    return meet(foot_a, foot_b, to_vec(near), 0.01 * curve_aim * size_);
  };
  const auto from = on_both(on.first, start), to = on_both(on.last, end);
  const double farthest = curve_farthest * size_;
  if (!from || !to || norm(*from - to_vec(start)) > farthest || norm(*to - to_vec(end)) > farthest) return curve;
  const auto better = fit_curve(on, *from, *to, size_);
  if (!better) return curve;
  SharedCurve now = on;
  now.curve = better->curve;
  now.on_a = better->on_a;
  now.on_b = better->on_b;
  now.first = better->curve->FirstParameter();
  now.last = better->curve->LastParameter();
  const double after = distance_of(now, size_);
  if (after >= before) return curve;
  const double off = std::fmax(1.1 * std::fmax(better->off, after), well_known * size_);
  BOPDS_Curve out = curve;
  out.SetCurve(IntTools_Curve(better->curve, better->on_a, better->on_b, off, off));
  out.SetTolerance(off);
  Bnd_Box box;
  BndLib_Add3dCurve::Add(GeomAdaptor_Curve(better->curve), off, box);
  out.SetBox(box);
  return out;
}

}  // namespace meso::brep
