// SPDX-License-Identifier: Apache-2.0
// What must hold everywhere in the cells' boxes, and the level that fills a share of them.
#include <algorithm>
#include <cmath>
#include <set>

#include "density_spacing.hpp"
#include "implicit_cell.hpp"
#include "meso/base/number.hpp"
#include "meso/implicit/flat_term.hpp"
#include "meso/model/walk.hpp"
#include "point_terms.hpp"

namespace meso::implicit {
namespace {

constexpr double meant = 0.002;  // what a share may be off by

std::string place_text(Vec3 p) { return format_number(p.x) + ", " + format_number(p.y) + ", " + format_number(p.z); }

std::vector<double> values_at(const Term& term, std::span<const Vec3> points) {
  std::vector<double> values(points.size());
  FlatTerm(term).values(points, values);
  return values;
}

std::string share_text(double share) { return format_number(std::round(share * 1e4) / 1e4 + 0.0); }  // no -0

/// What is left between the gaps, in words.
std::string reachable(std::span<const DensityTable::Gap> gaps) {
  std::string text, from = "0", to = "1";
  for (const DensityTable::Gap& gap : gaps) {
    if (gap.from <= meant) {
      from = share_text(gap.to);
    } else if (gap.to >= 1 - meant) {
      to = share_text(gap.from);
    } else {
      text += from + " and " + share_text(gap.from) + ", or ";
      from = share_text(gap.to);
    }
  }
  return text + from + " and " + to;
}

}  // namespace

// A grid over the region's box, its ends on the box: what falls and grows has its extremes there.
std::vector<Vec3> points_in(const BodyUse& use) {
  std::vector<Vec3> points;
  const Box3 box = use.region.bounds();
  if (box.empty() || !std::isfinite(norm(box.max - box.min))) return points;
  const double slack = 1e-9 * norm(box.max - box.min);
  Grid grid{.box = box, .nodes = {use.points_along, use.points_along, use.points_along}};
  std::vector<Vec3> row(static_cast<std::size_t>(use.points_along));
  std::vector<double> inside(row.size());
  for (std::int32_t k = 0; k < use.points_along; ++k)
    for (std::int32_t j = 0; j < use.points_along; ++j) {
      for (std::int32_t i = 0; i < use.points_along; ++i) row[static_cast<std::size_t>(i)] = grid.node(i, j, k);
      use.region.values(row, inside);
      for (std::size_t i = 0; i < row.size(); ++i)
        if (inside[i] <= slack) points.push_back(row[i]);
    }
  return points;
}

bool ImplicitCells::ask_fields(std::span<const Vec3> points) const {
  for (const eval::PointQuantity& quantity : quantities_)
    for (const Vec3& p : points)
      if (!quantity(p, report_.sink())) return false;
  return true;
}

bool ImplicitCells::check_weights(const Parts& made, std::span<const Vec3> points) const {
  constexpr double slack = 1e-9;
  for (std::size_t b = 0; b < made.weights.size(); ++b) {
    const std::vector<double> weights = values_at(made.weights[b], points);
    for (std::size_t n = 0; n < points.size(); ++n) {
      if (weights[n] >= -slack && weights[n] <= 1 + slack) continue;
      report_(Code::blend_weight, body_.blends[b].id_in_source,
              {cells_.unit_cell().id.text, share_text(weights[n]), place_text(points[n] / unit_mm_)}, "weight");
      return false;
    }
  }
  return true;
}

double ImplicitCells::see_wall(const Term& wall_mm, std::span<const Vec3> points) {
  double thickest = 0;
  const auto see = [&](double wall) {
    thinnest_wall_ = std::fmin(thinnest_wall_, wall);
    thickest = std::fmax(thickest, wall);
  };
  if (wall_mm.is_constant())
    see(wall_mm.node().number);
  else
    std::ranges::for_each(values_at(wall_mm, points), see);
  return thickest;
}

/// Parameters that shape the function; the share itself does not.
std::vector<bool> ImplicitCells::shaping() const {
  std::set<std::string> names;
  walk(body_, [&](const Element&, std::string_view attribute, const auto& value) {
    if constexpr (std::is_same_v<std::decay_t<decltype(value)>, Expression>)
      if (attribute != "density")
        for (const std::string& name : names_of(value, evaluation_.document().unit)) names.insert(name);
  });
  std::vector<bool> result;
  for (const CellParameter& p : cells_.unit_cell().parameters) result.push_back(names.contains(p.name.text));
  return result;
}

bool ImplicitCells::check_shares(const Term& share, const DensityTable& table, const std::vector<Term>& at,
                                 std::span<const Vec3> points) const {
  const std::vector<double> shares = values_at(share, points);
  std::vector<std::vector<double>> values;
  for (const Term& one : at) values.push_back(values_at(one, points));
  std::vector<double> here(at.size());
  for (std::size_t n = 0; n < points.size(); ++n) {
    for (std::size_t a = 0; a < at.size(); ++a) here[a] = values[a][n];
    const auto gaps = table.gaps(here);
    const bool is_between = shares[n] > 0 && shares[n] < 1;
    if (is_between && std::ranges::none_of(gaps, [&](const DensityTable::Gap& gap) {
          return shares[n] > gap.from + meant && shares[n] < gap.to - meant;
        }))
      continue;
    report_(Code::density_unreachable, body_.id_in_source,
            {cells_.unit_cell().id.text, share_text(shares[n]), place_text(points[n] / unit_mm_), reachable(gaps)},
            "density");
    return false;
  }
  return true;
}

// The least and the largest share are contoured in a cell of their own. Shares near those that were seen take about the
// same samples.
void ImplicitCells::see_shares(std::span<const double> shares, const DensityTable& table, const Term& function,
                               std::span<const double> at, const eval::BoxShape& box, double edge_mm) {
  constexpr double near = 0.04;
  if (shares.empty()) return;
  const auto [least, most] = std::ranges::minmax(shares);
  for (const double share : {least, most}) {
    std::vector<double>& seen = seen_shares_[&table];
    if (std::ranges::any_of(seen, [&](double s) { return std::fabs(s - share) < near; })) continue;
    seen.push_back(share);
    const Term body = function - Term::constant(table.level(share, at));
    density_spacing_ =
        std::min(density_spacing_, edge_mm * spacing_for_share(body, {box.corner, box.corner + box.size}, share));
  }
}

std::optional<Term> ImplicitCells::level_for(const Parts& made, const Values& values, const eval::BoxShape& box,
                                             const BodyUse& use, std::span<const Vec3> points) {
  const std::vector<bool> shapes = shaping();
  std::vector<std::size_t> free;
  std::vector<Term> at;
  std::vector<Interval> ranges;
  std::vector<double> key{box.size.x, box.size.y, box.size.z, box.corner.x, box.corner.y, box.corner.z};
  for (std::size_t p = 0; p < values.size(); ++p) {
    if (!shapes[p]) continue;
    if (values[p].is_constant()) {
      key.push_back(values[p].node().number);
      continue;
    }
    const std::vector<double> seen = values_at(values[p], points);
    const auto [least, most] = std::ranges::minmax(seen);
    free.push_back(p);
    at.push_back(values[p]);
    ranges.push_back({least, most});
    key.insert(key.end(), {least, most});
  }
  if (free.size() > 2) {
    report_(Code::not_yet_evaluated, body_.id_in_source,
            {"the density of a function with more than two parameters that are set at points"});
    return std::nullopt;
  }
  auto& table = tables_[key];
  CellPoint own;
  own.is_in_box = true;
  for (std::size_t i = 0; i < 3; ++i) own.local[i] = Term::coordinate(i);
  const auto function = [&](std::span<const double> chosen) {
    Values fixed = values;
    for (std::size_t k = 0; k < free.size(); ++k) fixed[free[k]] = Term::constant(chosen[k]);
    const auto one = parts(fixed, box, own);
    return one ? one->function : Term::constant(NAN);
  };
  if (!table) table = std::make_shared<const DensityTable>(function, DensityTable::Room{box.corner, box.size}, ranges);
  if (!check_shares(*made.share, *table, at, points)) return std::nullopt;
  std::vector<double> middle;
  for (const Interval& range : ranges) middle.push_back((range.lo + range.hi) / 2);
  see_shares(values_at(*made.share, points), *table, function(middle), middle, box, use.edge_mm);
  if (made.share->is_constant() && at.empty()) return Term::constant(table->level(made.share->node().number, {}));
  return density_level(table, *made.share, std::move(at));
}

}  // namespace meso::implicit
