// SPDX-License-Identifier: Apache-2.0
#include "meso/implicit/density_table.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "meso/implicit/flat_term.hpp"
#include "meso/implicit/point_function.hpp"

namespace meso::implicit {
namespace {

constexpr std::size_t quantiles = 4096;
constexpr double meant = 0.002;  // what a share may be off by

double at_quantile(const std::vector<double>& levels, double share) {
  const double t = std::clamp(share, 0.0, 1.0) * static_cast<double>(levels.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(t), levels.size() - 2);
  const double part = t - static_cast<double>(i);
  return levels[i] + part * (levels[i + 1] - levels[i]);
}

std::vector<double> sorted_values(const Term& function, const DensityTable::Room& box,
                                  std::span<const Vec3> unit_points) {
  std::vector<Vec3> points;
  points.reserve(unit_points.size());
  for (const Vec3& u : unit_points)
    points.push_back(box.corner + Vec3{u.x * box.size.x, u.y * box.size.y, u.z * box.size.z});
  std::vector<double> values(points.size());
  FlatTerm(function).values(points, values);
  for (double& v : values)
    if (std::isnan(v)) v = HUGE_VAL;  // outside at any level
  std::ranges::sort(values);
  return values;
}

std::vector<DensityTable::Gap> gaps_of(const std::vector<double>& sorted) {
  const double scale = std::isfinite(sorted.back()) ? sorted.back() - sorted.front() : 1;
  const auto count = static_cast<double>(sorted.size());
  std::vector<DensityTable::Gap> gaps;
  for (std::size_t i = 0; i < sorted.size();) {
    std::size_t j = i + 1;
    while (j < sorted.size() && (sorted[j] == sorted[i] || sorted[j] - sorted[i] <= 1e-12 * scale)) ++j;
    if (static_cast<double>(j - i) > 2 * meant * count)
      gaps.push_back({static_cast<double>(i) / count, static_cast<double>(j) / count});
    i = j;
  }
  return gaps;
}

class DensityLevel final : public PointFunction {
 public:
  DensityLevel(std::shared_ptr<const DensityTable> table, const Term& share, const std::vector<Term>& at)
      : table_(std::move(table)), share_(share) {
    for (const Term& term : at) at_.emplace_back(term);
  }

  void values(std::span<const Vec3> points, double* out) const override {
    std::vector<double> share(points.size());
    share_.values(points, share);
    std::array<std::vector<double>, 2> at;
    for (std::size_t a = 0; a < at_.size(); ++a) {
      at[a].resize(points.size());
      at_[a].values(points, at[a]);
    }
    std::array<double, 2> here{};
    for (std::size_t n = 0; n < points.size(); ++n) {
      for (std::size_t a = 0; a < at_.size(); ++a) here[a] = at[a][n];
      out[n] = std::isnan(share[n] + here[0] + here[1]) ? NAN : table_->level(share[n], {here.data(), at_.size()});
    }
  }
  [[nodiscard]] Interval interval(const Box3& box) const override {
    std::array<Interval, 2> at;
    for (std::size_t a = 0; a < at_.size(); ++a) at[a] = at_[a].interval(box);
    return table_->level(share_.interval(box), {at.data(), at_.size()});
  }

 private:
  std::shared_ptr<const DensityTable> table_;
  FlatTerm share_;
  std::vector<FlatTerm> at_;
};

}  // namespace

Term density_level(std::shared_ptr<const DensityTable> table, const Term& share, std::vector<Term> at) {
  return Term::external(std::make_shared<const DensityLevel>(std::move(table), share, at));
}

// The mean over a regular grid.
double root_mean_square(const Term& function, const DensityTable::Room& box) {
  constexpr int along = 32;
  const auto at = [&](int i, std::size_t axis) { return box.corner[axis] + (i + 0.25) / along * box.size[axis]; };
  std::vector<Vec3> points;
  for (int i = 0; i < along; ++i)
    for (int j = 0; j < along; ++j)
      for (int k = 0; k < along; ++k) points.push_back({at(i, 0), at(j, 1), at(k, 2)});
  std::vector<double> values(points.size());
  FlatTerm(function).values(points, values);
  double sum = 0;
  for (const double f : values) sum += f * f;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

// The additive sequence of the plastic number's generalisation to three dimensions (Roberts 2018).
std::vector<Vec3> even_points(std::size_t count) {
  constexpr double g = 1.2207440846057594753616853491088319;
  const Vec3 step{1 / g, 1 / (g * g), 1 / (g * g * g)};
  std::vector<Vec3> points(count);
  for (std::size_t n = 0; n < count; ++n)
    for (std::size_t a = 0; a < 3; ++a) {
      const double t = 0.5 + static_cast<double>(n + 1) * step[a];
      points[n][a] = t - std::floor(t);
    }
  return points;
}

DensityTable::DensityTable(const Function& function, const Room& room, std::vector<Interval> ranges)
    : ranges_(std::move(ranges)),
      nodes_(ranges_.empty()       ? 1
             : ranges_.size() == 1 ? 33
                                   : 17) {
  assert(ranges_.size() <= 2);
  const std::vector<Vec3> points = even_points(ranges_.empty() ? 1U << 18 : ranges_.size() == 1 ? 1U << 16 : 1U << 14);
  std::vector<double> at(ranges_.size());
  const auto value = [&](std::size_t axis, std::size_t i) {
    return ranges_[axis].lo +
           (ranges_[axis].hi - ranges_[axis].lo) * static_cast<double>(i) / static_cast<double>(nodes_ - 1);
  };
  for (std::size_t j = 0; j < nodes_along(1); ++j)
    for (std::size_t i = 0; i < nodes_along(0); ++i) {
      if (!ranges_.empty()) at[0] = value(0, i);
      if (ranges_.size() > 1) at[1] = value(1, j);
      const std::vector<double> sorted = sorted_values(function(at), room, points);
      Node made{std::vector<double>(quantiles + 1), gaps_of(sorted)};
      for (std::size_t q = 0; q <= quantiles; ++q)
        made.quantiles[q] = at_quantile(sorted, static_cast<double>(q) / static_cast<double>(quantiles));
      table_.push_back(std::move(made));
    }
}

/// In nodes, from 0 to nodes_ - 1.
double DensityTable::position(double value, std::size_t axis) const {
  const Interval& range = ranges_[axis];
  if (!(range.hi > range.lo)) return 0;
  return std::clamp((value - range.lo) / (range.hi - range.lo), 0.0, 1.0) * static_cast<double>(nodes_ - 1);
}

double DensityTable::level(double share, std::span<const double> at) const {
  std::size_t low[2] = {0, 0};
  double part[2] = {0, 0};
  for (std::size_t a = 0; a < ranges_.size(); ++a) {
    const double t = position(at[a], a);
    low[a] = std::min(static_cast<std::size_t>(t), nodes_ - 2);
    part[a] = t - static_cast<double>(low[a]);
  }
  double sum = 0;
  for (std::size_t j = 0; j < (ranges_.size() > 1 ? 2U : 1U); ++j)
    for (std::size_t i = 0; i < (ranges_.empty() ? 1U : 2U); ++i) {
      const double weight = (i == 0 ? 1 - part[0] : part[0]) * (j == 0 ? 1 - part[1] : part[1]);
      if (weight > 0) sum += weight * at_quantile(node(low[0] + i, low[1] + j).quantiles, share);
    }
  return sum;
}

// A level grows with the share; between nodes it lies between theirs.
Interval DensityTable::level(Interval share, std::span<const Interval> at) const {
  std::size_t first[2] = {0, 0}, last[2] = {0, 0};
  for (std::size_t a = 0; a < ranges_.size(); ++a) {
    first[a] = static_cast<std::size_t>(position(at[a].lo, a));
    last[a] = static_cast<std::size_t>(std::ceil(position(at[a].hi, a)));
  }
  Interval result{HUGE_VAL, -HUGE_VAL, share.undefined};
  for (std::size_t j = first[1]; j <= last[1]; ++j)
    for (std::size_t i = first[0]; i <= last[0]; ++i) {
      result.lo = std::min(result.lo, at_quantile(node(i, j).quantiles, share.lo));
      result.hi = std::max(result.hi, at_quantile(node(i, j).quantiles, share.hi));
    }
  for (const Interval& one : at) result.undefined = result.undefined || one.undefined;
  return result;
}

std::span<const DensityTable::Gap> DensityTable::gaps(std::span<const double> at) const {
  std::size_t near[2] = {0, 0};
  for (std::size_t a = 0; a < ranges_.size(); ++a) near[a] = static_cast<std::size_t>(std::lround(position(at[a], a)));
  return node(near[0], near[1]).gaps;
}

}  // namespace meso::implicit
