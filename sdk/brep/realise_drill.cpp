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

namespace meso::brep {
namespace {

constexpr double straight = 1 - 1e-12;  ///< cosine of what counts as parallel

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

  enum class Circle { within, beyond, across };
  [[nodiscard]] Circle circle(Vec3 centre, double radius) {
    if (inside == nullptr) look_closer();
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const double clear = radius + clear_distance;
      if (distance_to_box(edge_boxes[i], centre) > clear) continue;
      if (distance_to_edge(edges[i], centre) <= clear) return Circle::across;
    }
    double u = 0, v = 0;
    ElSLib::Parameters(plane, to_pnt(centre), u, v);
    return inside->Perform(gp_Pnt2d(u, v)) == TopAbs_IN ? Circle::within : Circle::beyond;
  }

 private:
  void look_closer() {
    inside = std::make_unique<BRepTopAdaptor_FClass2d>(surface.face(), Precision::PConfusion());
    for (TopExp_Explorer it(surface.face(), TopAbs_EDGE); it.More(); it.Next()) {
      edges.push_back(TopoDS::Edge(it.Current()));
      edge_boxes.push_back(box_of_edge(edges.back()));
    }
  }
};

/// A cylinder from `start` along `axis` (a unit vector).
struct Drill::Bore {
  Vec3 start, axis;
  double length = 0, radius = 0;
};

/// Where a bore passes through a face of the body: `at` millimetres along its axis.
struct Drill::Crossing {
  double at = 0;
  std::uint32_t face = 0;
  bool enters = false;
};

/// A cylinder taken out of the body, from one face or end of the cutter to another.
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

std::optional<Drill::Bore> Drill::bore_of(const Prototype& prototype) {
  if (prototype.solids.size() != 1 || prototype.surfaces.size() != 3) return {};
  std::optional<gp_Cylinder> wall;
  std::vector<gp_Pln> ends;
  for (const CarrierSurface& surface : prototype.surfaces) {
    const BRepAdaptor_Surface face(surface.face(), false);
    if (face.GetType() == GeomAbs_Cylinder) wall = face.Cylinder();
    if (face.GetType() == GeomAbs_Plane) ends.push_back(face.Plane());
  }
  if (!wall || ends.size() != 2) return {};
  const Vec3 axis = to_vec(wall->Axis().Direction()), origin = to_vec(wall->Location());
  std::array<double, 2> at{};
  for (std::size_t i = 0; i < 2; ++i) {
    if (std::fabs(dot(to_vec(ends[i].Axis().Direction()), axis)) < straight) return {};
    at[i] = dot(to_vec(ends[i].Location()) - origin, axis);
  }
  const double low = std::min(at[0], at[1]), high = std::max(at[0], at[1]);
  return Bore{origin + low * axis, axis, high - low, wall->Radius()};
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
    const BodyFace::Circle circle = face.circle(bore.start + at * bore.axis, bore.radius);
    if (circle == BodyFace::Circle::across) return {};
    if (circle == BodyFace::Circle::within) out.push_back({at, f, along < 0});
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
    Hole hole{{bore.start + begin * bore.axis, bore.axis, end - begin, bore.radius}, {}};
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
  auto [known, fresh] = bores_.try_emplace(cell.prototype);
  if (fresh)
    if (const auto bore = bore_of(cells.prototypes[cell.prototype])) known->second = std::make_unique<Bore>(*bore);
  if (known->second == nullptr) return false;
  if (faces_.empty()) list_faces();
  Bore bore = *known->second;
  bore.start = cell.placement * bore.start;
  bore.axis = cell.placement.linear * bore.axis;
  const auto found = crossings(bore, cells, cell);
  if (!found) return false;
  const auto holes = holes_between(*found, bore);
  if (!holes || holes->empty()) return false;
  holes_.insert(holes_.end(), holes->begin(), holes->end());
  return true;
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
    const gp_Ax2 frame(to_pnt(hole.bore.start), to_dir(hole.bore.axis));
    BRepPrimAPI_MakeCylinder cylinder(frame, hole.bore.radius, hole.bore.length);
    const std::array<TopoDS_Face, 2> ends{cylinder.Cylinder().BottomFace(), cylinder.Cylinder().TopFace()};
    const std::uint32_t shell = faces_[hole.faces[0] ? *hole.faces[0] : *hole.faces[1]].shell;
    for (TopExp_Explorer it(cylinder.Solid(), TopAbs_FACE); it.More(); it.Next()) {
      const auto end = static_cast<std::size_t>(it.Current().IsSame(ends[1]));
      if (!it.Current().IsSame(ends[end]) || !hole.faces[end]) {
        walls[shell].push_back(it.Current().Reversed());
        continue;
      }
      // The end of the cylinder is a piece of the face, seen from the same side: its rim, reversed, bounds a hole.
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
