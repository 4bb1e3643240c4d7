// SPDX-License-Identifier: Apache-2.0
#include "document_reader.hpp"
#include "leaf_formulas.hpp"
#include "meso/expr/expression.hpp"
#include "region.hpp"

namespace meso::sdf {

std::optional<Program> DocumentReader::read(const std::string& id) {
  const Document& document = evaluation_.document();
  where_ = "the document";
  if (document.unit != LengthUnit::millimeter && !no("its unit is not the millimetre") && !looks_on())
    return std::nullopt;
  const BuildItem* built = nullptr;
  for (const BuildItem& item : document.build) {
    if (!id.empty() && item.part.text != id) continue;
    if (built != nullptr) return no("it builds several parts"), std::nullopt;
    built = &item;
  }
  if (built == nullptr) return no("it has no build that says where samples are taken"), std::nullopt;
  where_ = "part '" + built->part.text + "'";
  if (built->placement) no("its item of the build has a placement");
  const auto& mesh = built->mesh;
  if (!mesh || !mesh->samples || !mesh->x || !mesh->y || !mesh->z || !mesh->dx || !mesh->dy || !mesh->dz)
    return no("its <mesh> does not state samples and all bounds"), std::nullopt;
  if (!faults_.empty() && !looks_on()) return std::nullopt;
  Program program;
  program.samples.clear();
  for (const auto& item : expr::split_list(mesh->samples->text))
    program.samples.push_back(value(Expression{std::string(item.text)}));
  const Vec3 corner{value(*mesh->x), value(*mesh->y), value(*mesh->z)};
  program.box = Box3{corner, corner + Vec3{value(*mesh->dx), value(*mesh->dy), value(*mesh->dz)}};
  if (!faults_.empty() && !looks_on()) return std::nullopt;
  if (!part(*evaluation_.find_part(built->part.text), *program.box) || !faults_.empty()) return std::nullopt;
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
    if (!macrostructure(part.macrostructure->text) && !looks_on()) return false;
  }
  bool is_first = !part.macrostructure;
  for (const Apply& apply : part.steps) {
    if (!step(part, apply, region, is_first) && !looks_on()) return false;
    if (!is_first) {
      const double radius = value(apply.radius, 0);
      if (apply.operation == ApplyOperation::union_ && radius > 0)
        push(Verb::smooth_union, {radius});
      else if (radius > 0 && !no("a fillet where it is cut") && !looks_on())
        return false;
      else
        push(apply.operation == ApplyOperation::union_         ? Verb::union_of
             : apply.operation == ApplyOperation::intersection ? Verb::intersection
                                                               : Verb::difference);
    }
    is_first = false;
  }
  return faults_.empty();
}

bool DocumentReader::step(const Part& part, const Apply& apply, const Box3& region, bool is_first) {
  where_ = "part '" + part.id.text + "'";
  bool ok = true;
  if (apply.boundary.value_or(BoundaryRule::clip) != BoundaryRule::clip) ok = no("a boundary rule");
  if (apply.fragments.value_or(FragmentRule::keep) != FragmentRule::keep) ok = no("a rule for fragments");
  if (apply.skin) ok = no("a skin");
  // Without, what touches is joined by growing a little, which words do not.
  if (!is_first && !apply.radius) ok = no("a step without radius=\"0\"");
  if (!ok && !looks_on()) return false;
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

std::optional<Program> program_of(const eval::Evaluation& evaluation, const std::string& part, WhyNot& why) {
  DocumentReader reader(evaluation, DocumentReader::Faults::first);
  auto program = reader.read(part);
  why = reader.faults().empty() ? WhyNot{} : reader.faults().front();
  return program;
}

std::vector<WhyNot> all_that_is_no_word(const eval::Evaluation& evaluation, const std::string& part) {
  DocumentReader reader(evaluation, DocumentReader::Faults::all);
  (void)reader.read(part);
  return reader.faults();
}

}  // namespace meso::sdf
