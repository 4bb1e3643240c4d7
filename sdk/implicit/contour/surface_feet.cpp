// SPDX-License-Identifier: Apache-2.0
#include "surface_feet.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace meso::implicit {
namespace {

constexpr std::size_t batch = 4096;
// What is kept of a point while it is asked is ten times the point: so many at a time.
constexpr std::size_t part = 1 << 14;
constexpr int most_steps = 8;

}  // namespace

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
  out.resize(points.size());
  values.resize(points.size());
  for (std::size_t first = 0; first < points.size(); first += part) {
    const auto some = points.subspan(first, std::min(part, points.size() - first));
    around_.clear();
    for (const Vec3& p : some)
      for (std::size_t axis = 0; axis < 4; ++axis) {
        around_.push_back(p);
        if (axis < 3) around_.back()[axis] += 1e-5 * grid_.spacing(axis);
      }
    ask(around_, around_values_);
    for (std::size_t i = 0; i < some.size(); ++i) {
      const double here = values[first + i] = around_values_[4 * i + 3];
      for (std::size_t axis = 0; axis < 3; ++axis)
        out[first + i][axis] = (around_values_[4 * i + axis] - here) / (around_[4 * i + axis][axis] - some[i][axis]);
    }
  }
}

// Those whose distance is not known to be less than `limit`; the others' is in `out`, and the values of all in values_.
std::vector<std::size_t> SurfaceFeet::not_certain(std::span<const PointNearSurface> points, double limit,
                                                  std::vector<double>& out) {
  // Slopes nearby tell the distance to within a third, but for wedges: there, by no more than a tenth of the limit, it
  // is taken on trust.
  constexpr double likely = 0.7, trusted = 0.1, beyond = 1.25;
  moving_.clear();
  for (const PointNearSurface& p : points) moving_.push_back(p.point);
  ask(moving_, values_);
  moving_.clear();
  out.resize(points.size());
  std::vector<std::size_t> open, probed;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const PointNearSurface& p = points[i];
    out[i] = values_[i] == 0 ? 0 : std::fabs(values_[i]) / p.slope;
    if (out[i] <= trusted * limit) continue;
    const double length = norm(p.ahead);
    if (!(out[i] <= likely * limit && length > 0)) {
      open.push_back(i);
      continue;
    }
    out[i] *= beyond;
    moving_.push_back(p.point + (values_[i] < 0 ? 1 : -1) * out[i] / length * p.ahead);
    probed.push_back(i);
  }
  ask(moving_, beyond_values_);
  for (std::size_t n = 0; n < probed.size(); ++n) {
    const std::size_t i = probed[n];
    const double here = std::fabs(values_[i]), there = std::fabs(beyond_values_[n]);
    if ((beyond_values_[n] < 0) == (values_[i] < 0)) open.push_back(i);
    // The secant's root; somewhat more, for a field that bends.
    if (std::isfinite(there)) out[i] *= std::min(1.0, 1.1 * here / (here + there));
  }
  return open;
}

void SurfaceFeet::distances(std::span<const PointNearSurface> points, double limit, std::vector<double>& out) {
  out.clear();
  std::vector<double> some;
  for (std::size_t first = 0; first < points.size(); first += part) {
    distances_of_part(points.subspan(first, std::min(part, points.size() - first)), limit, some);
    out.insert(out.end(), some.begin(), some.end());
  }
}

void SurfaceFeet::distances_of_part(std::span<const PointNearSurface> points, double limit, std::vector<double>& out) {
  const std::vector<std::size_t> which = not_certain(points, limit, out);
  std::vector<PointNearSurface> open;
  for (const std::size_t i : which) {
    open.push_back(points[i]);
    open.back().value = values_[i];
  }
  std::vector<double> found;
  find_distances(open, limit, found);
  for (std::size_t n = 0; n < which.size(); ++n) out[which[n]] = found[n];
}

// To the foot and a little beyond; and along the mesh's normal, since beside an edge of the surface, the field may be
// that of the sheet that is farther away. Where that tells of more than a curved surface would have, all around. Their
// values are known.
void SurfaceFeet::find_distances(std::span<const PointNearSurface> points, double limit, std::vector<double>& out) {
  constexpr double unlikely = 0.3;  // the height of an arc of 70 degrees over half of its chord
  std::vector<Foot> found;
  feet(points, 0.01 * limit, found);
  std::vector<Vec3> beyond;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 way = found[i].point - points[i].point;
    beyond.push_back(found[i].point + 0.03 * (1 + limit / std::max(norm(way), 1e-6 * limit)) * way);
    // Over a crease, the way to the one sheet goes along the other.
    const double length = norm(points[i].ahead);
    if (length > 0) beyond.back() += (points[i].value < 0 ? 0.03 : -0.03) * limit / length * points[i].ahead;
  }
  ask(beyond, beyond_values_);
  std::vector<Ray> rays;
  std::vector<std::size_t> which;
  out.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool certain = (beyond_values_[i] < 0) != (points[i].value < 0);
    out[i] = std::min(points[i].most, certain ? norm(beyond[i] - points[i].point) : HUGE_VAL);
    const double length = norm(points[i].ahead);
    if (!(out[i] > limit) || !(length > 0)) continue;
    const double reach = std::min(out[i], 2 * cell());
    rays.push_back({points[i].point, reach / length * points[i].ahead});
    which.push_back(i);
  }
  shoot(rays, limit / 20);
  measure_in_planes(points, limit, out);
  std::vector<PointNearSurface> lost;
  std::vector<std::size_t> which_lost;
  for (std::size_t n = 0; n < rays.size(); ++n) {
    const std::size_t i = which[n];
    if (rays[n].hit) out[i] = std::min(out[i], norm(rays[n].from - points[i].point) + limit / 20);
    if (!(out[i] > limit) || !(out[i] > unlikely * points[i].most) || !std::isfinite(out[i])) continue;
    lost.push_back(points[i]);
    lost.back().most = out[i];
    which_lost.push_back(i);
  }
  const std::vector<Ray> found_around = search(lost, limit / 20);
  for (std::size_t n = 0; n < lost.size(); ++n)
    if (found_around[n].hit)
      out[which_lost[n]] = std::min(out[which_lost[n]], norm(found_around[n].from - lost[n].point) + limit / 20);
}

// Of points on the box's sides that no way within them leads from: where the solid is right behind them, these sides
// are its surface.
void SurfaceFeet::measure_in_planes(std::span<const PointNearSurface> points, double limit, std::vector<double>& out) {
  std::vector<Vec3> behind;
  std::vector<std::size_t> which;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].planes == 0 || out[i] < points[i].most) continue;
    behind.push_back(points[i].point);
    for (unsigned axis = 0; axis < 3; ++axis) {
      const unsigned sides = points[i].planes >> 2 * axis & 3U;
      if (sides != 0) behind.back()[axis] += (sides == 1 ? 1 : -1) * limit / 20;
    }
    which.push_back(i);
  }
  ask(behind, beyond_values_);
  for (std::size_t n = 0; n < which.size(); ++n)
    if (beyond_values_[n] < 0) out[which[n]] = limit / 20;
}

std::vector<Ray> SurfaceFeet::search(std::span<const PointNearSurface> points, double accuracy) {
  std::vector<Vec3> directions;
  for (int n = 0; n < 27; ++n)
    if (n != 13) directions.push_back({n % 3 - 1.0, n / 3 % 3 - 1.0, n / 9 - 1.0});
  std::vector<Ray> result, rays;
  std::vector<std::size_t> open, of_ray;
  for (const PointNearSurface& p : points) {
    open.push_back(result.size());
    result.push_back({p.point, {}});
  }
  for (const double share : {0.0625, 0.125, 0.25, 0.5, 1.0}) {
    moving_.clear();
    for (const std::size_t i : open) {
      moving_.push_back(points[i].point);
      for (const Vec3& d : directions) moving_.push_back(points[i].point + share * points[i].most / norm(d) * d);
    }
    ask(moving_, values_);
    std::size_t at = 0;
    std::erase_if(open, [&](std::size_t i) {
      const std::size_t before = rays.size();
      for (std::size_t d = at + 1; d <= at + directions.size(); ++d) {
        if ((values_[d] < 0) == (values_[at] < 0)) continue;
        rays.push_back({points[i].point, (values_[at] < 0 ? 1 : -1) * (moving_[d] - points[i].point)});
        of_ray.push_back(i);
      }
      at += directions.size() + 1;
      return rays.size() > before;
    });
  }
  shoot(rays, accuracy);
  const auto far = [&](const Ray& ray, std::size_t i) { return norm(ray.from - points[i].point); };
  for (std::size_t n = 0; n < rays.size(); ++n) {
    Ray& best = result[of_ray[n]];
    if (rays[n].hit && (!best.hit || far(rays[n], of_ray[n]) < far(best, of_ray[n]))) best = rays[n];
  }
  return result;
}

void SurfaceFeet::check(std::span<const Vec3> points, std::span<const Vec3> directions, double accuracy,
                        std::vector<char>& on_surface) {
  on_surface.assign(points.size(), 0);
  for (std::size_t way = 0; way < 4; ++way) {
    moving_.clear();
    std::vector<std::size_t> open;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (on_surface[i] != 0) continue;
      Vec3 step = accuracy / norm(directions[i]) * directions[i];
      if (way > 0) step = {}, step[way - 1] = accuracy;
      moving_.push_back(points[i] - step), moving_.push_back(points[i] + step);
      open.push_back(i);
    }
    ask(moving_, values_);
    for (std::size_t n = 0; n < open.size(); ++n)
      on_surface[open[n]] = (values_[2 * n] < 0) != (values_[2 * n + 1] < 0) ? 1 : 0;
  }
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
