// SPDX-License-Identifier: Apache-2.0
#pragma once
// One row of samples in memory that samplers may write to.
//
//   SampledRow row(grid.nodes[0]);
//   sampler->begin_slab(k, k + 1);
//   row.sample(*sampler, j, k);
//   row.inside(i);   row.count_inside(0, 4);
//
// Thread rule: one thread.

#include "meso/implicit/grid_source.hpp"

namespace meso::implicit {

class SampledRow {
 public:
  explicit SampledRow(std::int32_t nodes);
  SampledRow(const SampledRow&) = delete;
  SampledRow& operator=(const SampledRow&) = delete;
  ~SampledRow();

  void sample(GridSampler& sampler, std::int32_t j, std::int32_t k) { sampler.row(j, k, values_, inside_); }
  [[nodiscard]] bool inside(std::int32_t i) const { return inside_[i / 64] >> i % 64 & 1; }
  /// Of `count` nodes from `first` on.
  [[nodiscard]] std::int32_t count_inside(std::int32_t first, std::int32_t count) const;
  /// What GridSampler::row() says of values holds: good at crossed edges only.
  [[nodiscard]] float value(std::int32_t i) const { return values_[i]; }

 private:
  float* values_;
  std::uint64_t* inside_;
};

}  // namespace meso::implicit
