// SPDX-License-Identifier: Apache-2.0
#include "point_terms.hpp"

#include <algorithm>
#include <cmath>

#include "meso/implicit/point_function.hpp"
#include "meso/implicit/point_program.hpp"

namespace meso::implicit {
namespace {

class Quantity final : public PointFunction {
 public:
  Quantity(eval::PointQuantity quantity, const Box3& region) : quantity_(std::move(quantity)), region_(region) {}

  void values(std::span<const Vec3> points, double* out) const override {
    for (std::size_t n = 0; n < points.size(); ++n) {
      DiagnosticSink unheard;
      auto value = quantity_(points[n], unheard);
      if (!value) {
        Vec3 near = points[n];
        for (std::size_t a = 0; a < 3; ++a) near[a] = std::clamp(near[a], region_.min[a], region_.max[a]);
        value = quantity_(near, unheard);
      }
      out[n] = value.value_or(NAN);
    }
  }
  [[nodiscard]] Interval interval(const Box3&) const override { return Interval::everything(); }

 private:
  eval::PointQuantity quantity_;
  Box3 region_;
};

/// Many points walk to the surface side by side: a formula costs a fraction for many points of what it costs for one.
class LevelDistance final : public PointFunction {
 public:
  LevelDistance(const Term& f, double step, double reach) : flat_(f), f_(f), step_(step), reach_(reach) {}

  void values(std::span<const Vec3> points, double* out) const override { values_within(points, HUGE_VAL, out); }
  void values_within(std::span<const Vec3> points, double within, double* out) const override {
    f_.values(points, out);
    if (within == 0) return;  // only signs are asked for
    const double asked = std::min(within, reach_);
    std::vector<Walk> open, still_open;
    Room room;
    for (std::size_t n = 0; n < points.size(); ++n)
      if (out[n] != 0 && !std::isnan(out[n])) open.push_back({n, points[n], out[n]});
    for (int i = 0; i < most_steps && !open.empty(); ++i) {
      find_slopes(open, room);
      still_open.clear();
      for (std::size_t k = 0; k < open.size(); ++k) {
        Walk& walk = open[k];
        const Vec3 p = points[walk.n], slope = room.slopes[k];
        const double square = dot(slope, slope), steepness = std::sqrt(square);
        double distance = norm(p - walk.q);
        if (!(square > 0) || !std::isfinite(square)) {
          if (i == 0) distance = 4 * reach_;
        } else if (i == 0 && std::abs(walk.f) > 4 * asked * steepness) {
          // The surface is four times as far as anybody asks: what the slope says.
          distance = std::abs(walk.f) / steepness;
        } else {
          if (go(walk, p, slope)) still_open.push_back(walk);
          distance = norm(p - walk.q);
        }
        out[walk.n] = std::copysign(distance, out[walk.n]);
      }
      open.swap(still_open);
      ask(open, room);
    }
  }
  [[nodiscard]] Interval interval(const Box3& box) const override {
    const Interval f = flat_.interval(box);
    return {f.lo > 0 ? 0 : -HUGE_VAL, f.hi < 0 ? 0 : HUGE_VAL, f.undefined};
  }

 private:
  struct Walk {
    std::size_t n;  ///< of the point
    Vec3 q;
    double f;
  };
  /// For what is asked together.
  struct Room {
    std::vector<Vec3> points, slopes;
    std::vector<double> f;
  };

  /// Down to the surface, and along it towards the point below p. False where that was the last step.
  [[nodiscard]] bool go(Walk& walk, Vec3 p, Vec3 slope) const {
    const double square = dot(slope, slope);
    const Vec3 way = p - walk.q;
    const Vec3 down = (-walk.f / square) * slope, along = way - (dot(way, slope) / square) * slope;
    const Vec3 move = down + along;
    const double length = norm(move);
    walk.q = walk.q + (length > step_ ? step_ / length : 1) * move;
    // What is left of the way along the surface counts with its square.
    return norm(down) > 1e-6 * step_ || dot(along, along) > 2e-6 * step_ * norm(p - walk.q);
  }
  /// Differences.
  void find_slopes(std::span<const Walk> walks, Room& room) const {
    const double h = 1e-6 * step_;
    room.points.clear();
    for (const Walk& w : walks)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        room.points.push_back(w.q);
        room.points.back()[axis] += h;
      }
    room.f.resize(room.points.size());
    f_.values(room.points, room.f.data());
    room.slopes.resize(walks.size());
    for (std::size_t k = 0; k < walks.size(); ++k)
      for (std::size_t axis = 0; axis < 3; ++axis)
        room.slopes[k][axis] =
            (room.f[3 * k + axis] - walks[k].f) / (room.points[3 * k + axis][axis] - walks[k].q[axis]);
  }
  void ask(std::span<Walk> walks, Room& room) const {
    room.points.clear();
    for (const Walk& w : walks) room.points.push_back(w.q);
    room.f.resize(room.points.size());
    f_.values(room.points, room.f.data());
    for (std::size_t k = 0; k < walks.size(); ++k) walks[k].f = room.f[k];
  }

  static constexpr int most_steps = 12;
  FlatTerm flat_;
  PointProgram f_;
  double step_, reach_;
};

class Phase final : public PointFunction {
 public:
  Phase(std::shared_ptr<const AxisPhase> phase, const Term& coordinate)
      : phase_(std::move(phase)), coordinate_(coordinate) {}

  void values(std::span<const Vec3> points, double* out) const override {
    coordinate_.values(points, {out, points.size()});
    for (std::size_t n = 0; n < points.size(); ++n) out[n] = phase_->at(out[n]);
  }
  [[nodiscard]] Interval interval(const Box3& box) const override { return phase_->at(coordinate_.interval(box)); }

 private:
  std::shared_ptr<const AxisPhase> phase_;
  FlatTerm coordinate_;
};

}  // namespace

Term quantity_term(eval::PointQuantity quantity, const Box3& region) {
  return Term::external(std::make_shared<const Quantity>(std::move(quantity), region));
}

Term distance_to_level(const Term& f, double step, double reach) {
  return Term::external(std::make_shared<const LevelDistance>(f, step, reach));
}

Term phase_term(std::shared_ptr<const AxisPhase> phase, const Term& coordinate) {
  return Term::external(std::make_shared<const Phase>(std::move(phase), coordinate));
}

// Gauss' rule of three points in each of the steps: exact to the sixth power of the step, as is enough for any size
// that changes over more than a few steps.
AxisPhase::AxisPhase(const Term& size, double start, double from, double to) : from_(std::min(start, from)) {
  constexpr int steps = 4096;
  const double end = std::max(start, to);
  spacing_ = (end - from_) / steps;
  const FlatTerm flat(size);
  const auto slope = [&](double q) { return 1 / flat.value({q, 0, 0}); };
  const double side = std::sqrt(0.6) / 2;
  double sum = 0;
  phase_.push_back(0);
  slope_.push_back(slope(from_));
  for (int i = 0; i < steps; ++i) {
    const double left = from_ + i * spacing_;
    sum += spacing_ / 18 *
           (5 * slope(left + (0.5 - side) * spacing_) + 8 * slope(left + 0.5 * spacing_) +
            5 * slope(left + (0.5 + side) * spacing_));
    phase_.push_back(sum);
    slope_.push_back(slope(left + spacing_));
  }
  const double at_start = at(start);
  for (double& p : phase_) p -= at_start;
}

double AxisPhase::at(double q) const {
  const double t = (q - from_) / spacing_;
  const auto last = phase_.size() - 1;
  if (!(t > 0)) return phase_.front() + (q - from_) * slope_.front();
  if (t >= static_cast<double>(last)) return phase_[last] + (t - static_cast<double>(last)) * spacing_ * slope_[last];
  const auto i = static_cast<std::size_t>(t);
  const double s = t - static_cast<double>(i), r = 1 - s;
  return phase_[i] * r * r * (1 + 2 * s) + phase_[i + 1] * s * s * (1 + 2 * r) +
         spacing_ * s * r * (r * slope_[i] - s * slope_[i + 1]);
}

}  // namespace meso::implicit
