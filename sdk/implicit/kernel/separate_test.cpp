// SPDX-License-Identifier: Apache-2.0
#include "separate.hpp"

#include "fields_for_test.hpp"

namespace meso::implicit {
namespace {

const Grid grid{.box = {{-1, -1, -1}, {1, 1, 1}}, .nodes = {40, 40, 40}};

/// Products per sample of a field that is one sum of products; -1: it is not.
int products(std::string_view text) {
  Graph graph;
  const Graph::Id root = separate(graph, graph.from_term(term_of(text)), grid);
  return graph[root].op == sum_of_products ? static_cast<int>(graph.operands(root).size() / 2) : -1;
}

TEST(Separate, CountsRowsByHand) {
  EXPECT_EQ(products("cos(2*pi*x)*sin(2*pi*y) + cos(2*pi*y)*sin(2*pi*z) + cos(2*pi*z)*sin(2*pi*x)"), 2);
  EXPECT_EQ(products("cos(2*pi*x) + cos(2*pi*y) + cos(2*pi*z)"), 1);
  EXPECT_EQ(products("cos(x) + cos(y) + cos(2*x) + 3*(cos(z) - cos(3*x))"), 1);  // a row by itself may be any sum
  EXPECT_EQ(products("cos(2*x)*sin(y)*cos(z) + cos(2*y)*sin(z)*cos(x) + cos(2*z)*sin(x)*cos(y)"), 3);
  EXPECT_EQ(products("cos(3*x + y)*cos(z) - sin(3*x - y)*sin(z) + cos(x - y)*cos(3*z) - sin(x + y)*sin(3*z)"), 4);
  EXPECT_EQ(products("2*x - 4*x*y + x*z/3 - y"), 1);  // multiples of one row are one row
  EXPECT_EQ(products("(x + y + z)^2"), 2);            // x^2 and x
  EXPECT_EQ(products("(y + z)/(2 + x)"), 1);
  EXPECT_EQ(products("sin(x + y*z)"), 2);
}

TEST(Separate, LeavesAloneWhatItWouldSpoil) {
  EXPECT_EQ(products("(x + y)^2 - (x - y)^2 - 4*x*y"), -1);  // terms of size 4 that cancel to nothing
  EXPECT_EQ(products("((x + y + 1000) - 1000)^2"), -1);
  EXPECT_EQ(products("sqrt(x)*y + z"), -1);  // no value where x is negative
  EXPECT_EQ(products("max(x + y, z)"), -1);
  EXPECT_EQ(products("y*z + 1"), -1);  // no x: a number per row
}

/// The error that regrouping adds, over the range, for fields shifted away from the origin.
TEST(Separate, ErrorIsWithinItsBound) {
  for (const char* shift : {"0", "10", "1000", "1e5", "1e8"}) {
    const std::string s = shift, u = "(x + y + " + s + ")", v = "(z - x - " + s + ")";
    for (const std::string& text : {u + "*" + v + " - 2*" + u + "*(z - " + s + ")", u + "^2 - (y + " + s + ")^2",
                                    "sin(" + u + ")*cos(" + v + ") + sin(" + v + ")*cos(z)"}) {
      const Term term = term_of(text);
      const Grid g{.box = {{-1, -1, -1}, {1, 1.1, 1.2}}, .nodes = {17, 16, 15}};
      std::vector<Vec3> points;
      for (std::int32_t k = 0; k < 15; ++k)
        for (std::int32_t j = 0; j < 16; ++j)
          for (std::int32_t i = 0; i < 17; ++i) points.push_back(g.node(i, j, k));
      std::vector<double> strict(points.size()), fast(points.size());
      compile(term, g, {.strict_math = true})->sampler()->values_at(points, strict.data());
      compile(term, g)->sampler()->values_at(points, fast.data());
      const auto [least, greatest] = std::minmax_element(strict.begin(), strict.end());
      for (std::size_t p = 0; p < points.size(); ++p)
        ASSERT_LE(std::abs(fast[p] - strict[p]), 2e-12 * (*greatest - *least)) << text;
    }
  }
}

TEST(Separate, AnyDepthAndAnyNumberOfUses) {
  Term chain = Term::coordinate(0), doubled = Term::coordinate(0) + Term::coordinate(1);
  for (int i = 0; i < 20000; ++i) chain = min(chain, Term::coordinate(1) * Term::coordinate(2) - Term::constant(i));
  for (int i = 0; i < 90; ++i) doubled = doubled + doubled;  // 2^90 leaves if it were a tree
  const Grid small{.box = grid.box, .nodes = {3, 3, 3}};
  EXPECT_EQ(Samples(*compile(chain, small, {.pruning = Pruning::off}), 3).value(0, 0, 0), 1.f - 19999.f);
  std::vector<double> found(1);
  compile(doubled, small)->sampler()->values_at({{Vec3{1, 1, 0}}}, found.data());
  EXPECT_EQ(found[0], std::ldexp(1.0, 91));
}

}  // namespace
}  // namespace meso::implicit
