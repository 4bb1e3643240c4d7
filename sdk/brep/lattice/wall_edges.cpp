// SPDX-License-Identifier: Apache-2.0
// align_edges: what one box divides on a side or an edge of it, the others there must divide, too.
#include <GeomAPI_ProjectPointOnCurve.hxx>
#include <algorithm>
#include <map>

#include "lattice/imprint.hpp"
#include "lattice/united_cells.hpp"

namespace meso::brep {
namespace {

bool has_near(const std::vector<Vec3>& points, Vec3 p, double tolerance) {
  return std::ranges::any_of(points, [&](Vec3 q) { return norm(p - q) <= tolerance; });
}

struct WallEdge {
  TopoDS_Edge edge;
  Box3 box;
};

/// What a kind has on the sides of its box.
struct OnSides {
  std::vector<Vec3> ends;  ///< of edges
  std::vector<WallEdge> edges;
};

class EdgeAlignment {
 public:
  EdgeAlignment(const CellGrid& grid, const std::vector<TopoDS_Shape>& solids)
      : grid_(grid), tolerance_(10 * grid.tolerance) {
    for (const TopoDS_Shape& solid : solids) kinds_.push_back(read(solid));
  }

  /// Where edges of kind `own` are to be divided, because kind `other` stands `shift` boxes away.
  [[nodiscard]] const std::vector<Vec3>& missing(std::uint32_t own, std::uint32_t other, const Index3& shift);

 private:
  [[nodiscard]] OnSides read(const TopoDS_Shape& solid) const;
  [[nodiscard]] bool on_side(Vec3 p) const {
    for (std::size_t i = 0; i < 3; ++i)
      if (std::fabs(p[i] - grid_.first.min[i]) <= tolerance_ || std::fabs(p[i] - grid_.first.max[i]) <= tolerance_)
        return true;
    return false;
  }
  [[nodiscard]] bool in_box(Vec3 p) const {
    for (std::size_t i = 0; i < 3; ++i)
      if (p[i] < grid_.first.min[i] - tolerance_ || p[i] > grid_.first.max[i] + tolerance_) return false;
    return true;
  }
  [[nodiscard]] bool divides(Vec3 p, const WallEdge& edge) const;

  CellGrid grid_;
  double tolerance_;
  std::vector<OnSides> kinds_;
  std::map<std::tuple<std::uint32_t, std::uint32_t, Index3>, std::vector<Vec3>> missing_;
};

OnSides EdgeAlignment::read(const TopoDS_Shape& solid) const {
  OnSides out;
  if (solid.IsNull()) return out;
  TopTools_IndexedMapOfShape edges;
  TopExp::MapShapes(solid, TopAbs_EDGE, edges);
  for (int e = 1; e <= edges.Extent(); ++e) {
    const TopoDS_Edge& edge = TopoDS::Edge(edges(e));
    if (BRep_Tool::Degenerated(edge)) continue;
    const Vec3 from = to_vec(BRep_Tool::Pnt(TopExp::FirstVertex(edge)));
    const Vec3 to = to_vec(BRep_Tool::Pnt(TopExp::LastVertex(edge)));
    for (const Vec3 p : {from, to})
      if (on_side(p) && !has_near(out.ends, p, tolerance_)) out.ends.push_back(p);
    if (!on_side(from) || !on_side(to)) continue;
    const BRepAdaptor_Curve curve(edge);
    WallEdge value{edge, {}};
    bool all = true;
    double step = 0;
    Vec3 last = from;
    for (int k = 0; k <= 8; ++k) {
      const double t = k / 8.0;
      const Vec3 p = to_vec(curve.Value((1 - t) * curve.FirstParameter() + t * curve.LastParameter()));
      all = all && on_side(p);
      value.box.extend(p);
      if (k > 0) step = std::fmax(step, norm(p - last));
      last = p;
    }
    if (!all) continue;
    const double by = curve.GetType() == GeomAbs_Line ? tolerance_ : step;
    value.box.min = value.box.min - Vec3{by, by, by};
    value.box.max = value.box.max + Vec3{by, by, by};
    out.edges.push_back(std::move(value));
  }
  return out;
}

bool EdgeAlignment::divides(Vec3 p, const WallEdge& edge) const {
  for (std::size_t i = 0; i < 3; ++i)
    if (p[i] < edge.box.min[i] || p[i] > edge.box.max[i]) return false;
  double first = 0, last = 0;
  const Handle(Geom_Curve) curve = BRep_Tool::Curve(edge.edge, first, last);
  const GeomAPI_ProjectPointOnCurve foot(to_pnt(p), curve, first, last);
  return foot.NbPoints() > 0 && foot.LowerDistance() <= tolerance_;
}

const std::vector<Vec3>& EdgeAlignment::missing(std::uint32_t own, std::uint32_t other, const Index3& shift) {
  const auto [known, fresh] = missing_.try_emplace({own, other, shift});
  if (!fresh) return known->second;
  const Vec3 by{shift[0] * grid_.size().x, shift[1] * grid_.size().y, shift[2] * grid_.size().z};
  for (const Vec3 end : kinds_[other].ends) {
    const Vec3 p = end + by;
    if (!in_box(p) || has_near(kinds_[own].ends, p, 2 * tolerance_)) continue;
    if (std::ranges::any_of(kinds_[own].edges, [&](const WallEdge& edge) { return divides(p, edge); }))
      known->second.push_back(p);
  }
  return known->second;
}

/// Boxes that share a side or an edge.
std::vector<Index3> neighbours() {
  std::vector<Index3> out;
  for (std::int32_t x = -1; x <= 1; ++x)
    for (std::int32_t y = -1; y <= 1; ++y)
      for (std::int32_t z = -1; z <= 1; ++z)
        if (const int away = std::abs(x) + std::abs(y) + std::abs(z); away == 1 || away == 2) out.push_back({x, y, z});
  return out;
}

}  // namespace

bool align_edges(const CellGrid& grid, const KeptCells& cells, std::uint32_t alike, CellKinds& kinds,
                 std::vector<TopoDS_Shape>& solids) {
  EdgeAlignment alignment(grid, solids);
  const double tolerance = 20 * grid.tolerance;
  const std::vector<Index3> shifts = neighbours();
  std::map<std::pair<std::uint32_t, std::vector<std::array<std::int64_t, 3>>>, std::uint32_t> known;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> changes;  // of cells
  for (std::uint32_t n = 0; n < cells.count(); ++n) {
    const Index3& cell = cells.cell(n);
    const std::uint32_t own = kinds.of(cell, cells);
    std::vector<Vec3> points;
    for (const Index3& shift : shifts) {
      const Index3 there{cell[0] + shift[0], cell[1] + shift[1], cell[2] + shift[2]};
      if (cells.number(there) == KeptCells::none) continue;
      const std::uint32_t other = kinds.of(there, cells);
      if (own < alike && other < alike) continue;
      for (const Vec3 p : alignment.missing(own, other, shift))
        if (!has_near(points, p, tolerance)) points.push_back(p);
    }
    if (points.empty()) continue;
    std::vector<std::array<std::int64_t, 3>> key;
    for (const Vec3 p : points)
      key.push_back({std::llround(p.x / tolerance), std::llround(p.y / tolerance), std::llround(p.z / tolerance)});
    const auto [it, fresh] = known.emplace(std::pair(own, std::move(key)), static_cast<std::uint32_t>(solids.size()));
    if (fresh) {
      solids.push_back(divided_at(solids[own], points));
      if (solids.back().IsNull()) return false;
    }
    changes.emplace_back(n, it->second);
  }
  for (const auto& [cell, kind] : changes) kinds.set(cell, kind);
  return true;
}

}  // namespace meso::brep
