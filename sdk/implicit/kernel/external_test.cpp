// SPDX-License-Identifier: Apache-2.0
// Fields that are asked, not compiled: a ball that answers no better than it was asked to.
#include <gtest/gtest.h>

#include "fields_for_test.hpp"
#include "meso/implicit/flat_term.hpp"

namespace meso::implicit {
namespace {

/// Signed distance to the unit ball; beyond the band its rows tell the sign and nothing else.
class Ball final : public ExternalField {
 public:
  mutable double asked_band = -1;
  mutable std::size_t asked_intervals = 0;
  double exact_within = 0;  ///< of rows, whatever is asked

  [[nodiscard]] double value(Vec3 p) const override { return norm(p) - 1; }
  [[nodiscard]] Interval interval(const Box3& box) const override {
    ++asked_intervals;
    const double middle = value(0.5 * (box.min + box.max)), reach = 0.5 * norm(box.max - box.min);
    return {middle - reach, middle + reach, false};
  }
  [[nodiscard]] double lipschitz() const override { return 1; }
  [[nodiscard]] Box3 bounds(double level) const override {
    const double r = 1 + level;
    return {{-r, -r, -r}, {r, r, r}};
  }
  [[nodiscard]] std::unique_ptr<Prepared> prepare(const Grid& grid, const Affine& field_from_grid, double band,
                                                  const RunOptions&) const override {
    asked_band = band;
    return std::make_unique<PreparedBall>(*this, grid, field_from_grid, band);
  }

 private:
  class PreparedBall final : public Prepared {
   public:
    PreparedBall(const Ball& ball, const Grid& grid, const Affine& map, double band)
        : ball_(ball), grid_(grid), map_(map), band_(std::max(band, ball.exact_within)) {}
    [[nodiscard]] std::unique_ptr<ExternalRows> make_rows() const override { return std::make_unique<Rows>(*this); }
    [[nodiscard]] double exact_within() const override { return ball_.exact_within; }

   private:
    class Rows final : public ExternalRows {
     public:
      explicit Rows(const PreparedBall& b) : b_(b) {}
      void row(std::int32_t j, std::int32_t k, std::int32_t first, std::int32_t last, double* out) override {
        ASSERT_LE(last, b_.grid_.nodes[0]);
        for (std::int32_t i = first; i < last; ++i) {
          const double v = b_.ball_.value(b_.map_ * b_.grid_.node(i, j, k));
          out[i - first] = std::abs(v) <= b_.band_ ? v : std::copysign(b_.band_ + 1000 + i, v);
        }
      }
      void values_at(std::span<const Vec3> points, std::span<const double> within, double* out) override {
        for (std::size_t i = 0; i < points.size(); ++i) {
          const double v = b_.ball_.value(b_.map_ * points[i]);
          out[i] = std::abs(v) <= within[i] ? v : std::copysign(within[i] + 1e-9 + 1000 * double(i % 3), v);
        }
      }

     private:
      const PreparedBall& b_;
    };
    const Ball& ball_;
    Grid grid_;
    Affine map_;
    double band_;
  };
};

const Grid grid{.box = {{-2, -2, -2}, {2, 2.5, 2}}, .nodes = {90, 45, 41}};

void expect_right_signs(const Term& term, bool signs_only) {
  const FlatTerm truth(term);
  for (const Pruning pruning : {Pruning::off, Pruning::on}) {
    const auto source = compile(term, grid, {.pruning = pruning});
    EXPECT_EQ(source->signs_only(), signs_only);
    const Samples samples(*source, 8);
    std::size_t inside = 0;
    for (std::int32_t k = 0; k < 41; ++k)
      for (std::int32_t j = 0; j < 45; ++j)
        for (std::int32_t i = 0; i < 90; ++i) {
          ASSERT_EQ(samples.is_inside(i, j, k), truth.value(grid.node(i, j, k)) < 0);
          inside += samples.is_inside(i, j, k);
        }
    EXPECT_GT(inside, 1000U);
    const std::vector<Vec3> points = {{1.3, 0.2, 0.1}, {1, 1, 1}, {-0.5, 1.5, 0.5}};
    std::vector<double> found(3);
    source->sampler()->values_at(points, found.data());
    for (std::size_t p = 0; p < 3; ++p) EXPECT_NEAR(found[p], truth.value(points[p]), 1e-14);
  }
}

TEST(External, IsAskedForNoMoreThanTheSignNeeds) {
  const auto ball = std::make_shared<Ball>();
  const Term b = Term::external(ball), x = Term::coordinate(0), y = Term::coordinate(1);
  const auto band_of = [&](const Term& term) {
    expect_right_signs(term, true);
    return ball->asked_band;
  };
  EXPECT_EQ(band_of(b), 0);
  EXPECT_NEAR(band_of(b - 0.25), 0.25, 1e-14);
  EXPECT_NEAR(band_of(abs(b + 0.25) - 0.5), 0.75, 1e-14);
  EXPECT_NEAR(band_of(2 * max(b, x) - 0.5), 0.25, 1e-14);
  EXPECT_NEAR(band_of(min(-b, x - 1) / Term::constant(4) + 0.125), 0.5, 1e-14);
  EXPECT_NEAR(band_of(Term::apply(expr::Op::select, {x, b, b - 0.25})), 0.25, 1e-14);
  EXPECT_EQ(band_of(max(b, max(sqrt(x * x + y * y) - 0.7, x + y - 0.3))), 0);
}

TEST(External, IsAskedForEverythingWhereItsValueCounts) {
  const auto ball = std::make_shared<Ball>();
  const Term b = Term::external(ball), x = Term::coordinate(0);
  for (const Term& term : {b + 0.1 * x, sqrt(b) - 0.5, b * x, Term::apply(expr::Op::select, {b, b - 1, x}),
                           Term::apply(expr::Op::less, {b, x}) - 0.5}) {
    expect_right_signs(term, false);
    EXPECT_EQ(ball->asked_band, HUGE_VAL);
  }
}

TEST(External, IntervalsAreAskedForOnlyWhereTheRestDoesNotTell) {
  const auto ball = std::make_shared<Ball>();
  const Term b = Term::external(ball), x = Term::coordinate(0);
  const auto asked = [&](const Term& term) {
    ball->asked_intervals = 0;
    expect_right_signs(term, true);
    return ball->asked_intervals;
  };
  const std::size_t everywhere = asked(b);
  EXPECT_EQ(asked(max(b, x + 0.5)), everywhere / 2);  // x + 0.5 is negative in three of six blocks along x
  EXPECT_EQ(asked(min(b, x + 0.5)), everywhere);      // without a value of the external there is none, which is outside
}

TEST(External, SaysHowFarItsRowsAreExact) {
  const auto ball = std::make_shared<Ball>();
  const Term b = Term::external(ball), x = Term::coordinate(0);
  EXPECT_EQ(compile(b, grid, {})->exact_within(), 0);
  EXPECT_EQ(compile(b - 0.25, grid, {})->exact_within(), 0);
  ball->exact_within = 0.5;
  const auto expect_exact = [&](const Term& term, double within) {
    const FlatTerm truth(term);
    const auto source = compile(term, grid, {.pruning = Pruning::off});
    ASSERT_NEAR(source->exact_within(), within, 2e-6 * within);
    const Samples samples(*source, 8);
    std::size_t near = 0;
    for (std::int32_t k = 0; k < 41; ++k)
      for (std::int32_t j = 0; j < 45; ++j)
        for (std::int32_t i = 0; i < 90; ++i) {
          const auto value = static_cast<float>(truth.value(grid.node(i, j, k)));
          const bool is_near = std::abs(samples.value(i, j, k)) <= source->exact_within();
          ASSERT_TRUE(is_near || std::abs(value) > 0.99 * within);
          ASSERT_TRUE(!is_near || std::abs(samples.value(i, j, k) - value) < 1e-6F);
          near += is_near ? 1 : 0;
        }
    EXPECT_GT(near, 1000U);
  };
  expect_exact(b, 0.5);
  expect_exact(b - 0.25, 0.25);
  expect_exact(2 * max(b, x) - 0.5, 0.5);
  expect_exact(max(b, -min(x, b - 0.1)), 0.4);
}

TEST(External, StandsWhereItsMapPutsIt) {
  const Term ball = Term::external(std::make_shared<Ball>());
  const Affine map{rotation({0, 0, 1}, 0.5), {0.5, -0.25, 0}};
  expect_right_signs(ball.at(map), true);
  expect_right_signs(max(ball.at(map), -ball), true);
}

}  // namespace
}  // namespace meso::implicit
