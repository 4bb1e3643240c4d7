// SPDX-License-Identifier: Apache-2.0
#include "primitive_index.hpp"

#include <algorithm>

#include "affine_map.hpp"

namespace meso::implicit {

PrimitiveIndex::PrimitiveIndex(std::vector<Primitive> primitives, const std::optional<Repetition>& repetition)
    : primitives_(std::move(primitives)), repetition_(repetition) {
  if (!repetition_) {
    if (primitives_.empty()) return;
    nodes_.emplace_back();
    build(0, 0, static_cast<std::uint32_t>(primitives_.size()));
    box_ = nodes_.front().box;
    return;
  }
  inverse_ = inverse(repetition_->steps);
  for (std::size_t i = 0; i < 9; ++i) absolute_inverse_.m[i] = std::abs(inverse_.m[i]) * (1 + 1e-12);
  Vec3 last;
  for (std::size_t a = 0; a < 3; ++a) last[a] = static_cast<double>(repetition_->count[a] - 1);
  for (const Primitive& p : primitives_) {
    const Vec3 half = 0.5 * (p.box.max - p.box.min);
    places_.push_back(inverse_ * (p.box.min + half));
    reaches_.push_back(absolute_inverse_ * half);
    for (unsigned corner = 0; corner < 8; ++corner) {
      const Vec3 d =
          repetition_->steps * Vec3{corner & 1 ? last.x : 0, corner & 2 ? last.y : 0, corner & 4 ? last.z : 0};
      box_.extend(p.box.min + d);
      box_.extend(p.box.max + d);
    }
  }
}

std::uint64_t PrimitiveIndex::bytes() const {
  return primitives_.capacity() * sizeof(Primitive) + nodes_.capacity() * sizeof(Node) +
         (places_.capacity() + reaches_.capacity()) * sizeof(Vec3);
}

// Halved at the median along the longest side of the middles' box: balanced, so 64 open nodes are plenty.
void PrimitiveIndex::build(std::uint32_t node, std::uint32_t first, std::uint32_t last) {
  Box3 box, middles;
  for (std::uint32_t i = first; i < last; ++i) {
    box.extend(primitives_[i].box.min);
    box.extend(primitives_[i].box.max);
    middles.extend(0.5 * (primitives_[i].box.min + primitives_[i].box.max));
  }
  nodes_[node].box = box;
  if (last - first <= leaf_size) {
    nodes_[node].first = first;
    nodes_[node].count = last - first;
    return;
  }
  const Vec3 size = middles.max - middles.min;
  const std::size_t axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::uint32_t half = first + (last - first) / 2;
  const auto at = [&](std::uint32_t i) { return primitives_.begin() + i; };
  std::nth_element(at(first), at(half), at(last), [axis](const Primitive& a, const Primitive& b) {
    return a.box.min[axis] + a.box.max[axis] < b.box.min[axis] + b.box.max[axis];
  });
  const auto child = static_cast<std::uint32_t>(nodes_.size());
  nodes_[node].first = child;
  nodes_.resize(nodes_.size() + 2);
  build(child, first, half);
  build(child + 1, half, last);
}

}  // namespace meso::implicit
