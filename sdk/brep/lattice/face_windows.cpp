// SPDX-License-Identifier: Apache-2.0
#include "lattice/face_windows.hpp"

#include <algorithm>

#include "lattice/window_border.hpp"
#include "lattice/window_loops.hpp"

namespace meso::brep {
namespace {

using Parameters = FaceParameters;

/// How far along a side, from 0 to 1.
double along(const ParameterRange& window, const BorderSide& side, const Parameters& p) {
  const std::size_t runs = 1 - side.fixed;
  const double share = (p[runs] - window.low[runs]) / (window.high[runs] - window.low[runs]);
  return side.falling ? 1 - share : share;
}

/// Where a function that changes its sign between a and b is zero.
template <typename Function>
double root(Function f, double a, double b) {
  const bool rising = f(a) < 0;
  for (int step = 0; step < 60 && a != b; ++step) {
    const double middle = 0.5 * (a + b);
    if (middle == a || middle == b) break;
    ((f(middle) < 0) == rising ? a : b) = middle;
  }
  return 0.5 * (a + b);
}

}  // namespace

void ParameterRange::extend(const Parameters& at) {
  for (std::size_t i = 0; i < 2; ++i) {
    low[i] = std::fmin(low[i], at[i]);
    high[i] = std::fmax(high[i], at[i]);
  }
}

void ParameterRange::grow(double share) {
  for (std::size_t i = 0; i < 2; ++i) {
    const double by = share * (high[i] - low[i]);
    low[i] -= by;
    high[i] += by;
  }
}

bool ParameterRange::meets(const Parameters& p, const Parameters& q) const {
  double enter = 0, leave = 1;
  for (std::size_t i = 0; i < 2; ++i) {
    const double d = q[i] - p[i];
    if (d == 0) {
      if (p[i] < low[i] || p[i] > high[i]) return false;
      continue;
    }
    const double a = (low[i] - p[i]) / d, b = (high[i] - p[i]) / d;
    enter = std::fmax(enter, std::fmin(a, b));
    leave = std::fmin(leave, std::fmax(a, b));
  }
  return enter <= leave;
}

/// False where the face has to be taken whole.
bool FaceWindows::look_for_crossings(Request& request) {
  const BodySurface::Face& mesh = *request.mesh;
  const ParameterRange& window = request.window;
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
    const BodySurface::Edge& polygon = mesh.edges[e];
    const auto node = [&](std::size_t i) { return mesh.parameters[polygon.nodes[i]]; };
    bool near = false;
    for (std::size_t i = 0; i + 1 < polygon.nodes.size() && !near; ++i) near = window.meets(node(i), node(i + 1));
    if (!near) continue;
    const TopoDS_Edge& edge = request.face->edges[e];
    if (polygon.seam || polygon.at.size() != polygon.nodes.size() || !BRep_Tool::SameRange(edge) ||
        !BRep_Tool::SameParameter(edge))
      return false;
    request.near.push_back(e);
    const auto number = static_cast<std::size_t>(numbers_.Add(edge)) - 1;
    if (number == edges_.size()) edges_.push_back({TopoDS::Edge(edge.Oriented(TopAbs_FORWARD)), {}, {}});
    const EdgeOnFace on(edge, request.face->face);
    if (!on.known()) return false;
    for (std::size_t i = 0; i + 1 < polygon.nodes.size(); ++i)
      for (std::size_t s = 0; s < border_sides.size(); ++s) {
        const BorderSide& side = border_sides[s];
        const auto beyond = [&](double t) { return on.at(t)[side.fixed] - fixed_at(window, side); };
        if ((beyond(polygon.at[i]) < 0) == (beyond(polygon.at[i + 1]) < 0)) continue;
        const double at = root(beyond, polygon.at[i], polygon.at[i + 1]);
        const double share = along(window, side, on.at(at));
        if (share > 0 && share < 1)
          request.crossings.push_back({number, at, on.place(at), static_cast<double>(s) + share});
      }
  }
  return true;
}

void FaceWindows::divide_edges() {
  const BRep_Builder builder;
  for (Edge& edge : edges_) {
    double first = 0, last = 0;
    const Handle(Geom_Curve) curve = BRep_Tool::Curve(edge.edge, first, last);
    const double tolerance = BRep_Tool::Tolerance(edge.edge);
    std::ranges::sort(edge.divisions, {}, &Division::at);
    std::vector<Division> kept;
    gp_Pnt before = BRep_Tool::Pnt(first_of(edge.edge));
    for (Division& division : edge.divisions) {
      const gp_Pnt p = curve->Value(division.at);
      if (p.Distance(before) < least_ || p.Distance(curve->Value(last)) < least_) continue;
      builder.MakeVertex(division.vertex, p, tolerance + least_);
      kept.push_back(division);
      before = p;
    }
    edge.divisions = std::move(kept);
    TopoDS_Vertex from = first_of(edge.edge);
    double start = first;
    const auto add_part = [&](double end, const TopoDS_Vertex& to) {
      TopoDS_Edge part = TopoDS::Edge(edge.edge.EmptyCopied());
      builder.Add(part, from.Oriented(TopAbs_FORWARD));
      builder.Add(part, to.Oriented(TopAbs_REVERSED));
      builder.Range(part, start, end);
      edge.parts.push_back(part);
      from = to;
      start = end;
    };
    if (edge.divisions.empty()) {
      edge.parts.push_back(edge.edge);
      continue;
    }
    for (const Division& division : edge.divisions) add_part(division.at, division.vertex);
    add_part(last, last_of(edge.edge));
  }
}

const FaceWindows::Edge* FaceWindows::known(const TopoDS_Edge& edge) const {
  const int number = numbers_.FindIndex(edge);
  return number == 0 ? nullptr : &edges_[static_cast<std::size_t>(number) - 1];
}

TopoDS_Face FaceWindows::with_divided_edges(const FaceEdges& face) const {
  const bool same = std::ranges::all_of(face.edges, [&](const TopoDS_Edge& edge) {
    const Edge* own = known(edge);
    return own == nullptr || own->parts.size() == 1;
  });
  if (same) return face.face;
  const BRep_Builder builder;
  TopoDS_Face out = TopoDS::Face(face.face.EmptyCopied().Oriented(TopAbs_FORWARD));
  for (TopoDS_Iterator wire(face.face.Oriented(TopAbs_FORWARD)); wire.More(); wire.Next()) {
    if (wire.Value().ShapeType() != TopAbs_WIRE) continue;
    TopoDS_Wire made;
    builder.MakeWire(made);
    for (TopExp_Explorer it(wire.Value(), TopAbs_EDGE); it.More(); it.Next()) {
      const Edge* own = known(TopoDS::Edge(it.Current()));
      if (own == nullptr || own->parts.size() == 1) {
        builder.Add(made, it.Current());
        continue;
      }
      for (const TopoDS_Edge& part : own->parts) builder.Add(made, part.Oriented(it.Current().Orientation()));
    }
    made.Closed(Standard_True);
    builder.Add(out, made);
  }
  return TopoDS::Face(out.Oriented(face.face.Orientation()));
}

std::vector<std::vector<TopoDS_Face>> FaceWindows::made() {
  for (Request& request : requests_) {
    if (request.mesh == nullptr) continue;
    if (!look_for_crossings(request)) {
      request.mesh = nullptr;
      continue;
    }
    for (const Crossing& crossing : request.crossings) edges_[crossing.edge].divisions.push_back({crossing.at, {}});
  }
  divide_edges();
  std::vector<std::vector<TopoDS_Face>> out;
  for (const Request& request : requests_) {
    out.emplace_back();
    if (request.mesh != nullptr) out.back() = Loops(*this, request).run();
    if (out.back().empty()) out.back().push_back(with_divided_edges(*request.face));
  }
  return out;
}

}  // namespace meso::brep
