// SPDX-License-Identifier: Apache-2.0
#include "brick_contents.hpp"

#include <array>
#include <cmath>

namespace meso::implicit {
namespace {

/// Neighbouring cells both place what they share, up to rounding.
bool are_one(const Capsule& a, const Capsule& b) {
  constexpr double rounding = 1e-10;
  const auto near = [](Vec3 u, Vec3 v) {
    const Vec3 d = u - v;
    return std::abs(d.x) + std::abs(d.y) + std::abs(d.z) < rounding;
  };
  return a.radius == b.radius &&
         ((near(a.from, b.from) && near(a.axis, b.axis)) || (near(a.from + a.axis, b.from) && near(a.axis, -b.axis)));
}

}  // namespace

void BrickContents::begin(const BrickBox& brick, const Nearness& nearness) {
  brick_ = brick;
  box_ = {brick.middle - brick.half, brick.middle + brick.half};
  nearness_ = nearness;
  calls_ = 0;
  first_field_ = fields_.size();
  nearest_ = HUGE_VAL;
  filled_ = false;
  candidates_.clear();
  sources_.clear();
}

void BrickContents::look_at(const Primitive& primitive, Vec3 displacement) {
  const std::uint32_t call = calls_++;
  if (primitive.is_capsule()) {
    Capsule capsule = primitive.capsule;
    capsule.from += displacement;
    const double distance = axis_distance(capsule, brick_.middle) - capsule.radius;
    if (distance > brick_.radius + nearness_.margin) return;
    nearest_ = std::min(nearest_, distance);
    candidates_.push_back({capsule, distance, call});
  } else {
    const Interval values = primitive.placed.interval({box_.min - displacement, box_.max - displacement});
    if (values.lo > nearness_.margin) return;
    filled_ = filled_ || (!nearness_.is_exact && values.hi < -nearness_.margin && !values.undefined);
    sources_.push_back({static_cast<std::uint32_t>(fields_.size() - first_field_), call});
    fields_.push_back(primitive.moved_by(displacement).placed);
  }
}

Brick BrickContents::finish() {
  Brick brick;
  brick.field = static_cast<std::uint32_t>(first_field_);
  brick.capsule = static_cast<std::uint32_t>(capsules_.size());
  keep_candidates(nearest_ + 2 * brick_.radius, capsules_.size());
  if (filled_ || (!nearness_.is_exact && nearest_ + brick_.radius < -nearness_.margin)) {
    fields_.resize(first_field_);
    capsules_.resize(brick.capsule);
    brick.state = Brick::State::inside;
    return brick;
  }
  brick.fields = static_cast<std::uint32_t>(fields_.size()) - brick.field;
  brick.capsules = static_cast<std::uint32_t>(capsules_.size()) - brick.capsule;
  brick.state = brick.capsules + brick.fields == 0 ? Brick::State::outside : Brick::State::mixed;
  return brick;
}

/// Those that may be the nearest somewhere in the brick, once each, equal radii together.
void BrickContents::keep_candidates(double farthest, std::size_t first) {
  std::stable_sort(candidates_.begin(), candidates_.end(),
                   [](const Candidate& a, const Candidate& b) { return a.capsule.radius > b.capsule.radius; });
  const std::size_t fields = fields_.size() - first_field_;
  for (const Candidate& c : candidates_) {
    if (c.distance > farthest) continue;
    std::size_t place = first;
    while (place < capsules_.size() && !are_one(c.capsule, capsules_[place])) ++place;
    if (place == capsules_.size()) capsules_.push_back(c.capsule);
    sources_.push_back({static_cast<std::uint32_t>(fields + place - first), c.call});
  }
}

void BrickSampler::sample(const BrickContents& contents, const Brick& brick, const Line& line, const double* x,
                          double* out) {
  row_(contents.capsules(brick), brick.capsules, line, x, out);
  for (std::size_t i = 0; i < strut_lanes; ++i) out[i] = out[i] < far_ ? out[i] : far_;
  for (const PlacedField& field : contents.fields(brick)) {
    std::array<Vec3, strut_lanes> points;
    std::array<double, strut_lanes> values;
    for (std::size_t i = 0; i < strut_lanes; ++i) points[i] = line.origin + x[i] * line.direction;
    field.values(points, local_, values.data());
    for (std::size_t i = 0; i < strut_lanes; ++i) out[i] = std::min(out[i], values[i]);
  }
}

}  // namespace meso::implicit
