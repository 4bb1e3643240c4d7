// SPDX-License-Identifier: Apache-2.0
#include "point_values.hpp"

#include <algorithm>
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
      values_(externals_.size()) {
  open_.externals.resize(externals_.size());
}

void PointValues::values_at(std::span<const Vec3> points, double* out) {
  for (std::size_t first = 0; first < points.size(); first += block_points)
    block(points.subspan(first, std::min(block_points, points.size() - first)), out + first);
}

void PointValues::block(std::span<const Vec3> points, double* out) {
  ask_signs(points);
  run(values_, points, out);
  if (std::none_of(bands_.begin(), bands_.end(), [](const Band& b) { return b.is_finite(); })) return;
  look_around(points, out);

  found_.resize(open_.points.size());
  run(open_.externals, open_.points, found_.data());
  exact_.points.clear();
  exact_.place.clear();
  for (std::size_t p = 0; p < open_.points.size(); ++p) {
    out[open_.place[p]] = found_[p];
    if (std::abs(found_[p]) <= open_.root_within[p]) continue;
    exact_.points.push_back(open_.points[p]);
    exact_.place.push_back(open_.place[p]);
  }
  if (exact_.points.empty()) return;
  within_.assign(exact_.points.size(), HUGE_VAL);
  for (std::size_t k = 0; k < externals_.size(); ++k) {
    values_[k].resize(exact_.points.size());
    externals_[k]->values_at(exact_.points, within_, values_[k].data());
  }
  found_.resize(exact_.points.size());
  run(values_, exact_.points, found_.data());
  for (std::size_t p = 0; p < found_.size(); ++p) out[exact_.place[p]] = found_[p];
}

/// Infinity of the right sign; zero, and what counts everywhere, as they are.
void PointValues::ask_signs(std::span<const Vec3> points) {
  for (std::size_t k = 0; k < externals_.size(); ++k) {
    within_.assign(points.size(), bands_[k].for_root(0) < HUGE_VAL ? 0 : HUGE_VAL);
    values_[k].resize(points.size());
    externals_[k]->values_at(points, within_, values_[k].data());
    if (!bands_[k].is_finite()) continue;
    for (double& v : values_[k])
      if (v != 0) v = std::copysign(HUGE_VAL, v);
  }
}

/// Which externals are near enough to count, given what the root comes to without them.
void PointValues::look_around(std::span<const Vec3> points, const double* out) {
  const std::size_t n = points.size();
  root_within_.resize(n);
  changed_.resize(n);
  for (std::size_t p = 0; p < n; ++p) {
    const bool decided = std::abs(out[p]) < HUGE_VAL;
    root_within_[p] = decided ? std::abs(out[p]) : reach_;
    changed_[p] = decided ? 0 : 1;
  }
  found_.resize(n);
  for (std::size_t k = 0; k < externals_.size(); ++k) {
    if (!bands_[k].is_finite()) continue;
    for (std::size_t p = 0; p < n; ++p) within_[p] = bands_[k].for_root(root_within_[p]);
    externals_[k]->values_at(points, within_, found_.data());
    for (std::size_t p = 0; p < n; ++p) {
      if (!(std::abs(found_[p]) <= within_[p])) continue;
      values_[k][p] = found_[p];
      changed_[p] = 1;
    }
  }
  open_.clear();
  for (std::size_t p = 0; p < n; ++p) {
    if (changed_[p] == 0) continue;
    open_.points.push_back(points[p]);
    open_.root_within.push_back(root_within_[p]);
    open_.place.push_back(p);
    for (std::size_t k = 0; k < externals_.size(); ++k) open_.externals[k].push_back(values_[k][p]);
  }
}

void PointValues::run(const std::vector<std::vector<double>>& externals, std::span<const Vec3> points, double* out) {
  program_.values_at(points, externals, out);
}

void PointValues::Batch::clear() {
  points.clear();
  root_within.clear();
  place.clear();
  for (std::vector<double>& values : externals) values.clear();
}

}  // namespace meso::implicit
