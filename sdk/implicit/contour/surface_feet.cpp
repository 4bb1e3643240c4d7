// SPDX-License-Identifier: Apache-2.0
#include "surface_feet.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace meso::implicit {
namespace {

constexpr std::size_t batch = 4096;
constexpr int most_steps = 8;

}  // namespace

Vec3 within(unsigned planes, Vec3 v) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    if ((planes >> 2 * axis & 3U) != 0) v[axis] = 0;
  return v;
}

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
    if (out[i] <= certainly * limit) continue;  // near an edge, it may be too much by any factor
    open.push_back(points[i]);
    place.push_back(i);
  }
  std::vector<Foot> found;
  feet(open, 0.01 * limit, found);
  for (std::size_t n = 0; n < found.size(); ++n) out[place[n]] = found[n].distance;
}

void SurfaceFeet::shoot(std::span<Ray> rays, double accuracy) {
  constexpr std::array<double, 5> steps{0, 0.125, 0.25, 0.5, 1};
  struct Bracket {
    std::size_t ray;
    Vec3 same, other;  // as the beginning; on the other side
    bool inside;
  };
  moving_.clear();
  for (const Ray& ray : rays)
    for (const double step : steps)
      for (const double side : {-1.0, 1.0}) moving_.push_back(ray.from + side * step * ray.along);
  ask(moving_, values_);
  std::vector<Bracket> open;
  for (std::size_t r = 0; r < rays.size(); ++r) {
    const std::size_t at = 2 * steps.size() * r;
    const bool inside = values_[at] < 0;
    const std::size_t side = inside ? 1 : 0;
    for (std::size_t s = 1; s < steps.size() && !rays[r].hit; ++s) {
      if ((values_[at + 2 * s + side] < 0) == inside) continue;
      rays[r].hit = true;
      open.push_back({r, moving_[at + 2 * s - 2 + side], moving_[at + 2 * s + side], inside});
    }
  }
  while (!open.empty() && go_on_()) {
    moving_.clear();
    for (const Bracket& b : open) moving_.push_back((b.same + b.other) / 2);
    ask(moving_, values_);
    std::size_t next = 0;
    std::erase_if(open, [&](Bracket& b) {
      const std::size_t i = next++;
      ((values_[i] < 0) == b.inside ? b.same : b.other) = moving_[i];
      rays[b.ray].from = moving_[i];
      return norm(b.other - b.same) <= accuracy;
    });
  }
}

void SurfaceFeet::feet(std::span<const PointNearSurface> points, double accuracy, std::vector<Foot>& out) {
  out.resize(points.size());
  std::vector<Vec3> gradient(points.size()), found_slopes;
  std::vector<double> before(points.size(), HUGE_VAL), value(points.size()), found_values;
  std::vector<std::size_t> open(points.size()), sloping, asked;
  for (std::size_t i = 0; i < points.size(); ++i) {
    open[i] = i;
    out[i] = {points[i].point, 0, {}};
    gradient[i] = within(points[i].planes, points[i].gradient);
    value[i] = points[i].value;
  }
  for (int step = 0; step < most_steps && !open.empty() && go_on_(); ++step) {
    // The value here, where it is not known; and the gradient, where the last one has not cut the value down to a
    // quarter.
    asked.clear(), sloping.clear();
    for (const std::size_t i : open) {
      if (norm(gradient[i]) == 0)
        sloping.push_back(i);
      else if (step > 0 || value[i] == HUGE_VAL)
        asked.push_back(i);
    }
    moving_.clear();
    for (const std::size_t i : asked) moving_.push_back(out[i].point);
    ask(moving_, values_);
    for (std::size_t n = 0; n < asked.size(); ++n) {
      const std::size_t i = asked[n];
      value[i] = values_[n];
      if (step > 0 && !(std::fabs(value[i]) < before[i] / 4)) sloping.push_back(i);
    }
    moving_.clear();
    for (const std::size_t i : sloping) moving_.push_back(out[i].point);
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
      foot = {next, norm(next - points[i].point), gradient[i]};
      return remains <= accuracy;
    });
  }
}

}  // namespace meso::implicit
