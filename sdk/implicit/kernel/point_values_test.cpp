// SPDX-License-Identifier: Apache-2.0
// Values at the ends of crossed edges of random fields that hold external ones: to the bit those of the plain walk,
// though the external is asked no more than it must be and answers no better.
#include <gtest/gtest.h>

#include <atomic>
#include <random>

#include "bands.hpp"
#include "meso/implicit/compile.hpp"
#include "meso/implicit/flat_term.hpp"

namespace meso::implicit {
namespace {

using expr::Op;

/// Distance to a ball. Beyond what is asked for it lies by any factor.
class Ball final : public ExternalField {
 public:
  mutable std::atomic<int> near = 0, exact = 0;  ///< questions up to some magnitude, and for everything

  [[nodiscard]] double value(Vec3 p) const override { return norm(p) - 1; }
  [[nodiscard]] Interval interval(const Box3&) const override { return {}; }
  [[nodiscard]] double lipschitz() const override { return 1; }
  [[nodiscard]] Box3 bounds(double level) const override {
    const double r = 1 + level;
    return {{-r, -r, -r}, {r, r, r}};
  }
  [[nodiscard]] std::unique_ptr<Prepared> prepare(const Grid& grid, const Affine& map, double band,
                                                  const RunOptions&) const override {
    return std::make_unique<PreparedBall>(*this, grid, map, band);
  }

 private:
  class PreparedBall final : public Prepared {
   public:
    PreparedBall(const Ball& ball, const Grid& grid, const Affine& map, double band)
        : ball_(ball), grid_(grid), map_(map), band_(band) {}
    [[nodiscard]] std::unique_ptr<ExternalRows> make_rows() const override { return std::make_unique<Rows>(*this); }

   private:
    class Rows final : public ExternalRows {
     public:
      explicit Rows(const PreparedBall& b) : b_(b) {}
      void row(std::int32_t j, std::int32_t k, std::int32_t first, std::int32_t last, double* out) override {
        for (std::int32_t i = first; i < last; ++i) out[i - first] = answer(b_.grid_.node(i, j, k), b_.band_);
      }
      void values_at(std::span<const Vec3> points, std::span<const double> within, double* out) override {
        for (std::size_t i = 0; i < points.size(); ++i) {
          out[i] = answer(points[i], within[i]);
          if (within[i] > 0) ++(within[i] < HUGE_VAL ? b_.ball_.near : b_.ball_.exact);
        }
      }

     private:
      double answer(Vec3 p, double within) {
        const double v = b_.ball_.value(b_.map_ * p);
        if (std::abs(v) <= within) return v;
        constexpr double factors[] = {1, 2, 1e6};
        return std::copysign(std::nextafter(within, HUGE_VAL) * factors[asked_++ % 3], v);
      }
      const PreparedBall& b_;
      std::size_t asked_ = 0;
    };
    const Ball& ball_;
    Grid grid_;
    Affine map_;
    double band_;
  };
};

class Random {
 public:
  explicit Random(unsigned seed) : bits_(seed) {}
  double number(double lo, double hi) { return std::uniform_real_distribution(lo, hi)(bits_); }
  std::size_t below(std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(bits_); }

  Term ball(const std::shared_ptr<const Ball>& field) {
    const double size = number(0.5, 1.5);
    const Mat3 turn = rotation({0.6, 0, 0.8}, number(0, 3));
    Affine map{turn, {number(-0.7, 0.7), number(-0.7, 0.7), number(-0.7, 0.7)}};
    for (double& m : map.linear.m) m *= size;
    const Term leaf = Term::external(field, map);
    return below(3) == 0 ? leaf : number(0.2, 3) * leaf;
  }
  Term smooth() {
    const Term x = Term::coordinate(0), y = Term::coordinate(1), z = Term::coordinate(2);
    const double a = number(0.5, 3), b = number(-1, 1);
    switch (below(4)) {
      case 0:
        return a * x + b * y - 0.1;
      case 1:
        return a * (x * y) + y * z - b * z;
      case 2:
        return sqrt(x * x + z * z) - 0.3 * a;
      default:  // waves without sines, whose last bits depend on who computes them
        return a * (x * (x * x - 1) - y * (y * y - 1) + b * z);
    }
  }
  Term solid(const std::shared_ptr<const Ball>& field, int depth) {
    if (depth == 0) return below(2) == 0 ? ball(field) : smooth();
    const Term a = solid(field, depth - 1);
    const auto other = [&] { return solid(field, depth - 1); };
    switch (below(9)) {
      case 0:
        return a - number(-0.3, 0.3);
      case 1:
        return abs(a) - number(0.02, 0.3);
      case 2:
        return min(a, other());
      case 3:
        return max(a, -other());
      case 4:
        return -a;
      case 5:
        return number(0.3, 4) * a;
      case 6:
        return a / Term::constant(number(-3, -0.5));
      case 7:
        return Term::apply(Op::select, {Term::apply(Op::less, {smooth(), Term::constant(0)}), a, other()});
      default:
        return max(a, other());
    }
  }

 private:
  std::mt19937 bits_;
};

const Grid grid{.box = {{-2, -1.9, -1.8}, {2, 2.1, 1.7}}, .nodes = {37, 31, 29}};

/// Nodes with a neighbour of the other sign.
std::vector<Vec3> edge_ends(const FlatTerm& truth) {
  const auto [nx, ny, nz] = grid.nodes;
  std::vector<Vec3> nodes;
  for (std::int32_t k = 0; k < nz; ++k)
    for (std::int32_t j = 0; j < ny; ++j)
      for (std::int32_t i = 0; i < nx; ++i) nodes.push_back(grid.node(i, j, k));
  std::vector<double> values(nodes.size());
  truth.values(nodes, values);
  std::vector<char> is_end(nodes.size(), 0);
  const auto edges = [&](std::size_t step, auto has_next) {
    for (std::size_t n = 0; n + step < nodes.size(); ++n)
      if (has_next(n) && (values[n] < 0) != (values[n + step] < 0)) is_end[n] = is_end[n + step] = 1;
  };
  const auto row = std::size_t(nx), plane = row * std::size_t(ny);
  edges(1, [&](std::size_t n) { return n % row + 1 < row; });
  edges(row, [&](std::size_t n) { return n % plane + row < plane; });
  edges(plane, [](std::size_t) { return true; });
  std::vector<Vec3> ends;
  for (std::size_t n = 0; n < nodes.size(); ++n)
    if (is_end[n] != 0) ends.push_back(nodes[n]);
  return ends;
}

TEST(PointValues, AreThoseOfThePlainWalkWhereEdgesCross) {
  std::size_t points = 0, near = 0, exact = 0;
  for (unsigned seed = 0; seed < 300; ++seed) {
    Random random(seed);
    const auto ball = std::make_shared<Ball>();
    const Term term = random.solid(ball, 1 + int(seed % 5));
    const FlatTerm truth(term);
    std::vector<Vec3> asked = edge_ends(truth);
    for (int n = 0; n < 50; ++n) asked.push_back({random.number(-3, 3), random.number(-3, 3), random.number(-3, 3)});
    const auto source = compile(term, grid, {.strict_math = true});
    std::vector<double> found(asked.size());
    source->sampler()->values_at(asked, found.data());
    for (std::size_t p = 0; p < asked.size(); ++p)
      ASSERT_EQ(found[p], truth.value(asked[p])) << seed << " at " << asked[p].x << " " << asked[p].y;
    points += asked.size();
    near += std::size_t(ball->near);
    exact += std::size_t(ball->exact);
  }
  // Not by asking for everything: that is for the scattered points and steep fields.
  EXPECT_GT(points, 100'000U);
  EXPECT_GT(near, points / 4);
  EXPECT_LT(exact, points / 4);
}

TEST(PointValues, OfExternalsThatCountEverywhereAreExact) {
  const auto ball = std::make_shared<Ball>();
  const Term b = Term::external(ball), x = Term::coordinate(0);
  for (const Term& term : {b + 0.1 * x, max(b * x, b), sqrt(abs(b)) - 0.5, Term::apply(Op::select, {b, b - 1, x})}) {
    const FlatTerm truth(term);
    const std::vector<Vec3> asked = edge_ends(truth);
    ASSERT_GT(asked.size(), 100U);
    std::vector<double> found(asked.size());
    compile(term, grid, {.strict_math = true})->sampler()->values_at(asked, found.data());
    for (std::size_t p = 0; p < asked.size(); ++p) ASSERT_EQ(found[p], truth.value(asked[p]));
  }
}

TEST(Bands, GrowWithWhatTheRootMustBe) {
  const auto ball = std::make_shared<Ball>();
  const Term b = Term::external(ball), x = Term::coordinate(0);
  const auto band = [](const Term& term, double t) {
    Graph graph;
    const Graph::Id root = graph.from_term(term);
    return external_bands(graph, root).at(0).for_root(t);
  };
  EXPECT_EQ(band(b, 0.7), 0.7);
  EXPECT_NEAR(band(b - 0.3, 0.2), 0.5, 1e-14);
  EXPECT_NEAR(band(abs(2 * b) - 0.5, 0.1), 0.3, 1e-14);
  EXPECT_NEAR(band(max(min(b - 1, x), 0.1 * b), 0), 1, 1e-14);
  EXPECT_NEAR(band(max(min(b - 1, x), 0.1 * b), 0.5), 5, 1e-14);
  // More lines than are kept: above all of them, if not on them.
  Term many = x;
  for (int i = 1; i < 12; ++i) many = max(many, i * b - 3.0 / i);
  for (const double t : {0.0, 0.1, 1.0, 30.0})
    for (int i = 1; i < 12; ++i) EXPECT_GE(band(many, t), (t + 3.0 / i) / i);
  EXPECT_EQ(band(b + x, 0.1), HUGE_VAL);
}

}  // namespace
}  // namespace meso::implicit
