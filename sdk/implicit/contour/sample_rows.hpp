// SPDX-License-Identifier: Apache-2.0
#pragma once
// The rows of samples that one thread looks at: a plane, and the row before last of the plane below.
//
// A new row takes the place of the row two before it in the plane below, which no cell needs any more; so one plane and
// two rows are enough, and every row is in the nearest cache while it is used.

#include <tbb/cache_aligned_allocator.h>

#include <cstdint>
#include <vector>

#include "layout.hpp"

namespace meso::implicit {

/// values[-1] and values[nodes] may be read and mean nothing; inside[-1] is 0, as are all bits past the last node.
struct SampleRow {
  float* values = nullptr;
  std::uint64_t* inside = nullptr;
};

class SampleRows {
 public:
  explicit SampleRows(const Layout& layout)
      : value_stride_(round_up(layout.nx, 64) + 2 * lead_values),
        word_stride_(round_up(layout.words + 1, lead_words)),
        values_(value_stride_ * (layout.ny + 3)),
        words_(lead_words + word_stride_ * (layout.ny + 3)) {
    for (std::size_t r = 0; r < layout.ny; ++r) plane_.push_back(slot(r));
    spare_[0] = slot(layout.ny);
    spare_[1] = slot(layout.ny + 1);
    outside_ = slot(layout.ny + 2);
  }

  /// Row j of the plane sampled last, or below (j = -1) and above (j = rows) it: nothing inside.
  [[nodiscard]] const SampleRow& at(std::ptrdiff_t j) const {
    return j < 0 || j >= static_cast<std::ptrdiff_t>(plane_.size()) ? outside_ : plane_[static_cast<std::size_t>(j)];
  }
  /// Nothing inside.
  [[nodiscard]] const SampleRow& outside() const { return outside_; }
  /// Where to sample the next row into, before replace().
  [[nodiscard]] const SampleRow& fresh() const { return spare_[0]; }
  /// What stood in row j - 1 before the row of this plane replaced it.
  [[nodiscard]] const SampleRow& replaced() const { return spare_[1]; }
  void replace(std::size_t j) {
    std::swap(spare_[0], spare_[1]);
    std::swap(spare_[1], plane_[j]);
  }

  [[nodiscard]] static std::uint64_t bytes(std::size_t nx, std::size_t ny) {
    return (ny + 3) * ((round_up(nx, 64) + 2 * lead_values) * sizeof(float) +
                       round_up(nx / 64 + 2, lead_words) * sizeof(std::uint64_t));
  }

 private:
  static constexpr std::size_t lead_values = 16, lead_words = 8;  // one cache line each

  static std::size_t round_up(std::size_t n, std::size_t to) { return (n + to - 1) / to * to; }
  SampleRow slot(std::size_t r) {
    return {values_.data() + r * value_stride_ + lead_values, words_.data() + lead_words + r * word_stride_};
  }

  std::size_t value_stride_, word_stride_;
  std::vector<float, tbb::cache_aligned_allocator<float>> values_;
  std::vector<std::uint64_t, tbb::cache_aligned_allocator<std::uint64_t>> words_;
  std::vector<SampleRow> plane_;
  SampleRow spare_[2];
  SampleRow outside_;
};

}  // namespace meso::implicit
