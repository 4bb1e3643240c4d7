// SPDX-License-Identifier: Apache-2.0
#include "point_terms.hpp"

#include <algorithm>
#include <cmath>

#include "meso/implicit/point_function.hpp"

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

class LevelDistance final : public PointFunction {
 public:
  LevelDistance(const Term& f, double step, double reach) : f_(f), step_(step), reach_(reach) {}

  void values(std::span<const Vec3> points, double* out) const override { values_within(points, HUGE_VAL, out); }
  void values_within(std::span<const Vec3> points, double within, double* out) const override {
    std::vector<double> f(points.size());
    f_.values(points, f);
    const double asked = std::min(within, reach_);
    for (std::size_t n = 0; n < points.size(); ++n)
      out[n] = std::isnan(f[n]) ? f[n] : std::copysign(distance(points[n], f[n], asked), f[n]);
  }
  [[nodiscard]] Interval interval(const Box3& box) const override {
    const Interval f = f_.interval(box);
    return {f.lo > 0 ? 0 : -HUGE_VAL, f.hi < 0 ? 0 : HUGE_VAL, f.undefined};
  }

 private:
  /// Where the slope at p says that the surface is four times as far as anybody asks, what the slope says.
  [[nodiscard]] double distance(Vec3 p, double f, double asked) const {
    Vec3 q = p;
    for (int i = 0; i < most_steps && f != 0; ++i) {
      const Vec3 slope = f_.gradient(q);
      const double square = dot(slope, slope);
      if (!(square > 0) || !std::isfinite(square)) return i == 0 ? 4 * reach_ : norm(p - q);
      if (i == 0 && std::abs(f) > 4 * asked * std::sqrt(square)) return std::abs(f) / std::sqrt(square);
      // Down to the surface, and along it towards the point below p.
      Vec3 move = (-f / square) * slope;
      const Vec3 way = p - q;
      move = move + (way - (dot(way, slope) / square) * slope);
      const double length = norm(move);
      q = q + (length > step_ ? step_ / length : 1) * move;
      if (length <= 1e-6 * step_) break;
      f = f_.value(q);
    }
    return norm(p - q);
  }

  static constexpr int most_steps = 12;
  FlatTerm f_;
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
