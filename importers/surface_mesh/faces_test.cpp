// SPDX-License-Identifier: Apache-2.0
#include "faces.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace meso {
namespace {

/// Twice the area of each triangle as seen from above; the polygon's own, by the shoelace formula.
struct Areas {
  double least = HUGE_VAL, sum = 0, polygon = 0;
};

Areas areas(const std::vector<Vec3>& points) {
  Faces faces{.corners = {}, .sizes = {static_cast<std::uint32_t>(points.size())}};
  for (std::uint32_t i = 0; i < points.size(); ++i) faces.corners.push_back(i);
  Areas out;
  for (const auto& [a, b, c] : triangles_of(faces, points)) {
    const double area = cross(points[b] - points[a], points[c] - points[a]).z;
    out.least = std::min(out.least, area);
    out.sum += area;
  }
  for (std::size_t i = 0; i < points.size(); ++i) out.polygon += cross(points[i], points[(i + 1) % points.size()]).z;
  return out;
}

TEST(Faces, PartsConcaveQuadrilateralsInside) {
  const std::vector<Vec3> arrow{{0, 0, 0}, {2, 1, 0}, {0, 2, 0}, {0.5, 1, 0}};
  for (std::size_t turn = 0; turn < 4; ++turn) {
    std::vector<Vec3> points = arrow;
    std::rotate(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(turn), points.end());
    const Areas a = areas(points);
    EXPECT_GT(a.least, 0) << turn;
    EXPECT_DOUBLE_EQ(a.sum, a.polygon);
  }
}

TEST(Faces, PartsConvexQuadrilateralsAlongTheShorterDiagonal) {
  const std::vector<Vec3> points{{0, 0, 0}, {1, -0.2, 0}, {3, 0, 0}, {1, 0.2, 0}};
  const Faces faces{.corners = {0, 1, 2, 3}, .sizes = {4}};
  EXPECT_EQ(triangles_of(faces, points), (std::vector<std::array<std::uint32_t, 3>>{{1, 2, 3}, {1, 3, 0}}));
}

TEST(Faces, CutsEarsOfStars) {
  std::vector<Vec3> star;
  for (int i = 0; i < 40; ++i) {
    const double r = i % 2 == 0 ? 1 : 0.3, angle = 2 * std::numbers::pi * i / 40;
    star.push_back({r * std::cos(angle), r * std::sin(angle), 0});
  }
  const Areas a = areas(star);
  EXPECT_GT(a.least, 0);
  EXPECT_NEAR(a.sum, a.polygon, 1e-14);
}

TEST(Faces, EndsWithPolygonsThatCrossThemselves) {
  const std::vector<Vec3> points{{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}, {0.5, 2, 0}};
  const Faces faces{.corners = {0, 1, 2, 3, 4, 0, 1, 1, 0, 0}, .sizes = {5, 5}};
  EXPECT_EQ(triangles_of(faces, points).size(), 6u);
}

}  // namespace
}  // namespace meso
