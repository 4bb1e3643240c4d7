// SPDX-License-Identifier: Apache-2.0
#include "lattice/window_loops.hpp"

#include <BRepTopAdaptor_FClass2d.hxx>
#include <Geom2d_Line.hxx>
#include <algorithm>

namespace meso::brep {
namespace {

using Parameters = FaceParameters;

Parameters border_point(const ParameterRange& window, double border) {
  const BorderSide& side = border_sides[static_cast<std::size_t>(border) % 4];
  const double share = border - std::floor(border), run = side.falling ? 1 - share : share;
  const std::size_t runs = 1 - side.fixed;
  Parameters out{};
  out[side.fixed] = fixed_at(window, side);
  out[runs] = (1 - run) * window.low[runs] + run * window.high[runs];
  return out;
}

double middle_of(const TopoDS_Edge& edge) {
  double first = 0, last = 0;
  BRep_Tool::Range(edge, first, last);
  return 0.5 * (first + last);
}

}  // namespace

void FaceWindows::Loops::take_parts() {
  const ParameterRange& window = request_.window;
  for (const std::size_t e : request_.near) {
    const TopoDS_Edge& edge = request_.face->edges[e];
    const EdgeOnFace on(edge, request_.face->face);
    for (const TopoDS_Edge& part : all_.known(edge)->parts) {
      const Parameters p = on.at(middle_of(part));
      if (p[0] < window.low[0] || p[0] > window.high[0] || p[1] < window.low[1] || p[1] > window.high[1]) continue;
      parts_.push_back({TopoDS::Edge(part.Oriented(edge.Orientation())), -1, 0, false});
    }
  }
}

std::optional<double> FaceWindows::Loops::border_of(const TopoDS_Vertex& vertex) const {
  const Vec3 place = to_vec(BRep_Tool::Pnt(vertex));
  for (const Crossing& crossing : request_.crossings) {
    if (norm(crossing.point - place) > all_.least_) continue;
    for (const Division& division : all_.edges_[crossing.edge].divisions)
      if (division.vertex.IsSame(vertex)) return crossing.border;
  }
  return {};
}

bool FaceWindows::Loops::link() {
  TopTools_IndexedMapOfShape starts;
  for (const Part& part : parts_) {
    const int before = starts.Extent();
    if (starts.Add(first_of(part.edge)) <= before) return false;  // two edges from one vertex
  }
  std::vector<bool> follows(parts_.size());
  for (Part& part : parts_) {
    part.next = starts.FindIndex(last_of(part.edge)) - 1;
    if (part.next >= 0) {
      if (follows[static_cast<std::size_t>(part.next)]) return false;
      follows[static_cast<std::size_t>(part.next)] = true;
      continue;
    }
    const auto border = border_of(last_of(part.edge));
    if (!border) return false;
    part.leaves = *border;
    exits_.push_back(*border);
  }
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    if (follows[p]) continue;
    const TopoDS_Vertex vertex = first_of(parts_[p].edge);
    const auto border = border_of(vertex);
    if (!border) return false;
    entries_.push_back({*border, p, vertex});
  }
  std::ranges::sort(entries_, {}, &Entry::border);
  return entries_.size() == exits_.size();
}

/// No edge crosses the border: it is in the face, unless the outer loop is within.
bool FaceWindows::Loops::border_alone() {
  if (parts_.empty() != request_.near.empty()) return false;  // an edge along the border
  double area = 0;
  for (const std::size_t e : request_.near) {
    const BodySurface::Edge& edge = request_.mesh->edges[e];
    const bool back = request_.face->edges[e].Orientation() == TopAbs_REVERSED;
    for (std::size_t i = 0; i + 1 < edge.nodes.size(); ++i) {
      const Parameters p = request_.mesh->parameters[edge.nodes[i]], q = request_.mesh->parameters[edge.nodes[i + 1]];
      area += (back ? -0.5 : 0.5) * (p[0] * q[1] - p[1] * q[0]);
    }
  }
  if (area > 0) return false;
  TopoDS_Wire wire;
  builder_.MakeWire(wire);
  for (std::size_t s = 0; s < 4; ++s)
    add_side(wire, static_cast<double>(s), corner(s), static_cast<double>(s + 1), corner((s + 1) % 4));
  wire.Closed(Standard_True);
  outer_.push_back(wire);
  return true;
}

std::vector<TopoDS_Face> FaceWindows::Loops::pieces() {
  std::vector<TopoDS_Face> out;
  for (const TopoDS_Wire& wire : outer_) {
    out.push_back(TopoDS::Face(face_.EmptyCopied().Oriented(TopAbs_FORWARD)));
    builder_.Add(out.back(), wire);
  }
  std::vector<std::size_t> piece_of(holes_.size());
  for (std::size_t p = 0; p < out.size() && out.size() > 1 && !holes_.empty(); ++p) {
    BRepTopAdaptor_FClass2d within(out[p], Precision::Confusion());
    for (std::size_t h = 0; h < holes_.size(); ++h)
      if (within.Perform({holes_[h].second[0], holes_[h].second[1]}) == TopAbs_IN) piece_of[h] = p;
  }
  for (std::size_t h = 0; h < holes_.size(); ++h) builder_.Add(out[piece_of[h]], holes_[h].first);
  for (TopoDS_Face& face : out) face.Orientation(request_.face->face.Orientation());
  return out;
}

bool FaceWindows::Loops::walk(std::size_t from) {
  TopoDS_Wire wire;
  builder_.MakeWire(wire);
  bool along_border = false;
  for (std::size_t at = from; !parts_[at].used;) {
    Part& part = parts_[at];
    part.used = true;
    builder_.Add(wire, part.edge);
    if (part.next >= 0) {
      at = static_cast<std::size_t>(part.next);
      continue;
    }
    along_border = true;
    // Around the border to where an edge enters next; another one that leaves before is a contradiction.
    const auto ahead = [&](double border) {
      return border > part.leaves ? border - part.leaves : border - part.leaves + 4;
    };
    const Entry* next = &entries_.front();
    for (const Entry& entry : entries_)
      if (ahead(entry.border) < ahead(next->border)) next = &entry;
    for (const double exit : exits_)
      if (exit != part.leaves && ahead(exit) <= ahead(next->border)) return false;
    if (!add_border(wire, part.leaves, last_of(part.edge), part.leaves + ahead(next->border), next->vertex))
      return false;
    at = next->part;
  }
  wire.Closed(Standard_True);
  if (along_border) {
    outer_.push_back(wire);
  } else {
    const EdgeOnFace on(parts_[from].edge, request_.face->face);
    holes_.emplace_back(wire, on.at(middle_of(parts_[from].edge)));
  }
  return true;
}

bool FaceWindows::Loops::add_border(TopoDS_Wire& wire, double from, TopoDS_Vertex start, double to,
                                    const TopoDS_Vertex& end) {
  for (double corner_at = std::floor(from) + 1; from < to; corner_at += 1) {
    const bool at_corner = corner_at < to;
    const double next = at_corner ? corner_at : to;
    const TopoDS_Vertex vertex = at_corner ? corner(static_cast<std::size_t>(next) % 4) : end;
    if (BRep_Tool::Pnt(start).Distance(BRep_Tool::Pnt(vertex)) < all_.least_) return false;
    add_side(wire, from, start, next, vertex);
    start = vertex;
    from = next;
  }
  return true;
}

void FaceWindows::Loops::add_side(TopoDS_Wire& wire, double from, const TopoDS_Vertex& start, double to,
                                  const TopoDS_Vertex& end) {
  const BorderSide& side = border_sides[static_cast<std::size_t>(from) % 4];
  const std::size_t runs = 1 - side.fixed;
  const double a = border_point(request_.window, from)[runs];
  // The end of a side is told as such, not as the start of the next one.
  const double b = to == std::floor(to) ? (side.falling ? request_.window.low : request_.window.high)[runs]
                                        : border_point(request_.window, to)[runs];
  const double fixed = fixed_at(request_.window, side);
  const Handle(Geom_Surface) surface = BRep_Tool::Surface(face_);
  const Handle(Geom_Curve) curve = side.fixed == 0 ? surface->UIso(fixed) : surface->VIso(fixed);
  TopoDS_Edge edge;
  builder_.MakeEdge(edge, curve, Precision::Confusion());
  builder_.Add(edge, (side.falling ? end : start).Oriented(TopAbs_FORWARD));
  builder_.Add(edge, (side.falling ? start : end).Oriented(TopAbs_REVERSED));
  const Handle(Geom2d_Curve) on_face = side.fixed == 0 ? new Geom2d_Line(gp_Pnt2d(fixed, 0), gp_Dir2d(0, 1))
                                                       : new Geom2d_Line(gp_Pnt2d(0, fixed), gp_Dir2d(1, 0));
  builder_.UpdateEdge(edge, on_face, face_, Precision::Confusion());
  builder_.Range(edge, std::fmin(a, b), std::fmax(a, b));
  builder_.Add(wire, edge.Oriented(side.falling ? TopAbs_REVERSED : TopAbs_FORWARD));
}

gp_Pnt FaceWindows::Loops::point(const Parameters& p) const { return BRep_Tool::Surface(face_)->Value(p[0], p[1]); }

TopoDS_Vertex FaceWindows::Loops::corner(std::size_t number) {
  if (corners_[number].IsNull())
    builder_.MakeVertex(corners_[number], point(border_point(request_.window, static_cast<double>(number))),
                        Precision::Confusion());
  return corners_[number];
}

}  // namespace meso::brep
