// SPDX-License-Identifier: Apache-2.0
// Random expressions over every operation, on random grids: compiled in every way against the plain walk.
#include <gtest/gtest.h>

#include <random>

#include "fields_for_test.hpp"
#include "meso/implicit/flat_term.hpp"

namespace meso::implicit {
namespace {

using expr::Op;

class Random {
 public:
  explicit Random(unsigned seed) : bits_(seed) {}
  double number(double lo, double hi) { return std::uniform_real_distribution(lo, hi)(bits_); }
  std::size_t below(std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(bits_); }

  /// Nodes are taken from a pool, so that some are shared. The smooth half stays finite.
  Term term(bool smooth) {
    std::vector<Term> pool = {Term::coordinate(0), Term::coordinate(1), Term::coordinate(2)};
    const std::size_t size = 4 + below(16);
    while (pool.size() < size) {
      const auto any = [&] { return below(5) == 0 ? Term::constant(number(-2, 2)) : pool[below(pool.size())]; };
      if (smooth) {
        constexpr Op ops[] = {Op::add, Op::subtract, Op::multiply, Op::sin, Op::cos, Op::negate, Op::add, Op::multiply};
        const Op op = ops[below(std::size(ops))];
        const bool one = op == Op::sin || op == Op::cos || op == Op::negate;
        pool.push_back(one ? Term::apply(op, {any()}) : Term::apply(op, {any(), any()}));
        continue;
      }
      const auto op =
          static_cast<Op>(int(Op::negate) + int(below(std::size_t(Op::select) - std::size_t(Op::negate) + 1)));
      std::vector<Term> operands;
      for (std::size_t k = 0; k < operands_of(op); ++k) operands.push_back(any());
      pool.push_back(Term::apply(op, std::move(operands)));
    }
    return pool.back();
  }

  Grid grid() {
    Grid g;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      g.box.min[axis] = number(-2, 1);
      g.box.max[axis] = g.box.min[axis] + number(0.1, 3);
      g.nodes[axis] = static_cast<std::int32_t>(2 + below(axis == 0 ? 150 : 40));
    }
    return g;
  }

 private:
  static std::size_t operands_of(Op op) {
    if (op == Op::select || op == Op::clamp) return 3;
    return op == Op::negate || op == Op::logical_not || op == Op::hash || (op >= Op::floor && op <= Op::atan) ? 1 : 2;
  }
  std::mt19937 bits_;
};

bool same(const Samples& a, const Samples& b) { return a.inside == b.inside && a.bytes() == b.bytes(); }

TEST(RandomField, EveryWayOfComputingGivesTheSameBits) {
  for (unsigned seed = 0; seed < 400; ++seed) {
    Random random(seed);
    const Term term = random.term(seed % 2 == 0);
    const Grid grid = random.grid();
    for (const bool strict : {false, true}) {
      const auto sampled = [&](InstructionSet set, Pruning pruning, std::int32_t slab, std::uint64_t tables) {
        return Samples(
            *compile(term, grid,
                     {.strict_math = strict, .instruction_set = set, .pruning = pruning, .max_table_bytes = tables}),
            slab);
      };
      const Samples all = sampled(InstructionSet::sse2, Pruning::off, 8, 1 << 20);
      for (const auto set : {InstructionSet::avx2, InstructionSet::avx512})
        ASSERT_TRUE(!is_supported(set) || same(sampled(set, Pruning::off, 5, 0), all)) << seed;
      const Samples pruned = sampled(InstructionSet::automatic, Pruning::on, 8, 1 << 20);
      ASSERT_EQ(pruned.inside, all.inside) << seed;
      for (std::size_t i = 0; i < all.values.size(); ++i)
        ASSERT_TRUE(pruned.values[i] == all.values[i] || pruned.values[i] == Samples::untouched ||
                    std::isnan(all.values[i]))
            << seed;
    }
  }
}

/// Elementary functions are not the C library's, and what amplifies their last place (a floor, a comparison, a pole)
/// may differ; so almost all samples must agree, and of smooth fields every one.
TEST(RandomField, ValuesAreThoseOfTheWalk) {
  std::size_t samples = 0, off = 0;
  for (unsigned seed = 1000; seed < 1200; ++seed) {
    Random random(seed);
    const bool smooth = seed % 2 == 0;
    const Term term = random.term(smooth);
    const Grid grid = random.grid();
    std::vector<Vec3> points;
    std::vector<double> truth;
    for (std::int32_t k = 0; k < grid.nodes[2]; k += 5)
      for (std::int32_t j = 0; j < grid.nodes[1]; j += 3)
        for (std::int32_t i = 0; i < grid.nodes[0]; i += 2) points.push_back(grid.node(i, j, k));
    double least = HUGE_VAL, greatest = -HUGE_VAL;
    const FlatTerm flat(term);
    for (const Vec3 p : points) {
      truth.push_back(flat.value(p));
      least = std::min(least, truth.back());
      greatest = std::max(greatest, truth.back());
    }
    for (const bool strict : {true, false}) {
      std::vector<double> found(points.size());
      compile(term, grid, {.strict_math = strict})->sampler()->values_at(points, found.data());
      const double tolerance = smooth ? 4e-12 * std::max(greatest - least, 1e-3 * std::abs(greatest)) : 0;
      for (std::size_t p = 0; p < points.size(); ++p) {
        const bool agrees = std::isnan(truth[p]) ? std::isnan(found[p])
                                                 : found[p] == truth[p] || std::abs(found[p] - truth[p]) <=
                                                                               tolerance + 1e-12 * std::abs(truth[p]);
        ASSERT_TRUE(agrees || !smooth) << seed << ": " << found[p] << " for " << truth[p];
        ++samples;
        off += !agrees;
      }
    }
  }
  EXPECT_LT(double(off) / double(samples), 2e-3);
}

}  // namespace
}  // namespace meso::implicit
