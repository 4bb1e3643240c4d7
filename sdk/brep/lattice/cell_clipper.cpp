// SPDX-License-Identifier: Apache-2.0
#include "lattice/cell_clipper.hpp"

#include <BOPAlgo_Splitter.hxx>
#include <BOPTools_AlgoTools.hxx>
#include <IntTools_Context.hxx>
#include <array>
#include <map>

#include "boolean.hpp"
#include "face_moments.hpp"
#include "meso/base/number.hpp"
#include "point_within.hpp"
#include "stop_watch.hpp"

namespace meso::brep {
namespace {

constexpr double volume_tolerance = 1e-6;  ///< relative, of the sum of the pieces
constexpr double edge_tolerance = 1e-3;    ///< of the cell

double largest_tolerance(const TopoDS_Shape& shape) {
  double largest = 0;
  for (TopExp_Explorer it(shape, TopAbs_EDGE); it.More(); it.Next())
    largest = std::fmax(largest, BRep_Tool::Tolerance(TopoDS::Edge(it.Current())));
  for (TopExp_Explorer it(shape, TopAbs_VERTEX); it.More(); it.Next())
    largest = std::fmax(largest, BRep_Tool::Tolerance(TopoDS::Vertex(it.Current())));
  return largest;
}

/// The pieces of the body's faces, each with the face it is a piece of.
using Caps = TopTools_DataMapOfShapeShape;

Caps caps_of(const BOPAlgo_Builder& builder, const std::vector<TopoDS_Face>& faces) {
  Caps caps;
  for (const TopoDS_Face& face : faces) {
    TopTools_ListOfShape images;
    if (!builder.Images().Find(face, images)) images.Append(face);
    for (const TopoDS_Shape& image : images) {
      const TopoDS_Shape* same = builder.ShapesSD().Seek(image);
      caps.Bind(same != nullptr ? *same : image, face);
    }
  }
  return caps;
}

/// +1: in the body, -1: not, 0: no face of the body bounds it; nothing if its faces contradict each other.
std::optional<int> side_of(const TopoDS_Shape& piece, const Caps& caps, const Handle(IntTools_Context) & context) {
  int side = 0;
  for (TopExp_Explorer it(piece, TopAbs_FACE); it.More(); it.Next()) {
    const TopoDS_Face& face = TopoDS::Face(it.Current());
    const TopoDS_Shape* of = caps.Seek(face);
    if (of == nullptr) continue;
    if (face.Orientation() == TopAbs_INTERNAL || face.Orientation() == TopAbs_EXTERNAL) return {};
    Standard_Integer error = 0;
    const int here = BOPTools_AlgoTools::IsSplitToReverse(face, TopoDS::Face(*of), context, &error) ? -1 : 1;
    if (error != 0 || here == -side) return {};
    side = here;
  }
  return side;
}

TopoDS_Shape moved(const TopoDS_Shape& shape, Vec3 by) {
  gp_Trsf move;
  move.SetTranslation(gp_Vec(by.x, by.y, by.z));
  return shape.Moved(TopLoc_Location(move));
}

}  // namespace

CellClipper::CellClipper(const std::vector<TopoDS_Shape>& solids, const BodySurface& surface, const CellGrid& grid,
                         const RunOptions& run)
    : grid_(grid), run_(run) {
  for (const TopoDS_Shape& solid : solids) {
    solids_.push_back(solids_of(solid.IsNull() ? solid : BRepBuilderAPI_Copy(solid).Shape()));
    double& volume = volumes_.emplace_back(0);
    for (const TopoDS_Shape& part : solids_.back()) volume += volume_of(part);
  }
  shares_ = recent_;
  const TopoDS_Shape body = BRepBuilderAPI_Copy(surface.body()).Shape();
  for (TopExp_Explorer it(body, TopAbs_FACE); it.More(); it.Next()) faces_.push_back(TopoDS::Face(it.Current()));
  for (TopExp_Explorer it(body, TopAbs_SOLID); it.More(); it.Next()) body_.emplace_back(it.Current());
}

bool CellClipper::in_body(Vec3 p) {
  return std::any_of(body_.begin(), body_.end(), [&](BRepClass3d_SolidClassifier& solid) {
    solid.Perform(to_pnt(p), Precision::Confusion());
    return solid.State() == TopAbs_IN;
  });
}

double CellClipper::share_of(const TopoDS_Face& face) {
  const double sign = face.Orientation() == TopAbs_REVERSED ? -1 : 1;
  for (const TopTools_DataMapOfShapeReal* known : {&shares_, &recent_})
    if (const double* share = known->Seek(face)) return sign * *share;
  const Vec3 m = face_moments(TopoDS::Face(face.Oriented(TopAbs_FORWARD))).volume_moment;
  const double share = (m.x + m.y + m.z) / 3;
  recent_.Bind(face, share);
  return sign * share;
}

double CellClipper::volume_of(const TopoDS_Shape& piece) {
  double volume = 0;
  for (TopExp_Explorer it(piece, TopAbs_FACE); it.More(); it.Next()) volume += share_of(TopoDS::Face(it.Current()));
  return volume;
}

ClippedCell CellClipper::clip(std::uint32_t kind, const Index3& cell, const std::vector<std::uint32_t>& faces) {
  const double a = grid_.tolerance;  // a millionth of the cell
  const std::array<Attempt, 5> ladder{
      {{0, {}}, {a, {}}, {10 * a, {}}, {0, {a, -0.7 * a, 0.4 * a}}, {0, {-0.6 * a, a, -0.8 * a}}}};
  std::string fault;
  for (const Attempt& how : ladder) {
    if (run_.should_stop()) break;
    try {
      ClippedCell made = attempt(how, kind, cell, faces);
      if (made.fault.empty()) return made;
      if (fault.empty()) fault = made.fault;
    } catch (const Standard_Failure& failure) {
      if (fault.empty()) fault = failure.GetMessageString();
    }
  }
  return {.fault = fault.empty() ? "stopped" : fault};
}

ClippedCell CellClipper::attempt(const Attempt& how, std::uint32_t kind, const Index3& cell,
                                 const std::vector<std::uint32_t>& faces) {
  using Left = ClippedCell::Left;
  recent_.Clear();
  const Vec3 to_cell = how.shift - (grid_.origin(cell) - grid_.first.min);
  std::vector<TopoDS_Face> tools;
  for (const std::uint32_t face : faces) tools.push_back(TopoDS::Face(moved(faces_[face], to_cell)));
  const Handle(StopWatch) watch = new StopWatch(run_);
  BOPAlgo_Splitter splitter;
  const Solids& parts = solids_[kind];
  for (const TopoDS_Shape& part : parts) splitter.AddArgument(part);
  for (const TopoDS_Face& tool : tools) splitter.AddTool(tool);
  splitter.SetNonDestructive(true);
  splitter.SetFuzzyValue(how.fuzzy);
  splitter.Perform(watch->Start());
  if (splitter.HasErrors()) return {.fault = "a cell cannot be split by the body"};

  const Caps caps = caps_of(splitter, tools);
  ClippedCell out;
  TopoDS_Compound kept;
  const BRep_Builder builder;
  builder.MakeCompound(kept);
  double sum = 0;
  std::size_t inside = 0, split = 0;
  for (const TopoDS_Shape& part : parts) {
    TopTools_ListOfShape images;
    if (splitter.Images().Find(part, images))
      ++split;
    else
      images.Append(part);
    for (const TopoDS_Shape& piece : images) {
      const double volume = volume_of(piece);
      sum += volume;
      if (volume <= 0) return {.fault = "a piece of a cell is inside out"};
      const std::optional<int> side = side_of(piece, caps, splitter.Context());
      if (!side) return {.fault = "the faces of a piece of a cell contradict each other"};
      const std::vector<Vec3> within = points_within(piece, 1);
      if (within.empty() && *side == 0) return {.fault = "a piece of a cell is too thin to be placed"};
      bool in = *side > 0;
      if (!within.empty()) {
        const bool found = in_body(within.front() - to_cell);
        if (*side != 0 && found != in) return {.fault = "a piece of a cell is not where its faces say"};
        in = found;
      }
      if (!in) continue;
      ++inside;
      builder.Add(kept, piece);
    }
  }
  if (std::fabs(sum - volumes_[kind]) > volume_tolerance * volumes_[kind])
    return {.fault = "the pieces of a cell do not add up to it"};
  if (inside == 0) return out;
  if (split == 0 && inside == parts.size()) return {.left = Left::all};
  if (edge_uses(kept).free > 0) return {.fault = "a piece of a cell is not closed"};
  if (const double known = largest_tolerance(kept); known > edge_tolerance * norm(grid_.size()))
    return {.fault = "an edge is only known to " + format_number(known) + " mm"};
  out.left = Left::part;
  out.solid = kept;
  return out;
}

}  // namespace meso::brep
