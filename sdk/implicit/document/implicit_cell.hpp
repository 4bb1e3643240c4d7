// SPDX-License-Identifier: Apache-2.0
#pragma once
// The body of an implicit cell as a term, its parameters being numbers or functions of the point. Private.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "meso/eval/evaluation.hpp"
#include "meso/implicit/surfaces.hpp"
#include "meso/implicit/term.hpp"
#include "shape_field.hpp"

namespace meso::implicit {

/// Where the terms of a cell's body are evaluated, in millimetres.
struct CellPoint {
  std::array<Term, 3> local;   ///< in cell coordinates
  std::array<Term, 3> global;  ///< in the world
};

class ImplicitCells {
 public:
  /// REQUIRES: a stream of cells with an implicit body.
  ImplicitCells(const eval::Evaluation& evaluation, const eval::CellStream& cells, const Reporter& report);

  /// True if some parameter is set at points: the body then depends on where in the world it stands.
  [[nodiscard]] bool varies_by_point() const;
  /// Negative inside, not cut to the box; about as steep as a distance. Nothing if something was reported.
  [[nodiscard]] std::optional<Term> body(const eval::PlacedCell& cell, const eval::BoxShape& box,
                                         const CellPoint& point) const;
  /// True if the body repeats after the box's edge along the axis, whatever the parameters that vary by point.
  [[nodiscard]] bool repeats(const eval::PlacedCell& cell, const eval::BoxShape& box, std::size_t axis) const;

 private:
  using Meaning = std::function<std::optional<Term>(const std::string&)>;

  [[nodiscard]] std::optional<std::vector<Term>> parameters_at(const eval::PlacedCell& cell,
                                                               const CellPoint& point) const;
  [[nodiscard]] std::optional<Term> body_at(const eval::PlacedCell& cell, const eval::BoxShape& box,
                                            const CellPoint& point) const;
  [[nodiscard]] Term surface_at(const Surface& surface, const eval::BoxShape& box, const CellPoint& point) const;
  [[nodiscard]] std::optional<Term> term(const Expression& expression, ElementId where, std::string_view attribute,
                                         const Meaning& meaning) const;
  [[nodiscard]] std::optional<Term> level(const std::optional<Expression>& expression, std::string_view attribute,
                                          const Meaning& meaning) const;

  const eval::Evaluation& evaluation_;
  const eval::CellStream& cells_;
  const Reporter& report_;
  const ImplicitBody& body_;
  double unit_mm_;
};

}  // namespace meso::implicit
