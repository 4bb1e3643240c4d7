// SPDX-License-Identifier: Apache-2.0
#pragma once
// The union of placed cells as one leaf of a field: f = min(distance to it, reach), negative inside. Private.
//
// Rows of samples are made brick by brick, 8 samples a side: what reaches into a brick is looked up once, so a sample
// costs the two or three struts near it, whatever the number of cells, and bricks away from every surface cost nothing.

#include <memory>

#include "meso/implicit/external_field.hpp"
#include "primitive_index.hpp"

namespace meso::implicit {

class PlacedCells final : public ExternalField, public std::enable_shared_from_this<PlacedCells> {
 public:
  /// `reach`: farther away nobody needs to know how far; the larger, the more a value costs.
  PlacedCells(PrimitiveIndex index, double reach);

  [[nodiscard]] double value(Vec3 p) const override;
  [[nodiscard]] Interval interval(const Box3& box) const override;
  [[nodiscard]] double lipschitz() const override { return lipschitz_; }
  [[nodiscard]] Box3 bounds(double level) const override;
  [[nodiscard]] std::unique_ptr<Prepared> prepare(const Grid& grid, const Affine& field_from_grid, double band,
                                                  const RunOptions& run) const override;
  [[nodiscard]] std::uint64_t bytes() const override { return index_.bytes(); }
  [[nodiscard]] std::uint64_t prepared_bytes(const Grid& grid) const override;

  [[nodiscard]] const PrimitiveIndex& index() const { return index_; }
  [[nodiscard]] double reach() const { return reach_; }

 private:
  PrimitiveIndex index_;
  double reach_, lipschitz_ = 1;
};

}  // namespace meso::implicit
