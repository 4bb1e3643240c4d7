// SPDX-License-Identifier: Apache-2.0
#include "boundary_rule.hpp"

#include <cmath>
#include <vector>

#include "meso/eval/bounds.hpp"

namespace meso::implicit {
namespace {

constexpr double decided_within = 2e-6;  ///< R-5.12.7's 1e-6, and the seam by which joined bodies have grown
constexpr double smallest_part = 1.0 / 32;

/// A part of a region: fractions of its three ranges.
struct Part3 {
  Vec3 middle{0.5, 0.5, 0.5};
  double half = 0.5;
};

class Region {
 public:
  Region(const eval::Shape& shape, const Affine& frame) : frame_(frame) {
    if (const auto* box = std::get_if<eval::BoxShape>(&shape.value)) box_ = *box;
    if (const auto* element = std::get_if<eval::VolumeElementShape>(&shape.value)) element_ = *element;
  }
  [[nodiscard]] Vec3 point(Vec3 fraction) const {
    if (!element_) {
      Vec3 p = box_.corner;
      for (std::size_t a = 0; a < 3; ++a) p[a] += fraction[a] * box_.size[a];
      return frame_ * p;
    }
    std::vector<double> q(element_->system->axes().size(), 0);
    for (std::size_t a = 0; a < 3; ++a)
      q[element_->axes[a]] = element_->from[a] + fraction[a] * (element_->to[a] - element_->from[a]);
    return element_->system->point(q);
  }
  /// No point of the part is farther from its middle.
  [[nodiscard]] double radius(const Part3& part) const {
    if (!element_) {
      Vec3 far;
      for (std::size_t a = 0; a < 3; ++a) {
        const Vec3 edge = part.half * box_.size[a] * frame_.linear.column(a);
        for (std::size_t i = 0; i < 3; ++i) far[i] += std::abs(edge[i]);
      }
      return norm(far);
    }
    eval::VolumeElementShape small = *element_;
    for (std::size_t a = 0; a < 3; ++a) {
      const double size = element_->to[a] - element_->from[a];
      small.from[a] = element_->from[a] + (part.middle[a] - part.half) * size;
      small.to[a] = element_->from[a] + (part.middle[a] + part.half) * size;
    }
    const Box3 box = *eval::bounds({small});
    return 0.5 * (box.max.x - box.min.x);
  }

 private:
  Affine frame_;
  eval::BoxShape box_;
  std::optional<eval::VolumeElementShape> element_;
};

class Search {
 public:
  Search(const BoundaryQuestion& question, const Field& body, const Region& region, const Field* own)
      : question_(question), body_(body), region_(region), own_(own) {}

  /// Is there a point that proves the cell not inside, or that it meets the body?
  bool finds() const {
    for (unsigned corner = 0; corner < 8; ++corner)
      if (proves(region_.point({corner & 1 ? 1.0 : 0.0, corner & 2 ? 1.0 : 0.0, corner & 4 ? 1.0 : 0.0}))) return true;
    std::vector<Part3> open{Part3{}};
    while (!open.empty()) {
      const Part3 part = open.back();
      open.pop_back();
      const Vec3 middle = region_.point(part.middle);
      if (proves(middle)) return true;
      if (part.half <= smallest_part || is_settled(middle, region_.radius(part))) continue;
      for (unsigned corner = 0; corner < 8; ++corner) {
        const double h = part.half / 2;
        open.push_back({part.middle + Vec3{corner & 1 ? h : -h, corner & 2 ? h : -h, corner & 4 ? h : -h}, h});
      }
    }
    return false;
  }

 private:
  [[nodiscard]] bool proves(Vec3 p) const {
    if (own_ != nullptr && !(own_->value(p) < 0)) return false;
    const double value = body_.value(p);
    if (!question_.inside) return value < -decided_within;
    if (value > decided_within) return true;
    if (!(value > -question_.clearance + decided_within)) return false;
    return question_.clearance == 0 ? value > decided_within : is_outside_around(p);
  }
  /// Values inside a union may be less than distances: points all around have the last word.
  [[nodiscard]] bool is_outside_around(Vec3 p) const {
    for (int n = 0; n < 27; ++n) {
      const Vec3 d{n % 3 - 1.0, n / 3 % 3 - 1.0, n / 9 - 1.0};
      const double reach = question_.clearance - decided_within;
      if (n != 13 && body_.value(p + (reach / norm(d)) * d) > decided_within) return true;
    }
    return false;
  }
  /// No point within the radius can prove anything.
  [[nodiscard]] bool is_settled(Vec3 middle, double radius) const {
    if (own_ != nullptr && std::isfinite(own_->lipschitz()) && own_->value(middle) > own_->lipschitz() * radius)
      return true;
    if (!std::isfinite(body_.lipschitz())) return false;
    const double value = body_.value(middle), change = body_.lipschitz() * radius;
    return question_.inside ? value + change <= -question_.clearance + decided_within
                            : value - change >= -decided_within;
  }

  const BoundaryQuestion& question_;
  const Field& body_;
  const Region& region_;
  const Field* own_;
};

}  // namespace

bool answer(const BoundaryQuestion& question, const Field& body, const eval::Shape& region, const Affine& frame,
            const Field* own) {
  const Region where(region, frame);
  return Search(question, body, where, own).finds() != question.inside;
}

}  // namespace meso::implicit
