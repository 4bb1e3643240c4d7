// SPDX-License-Identifier: Apache-2.0
#pragma once
// A field that is asked, not compiled: the distance to a mesh, a body of another engine. It stands as a leaf in a Term.

#include <cstdint>
#include <memory>
#include <span>

#include "meso/base/run_options.hpp"
#include "meso/base/vec.hpp"
#include "meso/implicit/grid.hpp"
#include "meso/implicit/interval.hpp"

namespace meso::implicit {

/// Samples of an external field on a grid; one per thread.
class ExternalRows {
 public:
  ExternalRows() = default;
  ExternalRows(const ExternalRows&) = delete;
  ExternalRows& operator=(const ExternalRows&) = delete;
  virtual ~ExternalRows() = default;
  /// Values at nodes (first ... last - 1, j, k) of the grid into out[0 ...]. The sign is right everywhere; the value is
  /// exact where its magnitude is at most `band` (see rows()), and elsewhere only beyond `band` with the right sign.
  virtual void row(std::int32_t j, std::int32_t k, std::int32_t first, std::int32_t last, double* out) = 0;
  /// Values at any points, given where the grid is: exact where the magnitude is at most within[p], elsewhere beyond it
  /// and of the right sign. Where a point is a node, the sign is row()'s. Neighbours in the list should be neighbours.
  virtual void values_at(std::span<const Vec3> points, std::span<const double> within, double* out) = 0;
};

class ExternalField {
 public:
  ExternalField() = default;
  ExternalField(const ExternalField&) = delete;
  ExternalField& operator=(const ExternalField&) = delete;
  virtual ~ExternalField() = default;

  [[nodiscard]] virtual double value(Vec3 p) const = 0;
  [[nodiscard]] virtual Interval interval(const Box3& box) const = 0;
  [[nodiscard]] virtual double lipschitz() const = 0;  ///< |f(p) - f(q)| <= lipschitz |p - q|; infinity: not known
  [[nodiscard]] virtual Box3 bounds(double level) const = 0;  ///< holds {f <= level}; may be infinite

  /// Samples of p -> f(field_from_grid p) at the grid's nodes. `band`: who asks looks only at values up to this
  /// magnitude; 0 asks for signs, infinity for exact values everywhere. Shares what is prepared: call once per grid,
  /// then make_rows() per thread. Empty if the run was stopped.
  class Prepared {
   public:
    Prepared() = default;
    Prepared(const Prepared&) = delete;
    Prepared& operator=(const Prepared&) = delete;
    virtual ~Prepared() = default;
    [[nodiscard]] virtual std::unique_ptr<ExternalRows> make_rows() const = 0;
    /// Up to which magnitude values of rows are exact, where that is more than the band that was asked for: for fields
    /// whose values beside the surface cost no more than their signs.
    [[nodiscard]] virtual double exact_within() const { return 0; }
  };
  [[nodiscard]] virtual std::unique_ptr<Prepared> prepare(const Grid& grid, const Affine& field_from_grid, double band,
                                                          const RunOptions& run) const = 0;

  /// Memory that it holds, and what prepare() takes for a grid: an estimate, on the safe side.
  [[nodiscard]] virtual std::uint64_t bytes() const { return 0; }
  [[nodiscard]] virtual std::uint64_t prepared_bytes(const Grid&) const { return 0; }
};

}  // namespace meso::implicit
