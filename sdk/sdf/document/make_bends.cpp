// SPDX-License-Identifier: Apache-2.0
#include "bends.hpp"
#include "document_maker.hpp"

namespace meso::sdf {

/// The solid as a part that stands sheared: z grows by `rise` while y grows by a turn.
std::string DocumentMaker::sheared(Index node, const std::string& part) {
  const std::string id = name(node) + "Sheared";
  number(name(node) + "Rise", word(node).numbers[1]);
  Apply step{.part = Ref<Part>{part}};
  step.placement = Placement{.matrix = {shear_matrix(name(node))}};
  document_.parts.items.push_back({.id = {id}, .steps = {std::move(step)}});
  return id;
}

std::optional<Operand> DocumentMaker::bent(Index node, const Box3& region) {
  const Instruction& at = word(node);
  const std::string id = name(node);
  const bool is_helix = at.verb == Verb::helix;
  const Bend bend = bend_of(at, region);
  const auto inner = operand(below(node), is_helix ? before_shear(bend.solid, at.numbers[1]) : bend.solid);
  if (!inner) return std::nullopt;
  number(id + "Turn", bend.turn);
  if (bend.is_spherical) number(id + "Poles", bend.poles);
  std::string part = *part_of(*inner, inner->id + "Part");
  if (is_helix) part = sheared(node, part);
  UnitCell cell{.id = {id}, .clip_to_box = true, .box = CellBox{}, .body = PartBody{.part = {part}}};
  CoordinateSystem system{.id = {id + "System"}};
  Pattern pattern;
  write_bend(bend, id, system, *cell.box, pattern);
  document_.coordinate_systems.items.push_back(std::move(system));
  return add_pattern(std::move(cell), std::move(pattern), id);
}

}  // namespace meso::sdf
