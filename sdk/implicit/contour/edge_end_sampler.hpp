// SPDX-License-Identifier: Apache-2.0
#pragma once
// For fields whose signs are cheap and whose values are dear: gets the signs of a plane and of those beside it first,
// then asks for values only where an edge inside the slab is crossed and the row did not tell, all at once.

#include <tbb/cache_aligned_allocator.h>

#include <array>
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

  /// What each holds from the start.
  [[nodiscard]] static std::uint64_t bytes(std::uint64_t nx, std::uint64_t ny);
  /// What it holds now beyond that.
  [[nodiscard]] std::uint64_t grown_bytes() const;

 private:
  using Words = std::vector<std::uint64_t, tbb::cache_aligned_allocator<std::uint64_t>>;
  using Floats = std::vector<float, tbb::cache_aligned_allocator<float>>;

  [[nodiscard]] std::uint64_t* signs(std::int32_t j, std::int32_t k) {
    return signs_[static_cast<std::size_t>(k) % signs_.size()].data() + static_cast<std::size_t>(j) * words_;
  }
  [[nodiscard]] float* values(std::int32_t j, std::int32_t k) {
    return values_[static_cast<std::size_t>(k) % values_.size()].data() + static_cast<std::size_t>(j) * stride_;
  }
  void sample_plane(std::int32_t k);
  void enter_plane(std::int32_t k);
  void mark_ends(std::int32_t j, std::int32_t k);
  void look_at_ends(std::int32_t j, std::int32_t k);
  void ask_for_missing();

  struct Missing {
    float* value;
    bool negative;
  };

  Grid grid_;
  std::unique_ptr<GridSampler> source_;
  float exact_within_;
  std::function<bool()> go_on_;
  std::size_t words_, stride_;  // of a row
  std::int32_t first_ = 0, last_ = 0, in_plane_ = -1;
  std::array<Words, 3> signs_;       // of the planes below, at and above the one at hand, in turn
  std::array<Floats, 2> values_;     // of the last two of these
  std::vector<std::uint64_t> ends_;  // of crossed edges, in the row at hand
  std::vector<Vec3> points_;         // ends that the plane's rows did not tell
  std::vector<Missing> missing_;     // at these
  std::vector<double> computed_;
};

}  // namespace meso::implicit
