// SPDX-License-Identifier: Apache-2.0
#include "brick_contents.hpp"

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
  nearest_ = HUGE_VAL;
  candidates_.clear();
  field_candidates_.clear();
  farthest_ = HUGE_VAL;
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
    if (!values.undefined) farthest_ = std::min(farthest_, values.hi);
    field_candidates_.push_back({&primitive, displacement, values.lo, call});
  }
}

Brick BrickContents::finish() {
  Brick brick;
  brick.field = static_cast<std::uint32_t>(fields_.size());
  brick.capsule = static_cast<std::uint32_t>(capsules_.size());
  farthest_ = std::min(farthest_, nearest_ + brick_.radius);
  keep_fields();
  keep_capsules(brick.capsule);
  if (!nearness_.is_exact && farthest_ < -nearness_.margin) {
    fields_.resize(brick.field);
    capsules_.resize(brick.capsule);
    brick.state = Brick::State::inside;
    return brick;
  }
  brick.fields = static_cast<std::uint32_t>(fields_.size()) - brick.field;
  brick.capsules = static_cast<std::uint32_t>(capsules_.size()) - brick.capsule;
  brick.state = brick.capsules + brick.fields == 0 ? Brick::State::outside : Brick::State::mixed;
  return brick;
}

/// Those that may be the least somewhere in the brick.
void BrickContents::keep_fields() {
  std::uint32_t thing = 0;
  for (const FieldCandidate& c : field_candidates_) {
    const double slack = 1e-9 * (std::abs(c.least) + std::abs(farthest_));  // rounding must leave none out
    if (c.least > farthest_ + slack) continue;
    sources_.push_back({thing++, c.call});
    fields_.push_back(c.primitive->moved_by(c.displacement).placed);
  }
}

/// Likewise; once each, equal radii together.
void BrickContents::keep_capsules(std::size_t first) {
  std::stable_sort(candidates_.begin(), candidates_.end(),
                   [](const Candidate& a, const Candidate& b) { return a.capsule.radius > b.capsule.radius; });
  const auto fields = static_cast<std::uint32_t>(sources_.size());
  for (const Candidate& c : candidates_) {
    if (c.distance > nearest_ + 2 * brick_.radius) continue;
    std::size_t place = first;
    while (place < capsules_.size() && !are_one(c.capsule, capsules_[place])) ++place;
    if (place == capsules_.size()) capsules_.push_back(c.capsule);
    sources_.push_back({fields + static_cast<std::uint32_t>(place - first), c.call});
  }
}

void BrickSampler::sample(const BrickContents& contents, const Brick& brick, std::span<const Line> lines,
                          const double* x, double* out) {
  const std::size_t count = lines.size() * strut_lanes;
  for (std::size_t l = 0; l < lines.size(); ++l)
    row_(contents.capsules(brick), brick.capsules, lines[l], x, out + l * strut_lanes);
  for (std::size_t i = 0; i < count; ++i) out[i] = out[i] < far_ ? out[i] : far_;
  if (brick.fields == 0) return;
  points_.clear();
  for (const Line& line : lines)
    for (std::size_t i = 0; i < strut_lanes; ++i) points_.push_back(line.origin + x[i] * line.direction);
  values_.resize(count);
  for (const PlacedField& field : contents.fields(brick)) {
    field.values(points_, local_, values_.data());
    for (std::size_t i = 0; i < count; ++i) out[i] = std::min(out[i], values_[i]);
  }
}

}  // namespace meso::implicit
