// SPDX-License-Identifier: Apache-2.0
#include "placed_cells.hpp"

#include <gtest/gtest.h>

#include <random>

#include "cell_primitives.hpp"
#include "meso/implicit/compile.hpp"
#include "meso/implicit/document_field.hpp"
#include "primitive_for_test.hpp"
#include "strut_rows.hpp"

namespace meso::implicit {
namespace {

class Numbers {
 public:
  double operator()(double lo, double hi) { return lo + static_cast<double>(random_() >> 11) * 0x1p-53 * (hi - lo); }
  Vec3 point(double reach) { return {(*this)(-reach, reach), (*this)(-reach, reach), (*this)(-reach, reach)}; }

 private:
  std::mt19937_64 random_{7};
};

std::vector<Primitive> some_primitives(Numbers& number, int count, double reach) {
  std::vector<Primitive> result;
  for (int i = 0; i < count; ++i) {
    const Vec3 from = number.point(reach);
    result.push_back(strut(from, i % 5 == 0 ? from : from + number.point(1), i % 2 == 0 ? 0.2 : number(0.1, 0.4)));
  }
  for (int i = 0; i < count / 10; ++i)
    add_field(Field::box({0.3, 0.5, 0.2}).rotated({1, 2, 3}, i).translated(number.point(reach)), result);
  return result;
}

double by_all(const std::vector<Primitive>& all, Vec3 p, double most) {
  double least = most;
  for (const Primitive& one : all) least = std::min(least, one.value(p));
  return least;
}

TEST(PlacedCells, ValuesAreThoseOfAllPrimitives) {
  Numbers number;
  const auto all = some_primitives(number, 200, 4);
  const auto cells = std::make_shared<const PlacedCells>(PrimitiveIndex(all, {}), 0.8);
  for (int i = 0; i < 3000; ++i) {
    const Vec3 p = number.point(5);
    EXPECT_DOUBLE_EQ(cells->value(p), by_all(all, p, 0.8));
    Box3 box;
    box.extend(p);
    box.extend(p + 0.3 * number.point(1));
    const Interval range = cells->interval(box);
    for (int k = 0; k < 5; ++k) {
      const Vec3 q = box.min + Vec3{number(0, 1) * (box.max.x - box.min.x), number(0, 1) * (box.max.y - box.min.y),
                                    number(0, 1) * (box.max.z - box.min.z)};
      EXPECT_TRUE(range.contains(cells->value(q)));
    }
  }
}

TEST(PlacedCells, AConesFormulaIsItsField) {
  Numbers number;
  for (const Cone& cone : {Cone{0.7, 0.3, 1.2}, Cone{0.2, 0.9, 0.4}, Cone{0.5, 0.5, 2}, Cone{0.6, 0, 1}}) {
    const Field field = Field::cone(cone.bottom, cone.top, cone.height);
    for (int i = 0; i < 2000; ++i) {
      const Vec3 p = number.point(2);
      EXPECT_NEAR(distance(cone, p), field.value(p), 1e-14);
    }
  }
}

TEST(PlacedCells, ARepetitionIsItsCopies) {
  Numbers number;
  const auto one = some_primitives(number, 20, 1);
  const Repetition repetition{Mat3::from_columns({2, 0.1, 0}, {0.5, 1.8, 0}, {0, 0.3, 2.2}), {4, 3, 2}};
  std::vector<Primitive> all;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 2; ++k)
        for (const Primitive& p : one)
          all.push_back(p.moved_by(repetition.steps * Vec3{double(i), double(j), double(k)}));
  const PlacedCells folded(PrimitiveIndex(one, repetition), 0.5);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 p = number.point(6) + Vec3{3, 2, 1};
    EXPECT_NEAR(folded.value(p), by_all(all, p, 0.5), 1e-12);
  }
  for (const Primitive& p : all) {
    EXPECT_LE(folded.bounds(0).min.x, p.box.min.x);
    EXPECT_GE(folded.bounds(0).max.z, p.box.max.z);
  }
}

/// Signs everywhere, values near the surface, in rows and at points, on grids that are turned and stretched.
TEST(PlacedCells, SamplesOfAGrid) {
  Numbers number;
  const auto all = some_primitives(number, 120, 3);
  const auto cells = std::make_shared<const PlacedCells>(PrimitiveIndex(all, {}), 0.9);
  const Grid grid{.box = {{-3.5, -3, -3.2}, {3.4, 3.1, 3}}, .nodes = {67, 31, 25}};
  for (const Affine& map : {Affine{}, Affine{rotation({0.6, 0, 0.8}, 0.7), {0.1, 0.2, -0.3}}}) {
    const auto prepared = cells->prepare(grid, map, 0, {});
    const auto rows = prepared->make_rows();
    const double edge = std::max({grid.spacing(0), grid.spacing(1), grid.spacing(2)});
    std::vector<double> row(67), within(67, edge), at(67);
    std::vector<Vec3> points(67);
    int near = 0;
    for (std::int32_t k = 0; k < 25; ++k)
      for (std::int32_t j = 0; j < 31; ++j) {
        rows->row(j, k, 0, 67, row.data());
        for (std::int32_t i = 0; i < 67; ++i) points[std::size_t(i)] = grid.node(i, j, k);
        rows->values_at(points, within, at.data());
        for (std::size_t i = 0; i < 67; ++i) {
          const double truth = by_all(all, map * points[i], 0.9);
          ASSERT_EQ(row[i] < 0, truth < 0) << i << " " << j << " " << k;
          ASSERT_EQ(at[i] < 0, truth < 0);
          if (std::abs(truth) > edge) continue;
          ++near;
          ASSERT_NEAR(row[i], truth, 1e-12);
          ASSERT_NEAR(at[i], truth, 1e-12);
        }
      }
    EXPECT_GT(near, 1000);
  }
}

/// Of bodies through each other those that are least somewhere in a brick: exactly, deep inside too.
TEST(PlacedCells, SamplesOfBodiesThroughEachOther) {
  Numbers number;
  std::vector<Primitive> all;
  for (int i = 0; i < 60; ++i)
    add_field(Field::box({0.9, 0.3, 0.2}).rotated({1, 2, 3}, 0.3 * i).translated(number.point(1.5)), all);
  all.push_back(strut({-1, 0, 0}, {1, 0.3, 0}, 0.3));
  const auto cells = std::make_shared<const PlacedCells>(PrimitiveIndex(all, {}), 0.9);
  const Grid grid{.box = {{-1, -1, -1}, {1, 1, 1}},
                  .nodes = {129, 129, 129}};  // bricks of 0.1, so the choice is narrow
  const auto rows = cells->prepare(grid, {}, HUGE_VAL, {})->make_rows();
  std::vector<double> row(129);
  for (std::int32_t k = 0; k < 129; k += 16)
    for (std::int32_t j = 0; j < 129; j += 7) {
      rows->row(j, k, 0, 129, row.data());
      for (std::int32_t i = 0; i < 129; ++i)
        ASSERT_NEAR(row[std::size_t(i)], by_all(all, grid.node(i, j, k), 0.9), 1e-12) << i << " " << j << " " << k;
    }
}

/// Points that stand together are asked together: each gets what it gets alone, whether slopes are bounded or not.
TEST(PlacedCells, NeighboursAreAnsweredAsIfAlone) {
  for (const bool bounded : {true, false}) {
    Numbers number;
    auto all = some_primitives(number, 200, 2);
    const Term x = Term::coordinate(0), y = Term::coordinate(1);
    Term angle = Term::apply(expr::Op::atan2, {y, x + 5});
    if (!bounded) add_field(intersection_of(Field::box(), Field::from_term(angle)), all);
    const auto cells = std::make_shared<const PlacedCells>(PrimitiveIndex(all, {}), 0.9);
    ASSERT_EQ(std::isfinite(cells->lipschitz()), bounded);
    const Grid grid{.box = {{-3, -3, -3}, {3, 3, 3}}, .nodes = {31, 31, 31}};
    const auto rows = cells->prepare(grid, {}, 0.1, {})->make_rows();
    std::vector<Vec3> points;
    for (int place = 0; place < 300; ++place) {
      const Vec3 middle = number.point(2.8);
      for (int n = 0; n < 12; ++n) points.push_back(middle + number.point(0.12));
    }
    for (std::size_t n = 0; n < 3600; ++n) points.push_back(points[n * 7 % 3600] + number.point(0.01));  // far apart
    std::vector<double> within(points.size(), HUGE_VAL), together(points.size());
    rows->values_at(points, within, together.data());
    for (std::size_t n = 0; n < points.size(); ++n) {
      double alone = 0;
      rows->values_at({&points[n], 1}, {&within[n], 1}, &alone);
      ASSERT_EQ(together[n], alone) << n;
      ASSERT_NEAR(alone, by_all(all, points[n], 0.9), 1e-12) << n;
    }
  }
}

TEST(PlacedCells, InstructionSetsGiveEqualBits) {
  Numbers number;
  std::vector<Capsule> capsules;
  for (int i = 0; i < 7; ++i) capsules.push_back(capsule(number.point(1), number.point(1), i < 4 ? 0.2 : 0.1 * i));
  const Line line{number.point(1), {1, 0.2, -0.1}};
  const double x[] = {-1, -0.7, -0.2, 0, 0.3, 0.31, 0.9, 2};
  double expected[8], out[8];
  strut_row_sse2::row(capsules.data(), capsules.size(), line, x, expected);
  for (std::size_t i = 0; i < 8; ++i) {
    double least = HUGE_VAL;
    for (const Capsule& c : capsules)
      least = std::min(least, axis_distance(c, line.origin + x[i] * line.direction) - c.radius);
    EXPECT_DOUBLE_EQ(expected[i], least);
  }
  if (is_supported(InstructionSet::avx2)) {
    strut_row_avx2::row(capsules.data(), capsules.size(), line, x, out);
    EXPECT_TRUE(std::equal(out, out + 8, expected));
  }
  if (is_supported(InstructionSet::avx512)) {
    strut_row_avx512::row(capsules.data(), capsules.size(), line, x, out);
    EXPECT_TRUE(std::equal(out, out + 8, expected));
  }
}

}  // namespace
}  // namespace meso::implicit
