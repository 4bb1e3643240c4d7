// SPDX-License-Identifier: Apache-2.0
#include "point_values.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace meso::implicit {
namespace {

constexpr std::size_t block_points = 4096;

}  // namespace

PointValues::PointValues(Program program, std::vector<Band> bands, std::vector<ExternalRows*> externals, double reach)
    : program_(std::move(program)),
      bands_(std::move(bands)),
      externals_(std::move(externals)),
      reach_(reach),
      bounded_(std::any_of(bands_.begin(), bands_.end(), [](const Band& b) { return b.is_finite(); })),
      one_way_(std::none_of(bands_.begin(), bands_.end(),
                            [](const Band& b) { return b.is_finite() && b.may_rise() && b.may_fall(); })),
      values_(externals_.size()),
      extremes_(externals_.size()) {}

void PointValues::values_at(std::span<const Vec3> points, double* out) {
  for (std::size_t first = 0; first < points.size(); first += block_points)
    block(points.subspan(first, std::min(block_points, points.size() - first)), out + first);
}

void PointValues::block(std::span<const Vec3> points, double* out) {
  ask_signs(points);
  if (!bounded_) return program_.values_at(points, values_, out);
  decide_by_signs(points, out);
  look_around(out);
  decide_by_distances(out);
  ask_exactly(out);
}

/// Infinity of the right sign; zero, and what counts everywhere, as they are.
void PointValues::ask_signs(std::span<const Vec3> points) {
  for (std::size_t k = 0; k < externals_.size(); ++k) {
    within_.assign(points.size(), bands_[k].is_finite() ? 0 : HUGE_VAL);
    values_[k].resize(points.size());
    externals_[k]->values_at(points, within_, values_[k].data());
    if (!bands_[k].is_finite()) continue;
    for (double& v : values_[k])
      if (v != 0) v = std::copysign(HUGE_VAL, v);
  }
}

/// Of all values that externals of these signs may have, those that make the root least, or greatest.
void PointValues::take_extremes(bool least) {
  for (std::size_t k = 0; k < externals_.size(); ++k) {
    extremes_[k] = values_[k];
    if (!bands_[k].is_finite()) continue;
    const double kept = bands_[k].may_fall() != least ? -HUGE_VAL : HUGE_VAL;
    for (double& v : extremes_[k])
      if (v != kept) v = 0;
  }
}

/// What is not decided is open, with infinities.
void PointValues::decide_by_signs(std::span<const Vec3> points, double* out) {
  const std::size_t n = points.size();
  open_.clear(externals_.size());
  found_.resize(n);
  if (one_way_) {
    take_extremes(true);
    program_.values_at(points, extremes_, out);
    take_extremes(false);
    program_.values_at(points, extremes_, found_.data());
  }
  for (std::size_t p = 0; p < n; ++p) {
    const bool decided = one_way_ && std::bit_cast<std::uint64_t>(out[p]) == std::bit_cast<std::uint64_t>(found_[p]) &&
                         !std::isnan(out[p]);
    if (!decided) open_.add(points[p], p, values_, p);
  }
}

/// Puts distances in where they are so small that they count, given what the root comes to without them.
void PointValues::look_around(double* out) {
  const std::size_t n = open_.points.size();
  found_.resize(n);
  within_.resize(n);
  program_.values_at(open_.points, open_.externals, found_.data());
  for (std::size_t p = 0; p < n; ++p) {
    out[open_.place[p]] = found_[p];
    open_.root_within.push_back(std::abs(found_[p]) < HUGE_VAL ? std::abs(found_[p]) : reach_);
  }
  for (std::size_t k = 0; k < externals_.size(); ++k) {
    if (!bands_[k].is_finite()) continue;
    for (std::size_t p = 0; p < n; ++p) within_[p] = bands_[k].for_root(open_.root_within[p]);
    externals_[k]->values_at(open_.points, within_, found_.data());
    for (std::size_t p = 0; p < n; ++p)
      if (std::abs(found_[p]) <= within_[p]) open_.externals[k][p] = found_[p];
  }
}

void PointValues::decide_by_distances(double* out) {
  const std::size_t n = open_.points.size();
  program_.values_at(open_.points, open_.externals, found_.data());
  exact_.clear(externals_.size());
  for (std::size_t p = 0; p < n; ++p) {
    out[open_.place[p]] = found_[p];
    if (!(std::abs(found_[p]) <= open_.root_within[p])) exact_.add(open_.points[p], open_.place[p], open_.externals, p);
  }
}

void PointValues::ask_exactly(double* out) {
  if (exact_.points.empty()) return;
  within_.assign(exact_.points.size(), HUGE_VAL);
  for (std::size_t k = 0; k < externals_.size(); ++k)
    externals_[k]->values_at(exact_.points, within_, exact_.externals[k].data());
  found_.resize(exact_.points.size());
  program_.values_at(exact_.points, exact_.externals, found_.data());
  for (std::size_t p = 0; p < found_.size(); ++p) out[exact_.place[p]] = found_[p];
}

void PointValues::Batch::clear(std::size_t count) {
  points.clear();
  root_within.clear();
  place.clear();
  externals.resize(count);
  for (std::vector<double>& values : externals) values.clear();
}

void PointValues::Batch::add(Vec3 point, std::size_t at, const std::vector<std::vector<double>>& values,
                             std::size_t n) {
  points.push_back(point);
  place.push_back(at);
  for (std::size_t k = 0; k < values.size(); ++k) externals[k].push_back(values[k][n]);
}

}  // namespace meso::implicit
