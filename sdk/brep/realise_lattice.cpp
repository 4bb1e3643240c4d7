// SPDX-License-Identifier: Apache-2.0
#include "realise_lattice.hpp"

#include <GeomLib_IsPlanarSurface.hxx>
#include <algorithm>

#include "boolean.hpp"
#include "box_lattice.hpp"
#include "lattice/cells_of_boxes.hpp"
#include "lattice/circles_apart.hpp"
#include "lattice/varied_cells.hpp"
#include "meso/eval/cell_fit.hpp"
#include "solid_primitive.hpp"
#include "solid_shape.hpp"

namespace meso::brep {
namespace {

constexpr double plane_tolerance = 1e-6;  ///< millimetres between a face and the plane of cell boxes it stands for

Affine inverse(const Affine& rigid) {
  const Mat3 back = transposed(rigid.linear);
  return {back, -(back * rigid.translation)};
}

/// Cells that are cut to their boxes are their own intersection with all of these.
TopoDS_Shape all_boxes(const BoxLattice& lattice) {
  Vec3 last = lattice.box.corner;
  for (std::size_t a = 0; a < 3; ++a) last[a] += lattice.count[a] * lattice.box.size[a];
  return BRepPrimAPI_MakeBox(to_pnt(lattice.box.corner), to_pnt(last)).Solid();
}

/// For each box axis, the box planes (numbered from the first cell's low side) that carry faces of the body; empty if a
/// face lies elsewhere, or beyond the cells: what the outermost cells send over their boxes would be in the body, too.
using PlaneNumbers = std::array<std::vector<std::int64_t>, 3>;

std::optional<PlaneNumbers> face_planes(const Solids& solids_in_cell_frame, const BoxLattice& lattice) {
  const eval::BoxShape& box = lattice.box;
  PlaneNumbers planes;
  for (const TopoDS_Shape& solid : solids_in_cell_frame)
    for (TopExp_Explorer it(solid, TopAbs_FACE); it.More(); it.Next()) {
      const GeomLib_IsPlanarSurface planar(BRep_Tool::Surface(TopoDS::Face(it.Current())), 1e-7);
      if (!planar.IsPlanar()) return {};
      const Vec3 normal = to_vec(planar.Plan().Axis().Direction()), point = to_vec(planar.Plan().Location());
      std::size_t axis = 0;
      while (axis < 3 && std::fabs(normal[axis]) < 1 - 1e-14) ++axis;
      if (axis == 3) return {};
      const double number = (point[axis] - box.corner[axis]) / box.size[axis];
      if (std::fabs(number - std::nearbyint(number)) * box.size[axis] > plane_tolerance) return {};
      if (std::nearbyint(number) < 0 || std::nearbyint(number) > lattice.count[axis]) return {};
      planes[axis].push_back(std::llround(number));
    }
  return planes;
}

/// The index grid cut by the face planes into blocks that are inside or outside as a whole.
class Blocks {
 public:
  Blocks(const Solids& solids_in_cell_frame, const BoxLattice& lattice, const PlaneNumbers& planes) {
    for (std::size_t a = 0; a < 3; ++a) {
      const std::int64_t count = lattice.count[a];
      std::vector<std::int64_t>& cuts = cuts_[a];
      cuts = planes[a];
      std::erase_if(cuts, [&](std::int64_t n) { return n <= 0 || n >= count; });
      cuts.push_back(0);
      cuts.push_back(count);
      std::ranges::sort(cuts);
      cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());
      for (std::size_t b = 0; b + 1 < cuts.size(); ++b)
        block_of_[a].insert(block_of_[a].end(), static_cast<std::size_t>(cuts[b + 1] - cuts[b]), b);
    }
    probe(solids_in_cell_frame, lattice.box);
  }

  [[nodiscard]] bool inside(const Index3& cell) const {
    return inside_[block(block_of_[0][static_cast<std::size_t>(cell[0])],
                         block_of_[1][static_cast<std::size_t>(cell[1])],
                         block_of_[2][static_cast<std::size_t>(cell[2])])];
  }
  /// Boxes, and cells of the pattern that have one of them.
  [[nodiscard]] std::uint64_t kept() const { return kept_; }
  [[nodiscard]] std::uint64_t kept_cells(const BoxLattice& lattice) const {
    if (!lattice.is_refined()) return kept_;
    CellsOfBoxes cells({lattice.count[0] - 1, lattice.count[1] - 1, lattice.count[2] - 1}, lattice.block);
    for (std::int32_t x = 0; x < lattice.count[0]; ++x)
      for (std::int32_t y = 0; y < lattice.count[1]; ++y)
        for (std::int32_t z = 0; z < lattice.count[2]; ++z)
          if (inside({x, y, z})) cells.add({x, y, z});
    return cells.count();
  }

  /// Walls of boxes between inside and outside.
  [[nodiscard]] std::uint64_t walls() const {
    std::uint64_t out = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      const std::size_t b = (a + 1) % 3, c = (a + 2) % 3;
      std::array<std::size_t, 3> at{};
      for (at[b] = 0; at[b] + 1 < cuts_[b].size(); ++at[b])
        for (at[c] = 0; at[c] + 1 < cuts_[c].size(); ++at[c]) {
          const auto area = static_cast<std::uint64_t>((cuts_[b][at[b] + 1] - cuts_[b][at[b]]) *
                                                       (cuts_[c][at[c] + 1] - cuts_[c][at[c]]));
          bool before = false;
          for (at[a] = 0; at[a] + 1 < cuts_[a].size(); ++at[a]) {
            const bool here = inside_[block(at[0], at[1], at[2])];
            if (here != before) out += area;
            before = here;
          }
          if (before) out += area;
        }
    }
    return out;
  }

 private:
  [[nodiscard]] std::size_t block(std::size_t x, std::size_t y, std::size_t z) const {
    return (x * (cuts_[1].size() - 1) + y) * (cuts_[2].size() - 1) + z;
  }

  void probe(const Solids& solids, const eval::BoxShape& box) {
    inside_.assign((cuts_[0].size() - 1) * (cuts_[1].size() - 1) * (cuts_[2].size() - 1), false);
    for (const TopoDS_Shape& solid : solids) {
      BRepClass3d_SolidClassifier classifier(solid);
      for (std::size_t x = 0; x + 1 < cuts_[0].size(); ++x)
        for (std::size_t y = 0; y + 1 < cuts_[1].size(); ++y)
          for (std::size_t z = 0; z + 1 < cuts_[2].size(); ++z) {
            const std::array<std::int64_t, 3> first{cuts_[0][x], cuts_[1][y], cuts_[2][z]};
            const std::array<std::int64_t, 3> last{cuts_[0][x + 1], cuts_[1][y + 1], cuts_[2][z + 1]};
            Vec3 p;
            std::uint64_t cells = 1;
            for (std::size_t a = 0; a < 3; ++a) {
              p[a] = box.corner[a] + (static_cast<double>(first[a]) + 0.5) * box.size[a];
              cells *= static_cast<std::uint64_t>(last[a] - first[a]);
            }
            classifier.Perform(to_pnt(p), Precision::Confusion());
            if (classifier.State() != TopAbs_IN) continue;
            inside_[block(x, y, z)] = true;
            kept_ += cells;
          }
    }
  }

  std::array<std::vector<std::int64_t>, 3> cuts_;
  std::array<std::vector<std::size_t>, 3> block_of_;
  std::vector<bool> inside_;
  std::uint64_t kept_ = 0;
};

/// Balls and frusta of beams; nothing where a cap is neither.
std::optional<std::vector<CellPrimitive>> primitives_of(const eval::BeamsShape& beams) {
  std::vector<CellPrimitive> out;
  const auto add_ball = [&](Vec3 centre, double radius) {
    const bool known = std::ranges::any_of(out, [&](const CellPrimitive& p) {
      const Ball* ball = std::get_if<Ball>(&p);
      return ball != nullptr && norm(ball->centre - centre) <= smallest_size && radius <= ball->radius + smallest_size;
    });
    if (!known) out.emplace_back(Ball{centre, radius});
  };
  for (const eval::StrutNode& node : beams.nodes)
    if (node.ball_radius > 0) add_ball(node.position, node.ball_radius);
  for (const eval::Strut& s : beams.struts) {
    const Vec3 from = beams.nodes[s.from].position, to = beams.nodes[s.to].position;
    out.emplace_back(Frustum{from, to, s.radius_from, s.radius_to});
    for (const auto& [cap, at, radius] : {std::tuple{s.cap_from, from, s.radius_from}, {s.cap_to, to, s.radius_to}}) {
      if (cap == BeamCap::butt) continue;
      if (cap == BeamCap::hemisphere && s.radius_from != s.radius_to) return {};
      add_ball(at, radius);
    }
  }
  return out;
}

bool have_extent(const eval::BeamsShape& beams) {
  return std::ranges::all_of(beams.struts, [&](const eval::Strut& s) {
    return norm(beams.nodes[s.to].position - beams.nodes[s.from].position) > smallest_size &&
           std::min(s.radius_from, s.radius_to) > smallest_size;
  });
}

std::optional<CellShape> repeated_cell(const eval::Shape& shape, const eval::BoxShape& box,
                                       const SolidContext& context) {
  const Box3 bounds{box.corner, box.corner + box.size};
  if (const auto* beams = std::get_if<eval::BeamsShape>(&shape.value)) {
    if (!have_extent(*beams)) return {};  // an error that the usual way tells
    if (auto primitives = primitives_of(*beams))
      return cell_shape({.box = bounds, .primitives = std::move(*primitives)}, context.sink);
  }
  auto solids = solid_from_shape(shape, {}, context);
  if (!solids || solids->empty()) return {};
  return CellShape{.box = bounds, .solids = std::move(*solids), .primitives = {}};
}

/// Around all that the cells of a lattice reach, without `removed`.
std::optional<Solids> all_but(const Solids& removed, const BoxLattice& lattice, const SolidContext& context) {
  constexpr int margin = 3;  // of boxes
  Vec3 first = lattice.box.corner, last = first;
  for (std::size_t a = 0; a < 3; ++a) {
    first[a] -= margin * lattice.box.size[a];
    last[a] += (lattice.count[a] + margin) * lattice.box.size[a];
  }
  return brep::cut({BRepPrimAPI_MakeBox(to_pnt(first), to_pnt(last)).Solid()}, removed, {}, context);
}

/// The cells of a lattice whose struts differ. Nothing where they are not struts, or their boxes differ.
std::optional<CellShape> varied_cell(const eval::CellStream& cells, const BoxLattice& lattice,
                                     const SolidContext& context) {
  const Vec3 size = lattice.box.size;
  const Index3 last{lattice.count[0] - 1, lattice.count[1] - 1, lattice.count[2] - 1};
  PrimitiveTable table(std::max({size.x, size.y, size.z}));
  auto varied = std::make_shared<VariedCells>(last);
  std::uint64_t found = 0;
  const auto take = [&](const eval::PlacedCell& cell) {
    const auto box = cells.cell_box(cell, context.sink);
    if (!box || norm(box->corner - lattice.box.corner) + norm(box->size - size) > 1e-9 * norm(size)) return false;
    const auto shape = cells.shape(cell, context.sink);
    const auto* beams = shape ? std::get_if<eval::BeamsShape>(&shape->value) : nullptr;
    const auto primitives = beams != nullptr ? primitives_of(*beams) : std::nullopt;
    if (!primitives) return false;
    std::vector<std::uint32_t> numbers;
    for (const CellPrimitive& primitive : *primitives) numbers.push_back(table.number_of(primitive));
    const Vec3 at = inverse(lattice.world_from_cell) * cell.world_from_cell.translation;
    Index3 index{};
    for (std::size_t a = 0; a < 3; ++a)
      index[a] = std::clamp(static_cast<std::int32_t>(std::lround(at[a] / size[a])), 0, last[a]);
    varied->set(index, std::move(numbers));
    ++found;
    return true;
  };
  if (!cells.visit(0, cells.size(), take, context.sink) || found != cells.size()) return {};
  auto shape =
      cell_shape({.box = {lattice.box.corner, lattice.box.corner + size}, .primitives = table.all()}, context.sink);
  if (shape) shape->varied = std::move(varied);
  return shape;
}

/// A lattice of boxes side by side, and the bodies in the frame of its first cell.
struct Found {
  BoxLattice lattice;
  CellShape cell;
  Solids body;  ///< empty: the union of all cells
  Solids added;
  std::shared_ptr<const Blocks> blocks;  ///< where the body's faces all lie on planes of the boxes
};

std::optional<Found> find_lattice(const LatticeRequest& request, const eval::CellStream& cells, bool may_refine,
                                  const SolidContext& context) {
  const bool may_vary =
      !request.whole_cells && (cells.unit_cell().clip_to_box.value_or(false) || !request.clip.empty() ||
                               !request.removed.empty() || !request.added.empty());
  const auto lattice = box_lattice(cells, may_refine, may_vary, context);
  if (!lattice || (lattice->is_fitted && request.whole_cells)) return {};
  const auto from_world = [&](Solids solids) {
    for (TopoDS_Shape& solid : solids) solid = mapped(solid, inverse(lattice->world_from_cell));
    return solids;
  };
  Solids in_cell_frame = from_world(request.clip);
  if (request.clip.empty() && !request.removed.empty()) {
    auto left = all_but(from_world(request.removed), *lattice, context);
    if (!left || left->empty()) return {};
    in_cell_frame = std::move(*left);
  } else if (request.clip.empty() && lattice->cut) {
    in_cell_frame.push_back(all_boxes(*lattice));
  }
  auto cell =
      lattice->varies ? varied_cell(cells, *lattice, context) : repeated_cell(lattice->shape, lattice->box, context);
  if (!cell) return {};
  // What sticks out of a box within a cell stays: cutting it is the same only if the next box has it, too.
  if (lattice->is_cut_by_cells && !reach_of(*cell).neighbours.empty())
    return find_lattice(request, cells, false, context);
  cell->cut_to_box = lattice->cut;
  std::shared_ptr<const Blocks> blocks;
  if (const auto planes = face_planes(in_cell_frame, *lattice); planes && !in_cell_frame.empty() && !lattice->varies)
    blocks = std::make_shared<const Blocks>(in_cell_frame, *lattice, *planes);
  return Found{*lattice, std::move(*cell), std::move(in_cell_frame), from_world(request.added), std::move(blocks)};
}

void place(Body& body, const Affine& world_from_body) {
  for (Solid& solid : body.solids) {
    solid.outer.placement = world_from_body * solid.outer.placement;
    for (Shell& hollow : solid.voids) hollow.placement = world_from_body * hollow.placement;
  }
}

using IndexTest = bool (*)(Index3);

/// The faces of some cells, where those share no edge with the others.
Shell part_of(const Shell& shell, IndexTest takes) {
  Shell out = shell;
  out.visit = [all = shell.visit, takes](const std::function<void(const FaceInstance&)>& callback) {
    all([&](const FaceInstance& face) {
      if (takes(face.cell)) callback(face);
    });
  };
  return out;
}

bool is_empty(const Shell& shell) {
  bool empty = true;
  shell.visit([&](const FaceInstance&) { empty = false; });
  return empty;
}

Body part_of(const Body& body, IndexTest takes) {
  Body out;
  for (const Solid& solid : body.solids) {
    Solid part{part_of(solid.outer, takes), {}};
    if (is_empty(part.outer)) continue;
    for (const Shell& hollow : solid.voids)
      if (Shell taken = part_of(hollow, takes); !is_empty(taken)) part.voids.push_back(std::move(taken));
    out.solids.push_back(std::move(part));
  }
  return out;
}

}  // namespace

Thickness strut_thickness(const eval::CellStream& cells, DiagnosticSink& sink) {
  const bool is_bent = cells.pattern().mapping.value_or(CellMapping::rigid) == CellMapping::conformal;
  if (cells.size() < 2 || is_bent || !cells.unit_cell().box ||
      !std::holds_alternative<BeamsBody>(cells.unit_cell().body))
    return {};
  const auto first = first_cell(cells, sink);
  const auto* beams = first ? std::get_if<eval::BeamsShape>(&first->shape.value) : nullptr;
  if (beams == nullptr) return {};
  Thickness out{0, std::max({first->box.size.x, first->box.size.y, first->box.size.z})};
  for (const eval::Strut& strut : beams->struts)
    out.radius = std::max({out.radius, strut.radius_from, strut.radius_to});
  for (const eval::StrutNode& node : beams->nodes) out.ball = std::max(out.ball, node.ball_radius);
  out.is_block = (out.ratio() > 0.4 || out.ball > out.edge) && eval::fill(*beams, first->box);
  return out;
}

namespace {

/// Of a cell that as_varied takes, boxes at the rim of the pattern.
constexpr FusedLimit few_fused{.most = 60, .is_told = false};

/// One way to make a lattice that a body cuts.
struct ClipAttempt {
  CellShape cell;
  CellClipper::Ways ways = CellClipper::Ways::all;
  bool is_wider = false;                  ///< balls have gained a little
  std::optional<std::size_t> again = {};  ///< worth it if that attempt was given up
};

/// Where a line of a body ends in the pole of a ball, or a face touches one, cells that are put together have poles in
/// several places; where a face passes close by the point in which two struts touch, balls that are a little larger
/// have no such point. Where cells cannot be put together, there may yet be other places for the poles.
std::vector<ClipAttempt> clip_attempts(const CellShape& cell) {
  using Ways = CellClipper::Ways;
  const auto poles_aside = with_poles_aside(cell);
  const auto apart = with_circles_apart(cell);
  std::vector<ClipAttempt> out{{cell, poles_aside ? Ways::first : Ways::all}};
  if (auto varied = as_varied(cell)) out.push_back({std::move(*varied)});
  if (poles_aside) out.push_back({*poles_aside});
  if (apart && cell.varied) out.push_back({*apart, Ways::all, true});
  if (apart)
    if (auto varied = as_varied(*apart)) out.push_back({std::move(*varied), Ways::all, true});
  if (poles_aside) out.push_back({cell, Ways::all, false, 0});
  return out;
}

std::optional<ClippedLattice> clipped_lattice(const Found& found, const Index3& last, const LatticeRequest& request,
                                              const SolidContext& context) {
  std::vector<DiagnosticSink> told;
  std::vector<bool> is_given_up;
  std::optional<ClippedLattice> made;
  bool is_wider = false;
  for (const ClipAttempt& attempt : clip_attempts(found.cell)) {
    if (made || context.run.should_stop() || (!told.empty() && told.back().has_errors())) break;
    told.emplace_back();
    is_given_up.push_back(false);
    if (attempt.again && !is_given_up[*attempt.again]) continue;
    const ClipOptions options{.mesh = request.mesh,
                              .reuse = true,
                              .block = found.lattice.block,
                              .pieces = request.pieces,
                              .added = found.added,
                              .fused = attempt.cell.varied && !found.cell.varied ? few_fused : request.fused,
                              .ways = attempt.ways};
    made = clipped_lattice_body(attempt.cell, last, found.body, options, context.run, told.back());
    is_wider = attempt.is_wider;
    is_given_up.back() = made && made->is_given_up;
    if (is_given_up.back()) made.reset();
  }
  // Of the attempts, the last one that has a reason: it most often names a cell.
  const DiagnosticSink* helps = nullptr;
  for (const DiagnosticSink& sink : told)
    if (!sink.diagnostics().empty()) helps = &sink;
  if (made) helps = &told.back();
  if (helps != nullptr)
    for (const Diagnostic& d : helps->diagnostics()) context.sink.report(d);
  if (made && is_wider) context.sink.report({.code = Code::geometry_balls_enlarged});
  if (!made && context.run.should_stop() && (helps == nullptr || helps != &told.back()))  // between two
    context.sink.report({.code = context.run.out_of_time() ? Code::limit_time : Code::cancelled});
  return made;
}

std::optional<ConnectedPieces> in_world(const std::shared_ptr<const LatticePieces>& pieces,
                                        const Affine& world_from_cell) {
  if (!pieces) return {};
  ConnectedPieces out;
  for (const std::optional<Vec3>& p : pieces->points())
    out.points.push_back(p ? std::optional(world_from_cell * *p) : std::nullopt);
  out.at = [pieces, back = inverse(world_from_cell)](Vec3 p) { return pieces->at(back * p); };
  return out;
}

}  // namespace

std::optional<LatticePart> lattice_part(const LatticeRequest& request, const eval::CellStream& cells,
                                        const SolidContext& context) {
  const auto& whole_cells = request.whole_cells;
  // Pieces are told by boxes, however well the body fits them.
  const bool joins = !request.added.empty() || request.pieces != PiecesAsked::none;
  if (joins && whole_cells) return {};
  const auto found = find_lattice(request, cells, !whole_cells, context);
  if (!found) return {};
  const auto& count = found->lattice.count;
  const Index3 last{count[0] - 1, count[1] - 1, count[2] - 1};
  const LatticeOptions options{.mesh = request.mesh, .run = context.run};
  LatticePart out;
  if (whole_cells || (found->body.empty() && !joins)) {
    CellSelection taken{{{}, last, [](Index3) { return true; }}, cells.size(), 0};
    if (whole_cells) {
      auto selected = select_cells(found->cell, last, found->body, *whole_cells, context.run, context.sink);
      if (!selected) return {};
      taken = std::move(*selected);
    }
    out = {.body = {}, .kept = taken.kept, .crossing = taken.crossing};
    if (out.kept == 0) return out;
    auto body = lattice_union(found->cell, taken.set, options, context.sink);
    if (!body) return {};
    out.body = std::move(*body);
    out.body.fragments = 0;
  } else if (found->blocks && !joins) {
    out.kept = found->blocks->kept_cells(found->lattice);
    if (out.kept == 0) return out;
    const LatticeSet set{.min = {0, 0, 0}, .max = last, .inside = [blocks = found->blocks](Index3 index) {
                           return blocks->inside(index);
                         }};
    auto body = lattice_body(found->cell, set, options, context.sink);
    if (!body) return {};
    out.body = std::move(*body);
  } else {
    auto clipped = clipped_lattice(*found, last, request, context);
    if (!clipped) return {};
    out = {std::move(clipped->body), clipped->kept, clipped->crossing, std::move(clipped->clip)};
    out.cut = in_world(clipped->cut, found->lattice.world_from_cell);
    out.joined = in_world(clipped->joined, found->lattice.world_from_cell);
  }
  place(out.body, found->lattice.world_from_cell);
  return out;
}

std::optional<LatticeSample> lattice_sample(const Solids& macrostructure, const eval::CellStream& cells,
                                            const std::optional<MeshFineness>& mesh, const SolidContext& context) {
  const auto found = find_lattice({.clip = macrostructure}, cells, true, context);
  if (!found || !found->blocks) return {};
  LatticeSample out{{}, found->blocks->kept_cells(found->lattice)};
  if (out.kept == 0) return out;
  // A block of n^3 cells has 6 n^2 walls: 8 a + 64 b = kept, 24 a + 96 b = walls.
  const auto kept = static_cast<double>(found->blocks->kept()), walls = static_cast<double>(found->blocks->walls());
  const double of_large = (3 * kept - walls) / 96, of_small = kept / 8 - 8 * of_large;
  // Both stand in one body, far enough apart to be told by the first index.
  const LatticeSet set{.min = {-1, -1, -1}, .max = {8, 4, 4}, .inside = [](Index3 i) {
                         const std::int32_t first = i[0] < 3 ? 0 : 4, edge = i[0] < 3 ? 2 : 4;
                         return i[0] >= first && i[0] < first + edge && i[1] >= 0 && i[1] < edge && i[2] >= 0 &&
                                i[2] < edge;
                       }};
  auto body = lattice_body(found->cell, set, {.mesh = mesh, .run = context.run}, context.sink);
  if (!body) return {};
  place(*body, found->lattice.world_from_cell);
  out.bodies.push_back({part_of(*body, [](Index3 i) { return i[0] < 3; }), of_small});
  out.bodies.push_back({part_of(*body, [](Index3 i) { return i[0] >= 3; }), of_large});
  return out;
}

}  // namespace meso::brep
