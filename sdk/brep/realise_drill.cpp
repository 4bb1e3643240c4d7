// SPDX-License-Identifier: Apache-2.0
#include "realise_drill.hpp"

#include <BRepTopAdaptor_FClass2d.hxx>
#include <ElSLib.hxx>
#include <Extrema_ExtPC.hxx>
#include <algorithm>
#include <array>
#include <numeric>

#include "boolean.hpp"
#include "face_moments.hpp"
#include "solid_primitive.hpp"

namespace meso::brep {
namespace {

constexpr double straight = 1 - 1e-12;  ///< cosine of what counts as parallel
constexpr double across_axis = 1e-6;    ///< and of what counts as perpendicular

Box3 grown(const Box3& box) {
  const Vec3 d{clear_distance, clear_distance, clear_distance};
  return {box.min - d, box.max + d};
}

bool contains(const Box3& outer, const Box3& inner) {
  for (std::size_t i = 0; i < 3; ++i)
    if (inner.min[i] < outer.min[i] || inner.max[i] > outer.max[i]) return false;
  return true;
}

double distance_to_box(const Box3& box, Vec3 p) {
  Vec3 d;
  for (std::size_t i = 0; i < 3; ++i) d[i] = std::max({box.min[i] - p[i], 0.0, p[i] - box.max[i]});
  return norm(d);
}

Box3 box_of_edge(const TopoDS_Edge& edge) {
  Bnd_Box bounds;
  BRepBndLib::Add(edge, bounds, false);
  return {to_vec(bounds.CornerMin()), to_vec(bounds.CornerMax())};
}

/// From an edge, its ends included.
double distance_to_edge(const TopoDS_Edge& edge, Vec3 p) {
  const BRepAdaptor_Curve curve(edge);
  const double first = curve.FirstParameter(), last = curve.LastParameter();
  double nearest = std::min(norm(to_vec(curve.Value(first)) - p), norm(to_vec(curve.Value(last)) - p));
  const Extrema_ExtPC projection(to_pnt(p), curve, first, last);
  if (!projection.IsDone()) return 0;
  for (int i = 1; i <= projection.NbExt(); ++i) nearest = std::min(nearest, std::sqrt(projection.SquareDistance(i)));
  return nearest;
}

/// Adds `wires` to a face; they are oriented as on the oriented face.
TopoDS_Face with_wires(const TopoDS_Face& face, const std::vector<TopoDS_Shape>& wires) {
  const BRep_Builder builder;
  const bool is_reversed = face.Orientation() == TopAbs_REVERSED;
  const TopoDS_Shape forward = face.Oriented(TopAbs_FORWARD);  // Add() complements children of a reversed parent
  TopoDS_Shape result = forward.EmptyCopied();
  for (TopoDS_Iterator it(forward); it.More(); it.Next()) builder.Add(result, it.Value());
  for (const TopoDS_Shape& wire : wires) builder.Add(result, is_reversed ? wire.Reversed() : wire);
  return TopoDS::Face(result.Oriented(face.Orientation()));
}

/// A face of a prism: a plane with its outward normal, or a cylinder with its axis.
struct Wall {
  bool is_plane = true;
  Vec3 direction, point;
  TopoDS_Face face;
};

std::optional<Wall> wall_of(const TopoDS_Face& face) {
  const BRepAdaptor_Surface surface(face, false);
  if (surface.GetType() == GeomAbs_Cylinder)
    return Wall{false, to_vec(surface.Cylinder().Axis().Direction()), to_vec(surface.Cylinder().Location()), face};
  if (surface.GetType() != GeomAbs_Plane) return {};
  const gp_Pln plane = surface.Plane();
  const bool is_against = (face.Orientation() == TopAbs_REVERSED) == plane.Direct();
  const Vec3 normal = to_vec(plane.Axis().Direction());
  return Wall{true, is_against ? -normal : normal, to_vec(plane.Location()), face};
}

int wires_in(const TopoDS_Face& face) {
  int wires = 0;
  for (TopoDS_Iterator it(face); it.More(); it.Next()) wires += it.Value().ShapeType() == TopAbs_WIRE;
  return wires;
}

/// No point of the edges, which are lines and circles or else sampled, is farther away.
double reach_of(const TopoDS_Face& face, Vec3 centre) {
  double reach = 0;
  for (TopExp_Explorer it(face, TopAbs_EDGE); it.More(); it.Next()) {
    const BRepAdaptor_Curve curve(TopoDS::Edge(it.Current()));
    constexpr int steps = 16;
    const double first = curve.FirstParameter(), step = (curve.LastParameter() - first) / steps;
    double longest = 0;
    for (int i = 0; i <= steps; ++i) {
      const Vec3 p = to_vec(curve.Value(first + i * step));
      reach = std::max(reach, norm(p - centre));
      if (i > 0) longest = std::max(longest, norm(p - to_vec(curve.Value(first + (i - 1) * step))));
    }
    if (curve.GetType() != GeomAbs_Line) reach += longest / 8;  // an arc rises less than that above its chord
  }
  return reach;
}

std::vector<std::uint32_t> roots_of(std::vector<std::uint32_t> parents) {
  for (std::uint32_t i = 0; i < parents.size(); ++i) {
    std::uint32_t root = i;
    while (parents[root] != root) root = parents[root];
    parents[i] = root;
  }
  return parents;
}

}  // namespace

struct Drill::BodyFace {
  CarrierSurface surface;
  std::uint32_t solid = 0, shell = 0;  ///< shells are numbered over all solids
  Vec3 point, normal;                  ///< outward, of a plane
  std::unique_ptr<BRepTopAdaptor_FClass2d> inside{};
  gp_Pln plane{};
  std::vector<TopoDS_Edge> edges{};
  std::vector<Box3> edge_boxes{};

  BodyFace(const TopoDS_Face& face, std::uint32_t of_solid, std::uint32_t of_shell)
      : surface(face), solid(of_solid), shell(of_shell) {
    if (!surface.is_plane()) return;
    plane = BRepAdaptor_Surface(face, false).Plane();
    point = to_vec(plane.Location());
    const Vec3 along = to_vec(plane.Axis().Direction()) * (plane.Direct() ? 1.0 : -1.0);
    normal = face.Orientation() == TopAbs_REVERSED ? -along : along;
  }

  enum class Outline { within, beyond, across };
  /// Where an outline in this face's plane lies: `centre` and `radius` are those of a circle around it.
  [[nodiscard]] Outline outline(const TopoDS_Face& piece, Vec3 centre, double radius) {
    if (inside == nullptr) look_closer();
    const double clear = radius + clear_distance;
    for (std::size_t i = 0; i < edges.size(); ++i) {
      if (distance_to_box(edge_boxes[i], centre) > clear || distance_to_edge(edges[i], centre) > clear) continue;
      if (!keeps_out(edges[i], piece)) return Outline::across;
    }
    const TopExp_Explorer corner(piece, TopAbs_VERTEX);
    double u = 0, v = 0;
    ElSLib::Parameters(plane, BRep_Tool::Pnt(TopoDS::Vertex(corner.Current())), u, v);
    return inside->Perform(gp_Pnt2d(u, v)) == TopAbs_IN ? Outline::within : Outline::beyond;
  }

 private:
  /// The edge is clear of the piece's outline, and not within it.
  static bool keeps_out(const TopoDS_Edge& edge, const TopoDS_Face& piece) {
    const BRepAdaptor_Curve curve(edge);
    const gp_Pnt p = curve.Value(curve.FirstParameter());
    const gp_Pln plane = BRepAdaptor_Surface(piece, false).Plane();
    double u = 0, v = 0;
    ElSLib::Parameters(plane, p, u, v);
    if (BRepTopAdaptor_FClass2d(piece, Precision::PConfusion()).Perform(gp_Pnt2d(u, v)) != TopAbs_OUT) return false;
    for (TopExp_Explorer it(piece, TopAbs_EDGE); it.More(); it.Next())
      if (exact_distance(it.Current(), edge) <= clear_distance) return false;
    return true;
  }

  void look_closer() {
    inside = std::make_unique<BRepTopAdaptor_FClass2d>(surface.face(), Precision::PConfusion());
    for (TopExp_Explorer it(surface.face(), TopAbs_EDGE); it.More(); it.Next()) {
      edges.push_back(TopoDS::Edge(it.Current()));
      edge_boxes.push_back(box_of_edge(edges.back()));
    }
  }
};

/// A prism from the plane of `start` along `axis` (a unit vector).
struct Drill::Bore {
  Vec3 start, axis;  ///< `start` is the middle of a circle around the outline
  double length = 0, radius = 0;
  TopoDS_Face end;  ///< at `start`, its normal along the axis

  [[nodiscard]] Bore moved(const Affine& placement) const {
    return {placement * start, placement.linear * axis, length, radius, TopoDS::Face(mapped(end, placement))};
  }
  /// The piece that begins so far along the axis.
  [[nodiscard]] Bore piece(double begin, double long_) const {
    Bore out = moved(Affine::from_translation(begin * axis));
    out.length = long_;
    return out;
  }
};

/// Where a bore passes through a face of the body: `at` millimetres along its axis.
struct Drill::Crossing {
  double at = 0;
  std::uint32_t face = 0;
  bool enters = false;
};

/// A prism taken out of the body, from one face or end of the cutter to another.
struct Drill::Hole {
  Bore bore;
  std::array<std::optional<std::uint32_t>, 2> faces;  ///< of the body, where it is open
};

Drill::~Drill() = default;

Drill::Drill(const Solids& body) : body_(body) {}

void Drill::list_faces() {
  std::uint32_t shells = 0;
  for (std::uint32_t s = 0; s < body_.size(); ++s)
    for (TopExp_Explorer shell(body_[s], TopAbs_SHELL); shell.More(); shell.Next(), ++shells)
      for (TopExp_Explorer it(shell.Current(), TopAbs_FACE); it.More(); it.Next())
        faces_.emplace_back(TopoDS::Face(it.Current()), s, shells);
}

std::vector<Drill::Bore> Drill::bores_of(const Prototype& prototype) {
  std::vector<Bore> out;
  if (prototype.solids.size() != 1 || !prototype.is_simple) return out;
  std::vector<Wall> walls;
  for (const CarrierSurface& surface : prototype.surfaces) {
    const auto wall = wall_of(surface.face());
    if (!wall) return out;
    walls.push_back(*wall);
  }
  for (const Wall& start : walls) {
    if (!start.is_plane ||
        std::ranges::any_of(out, [&](const Bore& b) { return dot(b.axis, start.direction) > straight; }))
      continue;                          // the other end of a prism that is known
    const Vec3 axis = -start.direction;  // that of a plane is its outward normal
    const Wall* end = nullptr;
    bool is_prism = true;
    for (const Wall& wall : walls) {
      if (&wall == &start) continue;
      const double along = dot(wall.direction, axis);
      if (wall.is_plane ? std::fabs(along) < across_axis : std::fabs(along) > straight) continue;
      is_prism = is_prism && wall.is_plane && along > straight && end == nullptr;
      end = &wall;
    }
    if (!is_prism || end == nullptr || wires_in(start.face) != 1) continue;
    Bore bore{{}, axis, dot(end->point - start.point, axis), 0, TopoDS::Face(start.face.Reversed())};
    const Box3 box = face_box(start.face);
    bore.start = (box.min + box.max) / 2;
    bore.start += dot(start.point - bore.start, axis) * axis;
    bore.radius = reach_of(start.face, bore.start);
    if (bore.length > clear_distance) out.push_back(bore);
  }
  return out;
}

std::optional<std::vector<Drill::Crossing>> Drill::crossings(const Bore& bore, const CellSolids& cells,
                                                             const CellSolid& cell) {
  std::vector<Crossing> out;
  const Box3 box = grown(cell.box);
  std::optional<CoarseMesh> mesh;
  for (std::uint32_t f = 0; f < faces_.size(); ++f) {
    BodyFace& face = faces_[f];
    if (!face.surface.box().intersects(box)) continue;
    const double along = face.surface.is_plane() ? dot(face.normal, bore.axis) : 0;
    if (std::fabs(along) < straight) {
      if (!mesh) mesh = cells.mesh_of(cell);
      if (contains(box, face.surface.box()) || proven_side(face.surface, *mesh, clear_distance) == 0) return {};
      continue;
    }
    const double at = dot(face.point - bore.start, bore.axis);
    if (at < -clear_distance || at > bore.length + clear_distance) continue;
    const Bore there = bore.piece(at, 0);
    const BodyFace::Outline outline = face.outline(there.end, there.start, bore.radius);
    if (outline == BodyFace::Outline::across) return {};
    if (outline == BodyFace::Outline::within) out.push_back({at, f, along < 0});
  }
  std::ranges::stable_sort(out, {}, &Crossing::at);
  return out;
}

std::optional<std::vector<Drill::Hole>> Drill::holes_between(const std::vector<Crossing>& crossings,
                                                             const Bore& bore) const {
  std::vector<Hole> holes;
  const auto add = [&](const Crossing* from, const Crossing* to) {
    const double begin = from != nullptr ? from->at : 0, end = to != nullptr ? to->at : bore.length;
    if (end - begin <= clear_distance) return false;
    Hole hole{bore.piece(begin, end - begin), {}};
    if (from != nullptr) hole.faces[0] = from->face;
    if (to != nullptr) hole.faces[1] = to->face;
    if (from != nullptr && to != nullptr && faces_[from->face].solid != faces_[to->face].solid) return false;
    holes.push_back(hole);
    return true;
  };
  const Crossing* entry = nullptr;
  bool is_inside = !crossings.empty() && !crossings.front().enters;
  for (const Crossing& crossing : crossings) {
    if (crossing.enters == is_inside) return {};
    if (!crossing.enters && entry == nullptr && &crossing != &crossings.front()) return {};  // thinner than the margin
    // Where the cutter begins on a face and leads away from it, it only touches the body, and likewise where it ends.
    const bool touches = crossing.enters ? crossing.at >= bore.length - clear_distance
                                         : entry == nullptr && crossing.at <= clear_distance;
    if (!crossing.enters && !touches && !add(entry, &crossing)) return {};
    entry = crossing.enters && !touches ? &crossing : nullptr;
    is_inside = crossing.enters;
  }
  if (entry != nullptr && !add(entry, nullptr)) return {};
  return holes;
}

bool Drill::add(const CellSolids& cells, const CellSolid& cell) {
  const auto [known, fresh] = bores_.try_emplace(cell.prototype);
  if (fresh) known->second = bores_of(cells.prototypes[cell.prototype]);
  if (known->second.empty()) return false;
  if (faces_.empty()) list_faces();
  for (const Bore& bore : known->second) {
    const std::vector<Hole> holes = holes_of(bore.moved(cell.placement), cells, cell);
    holes_.insert(holes_.end(), holes.begin(), holes.end());
    if (!holes.empty()) return true;
  }
  return false;
}

/// None if a boolean must do it.
std::vector<Drill::Hole> Drill::holes_of(const Bore& bore, const CellSolids& cells, const CellSolid& cell) {
  const auto found = crossings(bore, cells, cell);
  if (!found) return {};
  return holes_between(*found, bore).value_or(std::vector<Hole>{});
}

Solids Drill::drilled() const {
  if (holes_.empty()) return body_;
  std::vector<std::uint32_t> parents(faces_.back().shell + 1);
  std::iota(parents.begin(), parents.end(), 0);
  const auto root_of = [&](std::uint32_t shell) {
    while (parents[shell] != shell) shell = parents[shell];
    return shell;
  };
  std::vector<std::vector<TopoDS_Shape>> wires(faces_.size()), walls(parents.size());
  for (const Hole& hole : holes_) {
    const Vec3 sweep = hole.bore.length * hole.bore.axis;
    // A copy: else all holes of one prototype gather their curves on the same few edges.
    BRepPrimAPI_MakePrism prism(hole.bore.end, gp_Vec(sweep.x, sweep.y, sweep.z), true);
    const std::array<TopoDS_Shape, 2> ends{prism.FirstShape(), prism.LastShape()};
    const std::uint32_t shell = faces_[hole.faces[0] ? *hole.faces[0] : *hole.faces[1]].shell;
    for (TopExp_Explorer it(prism.Shape(), TopAbs_FACE); it.More(); it.Next()) {
      const auto end = static_cast<std::size_t>(it.Current().IsSame(ends[1]));
      if (!it.Current().IsSame(ends[end]) || !hole.faces[end]) {
        walls[shell].push_back(it.Current().Reversed());
        continue;
      }
      // The end of the prism is a piece of the face, seen from the same side: its rim, reversed, bounds a hole.
      const TopExp_Explorer rim(it.Current(), TopAbs_WIRE);
      wires[*hole.faces[end]].push_back(rim.Current().Reversed());
    }
    if (hole.faces[0] && hole.faces[1]) {
      const std::uint32_t a = root_of(faces_[*hole.faces[0]].shell), b = root_of(faces_[*hole.faces[1]].shell);
      parents[std::max(a, b)] = std::min(a, b);
    }
  }
  const std::vector<std::uint32_t> roots = roots_of(std::move(parents));
  std::vector<bool> changed(roots.size(), false);
  for (std::size_t s = 0; s < roots.size(); ++s)
    changed[roots[s]] = changed[roots[s]] || roots[s] != s || !walls[s].empty();
  const BRep_Builder builder;
  std::vector<TopoDS_Shell> shells(roots.size());
  Solids out;
  std::size_t shell = 0;
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    if (!changed[roots[faces_[f].shell]]) continue;
    TopoDS_Shell& to = shells[roots[faces_[f].shell]];
    if (to.IsNull()) builder.MakeShell(to);
    const TopoDS_Face& face = faces_[f].surface.face();
    builder.Add(to, wires[f].empty() ? face : with_wires(face, wires[f]));
  }
  for (std::size_t s = 0; s < walls.size(); ++s)
    for (const TopoDS_Shape& wall : walls[s]) builder.Add(shells[roots[s]], wall);
  for (const TopoDS_Shape& solid : body_) {
    TopoDS_Solid result;
    builder.MakeSolid(result);
    for (TopExp_Explorer it(solid, TopAbs_SHELL); it.More(); it.Next(), ++shell) {
      if (roots[shell] != shell) continue;
      if (changed[shell]) shells[shell].Closed(true);
      builder.Add(result, changed[shell] ? shells[shell] : it.Current());
    }
    out.push_back(result);
  }
  return out;
}

}  // namespace meso::brep
