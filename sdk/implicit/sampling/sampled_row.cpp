// SPDX-License-Identifier: Apache-2.0
#include "meso/implicit/sampled_row.hpp"

#include <new>

namespace meso::implicit {
namespace {

constexpr std::align_val_t alignment{64};

template <class T>
T* allocate(std::size_t count) {
  return static_cast<T*>(::operator new((count * sizeof(T) + 63) / 64 * 64, alignment));
}

std::size_t words(std::int32_t nodes) { return (static_cast<std::size_t>(nodes) + 63) / 64; }

}  // namespace

SampledRow::SampledRow(std::int32_t nodes)
    : values_(allocate<float>(words(nodes) * 64)), inside_(allocate<std::uint64_t>(words(nodes))) {}

SampledRow::~SampledRow() {
  ::operator delete(values_, alignment);
  ::operator delete(inside_, alignment);
}

std::int32_t SampledRow::count_inside(std::int32_t first, std::int32_t count) const {
  std::int32_t n = 0;
  for (std::int32_t i = first; i < first + count; ++i) n += inside(i) ? 1 : 0;
  return n;
}

}  // namespace meso::implicit
