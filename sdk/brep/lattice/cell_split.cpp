// SPDX-License-Identifier: Apache-2.0
#include "lattice/cell_split.hpp"

#include <BOPTools_AlgoTools3D.hxx>
#include <GCPnts_AbscissaPoint.hxx>
#include <map>
#include <optional>

#include "boolean.hpp"
#include "face_moments.hpp"
#include "lattice/sliver_faces.hpp"
#include "lattice/union_find.hpp"
#include "meso/base/number.hpp"

namespace meso::brep {
namespace {

constexpr double tiny = 1e-6;  ///< relative to the cell: of lengths and volumes
// Of areas as vectors: edges known to 1e-4 of the cell leave gaps of this size between their faces.
constexpr double open_area = 1e-4;
constexpr double roughest = 1e-2;      ///< of the cell: what is known worse is no edge
constexpr std::size_t witnesses = 12;  ///< points that must tell the same of one piece

double largest_tolerance(const TopoDS_Shape& shape) {
  double largest = 0;
  for (TopExp_Explorer it(shape, TopAbs_EDGE); it.More(); it.Next())
    largest = std::fmax(largest, BRep_Tool::Tolerance(TopoDS::Edge(it.Current())));
  for (TopExp_Explorer it(shape, TopAbs_VERTEX); it.More(); it.Next())
    largest = std::fmax(largest, BRep_Tool::Tolerance(TopoDS::Vertex(it.Current())));
  return largest;
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

/// What a face's area may be off, given how well its edges are known.
double doubt_of(const TopoDS_Face& face) {
  double doubt = 0;
  for (TopExp_Explorer it(face, TopAbs_EDGE); it.More(); it.Next()) {
    const TopoDS_Edge& edge = TopoDS::Edge(it.Current());
    if (BRep_Tool::Degenerated(edge)) continue;
    const BRepAdaptor_Curve curve(edge);
    doubt += BRep_Tool::Tolerance(edge) * GCPnts_AbscissaPoint::Length(curve);
  }
  return doubt;
}

class CellSplit {
 public:
  CellSplit(WholeCell& cell, const LocalBody& body, const SplitOptions& options)
      : cell_(cell), body_(body), options_(options) {}

  ClippedCell run(const RunOptions& run) {
    auto divided = divide_faces(cell_, body_, options_, run);
    if (!divided) return {.fault = "a cell cannot be split by the body"};
    faces_ = std::move(*divided);
    // What a face is cut along goes round or from border to border: the rest of it was not found.
    if (faces_.loose) return {.fault = "a face is cut along a part of a line"};
    join_sets();
    for (const auto step :
         {&CellSplit::place_cell_pieces, &CellSplit::place_caps, &CellSplit::check_sums, &CellSplit::take_slivers_out})
      if (const char* fault = (this->*step)()) return {.fault = fault};
    return result();
  }

 private:
  void join_sets();
  const char* place_cell_pieces();
  const char* place_caps();
  [[nodiscard]] int side_of_cell(Vec3 p);
  const char* check_sums();
  const char* take_slivers_out();
  void take();
  [[nodiscard]] bool is_changed() const;
  [[nodiscard]] bool is_touched_wall(const std::vector<PieceUse>& uses, const std::vector<std::uint8_t>& way) const;
  [[nodiscard]] const char* join_taken(UnionFind& joined) const;
  ClippedCell result();

  /// Points of a set of pieces, on edges that are not of the other side and on whole faces.
  [[nodiscard]] std::vector<Vec3> points_on(const std::vector<std::uint32_t>& set, bool of_cell) const;
  [[nodiscard]] std::optional<Vec3> middle_of(const Piece& piece) const;
  [[nodiscard]] const FaceMoments& moments(std::size_t piece);
  [[nodiscard]] bool is_whole(std::size_t piece) const { return piece < faces_.of_cell && faces_.pieces[piece].whole; }
  [[nodiscard]] WholeCell::Role role(std::size_t piece) const {
    return piece < faces_.of_cell ? cell_.faces[faces_.pieces[piece].of].role : WholeCell::Role::skin;
  }

  WholeCell& cell_;
  const LocalBody& body_;
  SplitOptions options_;
  DividedFaces faces_;
  std::vector<std::vector<std::uint32_t>> sets_;
  std::vector<bool> kept_;  ///< per piece: bounds what cell and body have in common
  struct Taken {
    std::uint32_t piece = 0;
    bool reversed = false;
  };
  std::vector<Taken> taken_;  ///< bounds the result
  std::map<std::size_t, FaceMoments> moments_;
};

void CellSplit::join_sets() {
  UnionFind joined(faces_.pieces.size());
  for (std::size_t e = 0; e < faces_.uses.size(); ++e) {
    if (faces_.by_cell[e] && faces_.by_body[e]) continue;
    for (const PieceUse& use : faces_.uses[e]) joined.join(faces_.uses[e].front().piece, use.piece);
  }
  std::map<std::uint32_t, std::uint32_t> numbers;
  for (std::uint32_t p = 0; p < faces_.pieces.size(); ++p) {
    const auto [it, fresh] = numbers.emplace(joined.root(p), static_cast<std::uint32_t>(sets_.size()));
    if (fresh) sets_.emplace_back();
    sets_[it->second].push_back(p);
  }
  kept_.assign(faces_.pieces.size(), false);
}

std::vector<Vec3> CellSplit::points_on(const std::vector<std::uint32_t>& set, bool of_cell) const {
  std::vector<Vec3> points;
  for (const std::uint32_t p : set) {
    const Piece& piece = faces_.pieces[p];
    if (of_cell && piece.whole) {
      const auto& triangles = cell_.faces[piece.of].triangles;
      for (std::size_t t = 0; t < triangles.size(); t += 1 + triangles.size() / 8) {
        const auto& [a, b, c] = triangles[t];
        points.push_back(a);
        points.push_back((a + b + c) / 3);  // of walls, corners would tell of the rim alone
      }
      continue;
    }
    int taken = 0;
    for (TopExp_Explorer it(piece.face, TopAbs_EDGE); it.More() && taken < 16; it.Next()) {
      const TopoDS_Edge& edge = TopoDS::Edge(it.Current());
      const int index = faces_.edges.FindIndex(edge);
      if (index == 0 || (of_cell ? faces_.by_body : faces_.by_cell)[static_cast<std::size_t>(index) - 1]) continue;
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
  if (BOPTools_AlgoTools3D::PointInFace(piece.face, point, at, faces_.context) != 0) return {};
  return to_vec(point);
}

/// The point of those that is farthest from the triangles, and all that are clear of them.
struct Farthest {
  double clear_from = 0;
  Vec3 point{};
  double distance = -1;
  std::vector<Vec3> clear{}, all{};
  void look_at(Vec3 p, const std::vector<Triangle3>& triangles) {
    const double d = distance_to(triangles, p);
    all.push_back(p);
    if (d > clear_from) clear.push_back(p);
    if (d <= distance) return;
    point = p;
    distance = d;
  }
  /// What `side` says of the farthest point; where surfaces touch, it may be on both: then what it says of all others
  /// of which it can say anything. 0: nothing, or both.
  template <typename Side>
  [[nodiscard]] int side_by(Side side) const {
    if (const int known = side(point); known != 0) return known;
    int agreed = 0;
    for (std::size_t i = 0; i < all.size(); i += 1 + all.size() / witnesses) {
      const int known = side(all[i]);
      if (known != 0 && known == -agreed) return 0;
      if (known != 0) agreed = known;
    }
    return agreed;
  }
  /// True where one of those that are clear is on the other side.
  template <typename Contains>
  [[nodiscard]] bool contradicts(bool in, Contains contains) const {
    for (std::size_t i = 0; i < clear.size(); i += 1 + clear.size() / witnesses)
      if (contains(clear[i]) != in) return true;
    return false;
  }
};

const char* CellSplit::place_cell_pieces() {
  for (const auto& set : sets_) {
    if (set.front() >= faces_.of_cell) continue;
    int side = 0;
    for (const std::uint32_t p : set) {
      if (faces_.pieces[p].coincident == 0) continue;
      if (side == -faces_.pieces[p].coincident) return "the faces of a piece of a cell contradict each other";
      side = faces_.pieces[p].coincident;
    }
    if (side == 0) {
      const double margin = body_.reach + tiny * options_.size;
      Farthest best{.clear_from = margin + roughest * options_.size};
      for (const Vec3 p : points_on(set, true)) best.look_at(p, body_.triangles);
      if (best.distance <= margin)
        for (const std::uint32_t p : set)
          if (const auto middle = middle_of(faces_.pieces[p])) best.look_at(*middle, body_.triangles);
      if (best.distance < 0) return "a piece of a cell is too thin to be placed";
      if (best.distance <= margin) {
        side = best.side_by(body_.side);
        if (side == 0) return "a piece of a cell is too thin to be placed";
      } else {
        side = body_.contains(best.point) ? 1 : -1;
      }
      // A face of the body that should have divided it and did not.
      if (best.contradicts(side > 0, body_.contains)) return "a piece of a cell is on both sides of the body";
    }
    for (const std::uint32_t p : set) kept_[p] = side > 0;
  }
  return nullptr;
}

/// +1: inside; 0: too close to say.
int CellSplit::side_of_cell(Vec3 p) {
  int side = -1;
  for (BRepClass3d_SolidClassifier& solid : cell_.solids) {
    solid.Perform(to_pnt(p), Precision::Confusion());
    if (solid.State() == TopAbs_ON) return 0;
    if (solid.State() == TopAbs_IN) side = 1;
  }
  return side;
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
    if (set.front() < faces_.of_cell) continue;
    const std::vector<Vec3> points = points_on(set, false);
    const bool reaches_out = std::ranges::any_of(points, beyond);
    Farthest best{.clear_from = margin + roughest * options_.size};
    for (const Vec3 p : points)
      if (!beyond(p)) best.look_at(p, triangles);
    const auto contradicted = [&](bool in) {
      return best.contradicts(in, [&](Vec3 p) { return cell_.probe.contains(p); });
    };
    if (reaches_out) {
      // Edges may all run close to walls.
      for (std::size_t i = 0; i < set.size() && best.clear.empty(); ++i)
        if (const auto middle = middle_of(faces_.pieces[set[i]]); middle && !beyond(*middle))
          best.look_at(*middle, triangles);
      if (contradicted(false)) return "a face of the body in a cell is on both sides of it";
      continue;
    }
    if (best.distance <= margin)
      for (const std::uint32_t p : set) {
        const auto middle = middle_of(faces_.pieces[p]);
        if (middle) best.look_at(*middle, triangles);
      }
    if (best.distance < 0) return "a face of the body in a cell is too thin to be placed";
    bool in = false;
    if (best.distance <= margin) {
      const int side = best.side_by([&](Vec3 p) { return side_of_cell(p); });
      if (side == 0) return "a face of the body in a cell is too thin to be placed";
      in = side > 0;
    } else {
      in = cell_.probe.contains(best.point);
    }
    if (contradicted(in)) return "a face of the body in a cell is on both sides of it";
    for (const std::uint32_t p : set) kept_[p] = in;
  }
  return nullptr;
}

const FaceMoments& CellSplit::moments(std::size_t piece) {
  const auto known = moments_.find(piece);
  if (known != moments_.end()) return known->second;
  return moments_.emplace(piece, face_moments(faces_.pieces[piece].face)).first->second;
}

const char* CellSplit::check_sums() {
  std::vector<double> rest(cell_.faces.size());
  for (std::size_t p = 0; p < faces_.of_cell; ++p)
    if (!faces_.pieces[p].whole) rest[faces_.pieces[p].of] += share_of(moments(p));
  double amiss = 0;
  for (std::size_t p = 0; p < faces_.of_cell; ++p) {
    double& sum = rest[faces_.pieces[p].of];
    if (faces_.pieces[p].whole || sum == 0) continue;
    amiss += std::fabs(sum - cell_.faces[faces_.pieces[p].of].share);
    sum = 0;
  }
  if (amiss > tiny * (cell_.volume + cell_.left_out)) return "the pieces of a cell do not add up to it";
  take();
  Vec3 area;
  for (const auto& [p, reversed] : taken_) {
    const bool whole = is_whole(p);
    area += (reversed ? -1.0 : 1.0) * (whole ? cell_.faces[faces_.pieces[p].of].area : moments(p).vector_area);
  }
  if (norm(area) > open_area * options_.size * options_.size) return "the faces of a piece of a cell do not close";
  return nullptr;
}

/// A piece without width, as where a cusp between two circles is cut off at its very tip, goes if it lies between two
/// edges that have the same ends; otherwise it is a fault. What is narrow, and better known than wide, stays.
const char* CellSplit::take_slivers_out() {
  std::vector<bool> is_taken(faces_.pieces.size());
  for (const Taken& taken : taken_) is_taken[taken.piece] = true;
  for (const Taken& taken : taken_) {
    const std::uint32_t p = taken.piece;
    if (is_whole(p)) continue;
    const TopoDS_Face face = faces_.pieces[p].face;
    if (moments(p).area > 2 * tiny * options_.size * extent_of(face) || moments(p).area > 2 * doubt_of(face)) continue;
    const auto sliver = sliver_of(
        faces_, p, tiny * options_.size, [&](std::uint32_t q) { return is_taken[q]; },
        [&](std::uint32_t q) { return role(q) != WholeCell::Role::skin; });
    if (!sliver) return "a piece of a face has no width";
    take_out(faces_, *sliver);
    is_taken[p] = false;
  }
  std::erase_if(taken_, [&](const Taken& taken) { return !is_taken[taken.piece]; });
  return nullptr;
}

/// Of a box it is what the common part of the space beside its solids leaves: faces of that turn round, and of the
/// sides the other pieces are taken.
void CellSplit::take() {
  for (std::uint32_t p = 0; p < faces_.pieces.size(); ++p) {
    const WholeCell::Role as = role(p);
    const bool is_in =
        !cell_.is_frame || as == WholeCell::Role::skin ? kept_[p] : as == WholeCell::Role::solid_wall || !kept_[p];
    if (is_in) taken_.push_back({p, cell_.is_frame && as == WholeCell::Role::skin});
  }
}

/// False if the result is the solid that was there before.
bool CellSplit::is_changed() const {
  std::size_t whole = 0, before = 0;
  for (const Taken& taken : taken_) {
    if (!is_whole(taken.piece) || role(taken.piece) == WholeCell::Role::open_wall) return true;
    ++whole;
  }
  for (const WholeCell::Face& face : cell_.faces) before += face.role != WholeCell::Role::open_wall;
  return whole != before;
}

/// An edge of the body along which it touches a plane of the cell: two pieces of the plane and two of the body that are
/// taken meet there. That such a plane is a wall, beside which there is more, is seen when cells are joined.
bool CellSplit::is_touched_wall(const std::vector<PieceUse>& uses, const std::vector<std::uint8_t>& way) const {
  std::optional<std::uint32_t> plane;
  std::size_t of_plane = 0, of_body = 0;
  for (const PieceUse& use : uses) {
    if (way[use.piece] == 0) continue;
    const Piece& piece = faces_.pieces[use.piece];
    if (use.piece >= faces_.of_cell) {
      ++of_body;
    } else {
      if (plane.value_or(piece.of) != piece.of || BRepAdaptor_Surface(piece.face).GetType() != GeomAbs_Plane)
        return false;
      plane = piece.of;
      ++of_plane;
    }
  }
  return of_plane == 2 && of_body == 2;
}

const char* CellSplit::join_taken(UnionFind& joined) const {
  std::vector<std::uint8_t> way(faces_.pieces.size(), 0);
  for (const Taken& taken : taken_) way[taken.piece] = taken.reversed ? 2 : 1;
  for (const auto& uses : faces_.uses) {
    int forward = 0, reversed = 0;
    std::optional<std::uint32_t> first;
    for (const PieceUse& use : uses) {
      if (way[use.piece] == 0) continue;
      ++(use.reversed == (way[use.piece] == 1) ? reversed : forward);
      if (!first) first = use.piece;
      joined.join(*first, use.piece);
    }
    if (forward != reversed) return "a piece of a cell is not closed";
    if (forward > 1 && !is_touched_wall(uses, way)) return "a piece of a cell touches itself";
  }
  return nullptr;
}

ClippedCell CellSplit::result() {
  using Left = ClippedCell::Left;
  if (!is_changed()) return {.left = Left::all};
  UnionFind joined(faces_.pieces.size());
  if (const char* fault = join_taken(joined)) return {.fault = fault};
  // A shell for each connected set, with its volume; those of negative volume are voids of the others.
  struct Lump {
    std::vector<TopoDS_Face> faces;
    double volume = 0;
  };
  std::vector<Lump> lumps;
  std::map<std::uint32_t, std::size_t> numbers;
  for (const auto& [p, reversed] : taken_) {
    const auto [it, fresh] = numbers.emplace(joined.root(p), lumps.size());
    if (fresh) lumps.emplace_back();
    Lump& lump = lumps[it->second];
    const TopoDS_Face& face = faces_.pieces[p].face;
    lump.faces.push_back(reversed ? TopoDS::Face(face.Reversed()) : face);
    const double share = is_whole(p) ? cell_.faces[faces_.pieces[p].of].share : share_of(moments(p));
    lump.volume += reversed ? -share : share;
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
  const double most = cell_.is_frame ? cell_.volume + cell_.left_out : cell_.volume;
  if (solids.empty() || volume > most * (1 + tiny)) return {.fault = "a piece of a cell is inside out"};
  if (cell_.is_frame && volume < cell_.left_out - tiny * most) return {.fault = "a body takes something away"};
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
  const double known = largest_tolerance(all);
  if (known > roughest * options_.size) return {.fault = "an edge is only known to " + format_number(known) + " mm"};
  return {.left = Left::part, .solid = all, .edge_tolerance = known};
}

}  // namespace

ClippedCell split_cell(WholeCell& cell, const LocalBody& body, const SplitOptions& options, const RunOptions& run) {
  return CellSplit(cell, body, options).run(run);
}

}  // namespace meso::brep
