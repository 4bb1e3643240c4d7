// SPDX-License-Identifier: Apache-2.0
#include "cell_period.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "cell_primitives.hpp"
#include "primitive_for_test.hpp"

namespace meso::implicit {
namespace {

/// A body-centred cell of 1 mm with thicker nodes; neighbours both place those that they share. `extra`: a cone in it.
std::vector<Primitive> cell(bool extra) {
  std::vector<Primitive> result;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p{double(corner & 1), double(corner >> 1 & 1), double(corner >> 2)};
    result.push_back(strut(p, p, 0.15));
    result.push_back(strut(p, {0.5, 0.5, 0.5}, 0.1));
  }
  if (extra) add_field(Field::cone(0.2, 0.1, 0.3).rotated({1, 2, 0}, 0.5).translated({0.4, 0.9, 0.2}), result);
  return result;
}

struct Lattice {
  const char* name;
  Mat3 steps;
  std::array<std::int64_t, 3> count;
  Grid grid;
  Affine field_from_grid;
  bool comes_again;
};

const Mat3 straight;
const Mat3 oblique = Mat3::from_columns({1, 0, 0}, {0.5, 1, 0}, {0, 0.5, 1});

std::vector<Lattice> lattices() {
  const Grid fine{.box = {{-0.3, 0.1, -1}, {3.7, 4.1, 5}}, .nodes = {41, 41, 61}};
  const Grid off{.box = {{-0.3, 0.1, -1}, {3.7, 4.1, 5}}, .nodes = {42, 42, 62}};
  // Period 30 along y: every second cell comes to a node again.
  const Grid halves{.box = {{0, 0, 0}, {4, 4, 4}}, .nodes = {41, 61, 31}};
  const Mat3 turn = rotation({0, 0.6, 0.8}, 0.4);
  return {{"straight", straight, {4, 3, 5}, fine, {}, true},
          {"as large as the grid", straight, {9, 9, 9}, fine, {{}, {3, 3, 3}}, true},
          {"oblique", oblique, {3, 3, 4}, fine, {}, true},
          {"one layer", straight, {4, 3, 1}, fine, {}, true},  // along z the grid is the period
          {"several nodes", straight, {4, 4, 4}, halves, {}, true},
          {"turned", turn * straight, {4, 3, 5}, fine, {turn, {0.1, 0.2, 0.3}}, true},
          {"does not come again", straight, {4, 3, 5}, off, {}, false}};
}

TEST(CellPeriod, CopiesAreWhatIsThere) {
  for (const bool extra : {false, true})
    for (const Lattice& l : lattices()) {
      const auto cells =
          std::make_shared<const PlacedCells>(PrimitiveIndex(cell(extra), Repetition{l.steps, l.count}), 0.4);
      for (const double band : {0.0, 0.5}) {
        const auto prepared = cells->prepare(l.grid, l.field_from_grid, band, {});
        const auto rows = prepared->make_rows();
        const double exact = prepared->exact_within();
        std::vector<double> row(std::size_t(l.grid.nodes[0])), within(row.size(), 0.1), at(row.size());
        std::vector<Vec3> points(row.size());
        int near = 0;
        for (std::int32_t k = 0; k < l.grid.nodes[2]; k += 4)
          for (std::int32_t j = 0; j < l.grid.nodes[1]; j += 3) {
            rows->row(j, k, 0, l.grid.nodes[0], row.data());
            for (std::int32_t i = 0; i < l.grid.nodes[0]; ++i) points[std::size_t(i)] = l.grid.node(i, j, k);
            rows->values_at(points, within, at.data());
            for (std::size_t i = 0; i < row.size(); ++i) {
              const double value = cells->value(l.field_from_grid * points[i]);
              if (std::abs(value) > exact) {
                ASSERT_GT(std::abs(row[i]), exact * (1 - 1e-9)) << l.name;
                ASSERT_EQ(row[i] < 0, value < 0) << l.name;
              } else {
                ASSERT_NEAR(row[i], value, 1e-12) << l.name << " " << i << " " << j << " " << k;
                ++near;
              }
              ASSERT_EQ(at[i] < 0, row[i] < 0) << l.name;
            }
          }
        EXPECT_GT(near, 500) << l.name;
      }
    }
}

TEST(CellPeriod, IsFoundWhereTheLatticeComesToNodesAgain) {
  for (const Lattice& l : lattices()) {
    const PlacedCells cells(PrimitiveIndex(cell(false), Repetition{l.steps, l.count}), 0.4);
    EXPECT_EQ(CellPeriod::find(cells, l.grid, l.field_from_grid, {0.1, 0.2, false}, {}) != nullptr, l.comes_again)
        << l.name;
  }
}

/// Whole cells have equal samples to the bit. In the outer half of the outermost cells struts may end.
TEST(CellPeriod, CellsAreEqualToTheBit) {
  const Grid grid{.box = {{0, 0, 0}, {5, 5, 5}}, .nodes = {51, 51, 51}};
  const PlacedCells cells(PrimitiveIndex(cell(false), Repetition{straight, {5, 5, 5}}), 0.4);
  const auto period = CellPeriod::find(cells, grid, {}, {0.1, 0.2, false}, {});
  ASSERT_NE(period, nullptr);
  int copied = 0;
  for (std::int32_t k = 0; k < 51; ++k)
    for (std::int32_t j = 0; j < 51; ++j) {
      std::vector<CellPeriod::Run> runs;
      period->find_runs(j, k, runs);
      EXPECT_EQ(runs.front().first, 0);
      EXPECT_EQ(runs.back().last, 51);
      for (const CellPeriod::Run& run : runs) {
        if (!run.copied) continue;
        std::vector<double> samples(std::size_t(run.last - run.first));
        period->copy(j, k, run.first, run.last, samples.data());
        for (std::int32_t i = run.first; i < run.last; ++i, ++copied) {
          const double sample = samples[std::size_t(i - run.first)];
          ASSERT_EQ(sample, period->at(i, j, k));
          const auto first = period->at(10 + i % 10, 10 + j % 10, 10 + k % 10);
          ASSERT_TRUE(first);
          ASSERT_EQ(sample, *first);
        }
      }
    }
  EXPECT_GE(copied, 40 * 40 * 40);
}

TEST(CellPeriod, StopsWhereTheRunIsStopped) {
  const Lattice l = lattices().front();
  const auto cells =
      std::make_shared<const PlacedCells>(PrimitiveIndex(cell(false), Repetition{l.steps, l.count}), 0.4);
  RunOptions run;
  run.cancelled = [] { return true; };
  EXPECT_EQ(cells->prepare(l.grid, {}, 0, run), nullptr);
}

}  // namespace
}  // namespace meso::implicit
