// SPDX-License-Identifier: Apache-2.0
#include <iterator>

#include "bends.hpp"
#include "document_reader.hpp"
#include "leaf_formulas.hpp"
#include "region.hpp"

namespace meso::sdf {

bool DocumentReader::fills(const Pattern& pattern, const Box3& region, Vec3 size) {
  if (!pattern.fill || pattern.fill->ranges.size() != 3) return no("cells that do not stand in a fill");
  for (const FillRange& range : pattern.fill->ranges) {
    const auto axis = static_cast<std::size_t>(range.axis.text[0] - 'x');
    if (range.axis.text.size() != 1 || axis > 2) return no("cells along axes of a system");
    const double step = value(range.step);
    if (step != size[axis]) return no("cells that do not touch");
    const auto [first, last] = counts(range);
    if (!(first * step <= region.min[axis] && last * step >= region.max[axis]))
      return no("cells that do not fill the bounds; words repeat without end");
  }
  return true;
}

bool DocumentReader::pattern(const Pattern& pattern, const Box3& region) {
  where_ = "pattern '" + pattern.id.text + "'";
  const UnitCell& cell = *find(evaluation_.document().unit_cells, pattern.unit_cell.text);
  if (pattern.mapping.value_or(CellMapping::rigid) == CellMapping::conformal) return bent_part(cell, pattern, region);
  if (pattern.coordinate_system) return no("a coordinate system");
  if (cell.library) return struts(cell, pattern, region);
  if (const auto* body = std::get_if<PartBody>(&cell.body))
    return pattern.fill ? repeated_part(cell, *body, pattern, region) : moved_part(*body, pattern, region);
  const auto* body = std::get_if<ImplicitBody>(&cell.body);
  if (body == nullptr || !cell.box) return no("cells of a kind that no word makes");
  if (body->mirror || body->wall) return no("a mirror or a wall of a length");
  if (!body->surface) return formula(cell, *body, pattern, region);
  return body->blends.empty() ? surface(cell, *body, pattern, region) : blended_surfaces(cell, *body, pattern, region);
}

// Each instruction works in the frame that the earlier ones left: the last one is the first word.
bool DocumentReader::moved_part(const PartBody& body, const Pattern& pattern, const Box3& region) {
  if (!stands_once(pattern)) return no("a part that does not stand once, at the origin");
  std::vector<Instruction> moves;
  Box3 where = region;
  for (const meso::Instruction& instruction : pattern.instructions) {
    Instruction move;
    if (const auto* t = std::get_if<TranslateInstruction>(&instruction)) {
      move.verb = Verb::move;
      move.numbers = {value(t->x, 0), value(t->y, 0), value(t->z, 0)};
    } else if (const auto* r = std::get_if<RotateInstruction>(&instruction)) {
      move.verb = Verb::rotate;
      move.numbers = {value(r->x), value(r->y), value(r->z), value(r->angle)};
    } else if (const auto* s = std::get_if<ScaleInstruction>(&instruction)) {
      const double k = value(s->factor, 1);
      move.verb = Verb::scale;
      move.numbers = {s->factor ? k : value(s->x, 1), s->factor ? k : value(s->y, 1), s->factor ? k : value(s->z, 1)};
    } else if (const auto* o = std::get_if<OrientInstruction>(&instruction);
               o != nullptr && o->axis == CellAxis::z && !o->frame && !o->zero && !o->signless && !o->second) {
      move.verb = Verb::orient;
      move.numbers = {value(o->x), value(o->y), value(o->z)};
    } else {
      return no("an instruction that no word says");
    }
    where = before(move, where);
    moves.push_back(std::move(move));
  }
  if (!part(*evaluation_.find_part(body.part.text), where)) return false;
  words_.insert(words_.end(), std::make_move_iterator(moves.rbegin()), std::make_move_iterator(moves.rend()));
  return true;
}

// The part's box is what one turn, or one turn from pole to pole, shows.
bool DocumentReader::bent_part(const UnitCell& cell, const Pattern& pattern, const Box3& region) {
  const auto* body = std::get_if<PartBody>(&cell.body);
  if (body == nullptr || !cell.box || !cell.clip_to_box.value_or(false) || !pattern.coordinate_system ||
      !pattern.instructions.empty())
    return no("bent cells that are not one part, cut to its box");
  const auto& system = *find(evaluation_.document().coordinate_systems, pattern.coordinate_system->text);
  const std::size_t before = faults_.size();
  const auto bend = read_bend(system, *cell.box, pattern, [&](const Expression& e) { return value(e); });
  if (faults_.size() > before) return false;
  if (!bend) return no("a cell that is not bent once round the z axis, or once round from pole to pole");
  if (!shows_all(*bend, region)) return no("a bent cell that does not reach to the bounds; words cut nothing");
  const Part& solid = *evaluation_.find_part(body->part.text);
  const Apply* only = !solid.macrostructure && solid.steps.size() == 1 ? solid.steps.data() : nullptr;
  const std::string prefix = !bend->is_spherical && only != nullptr && only->part && only->placement
                                 ? prefix_of_matrix(only->placement->matrix.text, shear_matrix)
                                 : "";
  if (!prefix.empty() && value(Expression{prefix + "Turn"}) == bend->turn) {
    const double rise = value(Expression{prefix + "Rise"});
    if (!part(*evaluation_.find_part(only->part->text), before_shear(bend->solid, rise))) return false;
    push(Verb::helix, {bend->turn, rise});
    return true;
  }
  if (!part(solid, bend->solid)) return false;
  if (bend->is_spherical)
    push(Verb::spherical, {bend->turn, bend->poles});
  else
    push(Verb::cylindrical, {bend->turn});
  return true;
}

bool DocumentReader::repeated_part(const UnitCell& cell, const PartBody& body, const Pattern& pattern,
                                   const Box3& region) {
  if (!cell.box || !cell.clip_to_box.value_or(false) || !pattern.instructions.empty())
    return no("a part in cells that are not cut to their boxes");
  const auto box = box_of(*cell.box);
  if (!box) return false;
  const Vec3 size{value(cell.box->dx), value(cell.box->dy), value(cell.box->dz)};
  if (!(box->min == -0.5 * size)) return no("a part in cells whose middle is not the origin");
  // The cell that holds the origin begins half a step before it, in words.
  const Box3 shifted{region.min + 0.5 * size, region.max + 0.5 * size};
  if (!fills(pattern, shifted, size) || !part(*evaluation_.find_part(body.part.text), {-0.5 * size, 0.5 * size}))
    return false;
  Vec3 steps = size;  // none where one cell holds the region
  for (const FillRange& range : pattern.fill->ranges)
    if (const auto [first, last] = counts(range); last - first == 1)
      steps[static_cast<std::size_t>(range.axis.text[0] - 'x')] = 0;
  if (!(steps == Vec3{})) push(Verb::repeat, {steps.x, steps.y, steps.z});
  return true;
}

}  // namespace meso::sdf
