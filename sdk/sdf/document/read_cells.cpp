// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
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

std::optional<std::string> DocumentReader::in_words(const UnitCell& cell, const Pattern& pattern,
                                                    const std::string& text, std::string_view axis_prefix) {
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
    known = known && std::ranges::none_of(pattern.instructions, [&](const meso::Instruction& instruction) {
              const auto* set = std::get_if<SetInstruction>(&instruction);
              return set != nullptr && set->parameter.text == name.text;
            });
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
  const auto words = in_words(cell, pattern, text, prefix);
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

bool DocumentReader::only_sets_at_points(const Pattern& pattern) {
  for (const meso::Instruction& instruction : pattern.instructions) {
    const auto* set = std::get_if<SetInstruction>(&instruction);
    if (set == nullptr || set->at != SetAt::point) return no("an instruction that no word says");
  }
  return true;
}

std::optional<Vec3> DocumentReader::scale_of(const UnitCell& cell, const Pattern& pattern, const Box3& region,
                                             std::string_view surface) {
  const auto box = box_of(*cell.box);
  if (!box) return std::nullopt;
  Vec3 factor{value(cell.box->dx), value(cell.box->dy), value(cell.box->dz)};
  if (!(box->min == Vec3{})) return no("a cell whose corner is not the origin"), std::nullopt;
  if (!fills(pattern, region, factor)) return std::nullopt;
  if (surface != "q-star-hex") return factor;
  if (factor.y != std::numbers::sqrt3 * factor.x)
    return no("a period that is stretched; words scale the surface's own"), std::nullopt;
  factor.y = factor.x;
  return factor;
}

bool DocumentReader::surface(const UnitCell& cell, const ImplicitBody& body, const Pattern& pattern,
                             const Box3& region) {
  const implicit::Surface* known = implicit::find_surface(*body.surface);
  if (known == nullptr) return no("an unknown surface");
  if (!only_sets_at_points(pattern)) return false;
  const auto scale = scale_of(cell, pattern, region, known->name);
  if (!scale) return false;
  const Vec3 factor = *scale;
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
  const auto words = in_words(cell, Pattern{}, field, "");
  if (!words) return no("'" + field + "' has names that words do not know");
  push(Verb::expression, {}, *words);
  return true;
}

// In a document it is an error where a weight leaves 0 to 1; in words it counts as its end there.
bool DocumentReader::blend_by(const Level& weight) {
  const std::string formula = weight.formula.empty() ? format_number(weight.number) : unclamped(weight.formula);
  const bool stays = weight.formula.empty() ? weight.number >= 0 && weight.number <= 1 : formula != weight.formula;
  if (!stays) return no("a weight that is not clamped from 0 to 1");
  push(Verb::blend, {}, formula);
  return true;
}

bool DocumentReader::formula(const UnitCell& cell, const ImplicitBody& body, const Pattern& pattern,
                             const Box3& region) {
  if (!stands_once(pattern) || !pattern.instructions.empty()) return no("a formula's cell that does not stand once");
  const auto box = box_of(*cell.box);
  if (!box) return false;
  if (!holds(*box, region)) return no("a cell that does not hold the bounds; words cut nothing");
  if (body.density) return no("the density of a formula");
  const auto unscaled = unscaled_field(body.field->text);
  if (!leaf(cell, unscaled ? *unscaled : body.field->text)) return false;
  for (const ImplicitBlend& blend : body.blends) {
    if (!blend.field) return no("a blend of surfaces by name, which weighs them by their size");
    const auto weight = level(cell, pattern, blend.weight, "");
    if (!weight || !leaf(cell, blend.field->text)) return false;
    if (!blend_by(*weight)) return false;
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

// The last blend is the outermost of shares that are blended alike.
bool DocumentReader::blended_surfaces(const UnitCell& cell, const ImplicitBody& body, const Pattern& pattern,
                                      const Box3& region) {
  if (!body.density || body.kind || body.isovalue)
    return no("a blend of surfaces by name without a density, which weighs them by their size");
  if (!only_sets_at_points(pattern)) return false;
  std::vector<std::string> shares(body.blends.size() + 1, body.density->text);
  for (std::size_t i = body.blends.size(); i > 0; --i) {
    const auto both = shares_of(shares[0], body.blends[i - 1].weight.text);
    if (!both) break;
    shares[0] = both->first, shares[i] = both->second;
    std::fill(shares.begin() + 1, shares.begin() + static_cast<std::ptrdiff_t>(i), shares[0]);
  }
  const auto add = [&](const std::optional<std::string>& name, const std::string& share) {
    const implicit::Surface* known = name ? implicit::find_surface(*name) : nullptr;
    if (known == nullptr) return no("a blend of surfaces and formulas");
    const auto scale = scale_of(cell, pattern, region, known->name);
    const auto read = scale ? level(cell, pattern, Expression{share}, "") : std::nullopt;
    if (!read) return false;
    push(Verb::surface, {}, std::string(known->name));
    if (!(*scale == Vec3{1, 1, 1})) push(Verb::scale, {scale->x, scale->y, scale->z});
    push(Verb::density, {read->number}, read->formula);
    return true;
  };
  if (!add(body.surface, shares[0])) return false;
  for (std::size_t i = 0; i < body.blends.size(); ++i) {
    const auto weight = level(cell, pattern, body.blends[i].weight, "");
    if (!weight || !add(body.blends[i].surface, shares[i + 1]) || !blend_by(*weight)) return false;
  }
  return true;
}

}  // namespace meso::sdf
