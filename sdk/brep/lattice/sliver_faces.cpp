// SPDX-License-Identifier: Apache-2.0
#include "lattice/sliver_faces.hpp"

#include <BRepTools_ReShape.hxx>
#include <Geom2d_BSplineCurve.hxx>
#include <GeomAPI_ProjectPointOnCurve.hxx>
#include <algorithm>

namespace meso::brep {
namespace {

const TopoDS_Edge& edge_at(const DividedFaces& faces, std::size_t index) {
  return TopoDS::Edge(faces.edges(static_cast<int>(index) + 1));
}

TopoDS_Vertex end_of(const TopoDS_Edge& edge, bool last) {
  const TopoDS_Edge forward = TopoDS::Edge(edge.Oriented(TopAbs_FORWARD));
  return last ? TopExp::LastVertex(forward) : TopExp::FirstVertex(forward);
}

/// Of points of the one edge from the other; endless where it has no curve.
double distance_between(const TopoDS_Edge& a, const TopoDS_Edge& b) {
  double first = 0, last = 0, from = 0, to = 0;
  const Handle(Geom_Curve) curve = BRep_Tool::Curve(a, first, last), other = BRep_Tool::Curve(b, from, to);
  if (curve.IsNull() || other.IsNull()) return HUGE_VAL;
  double most = 0;
  for (const double at : {0.25, 0.5, 0.75}) {
    const GeomAPI_ProjectPointOnCurve foot(curve->Value((1 - at) * first + at * last), other, from, to);
    if (foot.NbPoints() == 0) return HUGE_VAL;
    most = std::fmax(most, foot.LowerDistance());
  }
  return most;
}

const PieceUse* use_by(const DividedFaces& faces, std::size_t edge, std::uint32_t piece) {
  const auto& uses = faces.uses[edge];
  const auto it = std::ranges::find(uses, piece, &PieceUse::piece);
  return it == uses.end() ? nullptr : &*it;
}

}  // namespace

std::optional<Sliver> sliver_of(const DividedFaces& faces, std::uint32_t piece, double width,
                                const std::function<bool(std::uint32_t)>& is_taken,
                                const std::function<bool(std::uint32_t)>& is_fixed) {
  std::vector<std::size_t> edges;
  for (TopExp_Explorer it(faces.pieces[piece].face, TopAbs_EDGE); it.More(); it.Next()) {
    const int index = faces.edges.FindIndex(it.Current());
    if (index == 0) return {};
    edges.push_back(static_cast<std::size_t>(index) - 1);
  }
  if (edges.size() != 2 || edges[0] == edges[1]) return {};
  const TopoDS_Edge &a = edge_at(faces, edges[0]), &b = edge_at(faces, edges[1]);
  const bool same_way = end_of(a, false).IsSame(end_of(b, false)) && end_of(a, true).IsSame(end_of(b, true));
  const bool turned = end_of(a, false).IsSame(end_of(b, true)) && end_of(a, true).IsSame(end_of(b, false));
  if ((!same_way && !turned) || end_of(a, false).IsSame(end_of(a, true)) || distance_between(a, b) > width) return {};
  for (const auto& [kept, gone] : {std::array{edges[0], edges[1]}, {edges[1], edges[0]}}) {
    std::optional<std::uint32_t> beside;
    std::size_t count = 0;
    bool fixed = false;
    for (const PieceUse& use : faces.uses[gone]) {
      if (use.piece == piece) continue;
      fixed = fixed || is_fixed(use.piece);
      if (!is_taken(use.piece)) continue;
      beside = use.piece;
      ++count;
    }
    if (!fixed && count == 1) return Sliver{piece, *beside, kept, gone};
  }
  return {};
}

void take_out(DividedFaces& faces, const Sliver& sliver) {
  const TopoDS_Edge kept = TopoDS::Edge(edge_at(faces, sliver.kept_edge).Oriented(TopAbs_FORWARD));
  const TopoDS_Edge gone = TopoDS::Edge(edge_at(faces, sliver.edge).Oriented(TopAbs_FORWARD));
  Piece& beside = faces.pieces[sliver.beside];
  const bool same_way = end_of(kept, false).IsSame(end_of(gone, false));
  double first = 0, last = 0, from = 0, to = 0;
  const Handle(Geom2d_Curve) image = BRep_Tool::CurveOnSurface(gone, beside.face, from, to);
  if (image.IsNull()) throw Standard_Failure("an edge has no image on its face");
  BRep_Tool::Range(kept, first, last);
  // So short that it is straight.
  TColgp_Array1OfPnt2d ends(1, 2);
  ends(1) = image->Value(same_way ? from : to);
  ends(2) = image->Value(same_way ? to : from);
  TColStd_Array1OfReal knots(1, 2);
  knots(1) = first;
  knots(2) = last;
  TColStd_Array1OfInteger twice(1, 2);
  twice.Init(2);
  const double off = BRep_Tool::Tolerance(kept) + BRep_Tool::Tolerance(gone) + distance_between(kept, gone);
  const BRep_Builder builder;
  builder.UpdateEdge(kept, new Geom2d_BSplineCurve(ends, knots, twice, 1), beside.face, off);
  for (const bool at_end : {false, true}) builder.UpdateVertex(end_of(kept, at_end), off);
  BRepTools_ReShape change;
  change.Replace(gone, kept.Oriented(same_way ? TopAbs_FORWARD : TopAbs_REVERSED));
  beside.face = TopoDS::Face(change.Apply(beside.face));
  const PieceUse* use = use_by(faces, sliver.edge, sliver.beside);
  const PieceUse now{sliver.beside, use->reversed == same_way};
  std::erase_if(faces.uses[sliver.edge], [&](const PieceUse& u) { return u.piece == sliver.beside; });
  std::erase_if(faces.uses[sliver.kept_edge], [&](const PieceUse& u) { return u.piece == sliver.piece; });
  std::erase_if(faces.uses[sliver.edge], [&](const PieceUse& u) { return u.piece == sliver.piece; });
  faces.uses[sliver.kept_edge].push_back(now);
}

}  // namespace meso::brep
