// SPDX-License-Identifier: Apache-2.0
#include "lattice/lattice_pieces.hpp"

#include "lattice/box_frame.hpp"
#include "lattice/union_find.hpp"
#include "point_within.hpp"

namespace meso::brep {
namespace {

constexpr std::size_t tries = 4;  ///< boxes of a piece in which a point of it is looked for

TopoDS_Shape moved(const TopoDS_Shape& shape, Vec3 by) {
  gp_Trsf move;
  move.SetTranslation(gp_Vec(by.x, by.y, by.z));
  return shape.Moved(TopLoc_Location(move));
}

/// Whether walls in one plane share area, `high` being moved by `shift`.
bool walls_meet(const WallFaces& low, const WallFaces& high, Vec3 shift, double size) {
  if (low.faces.empty() || high.faces.empty()) return false;
  if (low.is_same(high, shift, size)) return true;
  BRepAlgoAPI_Common common(compound_of(low.faces), moved(compound_of(high.faces), shift));
  if (common.HasErrors()) return false;
  GProp_GProps area;
  BRepGProp::SurfaceProperties(common.Shape(), area);
  return area.Mass() > 1e-9 * size * size;
}

}  // namespace

LatticePieces::LatticePieces(const CellGrid& grid, const KeptCells& cells, const CellKinds& kinds,
                             const std::vector<TopoDS_Shape>& solids)
    : grid_(grid) {
  std::vector<std::vector<BoxWalls>> walls;  // by kind and lump
  for (const TopoDS_Shape& solid : solids) {
    auto& lumps = lumps_.emplace_back();
    auto& of_lumps = walls.emplace_back();
    if (solid.IsNull()) continue;
    for (TopExp_Explorer it(solid, TopAbs_SOLID); it.More(); it.Next()) {
      lumps.push_back(it.Current());
      of_lumps.push_back(walls_of(it.Current(), grid.first, 4 * grid.tolerance));
    }
  }
  std::uint32_t count = 0;
  for (std::uint32_t n = 0; n < cells.count(); ++n) {
    kind_of_.push_back(kinds.of(cells.cell(n), cells));
    first_lump_.push_back(count);
    count += static_cast<std::uint32_t>(lumps_[kind_of_.back()].size());
    numbers_.emplace(cells.cell(n), n);
  }
  const Vec3 size = grid.size();
  const double shortest = std::fmin(size.x, std::fmin(size.y, size.z));
  std::map<std::array<std::uint32_t, 3>, std::vector<std::array<std::size_t, 2>>> meeting;
  UnionFind joined(count);
  for (std::uint32_t n = 0; n < cells.count(); ++n)
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      Index3 next = cells.cell(n);
      ++next[axis];
      const std::uint32_t other = cells.number(next);
      if (other == KeptCells::none) continue;
      const std::array<std::uint32_t, 3> key{kind_of_[n], kind_of_[other], axis};
      auto known = meeting.find(key);
      if (known == meeting.end()) {
        known = meeting.emplace(key, std::vector<std::array<std::size_t, 2>>{}).first;
        Vec3 shift;
        shift[axis] = size[axis];
        for (std::size_t a = 0; a < walls[key[0]].size(); ++a)
          for (std::size_t b = 0; b < walls[key[1]].size(); ++b)
            if (walls_meet(walls[key[0]][a][2 * axis + 1], walls[key[1]][b][2 * axis], shift, shortest))
              known->second.push_back({a, b});
      }
      for (const auto& [a, b] : known->second) joined.join(lump(n, a), lump(other, b));
    }
  std::map<std::uint32_t, std::size_t> numbers;
  std::vector<std::size_t> tried;
  std::map<std::array<std::uint32_t, 2>, std::vector<Vec3>> within;  // of a kind's lump
  for (std::uint32_t n = 0; n < cells.count(); ++n)
    for (std::uint32_t l = 0; l < lumps_[kind_of_[n]].size(); ++l) {
      const auto [it, fresh] = numbers.emplace(joined.root(lump(n, l)), points_.size());
      if (fresh) {
        points_.emplace_back();
        tried.push_back(0);
      }
      piece_of_.push_back(it->second);
      if (points_[it->second] || tried[it->second]++ >= tries) continue;
      const auto [found, first_time] = within.try_emplace({kind_of_[n], l});
      if (first_time) found->second = points_within(lumps_[kind_of_[n]][l], 1);
      if (!found->second.empty())
        points_[it->second] = found->second.front() + (grid_.origin(cells.cell(n)) - grid_.first.min);
    }
}

std::optional<std::size_t> LatticePieces::at(Vec3 p) const {
  Index3 cell{};
  for (std::size_t i = 0; i < 3; ++i)
    cell[i] = static_cast<std::int32_t>(std::floor((p[i] - grid_.first.min[i]) / grid_.size()[i]));
  const auto found = numbers_.find(cell);
  if (found == numbers_.end()) return {};
  const Vec3 in_cell = p - (grid_.origin(cell) - grid_.first.min);
  const auto& lumps = lumps_[kind_of_[found->second]];
  for (std::size_t l = 0; l < lumps.size(); ++l)
    if (BRepClass3d_SolidClassifier(lumps[l], to_pnt(in_cell), Precision::Confusion()).State() == TopAbs_IN)
      return piece_of_[lump(found->second, l)];
  return {};
}

}  // namespace meso::brep
