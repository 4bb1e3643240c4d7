// SPDX-License-Identifier: Apache-2.0
#include "lattice/face_windows.hpp"

#include <BRepTopAdaptor_FClass2d.hxx>
#include <ElSLib.hxx>
#include <Geom2d_Line.hxx>
#include <algorithm>
#include <map>

namespace meso::brep {
namespace {

using Parameters = std::array<double, 2>;

/// Of points of an edge, on a face that has it.
class EdgeOnFace {
 public:
  EdgeOnFace(const TopoDS_Edge& edge, const TopoDS_Face& face) : surface_(face, false) {
    double first = 0, last = 0;
    curve_ = BRep_Tool::Curve(edge, first, last);
    if (surface_.GetType() != GeomAbs_Plane) on_face_ = BRep_Tool::CurveOnSurface(edge, face, first, last);
  }
  [[nodiscard]] bool known() const {
    return !curve_.IsNull() && (surface_.GetType() == GeomAbs_Plane || !on_face_.IsNull());
  }
  [[nodiscard]] Vec3 place(double t) const { return to_vec(curve_->Value(t)); }
  [[nodiscard]] Parameters at(double t) const {
    Parameters out{};
    if (!on_face_.IsNull()) {
      const gp_Pnt2d p = on_face_->Value(t);
      return {p.X(), p.Y()};
    }
    ElSLib::Parameters(surface_.Plane(), curve_->Value(t), out[0], out[1]);
    return out;
  }

 private:
  BRepAdaptor_Surface surface_;
  Handle(Geom_Curve) curve_;
  Handle(Geom2d_Curve) on_face_;
};

/// The sides of a window, counter-clockwise: which parameter is fixed, at which end, and which way the other one runs.
struct Side {
  std::size_t fixed;
  bool high, falling;
};
constexpr std::array<Side, 4> sides{{{1, false, false}, {0, true, false}, {1, true, true}, {0, false, true}}};

double fixed_at(const ParameterRange& window, const Side& side) {
  return side.high ? window.high[side.fixed] : window.low[side.fixed];
}

/// How far along a side, from 0 to 1.
double along(const ParameterRange& window, const Side& side, const Parameters& p) {
  const std::size_t runs = 1 - side.fixed;
  const double share = (p[runs] - window.low[runs]) / (window.high[runs] - window.low[runs]);
  return side.falling ? 1 - share : share;
}

Parameters border_point(const ParameterRange& window, double border) {
  const Side& side = sides[static_cast<std::size_t>(border) % 4];
  const double share = border - std::floor(border), run = side.falling ? 1 - share : share;
  const std::size_t runs = 1 - side.fixed;
  Parameters out{};
  out[side.fixed] = fixed_at(window, side);
  out[runs] = (1 - run) * window.low[runs] + run * window.high[runs];
  return out;
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

TopoDS_Vertex first_of(const TopoDS_Edge& edge) { return TopExp::FirstVertex(edge, true); }
TopoDS_Vertex last_of(const TopoDS_Edge& edge) { return TopExp::LastVertex(edge, true); }

double middle_of(const TopoDS_Edge& edge) {
  double first = 0, last = 0;
  BRep_Tool::Range(edge, first, last);
  return 0.5 * (first + last);
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
      for (std::size_t s = 0; s < sides.size(); ++s) {
        const Side& side = sides[s];
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

/// The boundary of a face's part: what is left of its edges, linked by their vertices and by the window's border.
class FaceWindows::Loops {
 public:
  Loops(const FaceWindows& all, const Request& request) : all_(all), request_(request) {
    face_ = TopoDS::Face(request.face->face.EmptyCopied().Oriented(TopAbs_FORWARD));
  }

  /// Empty where that is not clear.
  std::vector<TopoDS_Face> run() {
    take_parts();
    if (!link()) return {};
    if (entries_.empty() && !border_alone()) return {};
    for (std::size_t p = 0; p < parts_.size(); ++p)
      if (!parts_[p].used && !walk(p)) return {};
    return pieces();
  }

 private:
  struct Part {
    TopoDS_Edge edge;
    int next = -1;      ///< -1: leaves the window
    double leaves = 0;  ///< where, on its border
    bool used = false;
  };
  struct Entry {
    double border = 0;
    std::size_t part = 0;
    TopoDS_Vertex vertex;
  };

  void take_parts();
  bool link();
  bool border_alone();
  [[nodiscard]] std::vector<TopoDS_Face> pieces();
  bool walk(std::size_t from);
  bool add_border(TopoDS_Wire& wire, double from, TopoDS_Vertex start, double to, const TopoDS_Vertex& end);
  void add_side(TopoDS_Wire& wire, double from, const TopoDS_Vertex& start, double to, const TopoDS_Vertex& end);
  [[nodiscard]] std::optional<double> border_of(const TopoDS_Vertex& vertex) const;
  TopoDS_Vertex corner(std::size_t number);
  [[nodiscard]] gp_Pnt point(const Parameters& p) const;

  const FaceWindows& all_;
  const Request& request_;
  TopoDS_Face face_;
  std::vector<Part> parts_;
  std::vector<Entry> entries_;
  std::vector<double> exits_;
  std::array<TopoDS_Vertex, 4> corners_;
  std::vector<TopoDS_Wire> outer_;                         ///< those along the border: each bounds a piece of its own
  std::vector<std::pair<TopoDS_Wire, Parameters>> holes_;  ///< and a point of each
  const BRep_Builder builder_{};
};

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
  const Side& side = sides[static_cast<std::size_t>(from) % 4];
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
