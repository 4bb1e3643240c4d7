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

/// Three whole numbers side by side, so that one sum adds all of them.
constexpr unsigned lane_bits = 20;
constexpr std::uint64_t lane_mask = (1u << lane_bits) - 1;

class Curve {
 public:
  explicit Curve(const Box3& box) : min_(box.min) {
    const Vec3 size = box.max - box.min;
    const double largest = std::max({size.x, size.y, size.z});
    // A sum of three corners, without its last two bits, has to fit.
    if (largest > 0) scale_ = ((1u << bits_per_axis) - 1) * 4 / 3.0 / largest;
  }
  [[nodiscard]] std::uint64_t lanes(Vec3 p) const {
    std::uint64_t out = 0;
    for (unsigned i = 0; i < 3; ++i) out |= static_cast<std::uint64_t>((p[i] - min_[i]) * scale_) << i * lane_bits;
    return out;
  }
  /// Where the middle of a triangle lies, from the sum of its corners' lanes.
  [[nodiscard]] static std::uint64_t place(std::uint64_t sum) {
    std::uint64_t out = 0;
    for (unsigned i = 0; i < 3; ++i) out |= spread((sum >> i * lane_bits & lane_mask) >> 2) << i;
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

using Blocks = tbb::blocked_range<std::size_t>;
constexpr std::size_t grain = 1 << 14;

}  // namespace

std::vector<Placed> spatial_order(const TriangleMesh& mesh, const Box3& box, StopPoll& stop) {
  const Curve curve(box);
  std::vector<std::uint64_t> lanes(mesh.points.size());
  tbb::parallel_for(Blocks(0, lanes.size(), grain), [&](const Blocks& range) {
    if (stop()) return;
    for (std::size_t i = range.begin(); i != range.end(); ++i) lanes[i] = curve.lanes(mesh.points[i]);
  });
  std::vector<Placed> order(mesh.triangles.size()), other(order.size());
  tbb::parallel_for(Blocks(0, order.size(), grain), [&](const Blocks& range) {
    if (stop()) return;
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      // Triangles may refer to points all over the memory.
      if (i + prefetch_distance < order.size())
        for (const std::uint32_t p : mesh.triangles[i + prefetch_distance]) __builtin_prefetch(lanes.data() + p);
      const auto& [a, b, c] = mesh.triangles[i];
      order[i] = {Curve::place(lanes[a] + lanes[b] + lanes[c]), i};
    }
  });
  for (unsigned d = 0; d < digits && !stop(); ++d) {
    sort_by_digit(order, other, d * digit_bits);
    order.swap(other);
  }
  return order;
}

}  // namespace meso::implicit
