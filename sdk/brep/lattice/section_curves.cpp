// SPDX-License-Identifier: Apache-2.0
#include "lattice/section_curves.hpp"

#include <BRep_TEdge.hxx>
#include <BRep_TVertex.hxx>
#include <algorithm>
#include <optional>

#include "lattice/curve_fit.hpp"

namespace meso::brep {
namespace {

constexpr int most_steps = 12;     ///< of Newton's method
constexpr double smallest = 1e-7;  ///< millimetres: OpenCASCADE's least tolerance

/// Where a curve meets a surface; `t` is its parameter there.
std::optional<Vec3> pierce(const Geom_Curve& curve, double& t, Foot& foot, double eps) {
  for (int step = 0; step < most_steps && foot.regular(); ++step) {
    gp_Pnt p;
    gp_Vec along;
    curve.D1(t, p, along);
    const Vec3 tangent = to_vec(along.XYZ());
    const double climb = dot(foot.normal(), tangent);
    if (std::fabs(climb) < curve_flattest * norm(tangent)) return {};
    t += dot(foot.normal(), foot.point() - to_vec(p)) / climb;
    const Vec3 at = to_vec(curve.Value(t));
    foot.follow(at);
    if (foot.regular() && norm(foot.point() - at) < eps) return at;
  }
  return {};
}

std::optional<SharedCurve> surfaces_at(const SectionEdge& section) {
  double f = 0, l = 0;
  SharedCurve out;
  out.curve = BRep_Tool::Curve(section.edge, out.first, out.last);
  out.on_a = BRep_Tool::CurveOnSurface(section.edge, section.of_cell, f, l);
  out.on_b = BRep_Tool::CurveOnSurface(section.edge, section.of_body, f, l);
  if (out.curve.IsNull() || out.on_a.IsNull() || out.on_b.IsNull()) return {};
  if (BRep_Tool::IsClosed(section.edge, section.of_cell) || BRep_Tool::IsClosed(section.edge, section.of_body))
    return {};
  out.a.Load(BRep_Tool::Surface(section.of_cell));
  out.b.Load(BRep_Tool::Surface(section.of_body));
  return out;
}

void set_tolerance(const TopoDS_Edge& edge, double value) {
  Handle(BRep_TEdge)::DownCast(edge.TShape())->Tolerance(std::fmax(value, smallest));
}

class SectionFit {
 public:
  SectionFit(const std::vector<SectionEdge>& sections, const std::vector<DividedEdge>& divided, double size)
      : sections_(sections), divided_(divided), size_(size) {}

  void run() {
    for (std::size_t s = 0; s < sections_.size(); ++s)
      for (const bool last : {false, true}) {
        Corner& corner = corner_at(sections_[s].edge, last);
        corner.sections.push_back({s, last});
      }
    for (std::size_t d = 0; d < divided_.size(); ++d)
      for (const bool last : {false, true}) {
        const int known = vertices_.FindIndex(end_of(divided_[d].edge, last));
        if (known > 0) corners_[static_cast<std::size_t>(known) - 1].divided.push_back({d, last});
      }
    for (const SectionEdge& section : sections_) surfaces_.push_back(surfaces_at(section));
    for (Corner& corner : corners_) move(corner);
    for (std::size_t s = 0; s < sections_.size(); ++s) refit(s);
    for (Corner& corner : corners_) settle(corner);
  }

 private:
  struct End {
    std::size_t edge = 0;
    bool last = false;
  };
  struct Corner {
    TopoDS_Vertex vertex;
    Vec3 place;
    bool moved = false;
    std::vector<End> sections, divided;
  };

  static TopoDS_Vertex end_of(const TopoDS_Edge& edge, bool last) {
    const TopoDS_Edge forward = TopoDS::Edge(edge.Oriented(TopAbs_FORWARD));
    return last ? TopExp::LastVertex(forward) : TopExp::FirstVertex(forward);
  }
  Corner& corner_at(const TopoDS_Edge& edge, bool last) {
    const TopoDS_Vertex vertex = end_of(edge, last);
    const auto index = static_cast<std::size_t>(vertices_.Add(vertex)) - 1;
    if (index == corners_.size()) corners_.push_back({vertex, to_vec(BRep_Tool::Pnt(vertex)), false, {}, {}});
    return corners_[index];
  }

  void move(Corner& corner);
  std::optional<Vec3> on_divided(const Corner& corner, const SharedCurve& on, double at);
  void refit(std::size_t s);
  void settle(Corner& corner);

  const std::vector<SectionEdge>& sections_;
  const std::vector<DividedEdge>& divided_;
  double size_;
  TopTools_IndexedMapOfShape vertices_;
  std::vector<Corner> corners_;
  std::vector<std::optional<SharedCurve>> surfaces_;
};

void SectionFit::move(Corner& corner) {
  const auto one =
      std::ranges::find_if(corner.sections, [&](const End& end) { return surfaces_[end.edge].has_value(); });
  if (one == corner.sections.end()) return;
  const SharedCurve& on = *surfaces_[one->edge];
  const double at = one->last ? on.last : on.first, eps = 0.01 * curve_aim * size_;
  std::optional<Vec3> place;
  if (corner.divided.empty()) {
    Foot cell(on.a, on.on_a->Value(at)), body(on.b, on.on_b->Value(at));
    place = meet(cell, body, corner.place, eps);
  } else {
    place = on_divided(corner, on, at);
  }
  if (!place || norm(*place - corner.place) > curve_farthest * size_) return;
  corner.moved = norm(*place - corner.place) > eps;
  if (corner.moved) corner.place = *place;
}

/// Along the one old edge that ends here, and nowhere if there are others.
std::optional<Vec3> SectionFit::on_divided(const Corner& corner, const SharedCurve& on, double at) {
  const DividedEdge& edge = divided_[corner.divided.front().edge];
  if (edge.of_cell == edge.of_body || BRep_Tool::Degenerated(edge.edge)) return {};
  TopLoc_Location location;
  double first = 0, last = 0;
  const Handle(Geom_Curve) curve = BRep_Tool::Curve(edge.edge, location, first, last);
  for (const End& end : corner.divided) {
    const DividedEdge& other = divided_[end.edge];
    TopLoc_Location of_other;
    double f = 0, l = 0;
    if (other.of_cell != edge.of_cell || other.of_body != edge.of_body ||
        BRep_Tool::Curve(other.edge, of_other, f, l) != curve || of_other != location)
      return {};
  }
  const Handle(Geom_Curve) placed = BRep_Tool::Curve(edge.edge, first, last);
  double t = corner.divided.front().last ? last : first;
  Foot foot = edge.of_cell ? Foot(on.b, on.on_b->Value(at)) : Foot(on.a, on.on_a->Value(at));
  const auto place = pierce(*placed, t, foot, 0.01 * curve_aim * size_);
  if (!place) return {};
  // Only between the other ends of the pieces.
  for (const End& end : corner.divided) {
    BRep_Tool::Range(divided_[end.edge].edge, first, last);
    if (end.last ? t <= first : t >= last) return {};
  }
  for (const End& end : corner.divided) {
    const TopoDS_Edge& piece = divided_[end.edge].edge;
    BRep_Tool::Range(piece, first, last);
    BRep_Builder().Range(piece, end.last ? first : t, end.last ? t : last);
  }
  return place;
}

void SectionFit::refit(std::size_t s) {
  const SectionEdge& section = sections_[s];
  const Corner& start = corner_at(section.edge, false);
  const Corner& end = corner_at(section.edge, true);
  const double known = BRep_Tool::Tolerance(section.edge);
  if (!surfaces_[s] || (known <= curve_aim * size_ && !start.moved && !end.moved)) return;
  const auto best = fit_curve(*surfaces_[s], start.place, end.place, size_);
  if (!best || best->off > known) return;
  const BRep_Builder builder;
  builder.UpdateEdge(section.edge, best->curve, TopLoc_Location(), smallest);
  builder.UpdateEdge(section.edge, best->on_a, section.of_cell, smallest);
  builder.UpdateEdge(section.edge, best->on_b, section.of_body, smallest);
  builder.Range(section.edge, best->curve->FirstParameter(), best->curve->LastParameter());
  builder.SameRange(section.edge, Standard_True);
  builder.SameParameter(section.edge, Standard_True);
  set_tolerance(section.edge, 1.1 * best->off);
}

/// The vertex, with the tolerance that its edges leave it.
void SectionFit::settle(Corner& corner) {
  double off = smallest;
  const auto look_at = [&](const TopoDS_Edge& edge, bool last) {
    double from = 0, to = 0;
    const Handle(Geom_Curve) curve = BRep_Tool::Curve(edge, from, to);
    off = std::fmax(off, BRep_Tool::Tolerance(edge));
    if (!curve.IsNull()) off = std::fmax(off, 1.1 * curve->Value(last ? to : from).Distance(to_pnt(corner.place)));
  };
  for (const End& end : corner.sections) look_at(sections_[end.edge].edge, end.last);
  for (const End& end : corner.divided) look_at(divided_[end.edge].edge, end.last);
  const Handle(BRep_TVertex) vertex = Handle(BRep_TVertex)::DownCast(corner.vertex.TShape());
  vertex->Pnt(to_pnt(corner.place).Transformed(corner.vertex.Location().Transformation().Inverted()));
  vertex->Tolerance(off);
}

}  // namespace

void fit_sections(const std::vector<SectionEdge>& sections, const std::vector<DividedEdge>& divided, double size) {
  SectionFit(sections, divided, size).run();
}

}  // namespace meso::brep
