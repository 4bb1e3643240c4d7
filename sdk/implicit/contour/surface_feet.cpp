// SPDX-License-Identifier: Apache-2.0
#include "surface_feet.hpp"

#include <algorithm>
#include <cmath>

namespace meso::implicit {
namespace {

constexpr std::size_t batch = 4096;
constexpr int most_steps = 8;

Vec3 within(unsigned planes, Vec3 v) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    if ((planes >> 2 * axis & 3U) != 0) v[axis] = 0;
  return v;
}

}  // namespace

unsigned planes_of(const Box3& box, Vec3 p) {
  unsigned planes = 0;
  for (unsigned axis = 0; axis < 3; ++axis) {
    if (p[axis] == box.min[axis]) planes |= 1U << 2 * axis;
    if (p[axis] == box.max[axis]) planes |= 2U << 2 * axis;
  }
  return planes;
}

SurfaceFeet::SurfaceFeet(const GridSource& source, std::function<bool()> go_on)
    : grid_(source.grid()), sampler_(source.sampler()), go_on_(std::move(go_on)) {}

void SurfaceFeet::ask(std::span<const Vec3> points, std::vector<double>& out) {
  out.assign(points.size(), 0);
  for (std::size_t i = 0; i < points.size() && go_on_(); i += batch) {
    const auto some = points.subspan(i, std::min(batch, points.size() - i));
    sampler_->values_at(some, out.data() + i);
    asked_ += some.size();
  }
}

void SurfaceFeet::slopes(std::span<const Vec3> points, std::vector<Vec3>& out, std::vector<double>& values) {
  around_.clear();
  for (const Vec3& p : points)
    for (std::size_t axis = 0; axis < 4; ++axis) {
      around_.push_back(p);
      if (axis < 3) around_.back()[axis] += 1e-5 * grid_.spacing(axis);
    }
  ask(around_, around_values_);
  out.resize(points.size());
  values.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    values[i] = around_values_[4 * i + 3];
    for (std::size_t axis = 0; axis < 3; ++axis)
      out[i][axis] = (around_values_[4 * i + axis] - values[i]) / (around_[4 * i + axis][axis] - points[i][axis]);
  }
}

void SurfaceFeet::feet(std::span<const PointNearSurface> points, double enough, std::vector<Foot>& out) {
  constexpr double certainly = 0.7;  // slopes nearby tell the distance to within a third
  moving_.clear();
  for (const PointNearSurface& p : points) moving_.push_back(p.point);
  ask(moving_, values_);
  out.resize(points.size());
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double distance = std::fabs(values_[i]) / points[i].slope;
    out[i] = {points[i].point, distance};
    if (!(distance <= certainly * enough)) open.push_back(i);
  }
  for (int step = 0; step < most_steps && !open.empty() && go_on_(); ++step) {
    moving_.clear();
    for (const std::size_t i : open) moving_.push_back(out[i].point);
    slopes(moving_, gradients_, values_);
    std::size_t kept = 0;
    for (std::size_t n = 0; n < open.size(); ++n) {
      const std::size_t i = open[n];
      const Vec3 gradient = within(points[i].planes, gradients_[n]);
      const double slope = norm(gradient), remains = std::fabs(values_[n]) / slope;
      if (!std::isfinite(remains) || slope == 0) {  // no telling: as far as it came
        out[i].distance = norm(out[i].point - points[i].point);
        continue;
      }
      Vec3 next = out[i].point - values_[n] / (slope * slope) * gradient;
      for (std::size_t axis = 0; axis < 3; ++axis)
        next[axis] = std::clamp(next[axis], grid_.box.min[axis], grid_.box.max[axis]);
      out[i] = {next, norm(next - points[i].point)};
      if (remains > 0.01 * enough) open[kept++] = i;
    }
    open.resize(kept);
  }
}

}  // namespace meso::implicit
