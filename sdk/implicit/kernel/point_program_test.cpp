// SPDX-License-Identifier: Apache-2.0
#include "meso/implicit/point_program.hpp"

#include <gtest/gtest.h>

#include <random>
#include <thread>

#include "fields_for_test.hpp"
#include "meso/implicit/flat_term.hpp"

namespace meso::implicit {
namespace {

std::vector<Vec3> some_points(std::size_t count) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> in(-1, 1);
  std::vector<Vec3> points;
  for (std::size_t n = 0; n < count; ++n) points.push_back({in(random), in(random), in(random)});
  return points;
}

const char* const text = "max(cos(9*atan2(y, x)) + sin(7*z)*hypot(x, y), abs(x^3 - exp(y)) - z^2) - 0.1";

/// Any number of points, one or thousands; to the last places of the elementary functions.
TEST(PointProgram, ValuesAreTheTerms) {
  const Term term = term_of(text);
  const PointProgram program(term);
  const FlatTerm truth(term);
  for (const std::size_t count : {0U, 1U, 7U, 16U, 17U, 5000U}) {
    const std::vector<Vec3> points = some_points(count);
    std::vector<double> found(count);
    program.values(points, found.data());
    for (std::size_t n = 0; n < count; ++n) {
      ASSERT_NEAR(found[n], truth.value(points[n]), 1e-14);
      ASSERT_EQ(found[n], program.value(points[n])) << "a value depends on its point alone";
    }
  }
}

TEST(PointProgram, ManyThreadsMayAsk) {
  const PointProgram program(term_of(text));
  const std::vector<Vec3> points = some_points(3000);
  std::vector<double> expected(points.size());
  program.values(points, expected.data());
  std::vector<std::vector<double>> found(4, std::vector<double>(points.size()));
  std::vector<std::thread> threads;
  for (auto& values : found)
    threads.emplace_back([&] {
      for (std::size_t n = 0; n < points.size(); n += 100)
        program.values(std::span(points).subspan(n, 100), values.data() + n);
    });
  for (std::thread& thread : threads) thread.join();
  for (const auto& values : found) EXPECT_EQ(values, expected);
}

}  // namespace
}  // namespace meso::implicit
