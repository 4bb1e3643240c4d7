// SPDX-License-Identifier: Apache-2.0
#include <map>
#include <numbers>

#include "document_reader.hpp"
#include "leaf_formulas.hpp"
#include "meso/base/number.hpp"
#include "meso/expr/expression.hpp"
#include "meso/implicit/surfaces.hpp"
#include "region.hpp"

namespace meso::sdf {

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

}  // namespace meso::sdf
