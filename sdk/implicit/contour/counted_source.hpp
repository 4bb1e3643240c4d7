// SPDX-License-Identifier: Apache-2.0
#pragma once
// What a mesh to a tolerance has cost in samples.

#include <atomic>
#include <memory>
#include <utility>

#include "meso/implicit/grid_source.hpp"

namespace meso::implicit {

/// Counts the samples that another source gives, on its grid and wherever else they are taken.
class CountedSource final : public GridSource {
 public:
  struct Counts {
    std::uint64_t on_grids = 0;
    std::atomic<std::uint64_t> at_points{0};
  };

  CountedSource(std::unique_ptr<GridSource> source, Counts& counts) : source_(std::move(source)), counts_(counts) {
    counts_.on_grids += grid().node_count();  // planes between bricks, which two threads may sample, once
  }

  [[nodiscard]] const Grid& grid() const override { return source_->grid(); }
  [[nodiscard]] std::unique_ptr<GridSampler> sampler() const override {
    return std::make_unique<Sampler>(source_->sampler(), counts_);
  }
  [[nodiscard]] bool signs_only() const override { return source_->signs_only(); }
  [[nodiscard]] double exact_within() const override { return source_->exact_within(); }
  [[nodiscard]] std::uint64_t bytes() const override { return source_->bytes(); }

 private:
  class Sampler final : public GridSampler {
   public:
    Sampler(std::unique_ptr<GridSampler> sampler, Counts& counts) : sampler_(std::move(sampler)), counts_(counts) {}
    void begin_slab(std::int32_t first, std::int32_t last) override { sampler_->begin_slab(first, last); }
    void row(std::int32_t j, std::int32_t k, float* values, std::uint64_t* inside) override {
      sampler_->row(j, k, values, inside);
    }
    void values_at(std::span<const Vec3> points, double* out) override {
      counts_.at_points += points.size();
      sampler_->values_at(points, out);
    }

   private:
    std::unique_ptr<GridSampler> sampler_;
    Counts& counts_;
  };

  std::unique_ptr<GridSource> source_;
  Counts& counts_;
};

}  // namespace meso::implicit
