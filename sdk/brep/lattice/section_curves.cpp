// SPDX-License-Identifier: Apache-2.0
#include "lattice/section_curves.hpp"

#include <BRep_TEdge.hxx>
#include <BRep_TVertex.hxx>
#include <BSplCLib.hxx>
#include <Geom2d_BSplineCurve.hxx>
#include <algorithm>
#include <optional>

namespace meso::brep {
namespace {

constexpr double aim = 1e-7;       ///< of the cell: how far a curve may be off
constexpr double farthest = 2e-2;  ///< of the cell: how far a point may move
constexpr double flattest = 1e-3;  ///< sine of the angle between surfaces that cut each other
constexpr double smallest = 1e-7;  ///< millimetres: OpenCASCADE's least tolerance
constexpr int degree = 7;
constexpr std::array<int, 5> counts{8, 10, 14, 22, 38};  ///< points along a curve

/// A point of a surface that follows a point of space.
class Foot {
 public:
  Foot(const GeomAdaptor_Surface& surface, const gp_Pnt2d& at) : surface_(surface), u_(at.X()), v_(at.Y()) { look(); }

  [[nodiscard]] Vec3 point() const { return point_; }
  [[nodiscard]] Vec3 normal() const { return normal_; }
  [[nodiscard]] gp_Pnt2d parameters() const { return {u_, v_}; }
  /// Where the surface has a tangent plane.
  [[nodiscard]] bool regular() const { return regular_; }

  /// One step of Gauss and Newton.
  void follow(Vec3 p) {
    const Vec3 to = p - point_;
    const double a = dot(du_, du_), b = dot(du_, dv_), c = dot(dv_, dv_), det = a * c - b * b;
    const double along_u = dot(du_, to), along_v = dot(dv_, to);
    u_ += (c * along_u - b * along_v) / det;
    v_ += (a * along_v - b * along_u) / det;
    look();
  }

 private:
  void look() {
    gp_Pnt p;
    gp_Vec du, dv;
    surface_.D1(u_, v_, p, du, dv);
    point_ = to_vec(p);
    du_ = to_vec(du.XYZ());
    dv_ = to_vec(dv.XYZ());
    const Vec3 across = cross(du_, dv_);
    const double area = norm(across);
    regular_ = area > 1e-6 * norm(du_) * norm(dv_) && area > 0;
    normal_ = regular_ ? across / area : Vec3{};
  }

  const GeomAdaptor_Surface& surface_;
  double u_, v_;
  Vec3 point_, du_, dv_, normal_;
  bool regular_ = false;
};

constexpr int most_steps = 12;

/// Onto the surface, as close to `p` as it gets.
bool drop(Foot& foot, Vec3 p, double eps) {
  for (int step = 0; step < most_steps && foot.regular(); ++step) {
    const Vec3 before = foot.point();
    foot.follow(p);
    if (foot.regular() && norm(foot.point() - before) < eps) return true;
  }
  return false;
}

/// To the nearest point of both surfaces.
std::optional<Vec3> meet(Foot& a, Foot& b, Vec3 p, double eps) {
  for (int step = 0; step < most_steps && a.regular() && b.regular(); ++step) {
    const double c = dot(a.normal(), b.normal()), det = 1 - c * c;
    if (det < flattest * flattest) return {};
    const double to_a = dot(a.normal(), a.point() - p), to_b = dot(b.normal(), b.point() - p);
    p += (to_a - c * to_b) / det * a.normal() + (to_b - c * to_a) / det * b.normal();
    a.follow(p);
    b.follow(p);
    if (a.regular() && b.regular() && norm(a.point() - p) < eps && norm(b.point() - p) < eps) return p;
  }
  return {};
}

/// Where a curve meets a surface; `t` is its parameter there.
std::optional<Vec3> pierce(const Geom_Curve& curve, double& t, Foot& foot, double eps) {
  for (int step = 0; step < most_steps && foot.regular(); ++step) {
    gp_Pnt p;
    gp_Vec along;
    curve.D1(t, p, along);
    const Vec3 tangent = to_vec(along.XYZ());
    const double climb = dot(foot.normal(), tangent);
    if (std::fabs(climb) < flattest * norm(tangent)) return {};
    t += dot(foot.normal(), foot.point() - to_vec(p)) / climb;
    const Vec3 at = to_vec(curve.Value(t));
    foot.follow(at);
    if (foot.regular() && norm(foot.point() - at) < eps) return at;
  }
  return {};
}

struct Surfaces {
  GeomAdaptor_Surface cell, body;
  Handle(Geom2d_Curve) on_cell, on_body;
  Handle(Geom_Curve) curve;
  double first = 0, last = 0;

  [[nodiscard]] double at(int i, int count) const { return first + (last - first) * i / (count - 1); }
};

std::optional<Surfaces> surfaces_at(const SectionEdge& section) {
  double f = 0, l = 0;
  Surfaces out;
  out.curve = BRep_Tool::Curve(section.edge, out.first, out.last);
  out.on_cell = BRep_Tool::CurveOnSurface(section.edge, section.of_cell, f, l);
  out.on_body = BRep_Tool::CurveOnSurface(section.edge, section.of_body, f, l);
  if (out.curve.IsNull() || out.on_cell.IsNull() || out.on_body.IsNull()) return {};
  if (BRep_Tool::IsClosed(section.edge, section.of_cell) || BRep_Tool::IsClosed(section.edge, section.of_body))
    return {};
  out.cell.Load(BRep_Tool::Surface(section.of_cell));
  out.body.Load(BRep_Tool::Surface(section.of_body));
  return out;
}

/// The curve and its images, through the same points at the same parameters.
struct Fitted {
  Handle(Geom_BSplineCurve) curve;
  Handle(Geom2d_BSplineCurve) on_cell, on_body;
  double off = 0;
};

template <typename Points>
Points poles_through(const Points& points, const TColStd_Array1OfReal& knots, const TColStd_Array1OfReal& at) {
  TColStd_Array1OfInteger order(1, at.Length());
  order.Init(0);
  Points poles = points;
  int problem = 0;
  BSplCLib::Interpolate(degree, knots, at, order, poles, problem);
  if (problem != 0) throw Standard_Failure("a curve cannot be laid through its points");
  return poles;
}

std::optional<Fitted> fit(const Surfaces& on, Vec3 start, Vec3 end, int count, double size) {
  TColgp_Array1OfPnt points(1, count);
  TColgp_Array1OfPnt2d on_cell(1, count), on_body(1, count);
  TColStd_Array1OfReal at(1, count);
  const double eps = 0.01 * aim * size;
  for (int i = 0; i < count; ++i) {
    const double t = on.at(i, count);
    Foot cell(on.cell, on.on_cell->Value(t)), body(on.body, on.on_body->Value(t));
    const Vec3 before = to_vec(on.curve->Value(t));
    Vec3 p = i == 0 ? start : end;
    if (i > 0 && i + 1 < count) {
      const auto met = meet(cell, body, before, eps);
      if (!met || norm(*met - before) > farthest * size) return {};
      p = *met;
    } else if (!drop(cell, p, eps) || !drop(body, p, eps)) {
      return {};
    }
    points(i + 1) = to_pnt(p);
    on_cell(i + 1) = cell.parameters();
    on_body(i + 1) = body.parameters();
    const double step = i == 0 ? 0 : points(i).Distance(points(i + 1));
    if (i > 0 && step < 10 * eps) return {};
    at(i + 1) = i == 0 ? 0 : at(i) + step;
    if (i > 1 && gp_Vec(points(i - 1), points(i)).Dot(gp_Vec(points(i), points(i + 1))) <= 0) return {};
  }
  // Knots at the points, but for some at each end (de Boor's not-a-knot).
  const int inner = count - degree - 1;
  TColStd_Array1OfReal flat(1, count + degree + 1), knots(1, inner + 2);
  TColStd_Array1OfInteger times(1, inner + 2);
  times.Init(1);
  times(1) = times(inner + 2) = degree + 1;
  knots(1) = at(1);
  knots(inner + 2) = at(count);
  for (int i = 1; i <= inner; ++i) knots(i + 1) = at(i + (degree + 1) / 2);
  for (int i = 1; i <= flat.Length(); ++i) flat(i) = knots(std::clamp(i - degree, 1, inner + 2));
  Fitted out{new Geom_BSplineCurve(poles_through(points, flat, at), knots, times, degree),
             new Geom2d_BSplineCurve(poles_through(on_cell, flat, at), knots, times, degree),
             new Geom2d_BSplineCurve(poles_through(on_body, flat, at), knots, times, degree)};
  for (int i = 1; i < count; ++i)
    for (const double share : {0.25, 0.5, 0.75}) {
      const double t = (1 - share) * at(i) + share * at(i + 1);
      const gp_Pnt p = out.curve->Value(t);
      const gp_Pnt2d a = out.on_cell->Value(t), b = out.on_body->Value(t);
      out.off = std::fmax(out.off,
                          std::fmax(p.Distance(on.cell.Value(a.X(), a.Y())), p.Distance(on.body.Value(b.X(), b.Y()))));
    }
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
  std::optional<Vec3> on_divided(const Corner& corner, const Surfaces& on, double at);
  void refit(std::size_t s);
  void settle(Corner& corner);

  const std::vector<SectionEdge>& sections_;
  const std::vector<DividedEdge>& divided_;
  double size_;
  TopTools_IndexedMapOfShape vertices_;
  std::vector<Corner> corners_;
  std::vector<std::optional<Surfaces>> surfaces_;
};

void SectionFit::move(Corner& corner) {
  const auto one =
      std::ranges::find_if(corner.sections, [&](const End& end) { return surfaces_[end.edge].has_value(); });
  if (one == corner.sections.end()) return;
  const Surfaces& on = *surfaces_[one->edge];
  const double at = one->last ? on.last : on.first, eps = 0.01 * aim * size_;
  std::optional<Vec3> place;
  if (corner.divided.empty()) {
    Foot cell(on.cell, on.on_cell->Value(at)), body(on.body, on.on_body->Value(at));
    place = meet(cell, body, corner.place, eps);
  } else {
    place = on_divided(corner, on, at);
  }
  if (!place || norm(*place - corner.place) > farthest * size_) return;
  corner.moved = norm(*place - corner.place) > eps;
  if (corner.moved) corner.place = *place;
}

/// Along the one old edge that ends here, and nowhere if there are others.
std::optional<Vec3> SectionFit::on_divided(const Corner& corner, const Surfaces& on, double at) {
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
  Foot foot = edge.of_cell ? Foot(on.body, on.on_body->Value(at)) : Foot(on.cell, on.on_cell->Value(at));
  const auto place = pierce(*placed, t, foot, 0.01 * aim * size_);
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
  if (!surfaces_[s] || (known <= aim * size_ && !start.moved && !end.moved)) return;
  std::optional<Fitted> best;
  for (const int count : counts) {
    auto fitted = fit(*surfaces_[s], start.place, end.place, count, size_);
    if (!fitted) break;
    if (!best || fitted->off < best->off) best = std::move(fitted);
    if (best->off <= aim * size_) break;
  }
  if (!best || best->off > known) return;
  const BRep_Builder builder;
  builder.UpdateEdge(section.edge, best->curve, TopLoc_Location(), smallest);
  builder.UpdateEdge(section.edge, best->on_cell, section.of_cell, smallest);
  builder.UpdateEdge(section.edge, best->on_body, section.of_body, smallest);
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
