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

void SurfaceFeet::distances(std::span<const PointNearSurface> points, double limit, std::vector<double>& out) {
  constexpr double certainly = 0.7;  // slopes nearby tell the distance to within a third
  moving_.clear();
  for (const PointNearSurface& p : points) moving_.push_back(p.point);
  ask(moving_, values_);
  out.resize(points.size());
  std::vector<PointNearSurface> open;
  std::vector<std::size_t> place;
  for (std::size_t i = 0; i < points.size(); ++i) {
    out[i] = std::fabs(values_[i]) / points[i].slope;
    if (out[i] <= certainly * limit || (out[i] > limit / certainly && std::isfinite(out[i]))) continue;
    open.push_back(points[i]);
    place.push_back(i);
  }
  std::vector<Foot> found;
  feet(open, 0.01 * limit, found);
  for (std::size_t n = 0; n < found.size(); ++n) out[place[n]] = found[n].distance;
}

void SurfaceFeet::feet(std::span<const PointNearSurface> points, double accuracy, std::vector<Foot>& out) {
  out.resize(points.size());
  std::vector<Vec3> gradient(points.size()), found_slopes;
  std::vector<double> before(points.size(), HUGE_VAL), found_values;
  std::vector<std::size_t> open(points.size()), sloping, plain;
  for (std::size_t i = 0; i < points.size(); ++i) {
    open[i] = i;
    out[i].point = points[i].point;
  }
  std::vector<double> value(points.size());
  for (int step = 0; step < most_steps && !open.empty() && go_on_(); ++step) {
    // The value here; and the slope, where the last one has not cut the value down to a quarter.
    moving_.clear();
    for (const std::size_t i : open) moving_.push_back(out[i].point);
    if (step == 0) {
      sloping = open;
    } else {
      ask(moving_, values_);
      sloping.clear();
      moving_.clear();
      for (std::size_t n = 0; n < open.size(); ++n) {
        const std::size_t i = open[n];
        value[i] = values_[n];
        if (!(std::fabs(value[i]) < before[i] / 4)) sloping.push_back(i), moving_.push_back(out[i].point);
      }
    }
    slopes(moving_, found_slopes, found_values);
    for (std::size_t n = 0; n < sloping.size(); ++n) {
      gradient[sloping[n]] = within(points[sloping[n]].planes, found_slopes[n]);
      value[sloping[n]] = found_values[n];
    }
    std::erase_if(open, [&](std::size_t i) {
      const double slope = norm(gradient[i]), remains = std::fabs(value[i]) / slope;
      Foot& foot = out[i];
      if (!std::isfinite(remains)) return true;  // no telling: as far as it came
      before[i] = std::fabs(value[i]);
      Vec3 next = foot.point - value[i] / (slope * slope) * gradient[i];
      for (std::size_t axis = 0; axis < 3; ++axis)
        next[axis] = std::clamp(next[axis], grid_.box.min[axis], grid_.box.max[axis]);
      foot = {next, norm(next - points[i].point), slope};
      return remains <= accuracy;
    });
  }
}

}  // namespace meso::implicit
