// SPDX-License-Identifier: Apache-2.0
#pragma once
// For fields whose signs are cheap and whose values are dear: gets the signs of a whole slab first, then asks for
// values only where an edge inside the slab is crossed, all at once.

#include <tbb/cache_aligned_allocator.h>

#include <functional>
#include <vector>

#include "layout.hpp"
#include "meso/implicit/grid_source.hpp"

namespace meso::implicit {

class EdgeEndSampler final : public GridSampler {
 public:
  /// `go_on` is asked now and then; after it has said no, samples mean nothing. `exact_within` is the source's.
  EdgeEndSampler(const Grid& grid, std::unique_ptr<GridSampler> signs, double exact_within,
                 std::function<bool()> go_on);

  void begin_slab(std::int32_t first, std::int32_t last) override;
  void row(std::int32_t j, std::int32_t k, float* values, std::uint64_t* inside) override;
  void values_at(std::span<const Vec3> points, double* out) override { source_->values_at(points, out); }

  /// What it holds now.
  [[nodiscard]] std::uint64_t bytes() const;

 private:
  [[nodiscard]] std::uint64_t* at(std::int32_t j, std::int32_t k) { return signs_.data() + row_of(j, k) * words_; }
  [[nodiscard]] std::size_t row_of(std::int32_t j, std::int32_t k) const {
    return static_cast<std::size_t>(k - first_) * rows_ + static_cast<std::size_t>(j);
  }
  void keep_exact();
  std::size_t mark_ends(std::int32_t j, std::int32_t k);
  void take_values(std::int32_t j, std::int32_t k);
  void flush();

  Grid grid_;
  std::unique_ptr<GridSampler> source_;
  float exact_within_;
  std::function<bool()> go_on_;
  std::size_t rows_, words_;
  std::int32_t first_ = 0, last_ = 0;
  std::vector<std::uint64_t, tbb::cache_aligned_allocator<std::uint64_t>> signs_;
  std::vector<float, tbb::cache_aligned_allocator<float>> row_values_;  // meant where exact
  std::vector<std::uint64_t> exact_;                                    // by node
  std::vector<float> exact_values_;                                     // of those nodes
  std::vector<std::size_t> first_exact_;                                // by row
  std::vector<std::uint64_t> ends_;                                     // of crossed edges, by node
  std::vector<std::size_t> first_value_;                                // by row
  std::vector<Vec3> points_;                                            // some rows' worth, not exact
  std::vector<std::size_t> places_;                                     // of their values
  std::vector<double> computed_;
  std::vector<float> values_;
};

}  // namespace meso::implicit
