// SPDX-License-Identifier: Apache-2.0
#include "lattice/divided_faces.hpp"

#include <BOPTools_AlgoTools.hxx>
#include <algorithm>

#include "lattice/crossing_filler.hpp"
#include "lattice/section_curves.hpp"
#include "stop_watch.hpp"

namespace meso::brep {
namespace {

constexpr double tiny = 1e-6;  ///< relative to the cell

Box3 box_of(const Triangle3& triangle, double by) {
  Box3 box;
  for (const Vec3 p : triangle) box.extend(p);
  return {box.min - Vec3{by, by, by}, box.max + Vec3{by, by, by}};
}

bool overlaps(const Triangle3& triangle, const Box3& box) {
  return brep::overlaps(triangle, 0.5 * (box.min + box.max), 0.5 * (box.max - box.min));
}

bool meet(const Box3& a, const Box3& b) {
  for (std::size_t i = 0; i < 3; ++i)
    if (a.max[i] < b.min[i] || b.max[i] < a.min[i]) return false;
  return true;
}

/// Edges of faces of the cell that are farther than `by` from all triangles of the body.
class EdgesAway {
 public:
  EdgesAway(const std::vector<Triangle3>& triangles, double by) : triangles_(triangles), by_(by) {
    for (const Triangle3& triangle : triangles) boxes_.push_back(box_of(triangle, 0));
  }

  void add_those_of(const TopoDS_Face& face) {
    for (TopExp_Explorer it(face, TopAbs_EDGE); it.More(); it.Next()) {
      const TopoDS_Edge& edge = TopoDS::Edge(it.Current());
      if (!BRep_Tool::Degenerated(edge) && !may_meet(edge)) edges_.Add(edge);
    }
  }
  [[nodiscard]] const TopTools_MapOfShape& edges() const { return edges_; }

 private:
  [[nodiscard]] bool may_meet(const TopoDS_Edge& edge) const {
    const BRepAdaptor_Curve curve(edge);
    const bool is_line = curve.GetType() == GeomAbs_Line;
    const int spans = is_line ? 16 : 64;
    const auto at = [&](int i) {
      const double share = static_cast<double>(i) / spans;
      return to_vec(curve.Value((1 - share) * curve.FirstParameter() + share * curve.LastParameter()));
    };
    Vec3 from = at(0);
    for (int i = 1; i <= spans; ++i) {
      const Vec3 to = at(i);
      // Between two of 65 points of a turn, an ellipse twenty times as long as wide is off by a quarter of their
      // distance.
      const double by = by_ + BRep_Tool::Tolerance(edge) + (is_line ? 0 : 0.5 * norm(to - from));
      Box3 box;
      box.extend(from);
      box.extend(to);
      box = {box.min - Vec3{by, by, by}, box.max + Vec3{by, by, by}};
      for (std::size_t t = 0; t < triangles_.size(); ++t)
        if (meet(box, boxes_[t]) && overlaps(triangles_[t], box)) return true;
      from = to;
    }
    return false;
  }

  const std::vector<Triangle3>& triangles_;
  std::vector<Box3> boxes_;
  double by_;
  TopTools_MapOfShape edges_;
};

/// Faces of the cell and of the body that may touch one of the other, given how far triangles can be off.
struct NearFaces {
  std::vector<bool> of_cell, of_body;
};

NearFaces near_faces(const WholeCell& cell, const LocalBody& body, double by) {
  NearFaces out{std::vector<bool>(cell.faces.size()), std::vector<bool>(body.of_face.size())};
  std::vector<Box3> boxes;
  for (const Triangle3& triangle : body.triangles) boxes.push_back(box_of(triangle, by));
  for (std::size_t f = 0; f < cell.faces.size(); ++f) {
    const WholeCell::Face& face = cell.faces[f];
    for (std::size_t t = 0; t < body.of_face.size(); ++t) {
      if (out.of_cell[f] && out.of_body[t]) continue;
      for (std::size_t i = body.of_face[t][0]; i < body.of_face[t][1] && !(out.of_cell[f] && out.of_body[t]); ++i) {
        if (!meet(boxes[i], face.box)) continue;
        const bool touch = std::ranges::any_of(face.triangles, [&](const Triangle3& own) {
          const Box3 box = box_of(own, by);
          return meet(box, boxes[i]) && overlaps(body.triangles[i], box);
        });
        if (touch) out.of_cell[f] = out.of_body[t] = true;
      }
    }
  }
  return out;
}

class FaceDivision {
 public:
  FaceDivision(const WholeCell& cell, const LocalBody& body, const SplitOptions& options)
      : cell_(cell), body_(body), options_(options) {}

  std::optional<DividedFaces> run(const RunOptions& run) {
    if (!intersect(run)) return {};
    read_edges();
    fit();
    return std::move(out_);
  }

 private:
  bool intersect(const RunOptions& run);
  void take_pieces(BOPAlgo_Builder& builder, const std::vector<TopoDS_Face>& own, const std::vector<bool>& near,
                   const std::vector<TopoDS_Face>& tools);
  void read_edges();
  [[nodiscard]] bool is_contact(std::uint32_t piece, const TopoDS_Edge& edge);
  void fit();

  const WholeCell& cell_;
  const LocalBody& body_;
  SplitOptions options_;
  DividedFaces out_;
};

bool FaceDivision::intersect(const RunOptions& run) {
  // Copies, because faces that are not intersected must go on sharing the very edges that are.
  std::vector<TopoDS_Face> originals;
  for (const WholeCell::Face& face : cell_.faces) originals.push_back(face.face);
  const std::vector<TopoDS_Face> own =
      faces_in(BRepBuilderAPI_Copy(compound_of(originals), Standard_False, Standard_False).Shape());
  const double reach = cell_.reach + body_.reach + tiny * options_.size;
  NearFaces near = near_faces(cell_, body_, reach);
  if (options_.all_faces) {
    near.of_cell.assign(near.of_cell.size(), true);
    near.of_body.assign(near.of_body.size(), true);
  }
  std::vector<TopoDS_Face> tools, near_own;
  TopTools_ListOfShape arguments;
  for (std::size_t f = 0; f < own.size(); ++f)
    if (near.of_cell[f]) near_own.push_back(own[f]);
  if (!near_own.empty()) arguments.Append(compound_of(near_own));
  for (const TopoDS_Shape& solid : body_.faces) {
    const TopoDS_Shape copy = BRepBuilderAPI_Copy(solid, Standard_False, Standard_False).Shape();
    std::vector<TopoDS_Face> near_tools;
    for (const TopoDS_Face& face : faces_in(copy)) {
      if (near.of_body[tools.size()]) near_tools.push_back(face);
      tools.push_back(face);
    }
    if (!near_tools.empty()) arguments.Append(compound_of(near_tools));
  }
  BOPAlgo_Builder builder;
  if (near_own.empty() || arguments.Extent() < 2) {
    take_pieces(builder, own, near.of_cell, tools);
    return true;
  }
  const Handle(StopWatch) watch = new StopWatch(run);
  CrossingFiller filler(options_.size);
  filler.SetArguments(arguments);
  filler.SetFuzzyValue(options_.fuzzy);
  if (!options_.all_faces) {
    EdgesAway away(body_.triangles, reach + options_.fuzzy);
    for (const TopoDS_Face& face : near_own) away.add_those_of(face);
    filler.leave_out(away.edges());
  }
  filler.Perform(watch->Start());
  if (filler.HasErrors()) return false;
  for (const TopoDS_Shape& argument : arguments) builder.AddArgument(argument);
  builder.PerformWithFiller(filler, watch->Start());
  if (builder.HasErrors()) return false;
  take_pieces(builder, own, near.of_cell, tools);
  return true;
}

void FaceDivision::take_pieces(BOPAlgo_Builder& builder, const std::vector<TopoDS_Face>& own,
                               const std::vector<bool>& near, const std::vector<TopoDS_Face>& tools) {
  TopTools_IndexedMapOfShape known;  // pieces of the cell, numbered as in out_.pieces
  for (std::uint32_t f = 0; f < own.size(); ++f) {
    const auto pieces = near[f] ? pieces_of(builder, own[f], out_.context) : std::vector{own[f]};
    for (const TopoDS_Face& piece : pieces) {
      known.Add(piece);
      out_.pieces.push_back({.face = piece, .of = f, .whole = pieces.size() == 1});
    }
  }
  out_.of_cell = out_.pieces.size();
  for (std::uint32_t t = 0; t < tools.size(); ++t)
    for (const TopoDS_Face& piece : pieces_of(builder, tools[t], out_.context)) {
      const int same = known.FindIndex(piece);
      if (same > 0) {
        Piece& other = out_.pieces[static_cast<std::size_t>(same) - 1];
        other.coincident = other.face.Orientation() == piece.Orientation() ? 1 : -1;
      } else {
        out_.pieces.push_back({.face = piece, .of = t});
      }
    }
}

void FaceDivision::read_edges() {
  std::vector<std::pair<std::uint32_t, TopoDS_Edge>> within;
  for (std::uint32_t p = 0; p < out_.pieces.size(); ++p)
    for (TopExp_Explorer it(out_.pieces[p].face, TopAbs_EDGE); it.More(); it.Next()) {
      const TopoDS_Edge& edge = TopoDS::Edge(it.Current());
      if (BRep_Tool::Degenerated(edge)) continue;
      if (edge.Orientation() == TopAbs_INTERNAL) {
        within.emplace_back(p, edge);
        continue;
      }
      const auto index = static_cast<std::size_t>(out_.edges.Add(edge)) - 1;
      if (index >= out_.uses.size()) {
        out_.uses.emplace_back();
        out_.by_cell.push_back(false);
        out_.by_body.push_back(false);
      }
      out_.uses[index].push_back({p, edge.Orientation() == TopAbs_REVERSED});
      (p < out_.of_cell ? out_.by_cell : out_.by_body)[index] = true;
      if (out_.pieces[p].coincident != 0) out_.by_body[index] = true;
    }
  for (const auto& [p, edge] : within) {
    out_.loose = out_.loose || !is_contact(p, edge);
    if (out_.loose) return;
    BRepTools::RemoveInternals(out_.pieces[p].face, Standard_True);
  }
}

/// An old edge that lies in the piece because a face beside it touches the piece there.
bool FaceDivision::is_contact(std::uint32_t piece, const TopoDS_Edge& edge) {
  const int index = out_.edges.FindIndex(edge);
  if (index == 0) return false;
  double from = 0, to = 0;
  const Handle(Geom_Curve) curve = BRep_Tool::Curve(edge, from, to);
  return std::ranges::any_of(out_.uses[static_cast<std::size_t>(index) - 1], [&](const PieceUse& use) {
    return (use.piece < out_.of_cell) != (piece < out_.of_cell) &&
           touch_along(out_.pieces[use.piece].face, out_.pieces[piece].face, {curve, from, to}, out_.context);
  });
}

/// Sections lie in one face of the cell and in one of the body; what else there is are pieces of old edges.
void FaceDivision::fit() {
  std::vector<SectionEdge> sections;
  std::vector<DividedEdge> divided;
  for (std::size_t e = 0; e < out_.uses.size(); ++e) {
    const TopoDS_Edge& edge = TopoDS::Edge(out_.edges(static_cast<int>(e) + 1));
    const Piece* of_cell = nullptr;
    const Piece* of_body = nullptr;
    bool section = out_.by_cell[e] && out_.by_body[e];
    for (const PieceUse& use : out_.uses[e]) {
      const Piece& piece = out_.pieces[use.piece];
      const Piece*& known = use.piece < out_.of_cell ? of_cell : of_body;
      section = section && piece.coincident == 0 && (known == nullptr || known->of == piece.of);
      known = &piece;
    }
    if (section && of_cell != nullptr && of_body != nullptr)
      sections.push_back({edge, of_cell->face, of_body->face});
    else
      divided.push_back({edge, out_.by_cell[e], out_.by_body[e]});
  }
  fit_sections(sections, divided, options_.size);
}

bool on_same_surface(const TopoDS_Face& a, const TopoDS_Face& b) {
  TopLoc_Location of_a, of_b;
  return BRep_Tool::Surface(a, of_a) == BRep_Tool::Surface(b, of_b) && of_a == of_b;
}

}  // namespace

std::vector<TopoDS_Face> pieces_of(BOPAlgo_Builder& builder, const TopoDS_Face& face,
                                   const Handle(IntTools_Context) & context) {
  std::vector<TopoDS_Face> out;
  TopTools_ListOfShape images;
  if (!builder.Images().Find(face, images)) images.Append(face);
  for (const TopoDS_Shape& image : images) {
    const TopoDS_Shape* same = builder.ShapesSD().Seek(image);
    TopoDS_Face piece = TopoDS::Face(same != nullptr ? *same : image);
    if (on_same_surface(piece, face)) {
      piece.Orientation(face.Orientation());
    } else {
      Standard_Integer error = 0;
      if (BOPTools_AlgoTools::IsSplitToReverse(piece, face, context, &error)) piece.Reverse();
      if (error != 0) throw Standard_Failure("a piece of a face looks both ways");
    }
    out.push_back(piece);
  }
  return out;
}

std::optional<DividedFaces> divide_faces(const WholeCell& cell, const LocalBody& body, const SplitOptions& options,
                                         const RunOptions& run) {
  return FaceDivision(cell, body, options).run(run);
}

}  // namespace meso::brep
