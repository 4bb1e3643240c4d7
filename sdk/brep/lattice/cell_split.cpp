// SPDX-License-Identifier: Apache-2.0
#include "lattice/cell_split.hpp"

#include <BOPAlgo_Builder.hxx>
#include <BOPAlgo_PaveFiller.hxx>
#include <BOPTools_AlgoTools.hxx>
#include <BOPTools_AlgoTools3D.hxx>
#include <IntTools_Context.hxx>
#include <map>
#include <optional>

#include "boolean.hpp"
#include "face_moments.hpp"
#include "lattice/union_find.hpp"
#include "meso/base/number.hpp"
#include "stop_watch.hpp"

namespace meso::brep {
namespace {

constexpr double tiny = 1e-6;  ///< relative to the cell: of lengths and volumes
// Of areas as vectors: edges known to 1e-4 of the cell leave gaps of this size between their faces.
constexpr double open_area = 1e-4;
constexpr double edge_tolerance = 1e-3;  ///< of the cell

std::vector<Triangle3> triangles_of(const TopoDS_Face& face) {
  TopLoc_Location location;
  const Handle(Poly_Triangulation) mesh = BRep_Tool::Triangulation(face, location);
  if (mesh.IsNull()) throw Standard_Failure("a face of a cell could not be meshed");
  const auto node = [&](int i) { return to_vec(mesh->Node(i).Transformed(location.Transformation())); };
  std::vector<Triangle3> out;
  for (int i = 1; i <= mesh->NbTriangles(); ++i) {
    int a = 0, b = 0, c = 0;
    mesh->Triangle(i).Get(a, b, c);
    if (face.Orientation() == TopAbs_REVERSED) std::swap(b, c);
    out.push_back({node(a), node(b), node(c)});
  }
  return out;
}

Box3 box_of(const Triangle3& triangle, double by) {
  Box3 box;
  for (const Vec3 p : triangle) box.extend(p);
  return {box.min - Vec3{by, by, by}, box.max + Vec3{by, by, by}};
}

bool overlaps(const Triangle3& triangle, const Box3& box) {
  return brep::overlaps(triangle, 0.5 * (box.min + box.max), 0.5 * (box.max - box.min));
}

/// Whether they may touch, given how far triangles can be off.
bool come_near(const WholeCell::Face& face, const std::vector<Triangle3>& others, double by) {
  const Box3 all{face.box.min - Vec3{by, by, by}, face.box.max + Vec3{by, by, by}};
  std::vector<Triangle3> near;
  for (const Triangle3& other : others)
    if (overlaps(other, all)) near.push_back(other);
  if (near.empty()) return false;
  return std::ranges::any_of(face.triangles, [&](const Triangle3& own) {
    const Box3 box = box_of(own, by);
    return std::ranges::any_of(near, [&](const Triangle3& other) { return overlaps(other, box); });
  });
}

double largest_tolerance(const TopoDS_Shape& shape) {
  double largest = 0;
  for (TopExp_Explorer it(shape, TopAbs_EDGE); it.More(); it.Next())
    largest = std::fmax(largest, BRep_Tool::Tolerance(TopoDS::Edge(it.Current())));
  for (TopExp_Explorer it(shape, TopAbs_VERTEX); it.More(); it.Next())
    largest = std::fmax(largest, BRep_Tool::Tolerance(TopoDS::Vertex(it.Current())));
  return largest;
}

std::vector<TopoDS_Face> faces_in(const TopoDS_Shape& shape) {
  std::vector<TopoDS_Face> faces;
  for (TopExp_Explorer it(shape, TopAbs_FACE); it.More(); it.Next()) faces.push_back(TopoDS::Face(it.Current()));
  return faces;
}

/// Of a face's edges, roughly.
double extent_of(const TopoDS_Face& face) {
  Box3 box;
  for (TopExp_Explorer it(face, TopAbs_EDGE); it.More(); it.Next()) {
    if (BRep_Tool::Degenerated(TopoDS::Edge(it.Current()))) continue;
    const BRepAdaptor_Curve curve(TopoDS::Edge(it.Current()));
    for (const double at : {0.0, 0.5, 1.0})
      box.extend(to_vec(curve.Value((1 - at) * curve.FirstParameter() + at * curve.LastParameter())));
  }
  return norm(box.max - box.min);
}

template <typename Shapes>
TopoDS_Compound compound_of(const Shapes& shapes) {
  TopoDS_Compound compound;
  const BRep_Builder builder;
  builder.MakeCompound(compound);
  for (const TopoDS_Shape& shape : shapes) builder.Add(compound, shape);
  return compound;
}

/// A face of the cell or of the body, or a piece of one.
struct Piece {
  TopoDS_Face face;  ///< outward
  std::uint32_t of = 0;
  bool whole = false;     ///< not divided
  int coincident = 0;     ///< of the cell: a face of the body is the same; +1: and looks the same way
  std::uint32_t set = 0;  ///< pieces of one set are on one side
};

struct EdgeUse {
  std::uint32_t piece = 0;
  bool reversed = false;
};

double share_of(const FaceMoments& m) { return (m.volume_moment.x + m.volume_moment.y + m.volume_moment.z) / 3; }

class CellSplit {
 public:
  CellSplit(WholeCell& cell, const LocalBody& body, const SplitOptions& options)
      : cell_(cell), body_(body), options_(options) {}

  ClippedCell run(const RunOptions& run) {
    if (!intersect(run)) return {.fault = "a cell cannot be split by the body"};
    read_edges();
    join_sets();
    for (const auto step : {&CellSplit::place_cell_pieces, &CellSplit::place_caps, &CellSplit::check_sums})
      if (const char* fault = (this->*step)()) return {.fault = fault};
    return result();
  }

 private:
  using Edges = TopTools_IndexedMapOfShape;

  bool intersect(const RunOptions& run);
  void take_pieces(BOPAlgo_Builder& builder, const std::vector<TopoDS_Face>& own, const std::vector<bool>& near,
                   const std::vector<TopoDS_Face>& tools);
  void read_edges();
  void join_sets();
  const char* place_cell_pieces();
  const char* place_caps();
  const char* check_sums();
  ClippedCell result();

  /// Points of a set of pieces, on edges that are not of the other side and on whole faces.
  [[nodiscard]] std::vector<Vec3> points_on(const std::vector<std::uint32_t>& set, bool of_cell) const;
  [[nodiscard]] std::optional<Vec3> middle_of(const Piece& piece) const;
  [[nodiscard]] const FaceMoments& moments(std::size_t piece);

  WholeCell& cell_;
  const LocalBody& body_;
  SplitOptions options_;
  Handle(IntTools_Context) context_ = new IntTools_Context;
  std::vector<Piece> pieces_;  ///< those of the cell first
  std::size_t cell_pieces_ = 0;
  Edges edges_;
  std::vector<std::vector<EdgeUse>> uses_;  ///< per edge
  std::vector<bool> by_cell_, by_body_;     ///< per edge: bounds pieces of these
  std::vector<std::vector<std::uint32_t>> sets_;
  std::vector<bool> kept_;  ///< per piece
  std::map<std::size_t, FaceMoments> moments_;
};

bool CellSplit::intersect(const RunOptions& run) {
  // Copies, because faces that are not intersected must go on sharing the very edges that are.
  std::vector<TopoDS_Face> originals;
  for (const WholeCell::Face& face : cell_.faces) originals.push_back(face.face);
  const std::vector<TopoDS_Face> own =
      faces_in(BRepBuilderAPI_Copy(compound_of(originals), Standard_False, Standard_False).Shape());
  std::vector<TopoDS_Face> tools;
  TopTools_ListOfShape arguments;
  std::vector<bool> near;
  std::vector<TopoDS_Face> near_faces;
  for (std::size_t f = 0; f < own.size(); ++f) {
    near.push_back(options_.all_faces ||
                   come_near(cell_.faces[f], body_.triangles, cell_.reach + body_.reach + tiny * options_.size));
    if (near.back()) near_faces.push_back(own[f]);
  }
  if (!near_faces.empty()) arguments.Append(compound_of(near_faces));
  for (const TopoDS_Shape& solid : body_.faces) {
    const TopoDS_Shape copy = BRepBuilderAPI_Copy(solid, Standard_False, Standard_False).Shape();
    for (const TopoDS_Face& face : faces_in(copy)) tools.push_back(face);
    arguments.Append(copy);
  }
  BOPAlgo_Builder builder;
  if (near_faces.empty()) {
    take_pieces(builder, own, near, tools);
    return true;
  }
  const Handle(StopWatch) watch = new StopWatch(run);
  BOPAlgo_PaveFiller filler;
  filler.SetArguments(arguments);
  filler.SetFuzzyValue(options_.fuzzy);
  filler.Perform(watch->Start());
  if (filler.HasErrors()) return false;
  for (const TopoDS_Shape& argument : arguments) builder.AddArgument(argument);
  builder.PerformWithFiller(filler, watch->Start());
  if (builder.HasErrors()) return false;
  take_pieces(builder, own, near, tools);
  return true;
}

void CellSplit::take_pieces(BOPAlgo_Builder& builder, const std::vector<TopoDS_Face>& own,
                            const std::vector<bool>& near, const std::vector<TopoDS_Face>& tools) {
  TopTools_IndexedMapOfShape known;  // pieces of the cell, numbered as in pieces_
  const auto pieces_of = [&](const TopoDS_Face& face) {
    std::vector<TopoDS_Face> out;
    TopTools_ListOfShape images;
    if (!builder.Images().Find(face, images)) images.Append(face);
    for (const TopoDS_Shape& image : images) {
      const TopoDS_Shape* same = builder.ShapesSD().Seek(image);
      TopoDS_Face piece = TopoDS::Face(same != nullptr ? *same : image);
      if (!piece.IsSame(face)) {
        Standard_Integer error = 0;
        if (BOPTools_AlgoTools::IsSplitToReverse(piece, face, context_, &error)) piece.Reverse();
        if (error != 0) throw Standard_Failure("a piece of a face looks both ways");
      } else {
        piece = face;
      }
      out.push_back(piece);
    }
    return out;
  };
  for (std::uint32_t f = 0; f < own.size(); ++f) {
    const auto pieces = near[f] ? pieces_of(own[f]) : std::vector{own[f]};
    for (const TopoDS_Face& piece : pieces) {
      known.Add(piece);
      pieces_.push_back({.face = piece, .of = f, .whole = pieces.size() == 1});
    }
  }
  cell_pieces_ = pieces_.size();
  for (std::uint32_t t = 0; t < tools.size(); ++t)
    for (const TopoDS_Face& piece : pieces_of(tools[t])) {
      const int same = known.FindIndex(piece);
      if (same > 0) {
        Piece& other = pieces_[static_cast<std::size_t>(same) - 1];
        other.coincident = other.face.Orientation() == piece.Orientation() ? 1 : -1;
      } else {
        pieces_.push_back({.face = piece, .of = t});
      }
    }
}

void CellSplit::read_edges() {
  for (std::uint32_t p = 0; p < pieces_.size(); ++p)
    for (TopExp_Explorer it(pieces_[p].face, TopAbs_EDGE); it.More(); it.Next()) {
      const TopoDS_Edge& edge = TopoDS::Edge(it.Current());
      if (BRep_Tool::Degenerated(edge) || edge.Orientation() == TopAbs_INTERNAL) continue;
      const auto index = static_cast<std::size_t>(edges_.Add(edge)) - 1;
      if (index >= uses_.size()) {
        uses_.emplace_back();
        by_cell_.push_back(false);
        by_body_.push_back(false);
      }
      uses_[index].push_back({p, edge.Orientation() == TopAbs_REVERSED});
      (p < cell_pieces_ ? by_cell_ : by_body_)[index] = true;
      if (pieces_[p].coincident != 0) by_body_[index] = true;
    }
}

void CellSplit::join_sets() {
  UnionFind joined(pieces_.size());
  for (std::size_t e = 0; e < uses_.size(); ++e) {
    if (by_cell_[e] && by_body_[e]) continue;
    for (const EdgeUse& use : uses_[e]) joined.join(uses_[e].front().piece, use.piece);
  }
  std::map<std::uint32_t, std::uint32_t> numbers;
  for (std::uint32_t p = 0; p < pieces_.size(); ++p) {
    const auto [it, fresh] = numbers.emplace(joined.root(p), static_cast<std::uint32_t>(sets_.size()));
    if (fresh) sets_.emplace_back();
    sets_[it->second].push_back(p);
    pieces_[p].set = it->second;
  }
  kept_.assign(pieces_.size(), false);
}

std::vector<Vec3> CellSplit::points_on(const std::vector<std::uint32_t>& set, bool of_cell) const {
  std::vector<Vec3> points;
  for (const std::uint32_t p : set) {
    const Piece& piece = pieces_[p];
    if (of_cell && piece.whole) {
      const auto& triangles = cell_.faces[piece.of].triangles;
      for (std::size_t t = 0; t < triangles.size(); t += 1 + triangles.size() / 8) points.push_back(triangles[t][0]);
      continue;
    }
    int taken = 0;
    for (TopExp_Explorer it(piece.face, TopAbs_EDGE); it.More() && taken < 16; it.Next()) {
      const TopoDS_Edge& edge = TopoDS::Edge(it.Current());
      const int index = edges_.FindIndex(edge);
      if (index == 0 || (of_cell ? by_body_ : by_cell_)[static_cast<std::size_t>(index) - 1]) continue;
      const BRepAdaptor_Curve curve(edge);
      for (const double at : {0.25, 0.5, 0.75})
        points.push_back(to_vec(curve.Value((1 - at) * curve.FirstParameter() + at * curve.LastParameter())));
      ++taken;
    }
  }
  return points;
}

std::optional<Vec3> CellSplit::middle_of(const Piece& piece) const {
  gp_Pnt point;
  gp_Pnt2d at;
  if (BOPTools_AlgoTools3D::PointInFace(piece.face, point, at, context_) != 0) return {};
  return to_vec(point);
}

/// The point of those that is farthest from the triangles.
struct Farthest {
  Vec3 point;
  double distance = -1;
  void look_at(Vec3 p, const std::vector<Triangle3>& triangles) {
    const double d = distance_to(triangles, p);
    if (d > distance) *this = {p, d};
  }
};

const char* CellSplit::place_cell_pieces() {
  for (const auto& set : sets_) {
    if (set.front() >= cell_pieces_) continue;
    int side = 0;
    for (const std::uint32_t p : set) {
      if (pieces_[p].coincident == 0) continue;
      if (side == -pieces_[p].coincident) return "the faces of a piece of a cell contradict each other";
      side = pieces_[p].coincident;
    }
    if (side == 0) {
      const double margin = body_.reach + tiny * options_.size;
      Farthest best;
      const std::vector<Vec3> points = points_on(set, true);
      for (const Vec3 p : points) best.look_at(p, body_.triangles);
      if (best.distance <= margin)
        for (const std::uint32_t p : set)
          if (const auto middle = middle_of(pieces_[p])) best.look_at(*middle, body_.triangles);
      if (best.distance < 0) return "a piece of a cell is too thin to be placed";
      if (best.distance <= margin) {
        side = body_.side(best.point);
        if (side == 0) return "a piece of a cell is too thin to be placed";
      } else {
        side = body_.contains(best.point) ? 1 : -1;
      }
    }
    for (const std::uint32_t p : set) kept_[p] = side > 0;
  }
  return nullptr;
}

const char* CellSplit::place_caps() {
  const double margin = cell_.reach + tiny * options_.size;
  std::vector<Triangle3> triangles;
  Box3 box;
  for (const WholeCell::Face& face : cell_.faces) {
    triangles.insert(triangles.end(), face.triangles.begin(), face.triangles.end());
    box.extend(face.box.min);
    box.extend(face.box.max);
  }
  const auto beyond = [&](Vec3 p) {
    for (std::size_t i = 0; i < 3; ++i)
      if (p[i] < box.min[i] - margin || p[i] > box.max[i] + margin) return true;
    return false;
  };
  for (const auto& set : sets_) {
    if (set.front() < cell_pieces_) continue;
    std::vector<Vec3> points = points_on(set, false);
    if (std::ranges::any_of(points, beyond)) continue;
    Farthest best;
    for (const Vec3 p : points) best.look_at(p, triangles);
    if (best.distance <= margin)
      for (const std::uint32_t p : set) {
        const auto middle = middle_of(pieces_[p]);
        if (middle) best.look_at(*middle, triangles);
      }
    if (best.distance < 0) return "a face of the body in a cell is too thin to be placed";
    bool in = false;
    if (best.distance <= margin) {
      for (BRepClass3d_SolidClassifier& solid : cell_.solids) {
        solid.Perform(to_pnt(best.point), Precision::Confusion());
        if (solid.State() == TopAbs_ON) return "a face of the body in a cell is too thin to be placed";
        in = in || solid.State() == TopAbs_IN;
      }
    } else {
      in = cell_.probe.contains(best.point);
    }
    for (const std::uint32_t p : set) kept_[p] = in;
  }
  return nullptr;
}

const FaceMoments& CellSplit::moments(std::size_t piece) {
  const auto known = moments_.find(piece);
  if (known != moments_.end()) return known->second;
  return moments_.emplace(piece, face_moments(pieces_[piece].face)).first->second;
}

const char* CellSplit::check_sums() {
  std::vector<double> rest(cell_.faces.size());
  for (std::size_t p = 0; p < cell_pieces_; ++p)
    if (!pieces_[p].whole) rest[pieces_[p].of] += share_of(moments(p));
  double amiss = 0;
  for (std::size_t p = 0; p < cell_pieces_; ++p) {
    double& sum = rest[pieces_[p].of];
    if (pieces_[p].whole || sum == 0) continue;
    amiss += std::fabs(sum - cell_.faces[pieces_[p].of].share);
    sum = 0;
  }
  if (amiss > tiny * cell_.volume) return "the pieces of a cell do not add up to it";
  Vec3 area;
  for (std::size_t p = 0; p < pieces_.size(); ++p) {
    if (!kept_[p]) continue;
    const bool whole = p < cell_pieces_ && pieces_[p].whole;
    area += whole ? cell_.faces[pieces_[p].of].area : moments(p).vector_area;
    if (!whole && moments(p).area <= 2 * tiny * options_.size * extent_of(pieces_[p].face))
      return "a piece of a face has no width";
  }
  if (norm(area) > open_area * options_.size * options_.size) return "the faces of a piece of a cell do not close";
  return nullptr;
}

ClippedCell CellSplit::result() {
  using Left = ClippedCell::Left;
  bool changed = pieces_.size() > cell_pieces_ && std::any_of(kept_.begin() + static_cast<std::ptrdiff_t>(cell_pieces_),
                                                              kept_.end(), [](bool k) { return k; });
  for (std::size_t p = 0; p < cell_pieces_; ++p) changed = changed || !kept_[p] || !pieces_[p].whole;
  if (!changed) return {.left = Left::all};
  UnionFind joined(pieces_.size());
  for (const auto& uses : uses_) {
    int forward = 0, reversed = 0;
    std::optional<std::uint32_t> first;
    for (const EdgeUse& use : uses) {
      if (!kept_[use.piece]) continue;
      ++(use.reversed ? reversed : forward);
      if (!first) first = use.piece;
      joined.join(*first, use.piece);
    }
    if (forward != reversed) return {.fault = "a piece of a cell is not closed"};
    if (forward > 1) return {.fault = "a piece of a cell touches itself"};
  }
  // A shell for each connected set, with its volume; those of negative volume are voids of the others.
  struct Lump {
    std::vector<TopoDS_Face> faces;
    double volume = 0;
  };
  std::vector<Lump> lumps;
  std::map<std::uint32_t, std::size_t> numbers;
  for (std::uint32_t p = 0; p < pieces_.size(); ++p) {
    if (!kept_[p]) continue;
    const auto [it, fresh] = numbers.emplace(joined.root(p), lumps.size());
    if (fresh) lumps.emplace_back();
    Lump& lump = lumps[it->second];
    lump.faces.push_back(pieces_[p].face);
    lump.volume += p < cell_pieces_ && pieces_[p].whole ? cell_.faces[pieces_[p].of].share : share_of(moments(p));
  }
  if (lumps.empty()) return {};
  const BRep_Builder builder;
  std::vector<TopoDS_Solid> solids;
  double volume = 0;
  const auto shell_of = [&](const Lump& lump) {
    TopoDS_Shell shell;
    builder.MakeShell(shell);
    for (const TopoDS_Face& face : lump.faces) builder.Add(shell, face);
    shell.Closed(Standard_True);
    return shell;
  };
  for (const Lump& lump : lumps) {
    volume += lump.volume;
    if (lump.volume <= 0) continue;
    builder.MakeSolid(solids.emplace_back());
    builder.Add(solids.back(), shell_of(lump));
  }
  if (solids.empty() || volume > cell_.volume * (1 + tiny)) return {.fault = "a piece of a cell is inside out"};
  for (const Lump& lump : lumps) {
    if (lump.volume > 0) continue;
    std::size_t owner = 0;
    const TopExp_Explorer corner(lump.faces.front(), TopAbs_VERTEX);
    for (std::size_t s = 0; s < solids.size() && solids.size() > 1; ++s) {
      BRepClass3d_SolidClassifier in(solids[s], BRep_Tool::Pnt(TopoDS::Vertex(corner.Current())),
                                     Precision::Confusion());
      if (in.State() == TopAbs_IN) owner = s;
    }
    builder.Add(solids[owner], shell_of(lump));
  }
  const TopoDS_Compound all = compound_of(solids);
  if (const double known = largest_tolerance(all); known > edge_tolerance * options_.size)
    return {.fault = "an edge is only known to " + format_number(known) + " mm"};
  return {.left = Left::part, .solid = all};
}

}  // namespace

WholeCell whole_cell(const TopoDS_Shape& solid, double deflection) {
  WholeCell out;
  out.reach = 3 * deflection;
  const Solids parts = solids_of(BRepBuilderAPI_Copy(solid).Shape());
  for (const TopoDS_Shape& part : parts) {
    BRepMesh_IncrementalMesh(part, deflection, Standard_False, 0.3);
    for (const TopoDS_Face& face : faces_in(part)) {
      const FaceMoments m = face_moments(face);
      WholeCell::Face& value =
          out.faces.emplace_back(WholeCell::Face{face, triangles_of(face), {}, share_of(m), m.vector_area});
      for (const Triangle3& triangle : value.triangles)
        for (const Vec3 p : triangle) value.box.extend(p);
      out.volume += value.share;
      out.probe.add_group(value.triangles);
    }
    out.solids.emplace_back(part);
  }
  return out;
}

ClippedCell split_cell(WholeCell& cell, const LocalBody& body, const SplitOptions& options, const RunOptions& run) {
  return CellSplit(cell, body, options).run(run);
}

}  // namespace meso::brep
