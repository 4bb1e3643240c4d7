// SPDX-License-Identifier: Apache-2.0
#pragma once
// A leaf of a term whose values are computed point by point: tables, fields of the document, distances to a level.

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "meso/implicit/external_field.hpp"
#include "meso/implicit/flat_term.hpp"

namespace meso::implicit {

class PointFunction : public ExternalField, public std::enable_shared_from_this<PointFunction> {
 public:
  /// REQUIRES: room for as many values. A value depends on its point alone.
  virtual void values(std::span<const Vec3> points, double* out) const = 0;
  /// Exact up to the magnitude `within`, elsewhere beyond it and of the right sign.
  virtual void values_within(std::span<const Vec3> points, double /*within*/, double* out) const {
    values(points, out);
  }

  [[nodiscard]] double value(Vec3 p) const final;
  [[nodiscard]] double lipschitz() const override { return HUGE_VAL; }
  [[nodiscard]] Box3 bounds(double) const override {
    return {{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, {HUGE_VAL, HUGE_VAL, HUGE_VAL}};
  }
  [[nodiscard]] std::unique_ptr<Prepared> prepare(const Grid& grid, const Affine& field_from_grid, double band,
                                                  const RunOptions& run) const final;
};

/// p -> f(x(p), y(p), z(p)), also of functions with external leaves, which are asked point by point then.
[[nodiscard]] Term taken_from(const Term& f, const std::array<Term, 3>& xyz);

}  // namespace meso::implicit
