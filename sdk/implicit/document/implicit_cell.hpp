// SPDX-License-Identifier: Apache-2.0
#pragma once
// The body of an implicit cell as a term, its parameters being numbers or functions of the point. Private.

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "meso/eval/evaluation.hpp"
#include "meso/implicit/field.hpp"
#include "meso/implicit/surfaces.hpp"
#include "meso/implicit/term.hpp"
#include "point_terms.hpp"
#include "shape_field.hpp"

namespace meso::implicit {

/// Where the terms of a cell's body are evaluated, in millimetres.
struct CellPoint {
  std::array<Term, 3> local;   ///< in cell coordinates
  std::array<Term, 3> global;  ///< in the world
  bool is_in_box = false;      ///< of a single cell: `local` does not leave the box
};

/// Where a body is used.
struct BodyUse {
  Field region;               ///< the boxes of the cells that it is the body of
  double edge_mm = 0;         ///< the shortest of a cell
  std::int32_t points_along;  ///< how many points of the region's box are looked at along each axis
};

/// Those of a grid over the region's box that lie in the region.
[[nodiscard]] std::vector<Vec3> points_in(const BodyUse& use);
[[nodiscard]] std::array<Term, 3> scaled(double factor, const std::array<Term, 3>& p);
/// Which of `x y z` with the prefix it is.
[[nodiscard]] std::optional<std::size_t> coordinate(std::string_view name, std::string_view prefix);
[[nodiscard]] std::vector<std::string> names_of(const Expression& expression, LengthUnit unit);

class ImplicitCells {
 public:
  /// REQUIRES: a stream of cells with an implicit body.
  ImplicitCells(const eval::Evaluation& evaluation, const eval::CellStream& cells, const Reporter& report);

  /// True if some parameter is set at points: the body then depends on where in the world it stands.
  [[nodiscard]] bool varies_by_point() const;
  /// Negative inside, not cut to the box; about as steep as a distance. In the region weights and densities must be
  /// possible, and fields of the document have values. Nothing if something was reported.
  [[nodiscard]] std::optional<Term> body(const eval::PlacedCell& cell, const eval::BoxShape& box,
                                         const CellPoint& point, const BodyUse& use);
  /// True if the body repeats after the box's edge along the axis, whatever the parameters that vary by point.
  [[nodiscard]] bool repeats(const eval::PlacedCell& cell, const eval::BoxShape& box, std::size_t axis);
  /// Of a loop's `size`, in millimetres or radians. Nothing if something was reported.
  [[nodiscard]] std::shared_ptr<const AxisPhase> phase(const Loop& loop, bool is_angle, double from, double to) const;
  /// The thinnest wall of the bodies made so far, where the document states it in millimetres.
  [[nodiscard]] double thinnest_wall_mm() const { return thinnest_wall_; }
  /// How far apart samples may be for the bodies made so far to hold their stated shares within 0.2 %.
  [[nodiscard]] double density_spacing_mm() const { return density_spacing_; }

 private:
  using Meaning = std::function<std::optional<Term>(const std::string&)>;
  using Values = std::vector<Term>;  ///< of the cell's parameters
  /// What is behind a body: its function of the point, and by which level it is bounded.
  struct Parts {
    Term function;                ///< without the level
    std::optional<Term> share;    ///< the density, if that says the level
    std::optional<Term> wall_mm;  ///< of a shell with a stated wall
    Term level;                   ///< else: the body is function < level
    std::vector<Term> weights;
  };

  [[nodiscard]] std::optional<Values> parameters_at(const eval::PlacedCell& cell, const CellPoint& point,
                                                    const Box3& region);
  [[nodiscard]] std::optional<Term> quantity(const std::string& name, ElementId where, const CellPoint& point,
                                             const Box3& region);
  [[nodiscard]] std::optional<Parts> parts(const Values& values, const eval::BoxShape& box, const CellPoint& point);
  /// The same with levels as they are written: for slopes and periods.
  [[nodiscard]] std::optional<Term> plain_body(const eval::PlacedCell& cell, const eval::BoxShape& box,
                                               const CellPoint& point);
  [[nodiscard]] std::optional<Term> function_of(const std::optional<Expression>& field,
                                                const std::optional<std::string>& surface, const Element& where,
                                                const eval::BoxShape& box, const CellPoint& point,
                                                const Meaning& meaning);
  [[nodiscard]] std::optional<Term> blended(const eval::BoxShape& box, const CellPoint& point, const Meaning& meaning,
                                            std::vector<Term>& weights);
  [[nodiscard]] std::optional<Term> level_for(const Parts& parts, const Values& values, const eval::BoxShape& box,
                                              const BodyUse& use, std::span<const Vec3> points);
  void see_shares(std::span<const double> shares, const DensityTable& table, const Term& function,
                  std::span<const double> at, const eval::BoxShape& box, double edge_mm);
  [[nodiscard]] std::vector<bool> shaping() const;
  [[nodiscard]] bool check_shares(const Term& share, const DensityTable& table, const std::vector<Term>& at,
                                  std::span<const Vec3> points) const;
  [[nodiscard]] bool check_weights(const Parts& parts, std::span<const Vec3> points) const;
  [[nodiscard]] bool ask_fields(std::span<const Vec3> points) const;
  /// The thickest there.
  double see_wall(const Term& wall_mm, std::span<const Vec3> points);
  [[nodiscard]] CellPoint mirrored(const CellPoint& point, const eval::BoxShape& box) const;
  [[nodiscard]] double root_mean_square(const Surface& surface);
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
  double thinnest_wall_ = HUGE_VAL, density_spacing_ = HUGE_VAL;
  std::map<const DensityTable*, std::vector<double>> seen_shares_;
  std::vector<eval::PointQuantity> quantities_;  ///< that the body at hand asks at points
  std::map<std::string, double> root_mean_squares_;
  std::map<std::vector<double>, std::shared_ptr<const DensityTable>> tables_;
};

}  // namespace meso::implicit
