// SPDX-License-Identifier: Apache-2.0
#include "meso/implicit/point_function.hpp"

#include <array>
#include <cmath>

namespace meso::implicit {
namespace {

class Rows final : public ExternalRows {
 public:
  Rows(std::shared_ptr<const PointFunction> function, const Grid& grid, const Affine& field_from_grid, double band)
      : function_(std::move(function)), grid_(grid), map_(field_from_grid), band_(band) {}

  void row(std::int32_t j, std::int32_t k, std::int32_t first, std::int32_t last, double* out) override {
    points_.clear();
    for (std::int32_t i = first; i < last; ++i) points_.push_back(map_ * grid_.node(i, j, k));
    function_->values_within(points_, band_, out);
  }

  void values_at(std::span<const Vec3> points, std::span<const double> within, double* out) override {
    points_.clear();
    double farthest = 0;
    for (const Vec3& p : points) points_.push_back(map_ * p);
    for (const double w : within) farthest = std::fmax(farthest, w);
    function_->values_within(points_, farthest, out);
  }

 private:
  std::shared_ptr<const PointFunction> function_;
  Grid grid_;
  Affine map_;
  double band_;
  std::vector<Vec3> points_;
};

class Prepared final : public ExternalField::Prepared {
 public:
  Prepared(std::shared_ptr<const PointFunction> function, const Grid& grid, const Affine& field_from_grid, double band)
      : function_(std::move(function)), grid_(grid), map_(field_from_grid), band_(band) {}
  [[nodiscard]] std::unique_ptr<ExternalRows> make_rows() const override {
    return std::make_unique<Rows>(function_, grid_, map_, band_);
  }

 private:
  std::shared_ptr<const PointFunction> function_;
  Grid grid_;
  Affine map_;
  double band_;
};

/// Leaves that are asked are not taken along by Term::with.
class TakenFrom final : public PointFunction {
 public:
  TakenFrom(const Term& f, const std::array<Term, 3>& xyz)
      : f_(f), xyz_{FlatTerm(xyz[0]), FlatTerm(xyz[1]), FlatTerm(xyz[2])} {}

  void values(std::span<const Vec3> points, double* out) const override {
    std::vector<Vec3> sources(points.size());
    for (std::size_t a = 0; a < 3; ++a) {
      xyz_[a].values(points, {out, points.size()});
      for (std::size_t n = 0; n < points.size(); ++n) sources[n][a] = out[n];
    }
    f_.values(sources, {out, points.size()});
  }
  [[nodiscard]] Interval interval(const Box3& box) const override {
    Box3 from;
    for (std::size_t a = 0; a < 3; ++a) {
      const Interval range = xyz_[a].interval(box);
      if (range.undefined || !std::isfinite(range.lo) || !std::isfinite(range.hi)) return Interval::everything();
      from.min[a] = range.lo, from.max[a] = range.hi;
    }
    return f_.interval(from);
  }

 private:
  FlatTerm f_;
  std::array<FlatTerm, 3> xyz_;
};

}  // namespace

Term taken_from(const Term& f, const std::array<Term, 3>& xyz) {
  return f.has_external() ? Term::external(std::make_shared<const TakenFrom>(f, xyz)) : f.with(xyz);
}

double PointFunction::value(Vec3 p) const {
  double result = 0;
  values({&p, 1}, &result);
  return result;
}

std::unique_ptr<ExternalField::Prepared> PointFunction::prepare(const Grid& grid, const Affine& field_from_grid,
                                                                double band, const RunOptions&) const {
  return std::make_unique<implicit::Prepared>(shared_from_this(), grid, field_from_grid, band);
}

}  // namespace meso::implicit
