// SPDX-License-Identifier: Apache-2.0
#include "lattice/cell_clipper.hpp"

#include <array>
#include <optional>

#include "meso/base/number.hpp"

namespace meso::brep {
namespace {

TopoDS_Shape moved(const TopoDS_Shape& shape, Vec3 by) {
  gp_Trsf move;
  move.SetTranslation(gp_Vec(by.x, by.y, by.z));
  return shape.Moved(TopLoc_Location(move));
}

}  // namespace

CellClipper::CellClipper(const std::vector<TopoDS_Shape>& solids, const Otherwise& otherwise,
                         const BodySurface& surface, const CellGrid& grid, const RunOptions& run)
    : CellClipper(
          [&solids, otherwise, deflection = deflection_in(grid)](std::uint32_t kind, int variant) {
            const TopoDS_Shape solid = variant == 0 ? solids[kind]
                                       : otherwise  ? otherwise(kind, variant)
                                                    : TopoDS_Shape();
            return solid.IsNull() ? WholeCell{} : whole_cell(solid, deflection);
          },
          surface, grid, run) {}

CellClipper::CellClipper(std::function<WholeCell(std::uint32_t, int)> frame, const BodySurface& surface,
                         const CellGrid& grid, const RunOptions& run)
    : make_(std::move(frame)), surface_(surface), local_(surface, grid), grid_(grid), run_(run) {
  const TopoDS_Shape body = BRepBuilderAPI_Copy(surface.body()).Shape();
  for (TopExp_Explorer it(body, TopAbs_SOLID); it.More(); it.Next()) body_.emplace_back(it.Current());
}

WholeCell& CellClipper::whole(std::uint32_t kind, int variant) {
  const std::pair key{kind, variant};
  const auto known = whole_.find(key);
  return known != whole_.end() ? known->second : whole_.emplace(key, make_(kind, variant)).first->second;
}

int CellClipper::side_of(Vec3 p) {
  int side = -1;
  for (BRepClass3d_SolidClassifier& solid : body_) {
    solid.Perform(to_pnt(p), Precision::Confusion());
    if (solid.State() == TopAbs_ON) return 0;
    if (solid.State() == TopAbs_IN) side = 1;
  }
  return side;
}

ClippedCell CellClipper::clip(std::uint32_t kind, const Index3& cell, const std::vector<std::uint32_t>& faces,
                              Ways ways) {
  const double a = grid_.tolerance;  // a millionth of the cell
  const std::array<Attempt, 9> ladder{{{},
                                       {.patches = false, .all_faces = true},
                                       {.variant = 1},
                                       {.variant = 2},
                                       {.variant = 3},
                                       {.all_faces = true, .fuzzy = a},
                                       {.all_faces = true, .fuzzy = 10 * a},
                                       {.shift = {a, -0.7 * a, 0.4 * a}},
                                       {.shift = {-0.6 * a, a, -0.8 * a}}}};
  std::string fault;
  std::size_t tried = 0;
  std::optional<ClippedCell> best;  // of those with rough edges
  const Vec3 size = grid_.size();
  const double rough = rough_edge * std::fmin(size.x, std::fmin(size.y, size.z));
  const std::size_t last = ways == Ways::all ? ladder.size() : 2;
  for (std::size_t n = 0; n < last && !run_.should_stop(); ++n) {
    try {
      WholeCell& all = whole(kind, ladder[n].variant);
      if (all.faces.empty() && ladder[n].variant > 0) continue;
      if (all.faces.empty()) return {};
      ++tried;
      ClippedCell made = attempt(ladder[n], all, cell, faces);
      made.attempts = tried;
      if (made.fault.empty() && made.edge_tolerance <= rough) return made;
      if (made.fault.empty() && (!best || made.edge_tolerance < best->edge_tolerance)) best = made;
      if (fault.empty()) fault = made.fault.empty() ? "its edges are known too roughly" : made.fault;
    } catch (const Standard_Failure& failure) {
      if (fault.empty()) fault = what(failure);
    }
  }
  if (run_.should_stop()) return {.fault = "stopped"};
  if (best && ways == Ways::all) return *best;
  const auto listed = [](const auto& values) {
    std::string out;
    for (std::size_t i = 0; i < 3; ++i) out += (i == 0 ? "(" : ", ") + format_number(values[i]);
    return out + ")";
  };
  return {.fault = "cell " + listed(cell) + ", " + listed(grid_.origin(cell) - grid_.first.min) +
                   " mm from the first, in " + std::to_string(tried) + " ways: " + fault};
}

ClippedCell CellClipper::attempt(const Attempt& how, WholeCell& whole, const Index3& cell,
                                 const std::vector<std::uint32_t>& faces) {
  const Vec3 to_cell = how.shift - (grid_.origin(cell) - grid_.first.min);
  LocalBody body;
  const LocalFaces::Near near = local_.near(cell, faces, how.patches);
  for (const TopoDS_Shape& solid : near.solids) body.faces.push_back(moved(solid, to_cell));
  const Vec3 centre = grid_.centre(cell), half = 0.5 * grid_.size();
  std::vector<std::array<std::size_t, 2>> ranges;
  for (const std::uint32_t number : faces) {
    const std::size_t first = body.triangles.size();
    const BodySurface::Face& face = surface_.face(number);
    body.reach = std::fmax(body.reach, face.reach);
    const double by = face.reach + 0.1 * norm(half);
    for (std::size_t t = 0; t < face.triangles.size(); ++t) {
      const Triangle3 triangle = face.triangle(t);
      if (overlaps(triangle, centre, {half.x + by, half.y + by, half.z + by}))
        body.triangles.push_back({triangle[0] + to_cell, triangle[1] + to_cell, triangle[2] + to_cell});
    }
    ranges.push_back({first, body.triangles.size()});
  }
  for (const std::size_t i : near.stand_for) body.of_face.push_back(ranges[i]);
  // A frame is cut with what is not in the body.
  const bool turned = whole.is_frame;
  if (turned)
    for (TopoDS_Shape& solid : body.faces) solid.Reverse();
  body.contains = [this, to_cell, turned](Vec3 p) { return surface_.contains(p - to_cell) != turned; };
  body.side = [this, to_cell, turned](Vec3 p) { return (turned ? -1 : 1) * side_of(p - to_cell); };
  const Vec3 size = grid_.size();
  return split_cell(whole, body, {how.all_faces, how.fuzzy, std::fmin(size.x, std::fmin(size.y, size.z))}, run_);
}

}  // namespace meso::brep
