// SPDX-License-Identifier: Apache-2.0
// What the cells of a pattern are where they have a part: smaller cells, or beams.
#include <algorithm>

#include "box_lattice.hpp"
#include "part_fold.hpp"
#include "realise_beam_graph.hpp"
#include "solid_primitive.hpp"

namespace meso::brep {
namespace {

constexpr std::size_t most_struts = 100'000;  ///< of a part, to be placed as one cell

/// False: they are too many, or would be stretched and no beams.
bool append(eval::BeamsShape& to, const eval::BeamsShape& beams, const Affine& map) {
  if (!is_similarity(map) || to.struts.size() + beams.struts.size() > most_struts) return false;
  const double scale = std::cbrt(std::fabs(determinant(map.linear)));
  const std::size_t first = to.nodes.size();
  for (const eval::StrutNode& node : beams.nodes) to.nodes.push_back({map * node.position, scale * node.ball_radius});
  for (eval::Strut strut : beams.struts) {
    strut.from += first;
    strut.to += first;
    strut.radius_from *= scale;
    strut.radius_to *= scale;
    to.struts.push_back(strut);
  }
  return true;
}

bool is_plain_union(const Apply& apply) {
  return apply.operation == ApplyOperation::union_ && !apply.radius && !apply.skin;
}

}  // namespace

const Part* PartFold::part_in_cells(const Pattern& pattern) const {
  for (const UnitCell& cell : evaluation_.document().unit_cells)
    if (cell.id.text == pattern.unit_cell.text)
      if (const auto* body = std::get_if<PartBody>(&cell.body)) return evaluation_.find_part(body->part.text);
  return nullptr;
}

/// Cells inside of cells count once, however often the part stands: so they are placed.
CellCounts PartFold::counts_inside(const Part& part) {
  if (const auto known = operands_.find(&part); known != operands_.end())
    return without_fragments(known->second.counts);
  if (const auto known = beams_.find(&part); known != beams_.end() && known->second) return known->second->counts;
  const eval::CellStream* cells = only_cells_of(part);
  if (cells == nullptr) return {};
  const CellCounts own{.placed = cells->size(), .kept = cells->size()};
  const Part* inner = part_in_cells(cells->pattern());
  return inner != nullptr ? sum_of(own, counts_inside(*inner)) : own;
}

const eval::CellStream* PartFold::only_cells_of(const Part& part) {
  const auto [known, fresh] = only_cells_.try_emplace(&part);
  if (fresh && !part.macrostructure && part.steps.size() == 1) {
    const Apply& apply = part.steps.front();
    const Pattern* pattern = apply.pattern ? evaluation_.find_pattern(apply.pattern->text) : nullptr;
    if (pattern != nullptr && is_plain_union(apply)) known->second = evaluation_.cells(*pattern, context_.sink);
  }
  return known->second ? &*known->second : nullptr;
}

bool PartFold::graph_comes_first(const eval::CellStream& cells) {
  const eval::CellStream* inner = &cells;
  const eval::CellStream* next = inner;
  while (next != nullptr) {
    inner = next;
    const Part* part = part_in_cells(inner->pattern());
    next = part != nullptr ? only_cells_of(*part) : nullptr;
  }
  if (has_touching_circles(*inner)) return true;
  if (part_in_cells(cells.pattern()) == nullptr) return false;
  // Large cells of many beams: their booleans take long, unless smaller boxes stand side by side in them.
  const auto lattice = box_lattice(cells, true, false, context_);
  return !lattice || !lattice->is_refined();
}

const eval::BeamsShape* PartFold::beams_in(const eval::CellStream& cells) {
  const Part* part = part_in_cells(cells.pattern());
  const bool is_cut = cells.unit_cell().clip_to_box.value_or(false);
  return part != nullptr && !is_cut ? beams_of(*part) : nullptr;
}

const eval::BeamsShape* PartFold::beams_of(const Part& part) {
  const auto [known, fresh] = beams_.try_emplace(&part);
  if (fresh && !part.macrostructure) {
    Beams all;
    if (std::ranges::all_of(part.steps, [&](const Apply& apply) { return add_beams(all, apply); }))
      known->second = std::move(all);
  }
  return known->second ? &known->second->shape : nullptr;
}

bool PartFold::add_beams(Beams& all, const Apply& apply) {
  if (!is_plain_union(apply)) return false;
  if (apply.pattern) {
    const auto cells = evaluation_.cells(*evaluation_.find_pattern(apply.pattern->text), context_.sink);
    return cells && add_beams(all, *cells);
  }
  const Part& operand = *evaluation_.find_part(apply.part->text);
  const auto placement = evaluation_.placement(apply.placement, context_.sink);
  const eval::BeamsShape* beams = placement ? beams_of(operand) : nullptr;
  if (beams == nullptr || !append(all.shape, *beams, *placement)) return false;
  all.counts = sum_of(all.counts, counts_inside(operand));
  return true;
}

bool PartFold::add_beams(Beams& all, const eval::CellStream& cells) {
  const eval::BeamsShape* inner = beams_in(cells);
  const bool is_cut = cells.unit_cell().clip_to_box.value_or(false);
  if (is_cut || (inner == nullptr && !std::holds_alternative<BeamsBody>(cells.unit_cell().body))) return false;
  if (inner != nullptr) all.counts = sum_of(all.counts, counts_inside(*part_in_cells(cells.pattern())));
  all.counts.placed += cells.size();
  bool is_whole = true;
  const auto take = [&](const eval::PlacedCell& cell) {
    const auto shape = inner == nullptr ? cells.shape(cell, context_.sink) : std::nullopt;
    const auto* beams = shape ? std::get_if<eval::BeamsShape>(&shape->value) : inner;
    is_whole = beams != nullptr &&
               append(all.shape, *beams, cell.mapping == CellMapping::conformal ? Affine{} : cell.world_from_cell);
    ++all.counts.kept;
    return is_whole;
  };
  return cells.visit(0, cells.size(), take, context_.sink) && is_whole;
}

}  // namespace meso::brep
