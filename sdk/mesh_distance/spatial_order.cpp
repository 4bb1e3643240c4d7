// SPDX-License-Identifier: Apache-2.0
#include "spatial_order.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <utility>

namespace meso::implicit {
namespace {

constexpr unsigned bits_per_axis = 12, digit_bits = 9, digits = 3 * bits_per_axis / digit_bits;
constexpr std::size_t digit_values = 1u << digit_bits;

/// 12 bits, two zeros before each.
std::uint64_t spread(std::uint64_t x) {
  x = (x | x << 16) & 0x0000ff0000ffu;
  x = (x | x << 8) & 0x00f00f00f00fu;
  x = (x | x << 4) & 0x0c30c30c30c3u;
  return (x | x << 2) & 0x249249249249u;
}

class Curve {
 public:
  explicit Curve(const Box3& box) : min_(box.min) {
    const Vec3 size = box.max - box.min;
    const double largest = std::max({size.x, size.y, size.z});
    if (largest > 0) scale_ = ((1u << bits_per_axis) - 1) / largest;
  }
  [[nodiscard]] std::uint64_t place(Vec3 a, Vec3 b, Vec3 c) const {
    std::uint64_t out = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const double middle = 0.5 * (std::min({a[i], b[i], c[i]}) + std::max({a[i], b[i], c[i]}));
      out |= spread(static_cast<std::uint64_t>((middle - min_[i]) * scale_)) << i;
    }
    return out;
  }

 private:
  Vec3 min_;
  double scale_ = 0;
};

/// One stable pass over one digit of the place.
void sort_by_digit(const std::vector<Placed>& from, std::vector<Placed>& to, unsigned shift) {
  std::vector<std::size_t> next(digit_values, 0);
  const auto digit = [shift](const Placed& p) { return (p.place() >> shift) & (digit_values - 1); };
  for (const Placed& p : from) ++next[digit(p)];
  std::size_t sum = 0;
  for (std::size_t& n : next) sum += std::exchange(n, sum);
  for (const Placed& p : from) to[next[digit(p)]++] = p;
}

}  // namespace

std::vector<Placed> spatial_order(const TriangleMesh& mesh, const Box3& box) {
  const Curve curve(box);
  std::vector<Placed> order(mesh.triangles.size()), other(order.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, order.size(), 1 << 14), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      if (i + prefetch_distance < order.size())
        prefetch_points(mesh, static_cast<std::uint32_t>(i + prefetch_distance));
      const auto& [a, b, c] = mesh.triangles[i];
      order[i] = {curve.place(mesh.points[a], mesh.points[b], mesh.points[c]), i};
    }
  });
  for (unsigned d = 0; d < digits; ++d) {
    sort_by_digit(order, other, d * digit_bits);
    order.swap(other);
  }
  return order;
}

}  // namespace meso::implicit
