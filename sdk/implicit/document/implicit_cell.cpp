// SPDX-License-Identifier: Apache-2.0
#include "implicit_cell.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "meso/base/unit.hpp"
#include "meso/expr/expression.hpp"
#include "meso/implicit/flat_term.hpp"
#include "meso/implicit/surfaces.hpp"

namespace meso::implicit {
namespace {

std::array<Term, 3> scaled(double factor, const std::array<Term, 3>& p) {
  if (factor == 1) return p;
  return {factor * p[0], factor * p[1], factor * p[2]};
}

/// Which of `x y z` with the prefix it is.
std::optional<std::size_t> coordinate(std::string_view name, std::string_view prefix) {
  if (name.size() != prefix.size() + 1 || !name.starts_with(prefix)) return {};
  const char c = name.back();
  return c >= 'x' && c <= 'z' ? std::optional(static_cast<std::size_t>(c - 'x')) : std::nullopt;
}

/// What has no value is outside (min gives its first operand there).
Term outside_where_undefined(const Term& term, const Box3& box) {
  return interval_of(term, box).undefined ? min(Term::constant(1e30), term) : term;
}

std::vector<std::string> names_of(const Expression& expression, LengthUnit unit) {
  std::vector<std::string> names;
  if (const auto parsed = expr::parse_expression(expression.text, unit); parsed.expression)
    for (const expr::Name& name : parsed.expression->names()) names.push_back(name.text);
  return names;
}

}  // namespace

ImplicitCells::ImplicitCells(const eval::Evaluation& evaluation, const eval::CellStream& cells, const Reporter& report)
    : evaluation_(evaluation),
      cells_(cells),
      report_(report),
      body_(std::get<ImplicitBody>(cells.unit_cell().body)),
      unit_mm_(millimeters_per(evaluation.document().unit)) {}

std::optional<Term> ImplicitCells::term(const Expression& expression, ElementId where, std::string_view attribute,
                                        const Meaning& meaning) const {
  const auto parsed = expr::parse_expression(expression.text, evaluation_.document().unit);
  if (!parsed.expression) return std::nullopt;  // validation has read it
  std::vector<Term> terms;
  for (const expr::Name& name : parsed.expression->names()) {
    auto one = meaning(name.text);
    if (!one) {
      report_(Code::not_yet_evaluated, where, {"the name '" + name.text + "' in " + std::string(attribute)});
      return std::nullopt;
    }
    terms.push_back(std::move(*one));
  }
  return Term::from_expression(*parsed.expression, terms);
}

// for points: sets see document parameters and the point's place; defaults that follow see what they saw in
// the cell.
std::optional<std::vector<Term>> ImplicitCells::parameters_at(const eval::PlacedCell& cell,
                                                              const CellPoint& point) const {
  const auto& parameters = cells_.unit_cell().parameters;
  const auto& instructions = cells_.pattern().instructions;
  const LengthUnit unit = evaluation_.document().unit;
  std::vector<Term> values;
  for (const double v : cell.parameters) values.push_back(Term::constant(v));
  const auto position = [&](const std::string& name) {
    return static_cast<std::size_t>(
        std::ranges::find(parameters, name, [](const CellParameter& p) { return p.name.text; }) - parameters.begin());
  };
  std::vector<bool> is_set(parameters.size(), false);
  std::vector<const SetInstruction*> at_points;
  for (const Instruction& instruction : instructions) {
    const auto* set = std::get_if<SetInstruction>(&instruction);
    if (set == nullptr) continue;
    if (set->at.value_or(SetAt::cell) == SetAt::point)
      at_points.push_back(set);
    else
      is_set[position(set->parameter.text)] = true;
  }
  if (at_points.empty()) return values;

  const std::array<Term, 3> place = scaled(1 / unit_mm_, point.global);
  const Meaning at_point = [&](const std::string& name) -> std::optional<Term> {
    if (const auto axis = coordinate(name, "global.")) return place[*axis];
    const auto value = evaluation_.parameter(name);
    return value ? std::optional(Term::constant(*value)) : std::nullopt;
  };
  const Meaning in_cell = [&](const std::string& name) -> std::optional<Term> {
    if (const std::size_t p = position(name); p < parameters.size()) return values[p];
    if (const auto axis = coordinate(name, "global.")) return Term::constant(cell.global[*axis] / unit_mm_);
    const auto value = evaluation_.parameter(name);
    return value ? std::optional(Term::constant(*value)) : std::nullopt;
  };
  for (const SetInstruction* set : at_points) {
    const std::size_t p = position(set->parameter.text);
    auto value = term(set->value, set->id_in_source, "value", at_point);
    if (!value) return std::nullopt;
    values[p] = std::move(*value);
    is_set[p] = true;
    std::vector<bool> follows(parameters.size(), false);
    follows[p] = true;
    for (std::size_t f = p + 1; f < parameters.size(); ++f) {
      const auto names = names_of(parameters[f].value, unit);
      follows[f] = !is_set[f] && std::ranges::any_of(names, [&](const std::string& name) {
        const std::size_t n = position(name);
        return n < f && follows[n];
      });
      if (!follows[f]) continue;
      value = term(parameters[f].value, parameters[f].id_in_source, "value", in_cell);
      if (!value) return std::nullopt;
      values[f] = std::move(*value);
    }
  }
  return values;
}

std::optional<Term> ImplicitCells::level(const std::optional<Expression>& expression, std::string_view attribute,
                                         const Meaning& meaning) const {
  if (!expression) return Term::constant(0);
  return term(*expression, body_.id_in_source, attribute, meaning);
}

Term ImplicitCells::surface_at(const Surface& surface, const eval::BoxShape& box, const CellPoint& point) const {
  const auto parsed = expr::parse_expression(surface.expression, LengthUnit::millimeter);
  std::vector<Term> terms;
  for (const expr::Name& name : parsed.expression->names()) {
    const auto axis = static_cast<std::size_t>(name.text[0] - 'x');
    // The one surface whose period is not 1.
    const double period = surface.name == "q-star-hex" && axis == 1 ? std::numbers::sqrt3 : 1;
    const Term from_corner = box.corner[axis] == 0 ? point.local[axis] : point.local[axis] - box.corner[axis];
    terms.push_back((period / box.size[axis]) * from_corner);
  }
  return Term::from_expression(*parsed.expression, terms);
}

std::optional<Term> ImplicitCells::body_at(const eval::PlacedCell& cell, const eval::BoxShape& box,
                                           const CellPoint& point) const {
  const auto values = parameters_at(cell, point);
  if (!values) return std::nullopt;
  const auto& parameters = cells_.unit_cell().parameters;
  const std::array<Term, 3> xyz = scaled(1 / unit_mm_, point.local);
  const Meaning meaning = [&](const std::string& name) -> std::optional<Term> {
    if (const auto axis = coordinate(name, "")) return xyz[*axis];
    for (std::size_t p = 0; p < parameters.size(); ++p)
      if (parameters[p].name.text == name) return (*values)[p];
    const auto value = evaluation_.parameter(name);
    return value ? std::optional(Term::constant(*value)) : std::nullopt;
  };
  std::optional<Term> f;
  if (!body_.surface) {
    f = term(*body_.field, body_.id_in_source, "field", meaning);
  } else if (const Surface* surface = find_surface(*body_.surface)) {
    f = surface_at(*surface, box, point);
  } else {
    const auto near = nearest_surface(*body_.surface);
    report_(Code::implicit_unknown_surface, body_.id_in_source,
            {*body_.surface, near.empty() ? "" : "; did you mean '" + std::string(near) + "'?"});
  }
  const auto isovalue = level(body_.isovalue, "isovalue", meaning), lower = level(body_.lower, "lower", meaning),
             upper = level(body_.upper, "upper", meaning), thickness = level(body_.thickness, "thickness", meaning);
  if (!f || !isovalue || !lower || !upper || !thickness) return std::nullopt;
  const bool at_zero = isovalue->is_constant() && isovalue->node().number == 0;
  const Term from_level = at_zero ? *f : *f - *isovalue;
  switch (body_.kind.value_or(ImplicitKind::endoskeleton)) {
    case ImplicitKind::endoskeleton:
      return from_level;
    case ImplicitKind::exoskeleton:
      return -from_level;
    case ImplicitKind::shell:
      return abs(from_level) - 0.5 * *thickness;
    case ImplicitKind::eccentric_shell:
      break;
  }
  return max(*lower - *f, *f - *upper);
}

std::optional<Term> ImplicitCells::body(const eval::PlacedCell& cell, const eval::BoxShape& box,
                                        const CellPoint& point) const {
  const auto given = body_at(cell, box, point);
  if (!given) return std::nullopt;
  // How steep it is, in the cell's own coordinates.
  CellPoint own;
  for (std::size_t i = 0; i < 3; ++i) {
    own.local[i] = Term::coordinate(i);
    own.global[i] = Term::constant(cell.global[i]);
  }
  const double slope = FlatTerm(*body_at(cell, box, own)).lipschitz({box.corner, box.corner + box.size});
  const Term scaled = slope > 0 && std::isfinite(slope) ? (1 / slope) * *given : *given;
  constexpr double far = 1e9;
  return outside_where_undefined(scaled, {{-far, -far, -far}, {far, far, far}});
}

bool ImplicitCells::varies_by_point() const {
  return std::ranges::any_of(cells_.pattern().instructions, [](const Instruction& instruction) {
    const auto* set = std::get_if<SetInstruction>(&instruction);
    return set != nullptr && set->at == SetAt::point;
  });
}

// A formula is asked at points of a few cells: what agrees at all of them repeats.
bool ImplicitCells::repeats(const eval::PlacedCell& cell, const eval::BoxShape& box, std::size_t axis) const {
  if (body_.surface) return true;
  CellPoint point;
  for (std::size_t i = 0; i < 3; ++i) {
    point.local[i] = Term::coordinate(i);
    point.global[i] = Term::constant(cell.global[i]);
  }
  const auto body = body_at(cell, box, point);
  if (!body) return false;
  const FlatTerm flat(*body);
  std::mt19937_64 random(20);
  const auto fraction = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  for (int n = 0; n < 64; ++n) {
    Vec3 p;
    for (std::size_t i = 0; i < 3; ++i) p[i] = box.corner[i] + (2 * fraction() - 0.5) * box.size[i];
    Vec3 next = p;
    next[axis] += n % 2 == 0 ? box.size[axis] : 3 * box.size[axis];
    const double a = flat.value(p), b = flat.value(next);
    if (!(std::abs(a - b) <= 1e-9 * (1 + std::abs(a))) && !(std::isnan(a) && std::isnan(b))) return false;
  }
  return true;
}

}  // namespace meso::implicit
