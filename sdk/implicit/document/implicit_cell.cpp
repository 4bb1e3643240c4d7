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
#include "meso/model/describe.hpp"
#include "point_terms.hpp"

namespace meso::implicit {
namespace {

/// What has no value is outside (min gives its first operand there).
Term outside_where_undefined(const Term& term, const Box3& box) {
  return interval_of(term, box).undefined ? min(Term::constant(1e30), term) : term;
}

/// function < level
Term below(const Term& function, const Term& level) {
  return level.is_constant() && level.node().number == 0 ? function : function - level;
}

}  // namespace

ImplicitCells::ImplicitCells(const eval::Evaluation& evaluation, const eval::CellStream& cells, const Reporter& report)
    : evaluation_(evaluation),
      cells_(cells),
      report_(report),
      body_(std::get<ImplicitBody>(cells.unit_cell().body)),
      unit_mm_(millimeters_per(evaluation.document().unit)) {}

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

/// A surface in a blend is divided by this, so that equal weights mean equal parts.
double ImplicitCells::root_mean_square(const Surface& surface) {
  const auto [known, is_new] = root_mean_squares_.try_emplace(std::string(surface.name), 0);
  if (!is_new) return known->second;
  CellPoint point;
  for (std::size_t i = 0; i < 3; ++i) point.local[i] = Term::coordinate(i);
  const eval::BoxShape unit{{}, {1, 1, 1}};
  return known->second = implicit::root_mean_square(surface_at(surface, unit, point), {unit.corner, unit.size});
}

/// The second half of the box shows the first in a mirror, along the axes that the document names; so does every copy.
CellPoint ImplicitCells::mirrored(const CellPoint& point, const eval::BoxShape& box) const {
  if (!body_.mirror) return point;
  CellPoint result = point;
  for (const char axis : enum_texts<ImplicitMirror>[static_cast<std::size_t>(*body_.mirror)]) {
    const auto a = static_cast<std::size_t>(axis - 'x');
    const double half = box.size[a] / 2;
    Term from_middle = point.local[a] - (box.corner[a] + half);
    if (!point.is_in_box)  // the nearest of all middles
      from_middle = from_middle - box.size[a] * Term::apply(expr::Op::floor, {(1 / box.size[a]) * from_middle - -0.5});
    result.local[a] = Term::constant(box.corner[a] + half) - abs(from_middle);
  }
  return result;
}

std::optional<Term> ImplicitCells::function_of(const std::optional<Expression>& field,
                                               const std::optional<std::string>& name, const Element& where,
                                               const eval::BoxShape& box, const CellPoint& point,
                                               const Meaning& meaning) {
  if (field) return term(*field, where.id_in_source, "field", meaning);
  if (const Surface* surface = find_surface(*name)) {
    const Term f = surface_at(*surface, box, point);
    return body_.blends.empty() ? f : (1 / root_mean_square(*surface)) * f;
  }
  const auto near = nearest_surface(*name);
  report_(Code::implicit_unknown_surface, where.id_in_source,
          {*name, near.empty() ? "" : "; did you mean '" + std::string(near) + "'?"});
  return std::nullopt;
}

// a left fold, so that any number of functions keep shares whose sum is 1.
std::optional<Term> ImplicitCells::blended(const eval::BoxShape& box, const CellPoint& point, const Meaning& meaning,
                                           std::vector<Term>& weights) {
  auto f = function_of(body_.field, body_.surface, body_, box, point, meaning);
  for (const ImplicitBlend& blend : body_.blends) {
    const auto g = function_of(blend.field, blend.surface, blend, box, point, meaning);
    const auto w = term(blend.weight, blend.id_in_source, "weight", meaning);
    if (!f || !g || !w) return std::nullopt;
    weights.push_back(*w);
    f = *f + *w * (*g - *f);
  }
  return f;
}

std::optional<ImplicitCells::Parts> ImplicitCells::parts(const Values& values, const eval::BoxShape& box,
                                                         const CellPoint& given) {
  const CellPoint point = mirrored(given, box);
  const auto& parameters = cells_.unit_cell().parameters;
  const std::array<Term, 3> xyz = scaled(1 / unit_mm_, point.local);
  const Meaning meaning = [&](const std::string& name) -> std::optional<Term> {
    if (const auto axis = coordinate(name, "")) return xyz[*axis];
    for (std::size_t p = 0; p < parameters.size(); ++p)
      if (parameters[p].name.text == name) return values[p];
    const auto value = evaluation_.parameter(name);
    return value ? std::optional(Term::constant(*value)) : std::nullopt;
  };
  Parts made;
  const auto f = blended(box, point, meaning, made.weights);
  const auto isovalue = level(body_.isovalue, "isovalue", meaning), lower = level(body_.lower, "lower", meaning),
             upper = level(body_.upper, "upper", meaning), thickness = level(body_.thickness, "thickness", meaning),
             density = level(body_.density, "density", meaning), wall = level(body_.wall, "wall", meaning);
  if (!f || !isovalue || !lower || !upper || !thickness || !density || !wall) return std::nullopt;
  if (body_.density) made.share = density;
  const bool at_zero = isovalue->is_constant() && isovalue->node().number == 0;
  const Term from_level = at_zero ? *f : *f - *isovalue;
  switch (body_.kind.value_or(ImplicitKind::endoskeleton)) {
    case ImplicitKind::endoskeleton:
      made.function = from_level;
      return made;
    case ImplicitKind::exoskeleton:
      made.function = -from_level;
      return made;
    case ImplicitKind::shell:
      if (body_.wall) made.wall_mm = unit_mm_ * *wall;
      made.function = body_.wall ? from_level : abs(from_level);
      made.level = 0.5 * *thickness;
      return made;
    case ImplicitKind::eccentric_shell:
      break;
  }
  made.function = max(*lower - *f, *f - *upper);
  return made;
}

std::optional<Term> ImplicitCells::plain_body(const eval::PlacedCell& cell, const eval::BoxShape& box,
                                              const CellPoint& point) {
  const auto values = parameters_at(cell, point, {});
  const auto made = values ? parts(*values, box, point) : std::nullopt;
  if (!made) return std::nullopt;
  const Term& level = made->share ? *made->share : made->wall_mm ? *made->wall_mm : made->level;
  return below(made->function, level);
}

std::optional<Term> ImplicitCells::body(const eval::PlacedCell& cell, const eval::BoxShape& box, const CellPoint& point,
                                        const BodyUse& use) {
  const std::size_t errors = report_.sink().error_count();
  quantities_.clear();
  const auto values = parameters_at(cell, point, use.region.bounds());
  const auto made = values ? parts(*values, box, point) : std::nullopt;
  if (!made) return std::nullopt;
  std::vector<Vec3> points;
  if (varies_by_point() || !made->weights.empty() || made->share) points = points_in(use);
  if (!ask_fields(points) || !check_weights(*made, points)) return std::nullopt;
  if (made->wall_mm) {
    const double thickest = see_wall(*made->wall_mm, points);
    const Term distance = distance_to_level(made->function, use.edge_mm / 8, thickest / 2 + use.edge_mm / 8);
    return abs(distance) - 0.5 * *made->wall_mm;
  }
  const auto level = made->share ? level_for(*made, *values, box, use, points) : std::optional(made->level);
  // How steep it is, in the cell's own coordinates.
  CellPoint own;
  own.is_in_box = true;
  for (std::size_t i = 0; i < 3; ++i) {
    own.local[i] = Term::coordinate(i);
    own.global[i] = Term::constant(cell.global[i]);
  }
  const auto plain = plain_body(cell, box, own);
  if (!level || !plain || report_.sink().error_count() > errors) return std::nullopt;
  const double slope = FlatTerm(*plain).lipschitz({box.corner, box.corner + box.size});
  const Term given = below(made->function, *level);
  const Term scaled = slope > 0 && std::isfinite(slope) ? (1 / slope) * given : given;
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
bool ImplicitCells::repeats(const eval::PlacedCell& cell, const eval::BoxShape& box, std::size_t axis) {
  if (body_.surface && body_.blends.empty()) return true;
  CellPoint point;
  for (std::size_t i = 0; i < 3; ++i) {
    point.local[i] = Term::coordinate(i);
    point.global[i] = Term::constant(cell.global[i]);
  }
  const auto body = plain_body(cell, box, point);
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
