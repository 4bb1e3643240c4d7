// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "bends.hpp"
#include "leaf_formulas.hpp"
#include "meso/base/number.hpp"
#include "meso/expr/expression.hpp"
#include "meso/implicit/surfaces.hpp"
#include "meso/sdf_document/words_and_documents.hpp"
#include "region.hpp"

namespace meso::sdf {
namespace {

constexpr double whole = 1e-9;  // steps fit within this

/// Puts the words of what it reads behind those that are there; false after a fault.
class DocumentReader {
 public:
  DocumentReader(const eval::Evaluation& evaluation, WhyNot& why) : evaluation_(evaluation), why_(why) {}

  std::optional<Program> read(const std::string& part);

 private:
  bool part(const Part& part, const Box3& region);
  bool step(const Part& part, const Apply& apply, const Box3& region, bool is_first);
  bool placed_part(const Apply& apply, const Box3& region);
  bool macrostructure(const std::string& id);
  bool csg(const CsgNode& node);
  template <class Transform>
  bool inner(const Transform& transform) {
    if (transform.operands.size() != 1) return no("a transform of several bodies");
    return csg(transform.operands[0]);
  }
  bool pattern(const Pattern& pattern, const Box3& region);
  bool moved_part(const PartBody& body, const Pattern& pattern, const Box3& region);
  bool bent_part(const UnitCell& cell, const Pattern& pattern, const Box3& region);
  bool repeated_part(const UnitCell& cell, const PartBody& body, const Pattern& pattern, const Box3& region);
  bool struts(const UnitCell& cell, const Pattern& pattern, const Box3& region);
  bool surface(const UnitCell& cell, const ImplicitBody& body, const Pattern& pattern, const Box3& region);
  bool formula(const UnitCell& cell, const ImplicitBody& body, const Pattern& pattern, const Box3& region);
  bool leaf(const UnitCell& cell, const std::string& field);
  /// `divisor`: the text that levels of a scaled surface are divided by.
  bool levels(const UnitCell& cell, const ImplicitBody& body, const Pattern& pattern, const std::string& divisor);

  void push(Verb verb, std::initializer_list<double> numbers = {}, std::string text = {}) {
    Instruction made{.verb = verb, .text = std::move(text)};
    std::copy(numbers.begin(), numbers.end(), made.numbers.begin());
    words_.push_back(std::move(made));
  }
  bool no(std::string why) {
    if (why_.why.empty()) why_ = {where_, std::move(why)};
    return false;
  }
  double value(const Expression& expression) {
    DiagnosticSink unheard;
    const auto v = evaluation_.value(expression, {}, "value", unheard);
    if (!v) no("'" + expression.text + "' is no number of the document");
    return v.value_or(1);
  }
  double value(const std::optional<Expression>& expression, double absent) {
    return expression ? value(*expression) : absent;
  }
  std::optional<Box3> box_of(const CellBox& box) {
    const Vec3 corner{value(box.x, 0), value(box.y, 0), value(box.z, 0)};
    const Vec3 size{value(box.dx), value(box.dy), value(box.dz)};
    return why_.why.empty() ? std::optional(Box3{corner, corner + size}) : std::nullopt;
  }
  static bool stands_once(const Pattern& pattern) {
    return pattern.list && pattern.list->places.size() == 1 && pattern.list->places[0].at.text == "0, 0, 0";
  }
  /// Cells of this size side by side over the region.
  bool fills(const Pattern& pattern, const Box3& region, Vec3 size);
  /// The first and one after the last of a range's whole numbers.
  std::pair<double, double> counts(const FillRange& range) {
    const double step = value(range.step);
    return {std::ceil(value(range.from) / step - whole), std::floor(value(range.to) / step + whole)};
  }
  /// A number, or a formula of the words' x, y, z.
  struct Level {
    double number = 0;
    std::string formula{};
  };
  std::optional<Level> level(const UnitCell& cell, const Pattern& pattern, const Expression& expression,
                             const std::string& divisor);
  std::optional<std::string> in_words(const UnitCell& cell, const std::string& text, std::string_view axis_prefix);

  const eval::Evaluation& evaluation_;
  WhyNot& why_;
  std::string where_;
  std::vector<Instruction> words_;
};

template <class T>
const T* find(const Section<T>& all, const std::string& id) {
  const auto found = std::ranges::find(all, id, [](const T& one) { return one.id.text; });
  return found == all.end() ? nullptr : &*found;
}

std::optional<Program> DocumentReader::read(const std::string& id) {
  const Document& document = evaluation_.document();
  where_ = "the document";
  const auto refuse = [&](std::string why) { return no(std::move(why)), std::nullopt; };
  if (document.unit != LengthUnit::millimeter) return refuse("its unit is not the millimetre");
  const BuildItem* built = nullptr;
  for (const BuildItem& item : document.build) {
    if (!id.empty() && item.part.text != id) continue;
    if (built != nullptr) return refuse("it builds several parts");
    built = &item;
  }
  if (built == nullptr) return refuse("it has no build that says where samples are taken");
  where_ = "part '" + built->part.text + "'";
  if (built->placement) return refuse("its item of the build has a placement");
  const auto& mesh = built->mesh;
  if (!mesh || !mesh->samples || !mesh->x || !mesh->y || !mesh->z || !mesh->dx || !mesh->dy || !mesh->dz)
    return refuse("its <mesh> does not state samples and all bounds");
  Program program;
  program.samples.clear();
  for (const auto& item : expr::split_list(mesh->samples->text))
    program.samples.push_back(value(Expression{std::string(item.text)}));
  const Vec3 corner{value(*mesh->x), value(*mesh->y), value(*mesh->z)};
  program.box = Box3{corner, corner + Vec3{value(*mesh->dx), value(*mesh->dy), value(*mesh->dz)}};
  if (!why_.why.empty() || !part(*evaluation_.find_part(built->part.text), *program.box) || !why_.why.empty())
    return std::nullopt;
  program.instructions = std::move(words_);
  return program;
}

bool DocumentReader::part(const Part& part, const Box3& region) {
  if (words_.size() > max_words) return no("more than " + std::to_string(max_words) + " words");
  where_ = "part '" + part.id.text + "'";
  if (part.macrostructure) {
    const Macrostructure& body = *find(evaluation_.document().macrostructures, part.macrostructure->text);
    // All of the region but something: its complement there.
    const auto* tree = std::get_if<CsgBody>(&body.body);
    const auto* space =
        tree != nullptr && tree->operands.size() == 1 ? std::get_if<BoxPrimitive>(&tree->operands[0].value) : nullptr;
    if (space != nullptr && !body.placement && part.steps.size() == 1 &&
        part.steps[0].operation == ApplyOperation::difference) {
      const Vec3 at{value(space->x, 0), value(space->y, 0), value(space->z, 0)};
      const Box3 box{at, at + Vec3{value(space->dx), value(space->dy), value(space->dz)}};
      if (holds(box, region)) {
        if (!step(part, part.steps[0], region, true)) return false;
        push(Verb::complement);
        return true;
      }
    }
    if (!macrostructure(part.macrostructure->text)) return false;
  }
  bool is_first = !part.macrostructure;
  for (const Apply& apply : part.steps) {
    if (!step(part, apply, region, is_first)) return false;
    if (!is_first) {
      const double radius = value(apply.radius, 0);
      if (apply.operation == ApplyOperation::union_ && radius > 0)
        push(Verb::smooth_union, {radius});
      else if (radius > 0)
        return no("a fillet where it is cut");
      else
        push(apply.operation == ApplyOperation::union_         ? Verb::union_of
             : apply.operation == ApplyOperation::intersection ? Verb::intersection
                                                               : Verb::difference);
    }
    is_first = false;
  }
  return true;
}

bool DocumentReader::step(const Part& part, const Apply& apply, const Box3& region, bool is_first) {
  where_ = "part '" + part.id.text + "'";
  if (apply.boundary.value_or(BoundaryRule::clip) != BoundaryRule::clip) return no("a boundary rule");
  if (apply.fragments.value_or(FragmentRule::keep) != FragmentRule::keep) return no("a rule for fragments");
  if (apply.skin) return no("a skin");
  // Without, what touches is joined by growing a little, which words do not.
  if (!is_first && !apply.radius) return no("a step without radius=\"0\"");
  if (apply.pattern) return pattern(*evaluation_.find_pattern(apply.pattern->text), region);
  return placed_part(apply, region);
}

bool DocumentReader::placed_part(const Apply& apply, const Box3& region) {
  if (!apply.placement) return part(*evaluation_.find_part(apply.part->text), region);
  const std::string& matrix = apply.placement->matrix.text;
  const std::string mirror = prefix_of_matrix(matrix, mirror_matrix), scale = prefix_of_matrix(matrix, scale_matrix);
  const std::string& prefix = mirror.empty() ? scale : mirror;
  if (prefix.empty()) return no("a placement that is not written as a mirror or a scale");
  const double x = value(Expression{prefix + "X"}), y = value(Expression{prefix + "Y"}),
               z = value(Expression{prefix + "Z"});
  Instruction move{.verb = mirror.empty() ? Verb::scale : Verb::mirror};
  move.numbers = {x, y, z};
  if (!part(*evaluation_.find_part(apply.part->text), before(move, region))) return false;
  words_.push_back(std::move(move));
  return true;
}

bool DocumentReader::macrostructure(const std::string& id) {
  where_ = "macrostructure '" + id + "'";
  const Macrostructure& body = *find(evaluation_.document().macrostructures, id);
  if (body.placement) return no("a placement");
  if (const auto* tree = std::get_if<CsgBody>(&body.body))
    return tree->operands.size() == 1 ? csg(tree->operands[0]) : no("several bodies in one");
  DiagnosticSink unheard;
  const auto shape = evaluation_.shape(body, unheard);
  const auto* import = shape ? std::get_if<eval::ImportShape>(&shape->value) : nullptr;
  if (import == nullptr) return no("its body is neither csg nor an import");
  if (import->scale != 1 || !(import->transform == Affine{})) return no("an import that is scaled or transformed");
  const std::string extension = import->file.name().extension().string();
  if (extension == ".step" || extension == ".stp") return no("words read meshes, not STEP");
  push(Verb::file, {}, import->file.name().string());
  return true;
}

bool DocumentReader::csg(const CsgNode& node) {
  const auto moved = [&](Vec3 to) {
    if (!(to == Vec3{})) push(Verb::move, {to.x, to.y, to.z});
    return true;
  };
  if (const auto* s = std::get_if<SpherePrimitive>(&node.value)) {
    const double r = value(s->radius);
    push(Verb::ball);
    if (r != 1) push(Verb::scale, {r, r, r});
    return moved({value(s->x, 0), value(s->y, 0), value(s->z, 0)});
  }
  if (const auto* s = std::get_if<BoxPrimitive>(&node.value)) {
    const Vec3 half = 0.5 * Vec3{value(s->dx), value(s->dy), value(s->dz)};
    push(Verb::box);
    if (!(half == Vec3{1, 1, 1})) push(Verb::scale, {half.x, half.y, half.z});
    return moved(Vec3{value(s->x, 0), value(s->y, 0), value(s->z, 0)} + half);
  }
  const auto upright = [&](const auto& s, double bottom, double top) {
    const Vec3 from{value(s.x1), value(s.y1), value(s.z1)}, to{value(s.x2), value(s.y2), value(s.z2)};
    if (from.x != to.x || from.y != to.y || !(to.z > from.z)) return no("a cone that does not point along z");
    push(Verb::cone, {bottom, top, to.z - from.z});
    return moved(from);
  };
  if (const auto* s = std::get_if<ConePrimitive>(&node.value)) return upright(*s, value(s->radius1), value(s->radius2));
  if (const auto* s = std::get_if<CylinderPrimitive>(&node.value))
    return upright(*s, value(s->radius), value(s->radius));
  if (const auto* s = std::get_if<TorusPrimitive>(&node.value)) {
    if (s->ax || s->ay || s->az) return no("a torus with an axis of its own");
    push(Verb::torus, {value(s->major_radius), value(s->minor_radius)});
    return moved({value(s->x, 0), value(s->y, 0), value(s->z, 0)});
  }
  if (const auto* t = std::get_if<CsgTranslate>(&node.value)) {
    if (!inner(*t)) return false;
    push(Verb::move, {value(t->x, 0), value(t->y, 0), value(t->z, 0)});
    return true;
  }
  if (const auto* t = std::get_if<CsgRotate>(&node.value)) {
    if (!inner(*t)) return false;
    push(Verb::rotate, {value(t->x), value(t->y), value(t->z), value(t->angle)});
    return true;
  }
  if (const auto* t = std::get_if<CsgScale>(&node.value)) {
    if (!inner(*t)) return false;
    const double k = value(t->factor, 1);
    push(Verb::scale, {t->factor ? k : value(t->x, 1), t->factor ? k : value(t->y, 1), t->factor ? k : value(t->z, 1)});
    return true;
  }
  if (const auto* t = std::get_if<CsgTransform>(&node.value)) {
    const std::string mirror = prefix_of_matrix(t->matrix.text, mirror_matrix);
    if (mirror.empty()) return no("a matrix that is not written as a mirror");
    if (!inner(*t)) return false;
    push(Verb::mirror,
         {value(Expression{mirror + "X"}), value(Expression{mirror + "Y"}), value(Expression{mirror + "Z"})});
    return true;
  }
  return no("a body that no word makes, or several joined in one macrostructure");
}

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
  return body->surface && body->blends.empty() ? surface(cell, *body, pattern, region)
                                               : formula(cell, *body, pattern, region);
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
  const auto bend = read_bend(system, *cell.box, pattern, [&](const Expression& e) { return value(e); });
  if (!why_.why.empty()) return false;
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

bool DocumentReader::struts(const UnitCell& cell, const Pattern& pattern, const Box3& region) {
  const Expression *edge = nullptr, *radius = nullptr;
  for (const CellParameter& parameter : cell.parameters)
    (parameter.name.text == "cellEdge"      ? edge
     : parameter.name.text == "strutRadius" ? radius
                                            : edge) = &parameter.value;
  if (cell.parameters.size() != 2 || edge == nullptr || radius == nullptr || !pattern.instructions.empty())
    return no("a cell of the library with other parameters than cellEdge and strutRadius");
  const double k = value(*edge);
  if (!fills(pattern, region, {k, k, k})) return false;
  const std::string product = "*" + edge->text;
  const double r = radius->text.ends_with(product)
                       ? value(Expression{radius->text.substr(0, radius->text.size() - product.size())})
                       : value(*radius) / k;
  if (!(r > 0 && r < 0.25)) return no("struts that are no quarter of an edge thick");
  push(Verb::strut, {r}, cell.library->text);
  if (k != 1) push(Verb::scale, {k, k, k});
  return true;
}

std::optional<std::string> DocumentReader::in_words(const UnitCell& cell, const std::string& text,
                                                    std::string_view axis_prefix) {
  bool known = true;
  const auto parsed = expr::parse_expression(text, LengthUnit::millimeter);
  if (!parsed.expression) return std::nullopt;
  std::map<std::string, std::string> meaning;
  for (const expr::Name& name : parsed.expression->names()) {
    const bool is_axis = name.text.size() == axis_prefix.size() + 1 && name.text.starts_with(axis_prefix) &&
                         name.text.back() >= 'x' && name.text.back() <= 'z';
    if (is_axis) {
      meaning[name.text] = name.text.substr(axis_prefix.size());
      continue;
    }
    const auto own = std::ranges::find(cell.parameters, name.text, [](const CellParameter& p) { return p.name.text; });
    DiagnosticSink unheard;
    const auto number = own != cell.parameters.end() ? evaluation_.value(own->value, {}, "value", unheard)
                                                     : evaluation_.value(Expression{name.text}, {}, "value", unheard);
    if (number)
      meaning[name.text] = (*number < 0 ? "(" : "") + format_number(*number) + (*number < 0 ? ")" : "");
    else
      known = false;
  }
  if (!known) return std::nullopt;
  return renamed(text, [&](const std::string& name) {
    const auto found = meaning.find(name);
    return found == meaning.end() ? std::nullopt : std::optional(found->second);
  });
}

std::optional<DocumentReader::Level> DocumentReader::level(const UnitCell& cell, const Pattern& pattern,
                                                           const Expression& expression, const std::string& divisor) {
  std::string text = expression.text, prefix;
  if (!divisor.empty() && text.ends_with(divisor)) text.resize(text.size() - divisor.size());
  for (const meso::Instruction& instruction : pattern.instructions)
    if (const auto* set = std::get_if<SetInstruction>(&instruction); set != nullptr && set->parameter.text == text) {
      text = set->value.text;
      prefix = "global.";
      break;
    }
  const auto words = in_words(cell, text, prefix);
  if (!words) return no("'" + text + "' has names that words do not know"), std::nullopt;
  const auto parsed = expr::parse_expression(*words, LengthUnit::millimeter);
  if (!parsed.expression->is_constant()) return Level{.formula = *words};
  const auto number = expr::evaluate(*parsed.expression, {});
  return number ? std::optional(Level{.number = number.value}) : std::nullopt;
}

bool DocumentReader::levels(const UnitCell& cell, const ImplicitBody& body, const Pattern& pattern,
                            const std::string& divisor) {
  const auto one = [&](Verb verb, const Expression& expression) {
    const auto read = level(cell, pattern, expression, divisor);
    if (read) push(verb, {read->number}, read->formula);
    return read.has_value();
  };
  if (body.density) {
    if (body.kind || body.isovalue) return no("a density of a shell or an exoskeleton");
    return one(Verb::density, *body.density);
  }
  const ImplicitKind kind = body.kind.value_or(ImplicitKind::endoskeleton);
  if (body.isovalue && kind != ImplicitKind::eccentric_shell && !one(Verb::offset, *body.isovalue)) return false;
  switch (kind) {
    case ImplicitKind::endoskeleton:
      return true;
    case ImplicitKind::exoskeleton:
      push(Verb::complement);
      return true;
    case ImplicitKind::shell:
      return body.thickness ? one(Verb::shell, *body.thickness) : no("a shell without thickness");
    case ImplicitKind::eccentric_shell:
      break;
  }
  const auto lower = level(cell, pattern, *body.lower, divisor), upper = level(cell, pattern, *body.upper, divisor);
  if (!lower || !upper) return false;
  const bool is_graded = !lower->formula.empty() || !upper->formula.empty();
  const auto text = [](const Level& l) { return l.formula.empty() ? format_number(l.number) : l.formula; };
  push(Verb::eccentric_shell, {lower->number, upper->number}, is_graded ? text(*lower) + "," + text(*upper) : "");
  return true;
}

bool DocumentReader::surface(const UnitCell& cell, const ImplicitBody& body, const Pattern& pattern,
                             const Box3& region) {
  const implicit::Surface* known = implicit::find_surface(*body.surface);
  if (known == nullptr) return no("an unknown surface");
  const auto box = box_of(*cell.box);
  if (!box) return false;
  const Vec3 size{value(cell.box->dx), value(cell.box->dy), value(cell.box->dz)};
  if (!(box->min == Vec3{})) return no("a cell whose corner is not the origin");
  if (!fills(pattern, region, size)) return false;
  Vec3 factor = size;
  if (known->name == "q-star-hex") factor.y = value(Expression{cell.box->dx.text});
  if (known->name == "q-star-hex" && size.y != std::numbers::sqrt3 * factor.y)
    return no("a period that is stretched; words scale the surface's own");
  push(Verb::surface, {}, std::string(known->name));
  const bool is_scaled = !(factor == Vec3{1, 1, 1});
  // Levels of the scaled surface are written as lengths over its edge.
  const std::string divisor = is_scaled ? "/" + cell.box->dx.text : "";
  bool divided = body.density.has_value(), plain = false;
  for (const auto& level : {body.isovalue, body.lower, body.upper, body.thickness})
    if (level) (is_scaled && level->text.ends_with(divisor) ? divided : plain) = true;
  if (is_scaled && divided && plain) return no("levels before and after the scale");
  if (is_scaled && !plain) push(Verb::scale, {factor.x, factor.y, factor.z});
  if (!levels(cell, body, pattern, divisor)) return false;
  if (is_scaled && plain) push(Verb::scale, {factor.x, factor.y, factor.z});
  return true;
}

bool DocumentReader::leaf(const UnitCell& cell, const std::string& field) {
  for (const implicit::Surface& surface : implicit::surfaces())
    if (surface.expression == field) return push(Verb::surface, {}, std::string(surface.name)), true;
  for (const LeafFormula& known : leaf_formulas()) {
    if (known.field != field) continue;
    Instruction made{.verb = known.verb};
    for (std::size_t i = 0; i < known.parameters.size(); ++i) {
      const auto own = std::ranges::find(cell.parameters, known.parameters[i],
                                         [](const CellParameter& p) { return std::string_view(p.name.text); });
      if (own == cell.parameters.end()) return no("a formula without its sizes");
      made.numbers[i] = value(own->value);
    }
    words_.push_back(std::move(made));
    return true;
  }
  const auto words = in_words(cell, field, "");
  if (!words) return no("'" + field + "' has names that words do not know");
  push(Verb::expression, {}, *words);
  return true;
}

bool DocumentReader::formula(const UnitCell& cell, const ImplicitBody& body, const Pattern& pattern,
                             const Box3& region) {
  if (!stands_once(pattern) || !pattern.instructions.empty()) return no("a formula's cell that does not stand once");
  const auto box = box_of(*cell.box);
  if (!box) return false;
  if (!holds(*box, region)) return no("a cell that does not hold the bounds; words cut nothing");
  if (!body.field) return no("a blend of surfaces by name, which weighs them by their size");
  if (body.density) return no("the density of a formula");
  const auto unscaled = unscaled_field(body.field->text);
  if (!leaf(cell, unscaled ? *unscaled : body.field->text)) return false;
  for (const ImplicitBlend& blend : body.blends) {
    if (!blend.field) return no("a blend of surfaces by name, which weighs them by their size");
    const auto weight = in_words(cell, unclamped(blend.weight.text), "");
    if (!weight) return no("a weight with names that words do not know");
    if (!leaf(cell, blend.field->text)) return false;
    push(Verb::blend, {}, *weight);
  }
  if (unscaled) {
    const auto own = std::ranges::find(cell.parameters, "scale",
                                       [](const CellParameter& p) { return std::string_view(p.name.text); });
    if (own == cell.parameters.end()) return no("a formula without its scale");
    const double k = value(own->value);
    push(Verb::scale, {k, k, k});
  }
  return levels(cell, body, pattern, "");
}

}  // namespace

std::optional<Program> program_of(const eval::Evaluation& evaluation, const std::string& part, WhyNot& why) {
  why = {};
  return DocumentReader(evaluation, why).read(part);
}

}  // namespace meso::sdf
