// SPDX-License-Identifier: Apache-2.0
#include "lattice/quotient_builder.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <string>

#include "face_moments.hpp"
#include "fit_triangles.hpp"
#include "lattice/imprint.hpp"
#include "lattice/natural_faces.hpp"
#include "lattice/orbit_matcher.hpp"
#include "lattice/parallel.hpp"
#include "lattice/template_mesh.hpp"
#include "meso/brep/instance_map.hpp"
#include "shape_to_body.hpp"

namespace meso::brep {
namespace {

TopoDS_Shell all_faces(const TopoDS_Shape& solid) {
  TopoDS_Shell shell;
  BRep_Builder builder;
  builder.MakeShell(shell);
  for (TopExp_Explorer it(solid, TopAbs_FACE); it.More(); it.Next()) builder.Add(shell, it.Current());
  return shell;
}

/// Of one edge: a face and whether it uses the edge reversed.
using FaceUses = std::vector<std::pair<std::uint32_t, bool>>;

/// Of an edge along which a body touches a wall: puts the wall and the face of the skin on either side next to each
/// other. False if it is no such edge.
template <typename IsWall>
bool are_two_wedges(FaceUses& uses, const IsWall& is_wall) {
  if (uses.size() != 4) return false;
  std::ranges::sort(uses, {}, [&](const auto& use) { return std::pair(is_wall(use.first) == use.second, use.second); });
  return is_wall(uses[0].first) != is_wall(uses[1].first) && is_wall(uses[2].first) != is_wall(uses[3].first);
}

class Builder {
 public:
  Builder(const CellShape& cell, Quotient& quotient, double tolerance)
      : cell_(cell),
        quotient_(quotient),
        geometry_(*quotient.geometry),
        matcher_(geometry_, quotient.samples, cell.box.min, tolerance),
        tolerance_(tolerance) {}

  /// Matches the edges; false if the solid is not closed in itself.
  bool add_kind(const TopoDS_Shape& solid);
  void add_meshes(const MeshFineness& fineness, const RunOptions& run);
  /// False if a solid is not a manifold.
  [[nodiscard]] bool add_faces(const RunOptions& run);

 private:
  struct Source {
    TopoDS_Shell shell;
    TopTools_IndexedMapOfShape edges;  // in the order of shell_to_template
    std::vector<OrbitMatcher::Match> matches;
    std::vector<std::uint32_t> face_lumps;

    [[nodiscard]] TemplateEdges template_edges() const { return {shell, edges, matches}; }
  };

  [[nodiscard]] std::vector<Template> own_templates(const RunOptions& run) const;
  [[nodiscard]] bool on_wall(Vec3 p, std::size_t axis, int side) const {
    return std::fabs(p[axis] - (side ? cell_.box.max : cell_.box.min)[axis]) < 4 * tolerance_;
  }
  [[nodiscard]] bool on_boundary(const TopoDS_Edge& edge) const;
  void add_meshes_of(const Source& source, const CellKind& kind);
  void classify(CellFace& face, const FaceTemplate& value, const TopoDS_Face& shape) const;
  std::uint32_t wall_orbit(const CellFace& face, const FaceTemplate& value);
  bool find_clusters(CellKind& kind, const std::vector<std::uint32_t>& face_lumps);

  const CellShape& cell_;
  Quotient& quotient_;
  Template& geometry_;
  OrbitMatcher matcher_;
  double tolerance_;
  std::vector<Source> sources_;
  std::vector<bool> boundary_;  // per edge of the template
  std::map<std::vector<std::int32_t>, std::uint32_t> wall_orbits_;
  std::optional<EdgePolygons> polygons_;  // where a mesh is wanted
  MeshFineness fineness_;
};

bool Builder::on_boundary(const TopoDS_Edge& edge) const {
  const BRepAdaptor_Curve curve(edge);
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const int side : {0, 1}) {
      bool all = true;
      for (int k = 0; k <= 4; ++k) {
        const double t = k / 4.0;
        const gp_Pnt p = curve.Value((1 - t) * curve.FirstParameter() + t * curve.LastParameter());
        all = all && on_wall(to_vec(p), axis, side);
      }
      if (all) return true;
    }
  return false;
}

bool Builder::add_kind(const TopoDS_Shape& solid) {
  CellKind& kind = quotient_.kinds.emplace_back();
  Source& source = sources_.emplace_back();
  source.shell = all_faces(solid);
  for (TopExp_Explorer lump(solid, TopAbs_SOLID); lump.More(); lump.Next(), ++kind.lumps)
    for (TopExp_Explorer it(lump.Current(), TopAbs_FACE); it.More(); it.Next()) source.face_lumps.push_back(kind.lumps);
  TopExp::MapShapes(source.shell, TopAbs_EDGE, source.edges);
  source.matches = matcher_.match(source.edges);
  for (int i = 1; i <= source.edges.Extent(); ++i) {
    const TopoDS_Edge& edge = TopoDS::Edge(source.edges(i));
    const OrbitMatcher::Match& match = source.matches[static_cast<std::size_t>(i) - 1];
    if (boundary_.size() <= match.edge) boundary_.resize(match.edge + 1);
    if (BRep_Tool::Degenerated(edge) || !on_boundary(edge)) continue;
    boundary_[match.edge] = true;
    kind.boundary_edges.push_back({match.edge, match.offset});
  }
  std::size_t faces = 0;
  for (TopExp_Explorer it(source.shell, TopAbs_FACE); it.More(); it.Next()) ++faces;
  return source.face_lumps.size() == faces;  // every face bounds one solid
}

void Builder::add_meshes(const MeshFineness& fineness, const RunOptions& run) {
  std::vector<TemplateEdges> edges;
  for (const Source& source : sources_) edges.push_back(source.template_edges());
  polygons_ = mesh_alike(edges, geometry_, fineness, run);
  fineness_ = fineness;
}

void Builder::classify(CellFace& face, const FaceTemplate& value, const TopoDS_Face& shape) const {
  if (!std::holds_alternative<Plane>(value.surface)) return;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const int side : {0, 1}) {
      if (!on_wall(side ? value.box.min : value.box.max, axis, side)) continue;
      bool all = true;
      for (TopExp_Explorer it(shape, TopAbs_VERTEX); it.More(); it.Next())
        all = all && on_wall(to_vec(BRep_Tool::Pnt(TopoDS::Vertex(it.Current()))), axis, side);
      if (!all || std::fabs(std::fabs(value.moments.vector_area[axis]) / value.moments.area - 1) > 1e-9) continue;
      face.axis = static_cast<int>(axis);
      face.side = side;
    }
}

/// Two walls are one region if they have the same edges, seen from the cell on the high side of the plane.
std::uint32_t Builder::wall_orbit(const CellFace& face, const FaceTemplate& value) {
  std::vector<std::array<std::int32_t, 4>> edges;
  for (const auto& loop : value.loops)
    for (const Coedge& use : loop) {
      Index3 offset = use.offset;
      offset[static_cast<std::size_t>(face.axis)] -= face.side;
      edges.push_back({static_cast<std::int32_t>(use.edge), offset[0], offset[1], offset[2]});
    }
  std::sort(edges.begin(), edges.end());
  std::vector<std::int32_t> key{face.axis};
  for (const auto& edge : edges) key.insert(key.end(), edge.begin(), edge.end());
  return wall_orbits_.emplace(key, static_cast<std::uint32_t>(wall_orbits_.size())).first->second;
}

/// Moments take most of the time, and each kind's are its own.
std::vector<Template> Builder::own_templates(const RunOptions& run) const {
  std::vector<Template> own(sources_.size());
  const bool done = in_parallel(sources_.size(), run, [&](std::size_t, std::size_t k) {
    try {
      own[k] = shell_to_template(sources_[k].shell, {});
      return true;
    } catch (const Standard_Failure&) {
      return false;
    }
  });
  if (!done) throw Standard_Failure("some face has no area, or the run was stopped");
  return own;
}

void Builder::add_meshes_of(const Source& source, const CellKind& kind) {
  std::vector<MeshedFace> faces;
  for (std::size_t f = 0; f < kind.faces.size(); ++f) {
    FaceTemplate& face = geometry_.faces[kind.faces[f].face];
    auto mesh = named_mesh(kind.shapes[f], source.template_edges(), geometry_, *polygons_, fineness_);
    if (!mesh) throw Standard_Failure("a face has not the points of its edges");
    face.mesh = std::move(*mesh);
    const Handle(Geom_Surface) surface = BRep_Tool::Surface(kind.shapes[f]);
    if (!std::holds_alternative<Plane>(face.surface))
      fit_triangles(face.mesh, surface, geometry_.lattice, fineness_.deflection);
    faces.push_back({&face.mesh, surface, kind.faces[f].axis >= 0});
  }
  part_segments(faces, geometry_.lattice, cell_.box, 4 * tolerance_);
}

bool Builder::add_faces(const RunOptions& run) {
  std::vector<Template> templates = own_templates(run);
  for (std::size_t k = 0; k < sources_.size(); ++k) {
    const Source& source = sources_[k];
    CellKind& kind = quotient_.kinds[k];
    Template& own = templates[k];
    std::size_t index = 0;
    for (TopExp_Explorer it(source.shell, TopAbs_FACE); it.More(); it.Next(), ++index) {
      FaceTemplate& value = own.faces[index];
      for (auto& loop : value.loops)
        for (Coedge& use : loop) {
          const OrbitMatcher::Match& match = source.matches[use.edge];
          use = {.edge = match.edge, .offset = match.offset, .reversed = use.reversed != match.flipped};
        }
      CellFace face{.face = static_cast<std::uint32_t>(geometry_.faces.size())};
      classify(face, value, TopoDS::Face(it.Current()));
      if (face.axis >= 0) {
        face.wall_orbit = wall_orbit(face, value);
        kind.walls.insert(2 * std::uint64_t{face.wall_orbit} + static_cast<std::uint64_t>(face.side));
      }
      kind.faces.push_back(face);
      kind.shapes.push_back(TopoDS::Face(it.Current()));
      geometry_.faces.push_back(std::move(value));
    }
    Enclosed enclosed;
    for (const CellFace& face : kind.faces) enclosed.add(geometry_.faces[face.face], {});
    kind.volume = enclosed.volume();
    if (polygons_) add_meshes_of(source, kind);
  }
  quotient_.uses.resize(geometry_.edges.size());
  for (std::uint32_t k = 0; k < quotient_.kinds.size(); ++k)
    for (std::uint32_t f = 0; f < quotient_.kinds[k].faces.size(); ++f)
      for (const auto& loop : geometry_.faces[quotient_.kinds[k].faces[f].face].loops)
        for (const Coedge& use : loop)
          quotient_.uses[use.edge].push_back({.kind = k,
                                              .face = f,
                                              .face_cell = {-use.offset[0], -use.offset[1], -use.offset[2]},
                                              .reversed = use.reversed});
  bool closed = true;
  for (std::size_t k = 0; k < sources_.size(); ++k)
    closed = find_clusters(quotient_.kinds[k], sources_[k].face_lumps) && closed;
  return closed;
}

/// Faces of the skin that share an edge stay together. A wall hangs on the skin beside it where that is in one piece; a
/// wall between several must not tie them together, because it may not show: they are then joined edge by edge where it
/// does.
bool Builder::find_clusters(CellKind& kind, const std::vector<std::uint32_t>& face_lumps) {
  std::map<std::pair<std::uint32_t, Index3>, FaceUses> at_edge;
  for (std::uint32_t f = 0; f < kind.faces.size(); ++f)
    for (const auto& loop : geometry_.faces[kind.faces[f].face].loops)
      for (const Coedge& use : loop)
        if (!geometry_.edges[use.edge].degenerate) at_edge[{use.edge, use.offset}].push_back({f, use.reversed});
  UnionFind sets(kind.faces.size());
  std::vector<std::set<std::uint32_t>> beside(kind.faces.size());  // of a wall: faces of the skin
  const auto is_wall = [&](std::uint32_t f) { return kind.faces[f].axis >= 0; };
  for (auto& [edge, uses] : at_edge) {
    if (uses.size() != 2 && !are_two_wedges(uses, is_wall)) return false;
    for (std::size_t i = 0; i < uses.size(); i += 2) {
      if (uses[i].second == uses[i + 1].second) return false;
      const auto [a, b] = std::pair(uses[i].first, uses[i + 1].first);
      if (!is_wall(a) && !is_wall(b)) sets.join(a, b);
      if (is_wall(a) && !is_wall(b)) beside[a].insert(b);
      if (is_wall(b) && !is_wall(a)) beside[b].insert(a);
    }
  }
  std::vector<std::uint32_t> skin(kind.faces.size());
  for (std::uint32_t f = 0; f < skin.size(); ++f) skin[f] = sets.root(f);
  for (std::uint32_t f = 0; f < skin.size(); ++f) {
    const auto in_one_piece = [&](std::uint32_t other) { return skin[other] == skin[*beside[f].begin()]; };
    if (!beside[f].empty() && std::ranges::all_of(beside[f], in_one_piece)) sets.join(f, *beside[f].begin());
  }
  std::map<std::uint32_t, std::uint32_t> numbers;
  for (std::uint32_t f = 0; f < kind.faces.size(); ++f) {
    const auto [it, fresh] = numbers.emplace(sets.root(f), static_cast<std::uint32_t>(numbers.size()));
    kind.faces[f].cluster = it->second;
    if (fresh) kind.cluster_lumps.push_back(face_lumps[f]);
  }
  return true;
}

/// False with an error: the solids are right, and made in other ways they would be no easier to triangulate.
bool has_meshes(Builder& builder, const MeshFineness& fineness, const RunOptions& run, DiagnosticSink& sink) {
  try {
    builder.add_meshes(fineness, run);
    return true;
  } catch (const Standard_Failure& failure) {
    if (!run.should_stop())
      sink.report({.code = Code::geometry_kernel, .args = {"making the triangles of cells", what(failure)}});
    return false;
  }
}

}  // namespace

bool walls_overlap(const CellKind& low, const CellKind& high, int axis, Vec3 size) {
  Vec3 by{};
  by[static_cast<std::size_t>(axis)] = size[static_cast<std::size_t>(axis)];
  gp_Trsf move;
  move.SetTranslation(gp_Vec(by.x, by.y, by.z));
  const auto lonely = [&](const CellFace& face, int side, const CellKind& other) {
    return face.axis == axis && face.side == side &&
           !other.walls.contains(2 * std::uint64_t{face.wall_orbit} + static_cast<std::uint64_t>(1 - side));
  };
  for (std::size_t a = 0; a < low.faces.size(); ++a) {
    if (!lonely(low.faces[a], 1, high)) continue;
    for (std::size_t b = 0; b < high.faces.size(); ++b) {
      if (!lonely(high.faces[b], 0, low)) continue;
      BRepAlgoAPI_Common common(low.shapes[a], high.shapes[b].Moved(TopLoc_Location(move)));
      if (common.HasErrors()) return true;
      GProp_GProps area;
      BRepGProp::SurfaceProperties(common.Shape(), area);
      if (area.Mass() > 1e-9 * size.x * size.y) return true;
    }
  }
  return false;
}

std::optional<std::vector<TopoDS_Shape>> kind_solids(const CellShape& cell, const Reach& reach,
                                                     const std::vector<std::vector<std::uint32_t>>& kinds,
                                                     const RunOptions& run, DiagnosticSink& sink, FusedBudget* budget) {
  std::vector<TopoDS_Shape> solids(kinds.size());
  std::vector<CellShape> cells;  // one for each thread: OpenCASCADE writes to the shapes it reads
  for (std::size_t i = 0; i < workers_for(kinds.size(), run); ++i) {
    CellShape& own = cells.emplace_back(cell);
    for (TopoDS_Shape& solid : own.solids) solid = BRepBuilderAPI_Copy(solid).Shape();
  }
  std::vector<DiagnosticSink> sinks(kinds.size());
  const bool done = in_parallel(kinds.size(), run, [&](std::size_t worker, std::size_t k) {
    const auto solid = solid_in_box(cells[worker], reach, kinds[k], run, sinks[k], budget);
    if (solid) solids[k] = *solid;
    return solid.has_value();
  });
  if (!done) {
    const auto told = std::ranges::find_if(sinks, [](const DiagnosticSink& s) { return !s.diagnostics().empty(); });
    if (told != sinks.end()) sink.report(told->diagnostics().front());
    return {};
  }
  if (cell.varied) return solids;  // alike or not is a question of neighbours: align_edges()
  try {
    if (divide_alike(solids, cell)) return solids;
  } catch (const Standard_Failure&) {
  }
  sink.report({.code = Code::geometry_not_repeatable, .args = {"the walls of the unit cell cannot be divided alike"}});
  return {};
}

std::optional<Quotient> build_quotient(const CellShape& cell, const std::vector<TopoDS_Shape>& solids,
                                       const LatticeOptions& options, double tolerance, const RunOptions& run,
                                       DiagnosticSink& sink) {
  const Vec3 size = cell.size();
  Quotient quotient;
  quotient.tolerance = cell.tolerance();
  quotient.geometry->lattice = Mat3::from_columns({size.x, 0, 0}, {0, size.y, 0}, {0, 0, size.z});
  std::string fault;
  try {
    Builder builder(cell, quotient, tolerance);
    for (const TopoDS_Shape& solid : solids) {
      if (run.should_stop()) throw Standard_Failure("stopped");
      if (!builder.add_kind(solid)) fault = "a face of the unit cell bounds no solid";
    }
    if (options.mesh && !has_meshes(builder, *options.mesh, run, sink)) return {};
    if (!builder.add_faces(run)) fault = "the unit cell is not a manifold inside its box";
    if (fault.empty()) find_natural_faces(quotient);
  } catch (const Standard_Failure& failure) {
    fault = std::string("the faces of the unit cell cannot be read: ") + what(failure);
  }
  if (fault.empty()) return quotient;
  sink.report({.code = Code::geometry_not_repeatable, .args = {fault}});
  return {};
}

}  // namespace meso::brep
