// SPDX-License-Identifier: Apache-2.0
#pragma once
// A field given by any function, for tests.

#include <atomic>
#include <cmath>
#include <functional>
#include <memory>

#include "meso/implicit/grid_source.hpp"

namespace meso::implicit {

class FunctionSource final : public GridSource {
 public:
  using Function = std::function<double(Vec3)>;

  FunctionSource(Grid grid, Function f, bool signs_only = false, double exact_within = 0)
      : grid_(grid), f_(std::move(f)), signs_only_(signs_only), exact_within_(exact_within) {}

  [[nodiscard]] const Grid& grid() const override { return grid_; }
  [[nodiscard]] bool signs_only() const override { return signs_only_; }
  [[nodiscard]] double exact_within() const override { return exact_within_; }
  /// How many single points were asked for.
  [[nodiscard]] std::size_t asked() const { return asked_; }
  [[nodiscard]] std::unique_ptr<GridSampler> sampler() const override { return std::make_unique<Sampler>(*this); }

 private:
  class Sampler final : public GridSampler {
   public:
    explicit Sampler(const FunctionSource& source) : source_(source) {}
    void begin_slab(std::int32_t, std::int32_t) override {}
    void row(std::int32_t j, std::int32_t k, float* values, std::uint64_t* inside) override {
      const std::int32_t n = source_.grid_.nodes[0];
      for (std::int32_t w = 0; w <= (n - 1) / 64; ++w) inside[w] = 0;
      for (std::int32_t i = 0; i < n; ++i) {
        const double v = source_.f_(source_.grid_.node(i, j, k));
        const bool exact = !source_.signs_only_ || std::abs(v) <= source_.exact_within_;
        values[i] = exact ? static_cast<float>(v) : 1e9F;
        if (v < 0) inside[i / 64] |= std::uint64_t{1} << i % 64;
      }
    }
    void values_at(std::span<const Vec3> points, double* out) override {
      source_.asked_ += points.size();
      for (const Vec3& p : points) *out++ = source_.f_(p);
    }

   private:
    const FunctionSource& source_;
  };

  Grid grid_;
  Function f_;
  bool signs_only_;
  double exact_within_;
  mutable std::atomic<std::size_t> asked_ = 0;
};

/// Signs and sizes without any order, so that thousands of ambiguous faces join and every slope lies.
inline double noise(Vec3 p) {
  std::uint64_t h = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    h = (h ^ static_cast<std::uint64_t>(std::llround(p[i] * 1000) + 100000)) * 0x9e3779b97f4a7c15ULL;
    h ^= h >> 29;
  }
  return static_cast<double>(h % 2000001) / 1e6 - 1;
}

}  // namespace meso::implicit
