// SPDX-License-Identifier: Apache-2.0
#include "lattice/crossing_filler.hpp"

#include <BOPDS_DS.hxx>
#include <BOPDS_Iterator.hxx>
#include <BOPDS_Tools.hxx>
#include <GeomAPI_ProjectPointOnSurf.hxx>

namespace meso::brep {
namespace {

// Radians. OpenCASCADE takes a plane for one that touches up to a distance of 1e-7 mm, and returns the very line of
// contact; beyond that two lines, along which the angle is ten times as much even on a radius of two metres.
constexpr double parallel = 1e-6;

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
  for (const double at : {0.25, 0.5, 0.75}) {
    const gp_Pnt p = span.curve->Value((1 - at) * span.from + at * span.to);
    const Vec3 n = normal_at(a, p, context), m = normal_at(b, p, context);
    if (norm(n) == 0 || norm(m) == 0 || norm(cross(n, m)) > parallel) return false;
  }
  return true;
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
        crossing.Append(curve);
    }
    if (crossing.Length() < curves.Length()) curves = crossing;
  }
}

}  // namespace meso::brep
