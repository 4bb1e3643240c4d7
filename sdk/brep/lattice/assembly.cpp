// SPDX-License-Identifier: Apache-2.0
#include "lattice/assembly.hpp"

#include <algorithm>
#include <map>
#include <string>

#include "meso/brep/instance_map.hpp"
#include "meso/brep/placement.hpp"

namespace meso::brep {
namespace {

constexpr std::uint32_t none = KeptCells::none;

Index3 across(const Index3& cell, const CellFace& wall) {
  Index3 other = cell;
  other[static_cast<std::size_t>(wall.axis)] += wall.side ? 1 : -1;
  return other;
}

/// What stands where. Shared, unchanging, by the shells of the body.
class Layout {
 public:
  Layout(Quotient quotient, KeptCells cells, CellKinds kinds)
      : quotient_(std::move(quotient)), cells_(std::move(cells)), kinds_(std::move(kinds)) {
    for (const CellKind& kind : quotient_.kinds)
      clusters_ = std::max(clusters_, static_cast<std::uint32_t>(kind.cluster_lumps.size()));
    for (std::vector<EdgeUse>& uses : quotient_.uses) std::ranges::stable_sort(uses, {}, place_of);
  }

  [[nodiscard]] const Quotient& quotient() const { return quotient_; }
  [[nodiscard]] const KeptCells& cells() const { return cells_; }
  [[nodiscard]] std::uint32_t clusters() const { return clusters_; }
  /// A cluster of faces in a cell, as one number.
  [[nodiscard]] std::uint32_t node(std::uint32_t cell, const CellFace& face) const {
    return cell * clusters_ + face.cluster;
  }
  [[nodiscard]] std::uint32_t kind(const Index3& cell) const { return kinds_.of(cell, cells_); }
  /// Whether the wall of a kept cell is inside the solid.
  [[nodiscard]] bool cancelled(const Index3& cell, const CellFace& wall) const {
    const Index3 other = across(cell, wall);
    return cells_.number(other) != none &&
           quotient_.kinds[kind(other)].walls.contains(2 * std::uint64_t{wall.wall_orbit} +
                                                       static_cast<std::uint64_t>(1 - wall.side));
  }
  [[nodiscard]] bool shows(const Index3& cell, const CellFace& face) const {
    return face.axis < 0 || !cancelled(cell, face);
  }
  /// Visits the uses of a template's edge that stands `at` by the cells that are there.
  template <typename Visit>
  [[nodiscard]] bool visit_uses(std::uint32_t edge, const Index3& at, const Visit& visit) const {
    const std::vector<EdgeUse>& uses = quotient_.uses[edge];
    for (auto from = uses.begin(); from != uses.end();) {
      const Index3 beside = from->face_cell;
      const auto to = std::upper_bound(from, uses.end(), beside,
                                       [](const Index3& a, const EdgeUse& use) { return a < use.face_cell; });
      if (const std::uint32_t number = cells_.number(at + beside); number != none) {
        const std::uint32_t here = kind(at + beside);
        const auto [first, last] = std::ranges::equal_range(from, to, here, {}, &EdgeUse::kind);
        for (auto use = first; use != last; ++use)
          if (!visit(number, *use)) return false;
      }
      from = to;
    }
    return true;
  }
  /// Every piece of the natural face that `cell` owns is there.
  [[nodiscard]] bool complete(const NaturalFace& natural, const Index3& cell) const {
    return std::all_of(natural.parts.begin(), natural.parts.end(), [&](const NaturalFace::Part& part) {
      const std::uint32_t number = cells_.number(cell + part.offset);
      return number != none && kind(cell + part.offset) == 0 && !split_.contains({number, part.piece});
    });
  }

  static std::pair<Index3, std::uint32_t> place_of(const EdgeUse& use) { return {use.face_cell, use.kind}; }

  /// Faces of one cluster in one cell.
  template <typename Callback>
  void visit_node(std::uint32_t node, const Callback& callback) const {
    const std::uint32_t number = node / clusters_, cluster = node % clusters_;
    const Index3 cell = cells_.cell(number);
    const std::uint32_t kind_index = kind(cell);
    const CellKind& kind = quotient_.kinds[kind_index];
    for (std::uint32_t f = 0; f < kind.faces.size(); ++f) {
      const CellFace& face = kind.faces[f];
      if (face.cluster != cluster || !shows(cell, face)) continue;
      const Quotient::PartOf part = kind_index == 0 ? quotient_.part_of[f] : Quotient::PartOf{};
      if (part.natural >= 0) {
        const NaturalFace& natural = quotient_.naturals[static_cast<std::size_t>(part.natural)];
        if (complete(natural, {cell[0] - part.offset[0], cell[1] - part.offset[1], cell[2] - part.offset[2]})) {
          if (part.owner) callback(FaceInstance{natural.face, cell});
          continue;
        }
      }
      const auto split = split_.find({number, f});
      callback(FaceInstance{split == split_.end() ? face.face : split->second, cell});
    }
  }

  /// From now on face `f` of the cell is template face `face`: the same with some edges replaced by copies.
  void replace(std::uint32_t number, std::uint32_t f, std::uint32_t face) { split_[{number, f}] = face; }
  [[nodiscard]] std::uint32_t template_face(std::uint32_t number, std::uint32_t f) const {
    const auto split = split_.find({number, f});
    return split != split_.end() ? split->second : quotient_.kinds[kind(cells_.cell(number))].faces[f].face;
  }

 private:
  Quotient quotient_;
  KeptCells cells_;
  std::uint32_t clusters_ = 1;
  CellKinds kinds_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> split_;
};

/// Goes over every edge on a box plane once, joins what meets there, and takes apart sheets that only touch.
class Stitcher {
 public:
  explicit Stitcher(Layout& layout)
      : layout_(layout), nodes_(std::size_t{layout.cells().count()} * layout.clusters()) {}

  /// The shells: which clusters of faces hang together.
  [[nodiscard]] UnionFind& nodes() { return nodes_; }

  [[nodiscard]] bool stitch(const RunOptions& run) {
    const KeptCells& cells = layout_.cells();
    for (std::uint32_t n = 0; n < cells.count(); ++n) {
      if (n % 4096 == 0 && run.should_stop()) return false;
      const Index3 cell = cells.cell(n);
      for (const CellKind::EdgeAt& edge : layout_.quotient().kinds[layout_.kind(cell)].boundary_edges)
        if (!stitch_edge(n, edge.edge, cell + edge.offset)) return false;
    }
    return true;
  }

 private:
  struct Use {
    std::uint32_t cell = 0, face = 0, node = 0;
    bool shows = false, reversed = false;
    std::uint32_t partner_cell = none;  // across a wall that does not show
  };

  bool stitch_edge(std::uint32_t from, std::uint32_t edge, const Index3& at);
  bool stitch_sheets(std::uint32_t edge, const Index3& at);
  void copy_edge(std::uint32_t edge, const Index3& at, const std::vector<Use>& sheet, std::uint32_t number);

  Layout& layout_;
  std::vector<Use> uses_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> edge_copies_;
  std::map<std::array<std::int64_t, 6>, std::uint32_t> face_copies_;
  UnionFind nodes_;
};

bool Stitcher::stitch_edge(std::uint32_t from, std::uint32_t edge, const Index3& at) {
  const Quotient& quotient = layout_.quotient();
  uses_.clear();
  std::size_t showing = 0;
  const auto take = [&](std::uint32_t number, const EdgeUse& use) {
    if (number < from) return false;
    const Index3 cell = at + use.face_cell;
    const CellFace& face = quotient.kinds[use.kind].faces[use.face];
    Use found{.cell = number, .face = use.face, .node = layout_.node(number, face), .reversed = use.reversed};
    found.shows = layout_.shows(cell, face);
    if (!found.shows) found.partner_cell = layout_.cells().number(across(cell, face));
    showing += found.shows;
    uses_.push_back(found);
    return true;
  };
  if (!layout_.visit_uses(edge, at, take)) return true;  // an earlier cell has seen to it
  if (showing == 0) return true;
  if (showing != 2) return stitch_sheets(edge, at);
  const Use* first = nullptr;
  for (const Use& use : uses_) {
    if (!use.shows) continue;
    if (!first) {
      first = &use;
      continue;
    }
    nodes_.join(first->node, use.node);
    return first->reversed != use.reversed;
  }
  return false;
}

/// More than two faces meet: the solid touches itself along the edge. Faces that bound one wedge of material belong
/// together; a wedge is a cell, or several joined by walls that do not show. Each wedge after the first gets its own
/// copy of the edge, so that every edge is used twice.
bool Stitcher::stitch_sheets(std::uint32_t edge, const Index3& at) {
  std::map<std::uint32_t, std::uint32_t> wedge;  // cell -> smallest cell of its wedge
  for (const Use& use : uses_) wedge.emplace(use.cell, use.cell);
  for (std::size_t pass = 0; pass < wedge.size(); ++pass)
    for (const Use& use : uses_) {
      if (use.shows || !wedge.contains(use.partner_cell)) continue;
      const std::uint32_t smallest = std::min(wedge[use.cell], wedge[use.partner_cell]);
      wedge[use.cell] = wedge[use.partner_cell] = smallest;
    }
  std::map<std::uint32_t, std::vector<Use>> sheets;
  for (const Use& use : uses_)
    if (use.shows) sheets[wedge[use.cell]].push_back(use);
  std::uint32_t number = 0;
  for (const auto& [cell, sheet] : sheets) {
    if (sheet.size() != 2 || sheet[0].reversed == sheet[1].reversed) return false;
    nodes_.join(sheet[0].node, sheet[1].node);
    if (number > 0) copy_edge(edge, at, sheet, number);
    ++number;
  }
  return true;
}

void Stitcher::copy_edge(std::uint32_t edge, const Index3& at, const std::vector<Use>& sheet, std::uint32_t number) {
  Template& geometry = *layout_.quotient().geometry;
  const auto [copy, fresh_edge] =
      edge_copies_.emplace(std::pair(edge, number), static_cast<std::uint32_t>(geometry.edges.size()));
  if (fresh_edge) geometry.edges.push_back(EdgeTemplate(geometry.edges[edge]));
  for (const Use& use : sheet) {
    const std::uint32_t original = layout_.template_face(use.cell, use.face);
    const Index3& cell = layout_.cells().cell(use.cell);
    const Index3 offset{at[0] - cell[0], at[1] - cell[1], at[2] - cell[2]};
    const auto [face, fresh_face] =
        face_copies_.emplace(std::array<std::int64_t, 6>{original, edge, number, offset[0], offset[1], offset[2]},
                             static_cast<std::uint32_t>(geometry.faces.size()));
    if (fresh_face) {
      geometry.faces.push_back(FaceTemplate(geometry.faces[original]));
      for (auto& loop : geometry.faces.back().loops)
        for (Coedge& coedge : loop)
          if (coedge.edge == edge && coedge.offset == offset) coedge.edge = copy->second;
    }
    layout_.replace(use.cell, use.face, face->second);
  }
}

/// Which connected solid each cluster bounds: solids of neighbouring cells are joined by the walls that do not show.
UnionFind join_lumps(const Layout& layout, std::uint32_t lumps) {
  const KeptCells& cells = layout.cells();
  UnionFind sets(std::size_t{cells.count()} * lumps);
  for (std::uint32_t n = 0; n < cells.count(); ++n) {
    const Index3 cell = cells.cell(n);
    const CellKind& kind = layout.quotient().kinds[layout.kind(cell)];
    for (const CellFace& face : kind.faces) {
      if (face.axis < 0 || face.side == 0 || !layout.cancelled(cell, face)) continue;
      const Index3 other = across(cell, face);
      const CellKind& other_kind = layout.quotient().kinds[layout.kind(other)];
      const auto twin = std::find_if(other_kind.faces.begin(), other_kind.faces.end(), [&](const CellFace& f) {
        return f.axis == face.axis && f.side == 0 && f.wall_orbit == face.wall_orbit;
      });
      sets.join(n * lumps + kind.cluster_lumps[face.cluster],
                cells.number(other) * lumps + other_kind.cluster_lumps[twin->cluster]);
    }
  }
  return sets;
}

/// Walls that meet and are not the same region, where one kind of cell stands beside another.
bool any_walls_overlap(const Layout& layout) {
  const Quotient& quotient = layout.quotient();
  const Mat3& lattice = quotient.geometry->lattice;
  const Vec3 size{lattice(0, 0), lattice(1, 1), lattice(2, 2)};
  std::set<std::array<std::uint32_t, 3>> seen;
  for (std::uint32_t n = 0; n < layout.cells().count(); ++n)
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      const Index3 cell = layout.cells().cell(n);
      Index3 next = cell;
      ++next[axis];
      if (layout.cells().number(next) == none) continue;
      const std::uint32_t low = layout.kind(cell), high = layout.kind(next);
      if (!seen.insert({low, high, axis}).second) continue;
      if (walls_overlap(quotient.kinds[low], quotient.kinds[high], static_cast<int>(axis), size)) return true;
    }
  return false;
}

struct ShellNodes {
  std::vector<std::uint32_t> nodes;
  std::uint32_t solid = 0;
  Enclosed enclosed;
};

/// Shells in the order of their first cell.
std::vector<ShellNodes> collect_shells(const Layout& layout, UnionFind& nodes, UnionFind& solids, std::uint32_t lumps) {
  const Template& geometry = *layout.quotient().geometry;
  std::vector<ShellNodes> shells;
  std::vector<std::uint32_t> shell_of(std::size_t{layout.cells().count()} * layout.clusters(), none);
  for (std::uint32_t node = 0; node < shell_of.size(); ++node) {
    const std::uint32_t cell = node / layout.clusters(), cluster = node % layout.clusters();
    Enclosed enclosed;
    layout.visit_node(node, [&](const FaceInstance& instance) {
      enclosed.add(geometry.faces[instance.face], cell_origin(geometry, instance.cell));
    });
    const bool any = !enclosed.empty();
    const std::uint32_t root = nodes.root(node);
    if (!any && root == node) continue;  // a cluster of walls of which none shows
    const CellKind& kind = layout.quotient().kinds[layout.kind(layout.cells().cell(cell))];
    if (shell_of[root] == none) {
      shell_of[root] = static_cast<std::uint32_t>(shells.size());
      shells.emplace_back().solid = solids.root(cell * lumps + kind.cluster_lumps[cluster]);
    }
    ShellNodes& shell = shells[shell_of[root]];
    if (any) shell.nodes.push_back(node);
    shell.enclosed.add(enclosed);
  }
  return shells;
}

/// What the faces of a kind lack to close, as a vector: the edges of cut cells are known to their tolerance only.
std::vector<double> gaps_of(const Quotient& quotient) {
  std::vector<double> gaps;
  for (const CellKind& kind : quotient.kinds) {
    Vec3 sum;
    for (const CellFace& face : kind.faces) sum += quotient.geometry->faces[face.face].moments.vector_area;
    gaps.push_back(norm(sum));
  }
  return gaps;
}

}  // namespace

std::optional<Body> assemble(Quotient quotient, KeptCells cells, CellKinds kinds, const RunOptions& run,
                             DiagnosticSink& sink) {
  const auto fault = [&](const char* what) {
    sink.report({.code = Code::geometry_not_repeatable, .args = {what}});
    return std::nullopt;
  };
  const std::shared_ptr<const Template> geometry = quotient.geometry;
  const auto layout = std::make_shared<Layout>(std::move(quotient), std::move(cells), std::move(kinds));
  if (any_walls_overlap(*layout)) return fault("cells meet in parts of their walls");
  Stitcher stitcher(*layout);
  const bool closed = stitcher.stitch(run);
  if (run.should_stop()) {
    sink.report({.code = run.out_of_time() ? Code::limit_time : Code::cancelled});
    return {};
  }
  if (!closed) return fault("the walls of neighbouring cells do not close");
  std::uint32_t lumps = 1;
  double expected = 0, unknown = 0;
  const std::vector<double> gaps = gaps_of(layout->quotient());
  for (const CellKind& kind : layout->quotient().kinds) lumps = std::max(lumps, kind.lumps);
  for (std::uint32_t n = 0; n < layout->cells().count(); ++n) {
    const Index3& cell = layout->cells().cell(n);
    const std::uint32_t kind = layout->kind(cell);
    expected += layout->quotient().kinds[kind].volume;
    unknown += gaps[kind] * norm(cell_origin(*geometry, cell + Index3{1, 1, 1})) / 3;
  }
  UnionFind solids = join_lumps(*layout, lumps);
  const std::vector<ShellNodes> shells = collect_shells(*layout, stitcher.nodes(), solids, lumps);

  Body body;
  std::map<std::uint32_t, std::vector<Shell>> voids;
  std::vector<std::uint32_t> owners;
  double volume = 0;
  for (const ShellNodes& found : shells) {
    volume += found.enclosed.volume();
    Shell shell{.geometry = geometry, .placement = {}, .visit = {}};
    shell.visit = [layout, nodes = found.nodes](const std::function<void(const FaceInstance&)>& callback) {
      for (const std::uint32_t node : nodes) layout->visit_node(node, callback);
    };
    if (found.enclosed.volume() < 0) {
      voids[found.solid].push_back(std::move(shell));
    } else {
      owners.push_back(found.solid);
      body.solids.push_back({.outer = std::move(shell), .voids = {}});
    }
  }
  for (std::size_t s = 0; s < owners.size(); ++s)
    if (const auto found = voids.find(owners[s]); found != voids.end()) {
      body.solids[s].voids = std::move(found->second);
      voids.erase(found);
    }
  if (!voids.empty() || std::fabs(volume - expected) > 1e-6 * expected + unknown)
    return fault("the shells do not enclose what the cells hold");
  body.fragments = body.solids.empty() ? 0 : body.solids.size() - 1;
  body.pieces_volume = expected;
  return body;
}

}  // namespace meso::brep
