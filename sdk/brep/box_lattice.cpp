// SPDX-License-Identifier: Apache-2.0
#include "box_lattice.hpp"

#include "solid_primitive.hpp"

namespace meso::brep {
namespace {

constexpr std::int64_t most_boxes = 1'000'000;  ///< along an axis

constexpr double least_step = 0.3;  ///< of a box's edge: where beams stand closer, too many share a place

bool is_rigid(const Affine& map) { return is_similarity(map) && std::fabs(determinant(map.linear) - 1) < 1e-12; }

/// The box axis that `step` runs along, up it; -1 if there is none.
int axis_of(Vec3 step) {
  for (std::size_t a = 0; a < 3; ++a) {
    Vec3 along;
    along[a] = step[a];
    if (step[a] > 0 && norm(step - along) <= 1e-9 * step[a]) return static_cast<int>(a);
  }
  return -1;
}

bool is_as_long(double step, double edge) { return std::fabs(step - edge) <= 1e-9 * edge; }

/// The boxes of the pattern's own cells.
std::optional<BoxLattice> own_boxes(const eval::CellStream& cells, bool may_vary, DiagnosticSink& sink) {
  auto steps = cells.shape_varies() ? std::nullopt : cells.lattice();
  const bool varies = !steps;
  if (varies && may_vary && std::holds_alternative<BeamsBody>(cells.unit_cell().body))
    steps = cells.lattice_of_places();
  if (!steps || !is_rigid(steps->world_from_first)) return {};
  auto first = first_cell(cells, sink);
  if (!first) return {};
  BoxLattice out{.box = first->box,
                 .world_from_cell = steps->world_from_first,
                 .shape = std::move(first->shape),
                 .cut = cells.unit_cell().clip_to_box.value_or(false),
                 .varies = varies};
  // Beams that stand closer than their boxes, or farther apart, reach out of boxes as long as the steps.
  const bool may_fit = !varies && !out.cut && std::holds_alternative<BeamsBody>(cells.unit_cell().body);
  const Mat3 columns = transposed(steps->world_from_first.linear) * steps->lattice;
  std::array<bool, 3> used{};
  for (std::size_t loop = 0; loop < 3; ++loop) {
    const Vec3 step = columns.column(loop);
    if (steps->count[loop] == 1) continue;
    const int found = axis_of(step);
    if (found < 0 || steps->count[loop] > most_boxes) return {};
    const auto axis = static_cast<std::size_t>(found);
    if (used[axis]) return {};
    used[axis] = true;
    out.count[axis] = static_cast<std::int32_t>(steps->count[loop]);
    if (is_as_long(step[axis], out.box.size[axis])) continue;
    if (!may_fit || step[axis] < least_step * out.box.size[axis]) return {};
    out.box.size[axis] = step[axis];
    out.is_fitted = true;
  }
  return out;
}

bool is_unturned(const Affine& map) {
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c)
      if (std::fabs(map.linear(r, c) - (r == c ? 1 : 0)) > 1e-14) return false;
  return true;
}

/// The smaller boxes that each box of `outer` is filled with.
std::optional<BoxLattice> smaller_boxes(const BoxLattice& outer, const SolidContext& context) {
  const auto* of_part = std::get_if<eval::PartShape>(&outer.shape.value);
  const eval::CellStream* cells =
      of_part != nullptr && context.parts != nullptr ? context.parts->only_cells_of(*of_part->part) : nullptr;
  auto inner = cells != nullptr ? own_boxes(*cells, false, context.sink) : std::nullopt;
  if (!inner || inner->is_fitted || !is_unturned(inner->world_from_cell)) return {};
  inner->is_cut_by_cells = outer.is_cut_by_cells || (outer.cut && !inner->cut);
  inner->cut = inner->cut || outer.cut;
  const Vec3 low = inner->world_from_cell.translation + inner->box.corner - outer.box.corner;
  std::uint64_t boxes = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    const double size = outer.box.size[a];
    const bool fills =
        std::fabs(low[a]) <= 1e-9 * size && std::fabs(inner->count[a] * inner->box.size[a] - size) <= 1e-12 * size;
    if (!fills && (outer.count[a] > 1 || outer.cut)) return {};
    const std::int64_t count = std::int64_t{outer.count[a]} * inner->count[a];
    if (count > most_boxes) return {};
    boxes *= static_cast<std::uint64_t>(count);
    inner->block[a] = outer.block[a] * inner->count[a];
    inner->count[a] = static_cast<std::int32_t>(count);
  }
  if (boxes > context.run.max_cells) return {};
  inner->world_from_cell = outer.world_from_cell * inner->world_from_cell;
  return inner;
}

}  // namespace

std::optional<BoxLattice> box_lattice(const eval::CellStream& cells, bool may_refine, bool may_vary,
                                      const SolidContext& context) {
  auto out = own_boxes(cells, may_vary, context.sink);
  while (out && may_refine) {
    auto smaller = smaller_boxes(*out, context);
    if (!smaller) break;
    out = std::move(smaller);
  }
  return out;
}

std::optional<FirstCell> first_cell(const eval::CellStream& cells, DiagnosticSink& sink) {
  std::optional<FirstCell> out;
  const auto take = [&](const eval::PlacedCell& cell) {
    const auto box = cells.cell_box(cell, sink);
    if (!box) return false;
    if (auto shape = cells.shape(cell, sink)) out = FirstCell{*box, std::move(*shape)};
    return false;
  };
  (void)cells.visit(0, 1, take, sink);
  return out;
}

}  // namespace meso::brep
