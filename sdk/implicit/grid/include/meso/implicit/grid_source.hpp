// SPDX-License-Identifier: Apache-2.0
#pragma once
// What contouring asks of a field, and all it knows of one: rows of samples on a grid, and values at points.
//
//   const GridSource& source = ...;                        // shared by all threads
//   std::unique_ptr<GridSampler> sampler = source.sampler();  // one per thread
//   sampler->begin_slab(0, 8);                             // planes 0...7 come next, ascending
//   sampler->row(j, k, values, inside);
//
// A sample is computed in double; its sign is taken there and its value rounded to float. Equal nodes give equal bits
// in every slab, thread and instruction set.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "meso/implicit/grid.hpp"

namespace meso::implicit {

class GridSampler {
 public:
  GridSampler() = default;
  GridSampler(const GridSampler&) = delete;
  GridSampler& operator=(const GridSampler&) = delete;
  virtual ~GridSampler() = default;

  /// Announces that rows of the planes [first, last) come next, plane by plane, each plane's rows ascending. This is
  /// where a sampler finds out which parts of the slab need no evaluation.
  virtual void begin_slab(std::int32_t first, std::int32_t last) = 0;

  /// Samples nodes (0 ... nodes[0] - 1, j, k). Bit i % 64 of inside[i / 64] is set if and only if the value is negative
  /// (zero and NaN are outside); bits past the last node are 0. values[i] is written wherever an edge of the grid with
  /// one end inside and one outside ends (elsewhere it may be left as it was). Both arrays are 64-byte aligned;
  /// `values` has room for nodes[0] rounded up to 64.
  virtual void row(std::int32_t j, std::int32_t k, float* values, std::uint64_t* inside) = 0;

  /// Values in double at any points: for refining and for root polish. Where a point is a node, the sign is the row's.
  virtual void values_at(std::span<const Vec3> points, double* out) = 0;
};

class GridSource {
 public:
  GridSource() = default;
  GridSource(const GridSource&) = delete;
  GridSource& operator=(const GridSource&) = delete;
  virtual ~GridSource() = default;

  [[nodiscard]] virtual const Grid& grid() const = 0;
  [[nodiscard]] virtual std::unique_ptr<GridSampler> sampler() const = 0;

  /// True: a row's values are good for their sign only, and contouring must ask values_at() for both ends of every
  /// edge it crosses. For fields whose values are dear and whose signs are cheap (distance to a mesh).
  [[nodiscard]] virtual bool signs_only() const { return false; }
  /// If so: samples of magnitudes up to this are exact all the same, and need not be asked for again.
  [[nodiscard]] virtual double exact_within() const { return 0; }

  /// Memory that it holds: counts against a run's budget.
  [[nodiscard]] virtual std::uint64_t bytes() const { return 0; }
};

}  // namespace meso::implicit
