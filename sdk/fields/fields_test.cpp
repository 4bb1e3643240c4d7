// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <fstream>
#include <random>
#include <set>

#include "meso/fields/base64.hpp"
#include "meso/fields/grid_interpolation.hpp"
#include "meso/fields/mesh_interpolation.hpp"
#include "meso/fields/point_search.hpp"
#include "meso/fields/split_cells.hpp"
#include "meso/fields/statistics.hpp"
#include "meso/fields/symmetric_tensor.hpp"
#include "meso/fields/table.hpp"

namespace meso::fields {
namespace {

using testing::ElementsAre;

std::optional<std::string> decoded(std::string_view text) {
  std::string bytes(base64_bytes_at_most(text.size()), '\0');
  const auto size = decode_base64(text, reinterpret_cast<std::byte*>(bytes.data()));
  if (!size) return std::nullopt;
  bytes.resize(*size);
  return bytes;
}

// RFC 4648, section 10.
TEST(Base64, DecodesTheVectorsOfTheRfc) {
  EXPECT_EQ(decoded(""), "");
  EXPECT_EQ(decoded("Zg=="), "f");
  EXPECT_EQ(decoded("Zm8="), "fo");
  EXPECT_EQ(decoded("Zm9v"), "foo");
  EXPECT_EQ(decoded("Zm9vYg=="), "foob");
  EXPECT_EQ(decoded("Zm9v\n Ym\tFy \r\n"), "foobar");
  EXPECT_EQ(decoded("+/+/"), "\xFB\xFF\xBF");
}

TEST(Base64, RefusesWhatIsNone) {
  for (const char* text : {"Z", "Zm", "Zm9", "Zg=", "Z===", "====", "Zm9v=", "Zg==Zg==", "Zm-v", "Zm9v\x80m9v"})
    EXPECT_FALSE(decoded(text)) << text;
}

TEST(Base64, ComesBackAsItWas) {
  std::mt19937 random(1);
  for (std::size_t size = 0; size < 70; ++size) {
    std::string bytes(size, '\0');
    for (char& c : bytes) c = static_cast<char>(random());
    EXPECT_EQ(decoded(encode_base64(reinterpret_cast<const std::byte*>(bytes.data()), size)), bytes);
  }
}

TEST(Records, AFileMayHaveAnOffsetAndAStride) {
  const std::string file = testing::TempDir() + "records.raw";
  const std::vector<double> numbers{-1, 0, 1, 99, 10, 11, 98, 20, 21};
  std::ofstream(file, std::ios::binary).write(reinterpret_cast<const char*>(numbers.data()), 72);
  std::string error;
  const auto mapped = ResourceBytes::open(file, error);
  ASSERT_TRUE(mapped) << error;
  const auto records = Records::map(mapped, {.offset = 8, .stride = 24, .rows = 3, .columns = 2});
  ASSERT_TRUE(records);
  EXPECT_EQ((*records)(1, 0), 10);
  EXPECT_EQ((*records)(2, 1), 21);
  EXPECT_FALSE(Records::map(mapped, {.offset = 16, .stride = 24, .rows = 3, .columns = 2}));
  EXPECT_FALSE(Records::map(mapped, {.rows = std::size_t{1} << 62, .columns = 8}));
  EXPECT_FALSE(ResourceBytes::open(testing::TempDir(), error));
}

// With Q orthogonal and D diagonal the tensor Q D Q^T has the values of D and the columns of Q.
TEST(Principal, FindsValuesAndDirections) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  for (int n = 0; n < 300; ++n) {
    const Vec3 a{normal(random), normal(random), normal(random)}, b{normal(random), normal(random), normal(random)};
    const Vec3 u = a / norm(a), w = cross(a, b) / norm(cross(a, b)), v = cross(w, u);
    const double low = 1e3 * normal(random);
    const double d[] = {low + 2 + std::abs(normal(random)), low + 1, low};
    const Vec3 axes[] = {u, v, w};
    double m[3][3]{};
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 3; ++c) m[r][c] += d[i] * axes[i][r] * axes[i][c];
    const Principal p = principal({m[0][0], m[1][1], m[2][2], m[0][1], m[1][2], m[2][0]});
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(p.value[i], d[i], 1e-12 * (std::abs(low) + 10));
      EXPECT_LT(norm(cross(p.direction[i], axes[i])), 1e-9);
      EXPECT_GT(p.direction[i].z, 0);
    }
  }
}

TEST(Principal, IsCalmAboutSpecialTensors) {
  const Principal none = principal({});
  EXPECT_THAT(none.value, ElementsAre(0, 0, 0));
  const Principal p = principal({.xx = 3e-300, .yy = 1e-300, .zz = 2e-300});
  EXPECT_THAT(p.value, ElementsAre(3e-300, 2e-300, 1e-300));
  EXPECT_EQ(p.direction[1], (Vec3{0, 0, 1}));
  // Pure shear: +t and -t at 45 degrees; von Mises is sqrt(3) t.
  const Principal shear = principal({.xy = 2});
  EXPECT_NEAR(shear.value[0], 2, 1e-15);
  EXPECT_NEAR(shear.direction[0].x, std::sqrt(0.5), 1e-15);
  EXPECT_NEAR(von_mises({.xy = 2}), 2 * std::sqrt(3), 1e-15);
  EXPECT_EQ(von_mises({.xx = -7}), 7);
}

std::vector<Vec3> random_points(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> one(0, 1);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i) points.push_back({one(random), one(random), one(random)});
  return points;
}

TEST(PointSearch, FindsWhatAnExhaustiveSearchFinds) {
  const std::vector<Vec3> points = random_points(3000, 3);
  const PointSearch search = *PointSearch::make(points, {});
  for (const Vec3& p : random_points(500, 4)) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < points.size(); ++i) {
      if (norm(points[i] - p) < norm(points[best] - p)) best = i;
    }
    EXPECT_EQ(search.nearest(p), static_cast<std::int64_t>(best));
  }
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(search.nearest(points[i]), static_cast<std::int64_t>(i));
}

TEST(PointSearch, TakesTheLowerNumberOfEquallyNearOnes) {
  std::vector<Vec3> points;
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 8; ++j)
      for (int k = 0; k < 8; ++k) points.push_back({7.0 - i, 7.0 - j, 7.0 - k});
  const PointSearch search = *PointSearch::make(points, {});
  for (int i = 0; i < 7; ++i) {
    // The middle of a cube of eight: the lowest number is that of the corner with the largest coordinates.
    const std::int64_t n = (6 - i) * 64 + (6 - i) * 8 + (6 - i);
    EXPECT_EQ(search.nearest({i + 0.5, i + 0.5, i + 0.5}), n);
  }
}

// Asked in time, however many points there are: 300 000 take more than one look.
TEST(Long, WorkStopsWhenItIsAsked) {
  const std::vector<Vec3> points = random_points(300'000, 9);
  int looks = 0;
  const RunOptions third{.cancelled = [&] { return ++looks == 3; }};
  EXPECT_FALSE(PointSearch::make(points, third));
  looks = 0;
  EXPECT_FALSE(thin(points, 0.01, third));
  looks = 0;
  EXPECT_FALSE(statistics(Records::of(std::vector<double>(300'000), 1), third));
  std::vector<std::int64_t> cells;
  for (std::int64_t i = 0; i < 300'000; ++i) cells.push_back(i);
  looks = 0;
  EXPECT_FALSE(MeshInterpolation::make(std::make_shared<const std::vector<Vec3>>(points), 4, cells, third));
}

TEST(InverseDistance, IsExactAtRecordsAndShepardBetween) {
  const PointSearch search = *PointSearch::make({{0, 0, 0}, {3, 0, 0}}, {});
  const Records values = Records::of({10, 40}, 1);
  EXPECT_EQ(search.inverse_distance({3, 0, 0}, 2)(values, 0), 40);
  // Weights 1/1 and 1/4.
  EXPECT_NEAR(search.inverse_distance({1, 0, 0}, 2)(values, 0), (10 + 40 / 4.0) / 1.25, 1e-14);
  EXPECT_NEAR(search.inverse_distance({1e-200, 0, 0}, 2)(values, 0), 10, 1e-14);
}

TEST(Thin, KeepsWhatTheRuleKeeps) {
  std::vector<Vec3> points = random_points(2000, 5);
  points.insert(points.begin() + 100, points[7]);
  for (const double distance : {0.0, 0.03, 0.2, 5.0}) {
    std::vector<std::size_t> rule;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const bool is_free = std::all_of(rule.begin(), rule.end(), [&](std::size_t k) {
        const Vec3 d = points[i] - points[k];
        return dot(d, d) > distance * distance;
      });
      if (is_free) rule.push_back(i);
    }
    EXPECT_EQ(*thin(points, distance, {}), rule) << distance;
  }
  EXPECT_EQ(thin(std::vector<Vec3>(3), 0, {})->size(), 1U);
  EXPECT_THAT(*thin(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {2.5, 0, 0}}, 1, {}), ElementsAre(0, 2));
}

// A product of linear functions is what trilinear interpolation reproduces.
TEST(GridInterpolation, ReproducesTrilinearFunctions) {
  const std::vector<std::vector<double>> axes{{0, 1, 4}, {-2, 0, 0.5, 3}, {10, 20}};
  const auto f = [](double a, double b, double c) { return (1 + a) * (2 - b) * (3 + c / 10); };
  std::vector<double> values;
  for (const double a : axes[0])
    for (const double b : axes[1])
      for (const double c : axes[2]) values.push_back(f(a, b, c));
  const Records records = Records::of(values, 1);
  const GridInterpolation grid(axes);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> one(0, 1);
  for (int n = 0; n < 200; ++n) {
    const double q[] = {4 * one(random), -2 + 5 * one(random), 10 + 10 * one(random)};
    EXPECT_NEAR(grid.at(q)(records, 0), f(q[0], q[1], q[2]), 1e-12);
  }
  for (std::size_t r = 0; r < values.size(); ++r) {
    const double q[] = {axes[0][r / 8], axes[1][r / 2 % 4], axes[2][r % 2]};
    EXPECT_EQ(grid.at(q)(records, 0), values[r]);
    EXPECT_EQ(grid.at(q).count, 1U);
  }
  const double outside[] = {4.1, 0, 10};
  EXPECT_FALSE(grid.contains(outside));
  EXPECT_EQ(grid.at(outside)(records, 0), f(4, 0, 10));
}

// Second order: exact for quadratic functions inside, also on unequal steps; at an end the difference.
TEST(GridInterpolation, DerivativesAreThoseOfParabolas) {
  const std::vector<double> axis{0, 1, 3, 4, 7};
  std::vector<double> values;
  for (const double a : axis) values.push_back(a * a);
  const Records records = Records::of(values, 1);
  const GridInterpolation grid({axis});
  for (std::size_t i = 1; i < 4; ++i) {
    const double q[] = {axis[i]};
    EXPECT_NEAR(grid.derivative(records, 0, grid.at(q))[0], 2 * axis[i], 1e-13);
  }
  const double end[] = {0.0};
  EXPECT_EQ(grid.derivative(records, 0, grid.at(end))[0], 1);
}

TEST(MeshInterpolation, ReproducesLinearFunctionsOnTetrahedra) {
  // Twelve tetrahedra around the middle of a cube.
  const auto points = std::make_shared<const std::vector<Vec3>>(std::vector<Vec3>{
      {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}, {0.5, 0.5, 0.5}});
  const std::vector<std::int64_t> cells{0, 1, 2, 8, 0, 2, 3, 8, 4, 6, 5, 8, 4, 7, 6, 8, 0, 5, 1, 8, 0, 4, 5, 8,
                                        1, 6, 2, 8, 1, 5, 6, 8, 2, 7, 3, 8, 2, 6, 7, 8, 3, 4, 0, 8, 3, 7, 4, 8};
  const auto f = [](Vec3 p) { return 5 + p.x - 2 * p.y + 3 * p.z; };
  std::vector<double> values;
  for (const Vec3& p : *points) values.push_back(f(p));
  const Records records = Records::of(values, 1);
  const MeshInterpolation mesh = *MeshInterpolation::make(points, 4, cells, {});
  for (const Vec3& p : random_points(500, 6)) {
    const auto stencil = mesh.at(p);
    ASSERT_TRUE(stencil);
    EXPECT_NEAR((*stencil)(records, 0), f(p), 1e-13);
  }
  for (std::size_t i = 0; i < points->size(); ++i) EXPECT_EQ((*mesh.at((*points)[i]))(records, 0), values[i]);
  EXPECT_FALSE(mesh.at({1.001, 0.5, 0.5}));
}

TEST(MeshInterpolation, ReproducesTrilinearFunctionsOnHexahedra) {
  const auto points = std::make_shared<const std::vector<Vec3>>(std::vector<Vec3>{
      {0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}, {0.3, 0, 1}, {2.5, 0.2, 1.2}, {2, 1, 1}, {0, 1.4, 1}});
  const auto f = [](Vec3 p) { return 1 + p.x + 4 * p.y - p.z; };  // linear in space: trilinear in the element
  std::vector<double> values;
  for (const Vec3& p : *points) values.push_back(f(p));
  const Records records = Records::of(values, 1);
  const MeshInterpolation mesh = *MeshInterpolation::make(points, 8, {0, 1, 2, 3, 4, 5, 6, 7}, {});
  int inside = 0;
  for (const Vec3& p : random_points(300, 8)) {
    const auto stencil = mesh.at({2 * p.x, p.y, p.z});
    if (!stencil) continue;
    ++inside;
    EXPECT_NEAR((*stencil)(records, 0), f({2 * p.x, p.y, p.z}), 1e-12);
  }
  EXPECT_GT(inside, 200);
  for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ((*mesh.at((*points)[i]))(records, 0), values[i]);
}

double volume_of(const std::vector<Vec3>& points, const std::vector<std::int64_t>& tetra) {
  double sum = 0;
  for (std::size_t i = 0; i < tetra.size(); i += 4) {
    const auto at = [&](std::size_t c) { return points[static_cast<std::size_t>(tetra[i + c])]; };
    sum += std::abs(dot(at(1) - at(0), cross(at(2) - at(0), at(3) - at(0)))) / 6;
  }
  return sum;
}

// Whatever corner has the lowest number: all of the volume, and no tetrahedron without any.
TEST(SplitCells, FillTheirCell) {
  const std::vector<Vec3> cube{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  const std::vector<Vec3> wedge{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  const std::vector<Vec3> pyramid{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.3, 0.4, 1}};
  const auto check = [](CellKind kind, const std::vector<Vec3>& places, std::size_t least, double volume) {
    std::vector<std::int64_t> numbers(places.size());
    std::mt19937 random(12);
    for (int n = 0; n < 50; ++n) {
      for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = static_cast<std::int64_t>(i);
      std::shuffle(numbers.begin(), numbers.end(), random);
      std::vector<Vec3> points(places.size());
      for (std::size_t i = 0; i < places.size(); ++i) points[static_cast<std::size_t>(numbers[i])] = places[i];
      std::vector<std::int64_t> tetra;
      append_tetrahedra(kind, numbers, tetra);
      EXPECT_GE(tetra.size(), 4 * least);
      EXPECT_NEAR(volume_of(points, tetra), volume, 1e-15);
      for (std::size_t i = 0; i < tetra.size(); i += 4)
        EXPECT_GT(volume_of(points, {tetra.begin() + static_cast<std::ptrdiff_t>(i),
                                     tetra.begin() + static_cast<std::ptrdiff_t>(i + 4)}),
                  0.05);
    }
  };
  check(CellKind::hexahedron, cube, 6, 1);
  check(CellKind::wedge, wedge, 3, 0.5);
  check(CellKind::pyramid, pyramid, 2, 1 / 3.0);
}

// A wedge on a pyramid on a cube, numbered anyhow: sides that two cells share are halved alike, so that a function of
// the records is continuous there.
TEST(SplitCells, NeighboursAgreeOnTheirSide) {
  std::mt19937 random(13);
  std::vector<std::int64_t> name(9);
  for (std::size_t i = 0; i < name.size(); ++i) name[i] = static_cast<std::int64_t>(i);
  for (int n = 0; n < 50; ++n) {
    std::shuffle(name.begin(), name.end(), random);
    const auto cell = [&](CellKind kind, const std::vector<std::size_t>& corners) {
      std::vector<std::int64_t> numbers, tetra;
      for (const std::size_t c : corners) numbers.push_back(name[c]);
      append_tetrahedra(kind, numbers, tetra);
      return tetra;
    };
    // Triangles on the side of the corners 4 5 6 7 of the cube.
    const auto on_side = [&](const std::vector<std::int64_t>& tetra) {
      std::set<std::set<std::int64_t>> found;
      const std::set<std::int64_t> side{name[4], name[5], name[6], name[7]};
      for (std::size_t i = 0; i < tetra.size(); i += 4) {
        std::set<std::int64_t> triangle;
        for (std::size_t c = 0; c < 4; ++c)
          if (side.count(tetra[i + c]) > 0) triangle.insert(tetra[i + c]);
        if (triangle.size() == 3) found.insert(triangle);
      }
      return found;
    };
    const auto cube = on_side(cell(CellKind::hexahedron, {0, 1, 2, 3, 4, 5, 6, 7}));
    EXPECT_EQ(cube.size(), 2U);
    EXPECT_EQ(cube, on_side(cell(CellKind::pyramid, {4, 5, 6, 7, 8})));
    EXPECT_EQ(cube, on_side(cell(CellKind::wedge, {4, 5, 8, 7, 6, 3})));
  }
}

TEST(Statistics, CountWhatIsNoNumber) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  const auto all = *statistics(Records::of({1, 2, -3, nan, 7, -infinity}, 2), {});
  EXPECT_EQ(all[0].min, -3);
  EXPECT_EQ(all[0].max, 7);
  EXPECT_EQ(all[0].nan + all[0].infinite, 0U);
  EXPECT_EQ(all[1].nan, 1U);
  EXPECT_EQ(all[1].infinite, 1U);
  EXPECT_EQ(all[1].first_not_finite, 1U);
  EXPECT_EQ(all[1].max, 2);
}

TEST(ColumnName, IsOneThatExpressionsCanUse) {
  EXPECT_EQ(column_name("von Mises"), "von_Mises");
  EXPECT_EQ(column_name("2nd"), "_2nd");
  EXPECT_EQ(column_name("STR(%)"), "STR___");
  EXPECT_EQ(column_name(""), "_");
}

TEST(Layout, SizesBeyondAllFilesAreTold) {
  EXPECT_EQ(Records::bytes_needed({.offset = 16, .rows = 3, .columns = 4}), 16 + 3 * 4 * 8U);
  EXPECT_FALSE(Records::bytes_needed({.rows = 1, .columns = (std::size_t{1} << 61) + 1}));
  EXPECT_FALSE(Records::bytes_needed({.rows = std::size_t{1} << 62, .columns = 4}));
}

}  // namespace
}  // namespace meso::fields
