// SPDX-License-Identifier: Apache-2.0
#include "exact_sign.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "test_meshes.hpp"

namespace meso::implicit {
namespace {

__extension__ using Wide = __int128;

int sign(Wide x) { return (x > 0) - (x < 0); }

/// Whole numbers of 38 bits: their determinants fit 128 bits, and by far not 53.
struct Whole {
  std::int64_t x, y, z;
  [[nodiscard]] Vec3 as_doubles() const { return {double(x), double(y), double(z)}; }
};

Whole random_whole(Random& random, double size) {
  return {std::llround(random.in(-size, size)), std::llround(random.in(-size, size)),
          std::llround(random.in(-size, size))};
}

int whole_side(const Whole& a, const Whole& b, const Whole& c, const Whole& p) {
  const Wide bx = b.x - a.x, by = b.y - a.y, bz = b.z - a.z, cx = c.x - a.x, cy = c.y - a.y, cz = c.z - a.z;
  return sign((by * cz - bz * cy) * (p.x - a.x) + (bz * cx - bx * cz) * (p.y - a.y) +
              (bx * cy - by * cx) * (p.z - a.z));
}

TEST(ExactSign, TurnsAgreeWithWholeNumbersNextToTheLine) {
  // Kettner et al., Classroom examples of robustness problems (2008): doubles around (0.5, 0.5) and a line through it.
  constexpr double ulp = 0x1p-53;
  for (int i = 0; i < 64; ++i) {
    for (int j = 0; j < 64; ++j)
      ASSERT_EQ(turn_sign({12, 12}, {24, 24}, {0.5 + i * ulp, 0.5 + j * ulp}), (j > i) - (j < i));
  }
}

TEST(ExactSign, SidesAgreeWithWholeNumbersNextToThePlane) {
  Random random(2);
  std::array<int, 3> seen{};
  for (int n = 0; n < 20'000; ++n) {
    const Whole a = random_whole(random, 0x1p36), u = random_whole(random, 0x1p32), v = random_whole(random, 0x1p32);
    const Whole b{a.x + 8 * u.x, a.y + 8 * u.y, a.z + 8 * u.z}, c{a.x + 8 * v.x, a.y + 8 * v.y, a.z + 8 * v.z};
    const std::int64_t s = n % 11 - 3, t = n % 7 - 2;
    Whole p{a.x + s * u.x + t * v.x, a.y + s * u.y + t * v.y, a.z + s * u.z + t * v.z};
    if (n % 3 != 0) (n % 2 == 0 ? p.x : p.z) += n % 3 == 1 ? 1 : -1;
    const Triangle triangle{a.as_doubles(), b.as_doubles(), c.as_doubles()};
    const int expected = whole_side(a, b, c, p);
    ASSERT_EQ(side_sign(triangle, p.as_doubles()), expected);
    ++seen[std::size_t(expected + 1)];
    const bool in = s >= 0 && t >= 0 && s + t <= 8;
    if (n % 3 == 0) {
      ASSERT_EQ(is_on(triangle, p.as_doubles()), in);
    }
    if (n % 3 != 0) {
      ASSERT_EQ(is_on(triangle, p.as_doubles()), expected == 0 && in);
    }
  }
  EXPECT_GT(std::min({seen[0], seen[1], seen[2]}), 1000);
  // Differences that are no doubles.
  const Triangle far{{{1e10, 1, 0}, {-1e10, 1, 1e-10}, {3, 1 + 1e-15, 1e5}}};
  EXPECT_EQ(side_sign(far, {3, 1 + 1e-15, 1e5}), 0);
  EXPECT_EQ(side_sign(far, {3, 1 + 2e-15, 1e5}), -side_sign(far, {3, 1, 1e5}));
}

TEST(ExactSign, SegmentsAndPointsHoldWhatTheyHold) {
  const Triangle segment{{{0, 0, 0}, {2, 4, 6}, {1, 2, 3}}}, point{{{1, 2, 3}, {1, 2, 3}, {1, 2, 3}}};
  EXPECT_TRUE(is_on(segment, {0.5, 1, 1.5}));
  EXPECT_FALSE(is_on(segment, {0.5, 1, std::nextafter(1.5, 2)}));
  EXPECT_FALSE(is_on(segment, {3, 6, 9}));
  EXPECT_TRUE(is_on(point, {1, 2, 3}));
  EXPECT_FALSE(is_on(point, {1, 2, 3.5}));
}

TEST(ExactSign, RaysThroughEdgesAndCornersEnterAsOftenAsTheyLeave) {
  // Every node of a grid that hits all corners and edges of a box with parted faces, and of one turned by 45 degrees.
  for (const bool turned : {false, true}) {
    TriangleMesh mesh = box_mesh({-1, -1, -1}, {1, 1, 1});
    if (turned) mesh = moved(mesh, {{{1, -1, 0, 1, 1, 0, 0, 0, 1}}, {}});
    for (double y = -2; y <= 2; y += 0.25) {
      for (double z = -2; z <= 2; z += 0.25) {
        int sum = 0, out = 0;
        for (const auto& t : mesh.triangles) {
          const int crossing = view_along_x({mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]}, y, z).crossing;
          sum += crossing;
          out += crossing > 0 ? 1 : 0;
        }
        ASSERT_EQ(sum, 0);
        ASSERT_LE(out, 1);
        const double reach = turned ? 2 : 1;
        if (std::abs(y) < reach && std::abs(z) < 1) {
          ASSERT_EQ(out, 1) << y << " " << z;
        }
      }
    }
  }
}

}  // namespace
}  // namespace meso::implicit
