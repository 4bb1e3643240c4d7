// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <chrono>
#include <map>
#include <numbers>

#include "lattice/shape_lattice.hpp"
#include "meso/brep/audit.hpp"
#include "meso/brep/lattice_body.hpp"
#include "meso/brep/measure.hpp"
#include "meso/brep/triangles.hpp"

namespace meso::brep {
namespace {

constexpr double pi = std::numbers::pi;

LatticeCell bcc(Vec3 size, double strut, double ball) {
  LatticeCell cell{.box = {{0, 0, 0}, size}, .primitives = {}};
  const Vec3 centre = 0.5 * size;
  cell.primitives.push_back(Ball{centre, ball});
  for (int i = 0; i < 8; ++i) {
    const Vec3 corner{i & 1 ? size.x : 0, i & 2 ? size.y : 0, i & 4 ? size.z : 0};
    cell.primitives.push_back(Ball{corner, ball});
    cell.primitives.push_back(Frustum{corner, centre, strut, strut});
  }
  return cell;
}

/// Two whole balls, eight struts between their circles, minus the caps that the struts cut from the balls.
double bcc_volume(Vec3 size, double strut, double ball) {
  const double height = std::sqrt(ball * ball - strut * strut), sagitta = ball - height;
  const double cap = pi * sagitta * sagitta * (3 * ball - sagitta) / 3;
  const double length = 0.5 * norm(size) - 2 * height;
  return 2 * 4 * pi / 3 * ball * ball * ball + 8 * (pi * strut * strut * length - 2 * cap);
}

/// Struts along the three axes between balls on the corners: every strut is cut into four, every ball into eight.
LatticeCell cubic(Vec3 size, double strut, double ball) {
  LatticeCell cell{.box = {{0, 0, 0}, size}, .primitives = {}};
  for (int i = 0; i < 8; ++i) {
    const Vec3 corner{i & 1 ? size.x : 0, i & 2 ? size.y : 0, i & 4 ? size.z : 0};
    cell.primitives.push_back(Ball{corner, ball});
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (corner[axis] > 0) continue;
      Vec3 end = corner;
      end[axis] = size[axis];
      cell.primitives.push_back(Frustum{corner, end, strut, strut});
    }
  }
  return cell;
}
double cubic_volume(Vec3 size, double strut, double ball) {
  const double height = std::sqrt(ball * ball - strut * strut), sagitta = ball - height;
  const double cap = pi * sagitta * sagitta * (3 * ball - sagitta) / 3;
  return 4 * pi / 3 * ball * ball * ball + pi * strut * strut * (size.x + size.y + size.z - 6 * height) - 6 * cap;
}

LatticeSet block(int x, int y, int z) {
  return {.min = {0, 0, 0}, .max = {x - 1, y - 1, z - 1}, .inside = [](Index3) { return true; }};
}
LatticeSet subset(int x, int y, int z, std::function<bool(Index3)> inside) {
  return {.min = {0, 0, 0}, .max = {x - 1, y - 1, z - 1}, .inside = std::move(inside)};
}

struct Case {
  std::optional<Body> body;
  Audit audit;
  Measures measures;
};

template <typename Cell>
Case realise(const Cell& cell, const LatticeSet& set, const LatticeOptions& options = {}) {
  DiagnosticSink sink;
  const auto start = std::chrono::steady_clock::now();
  Case result{.body = lattice_body(cell, set, options, sink), .audit = {}, .measures = {}};
  const auto made = std::chrono::steady_clock::now();
  for (const Diagnostic& d : sink.diagnostics()) ADD_FAILURE() << render(d);
  if (!result.body) return result;
  result.measures = measure(*result.body);
  const auto measured = std::chrono::steady_clock::now();
  result.audit = audit(*result.body);
  const auto ms = [](auto a, auto b) { return std::chrono::duration<double, std::milli>(b - a).count(); };
  std::cerr << "made " << ms(start, made) << " measured " << ms(made, measured) << " audited "
            << ms(measured, std::chrono::steady_clock::now()) << " ms, faces " << result.audit.faces << " solids "
            << result.measures.solids << " shells " << result.measures.shells << " volume " << result.measures.volume
            << '\n';
  const Audit& a = result.audit;
  EXPECT_TRUE(a.clean()) << "free " << a.free_edges << ", multiple " << a.multiple_edges << ", conflicts "
                         << a.conflicts << ", open loops " << a.open_loops << ", components " << a.components << " of "
                         << a.shells;
  return result;
}

TEST(Lattice, BodyCentredBlocksHaveTheClosedFormVolume) {
  for (const Vec3 size : {Vec3{5, 5, 5}, Vec3{10.0 / 3, 10.0 / 3, 10.0 / 3}})
    for (const int n : {1, 2, 3}) {
      const double scale = size.x / 5;
      const Case c = realise(bcc(size, 0.5 * scale, 0.9 * scale), block(n, n, n));
      EXPECT_NEAR(c.measures.volume / (n * n * n * bcc_volume(size, 0.5 * scale, 0.9 * scale)), 1, 1e-6);
      EXPECT_EQ(c.measures.solids, 1u);
    }
}

TEST(Lattice, CubicBlocksHaveTheClosedFormVolume) {
  for (const int n : {1, 2, 3, 5}) {
    const Case c = realise(cubic({5, 5, 5}, 0.5, 0.9), block(n, n, n));
    EXPECT_NEAR(c.measures.volume / (n * n * n * cubic_volume({5, 5, 5}, 0.5, 0.9)), 1, 1e-6);
  }
}

/// Every directed triangle edge has its opposite; equal points are equal bit for bit.
std::size_t unmatched_half_edges(const Body& body, double& volume) {
  std::map<std::array<double, 3>, std::uint32_t> ids;
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
  visit_triangles(body, [&](std::span<const Triangle> block) {
    for (const Triangle& t : block) {
      std::array<std::uint32_t, 3> v{};
      for (std::size_t i = 0; i < 3; ++i)
        v[i] = ids.emplace(std::array{t[i].x, t[i].y, t[i].z}, static_cast<std::uint32_t>(ids.size())).first->second;
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t a = v[i], b = v[(i + 1) % 3];
        balance[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
      }
      volume += dot(t[0], cross(t[1], t[2])) / 6;
    }
  });
  std::size_t unmatched = 0;
  for (const auto& [edge, count] : balance) unmatched += count != 0;
  return unmatched;
}

TEST(Lattice, MeshesAreWatertight) {
  const auto corner = [](Index3 c) { return c[0] == 0 || c[1] == 0; };
  for (const LatticeCell& cell : {bcc({5, 5, 5}, 0.5, 0.9), cubic({5, 4, 6}, 0.5, 0.9)}) {
    const Case c = realise(cell, subset(3, 3, 3, corner), {.mesh = MeshFineness{.deflection = 0.02, .angle = 0.3}});
    ASSERT_TRUE(c.body);
    double volume = 0;
    EXPECT_EQ(unmatched_half_edges(*c.body, volume), 0u);
    EXPECT_NEAR(volume / c.measures.volume, 1, 0.03);
  }
}

TEST(Lattice, BallsOnCornersAreWholeInside) {
  // Inside: per cell one ball at the centre, one on corners, eight struts. 3x3x3 cells have 8 whole corner balls.
  const Case c = realise(bcc({5, 5, 5}, 0.5, 0.9), block(3, 3, 3));
  EXPECT_EQ(c.audit.faces, 27u * 9 + 8 + (27 * 8 - 8 * 8) + 9 * 6 * 4);
  const Case cubes = realise(cubic({5, 4, 6}, 0.5, 0.9), block(3, 3, 3));
  // 8 whole balls, 3 * 12 whole struts; on the border pieces and walls.
  EXPECT_EQ(cubes.audit.faces, 8u + 36 + (27 * 8 - 8 * 8) + (27 * 12 - 36 * 4) + 9 * 6);
}

TEST(Lattice, IBeam) {
  for (const int f : {1, 2}) {
    const auto inside = [f](Index3 c) { return c[1] < 2 * f || c[1] >= 10 * f || (c[0] >= 3 * f && c[0] < 7 * f); };
    int count = 0;
    for (int i = 0; i < 10 * f; ++i)
      for (int j = 0; j < 12 * f; ++j) count += inside({i, j, 0});
    const Case c = realise(bcc({5, 5, 5}, 0.5, 0.9), subset(10 * f, 12 * f, 40 * f, inside));
    std::cerr << count * 40 * f << " cells\n";
    EXPECT_NEAR(c.measures.volume / (count * 40 * f * bcc_volume({5, 5, 5}, 0.5, 0.9)), 1, 1e-6);
  }
}

TEST(Lattice, StrutsWithoutBallsReachIntoNeighbours) {
  for (const double ball : {0.5, 0.6}) {
    const Case c = realise(bcc({5, 5, 5}, 0.5, ball), block(3, 3, 3));
    EXPECT_EQ(c.measures.solids, 1u);
  }
}

TEST(Lattice, BoxesThatTouchAlongEdges) {
  CellShape cell{.box = {{0, 0, 0}, {5, 4, 6}}, .solids = {BRepPrimAPI_MakeBox(5, 4, 6).Solid()}, .primitives = {}};
  const Case all = realise(cell, block(3, 3, 3));
  EXPECT_NEAR(all.measures.volume, 27 * 120, 1e-6);
  const Case checker = realise(cell, subset(4, 4, 4, [](Index3 c) { return (c[0] + c[1] + c[2]) % 2 == 0; }));
  EXPECT_NEAR(checker.measures.volume, 32 * 120, 1e-6);
  EXPECT_EQ(checker.measures.solids, 32u);
  const Case bridge = realise(cell, subset(2, 2, 2, [](Index3 c) { return c[2] == 0 || c[0] == c[1]; }));
  EXPECT_NEAR(bridge.measures.volume, 6 * 120, 1e-6);
  EXPECT_EQ(bridge.measures.solids, 1u);
}

TEST(Lattice, BoxMinusBall) {
  CellShape cell{.box = {{0, 0, 0}, {5, 5, 5}}, .solids = {}, .primitives = {}};
  cell.solids.push_back(
      BRepAlgoAPI_Cut(BRepPrimAPI_MakeBox(5, 5, 5).Solid(), BRepPrimAPI_MakeSphere(gp_Pnt(2.5, 2.5, 2.5), 2).Solid())
          .Shape());
  const Case c = realise(cell, block(3, 3, 3));
  EXPECT_NEAR(c.measures.volume / (27 * (125 - 32 * pi / 3)), 1, 1e-9);
  EXPECT_EQ(c.measures.solids, 1u);
  EXPECT_EQ(c.measures.shells, 28u);
  cell.solids = {
      BRepAlgoAPI_Cut(BRepPrimAPI_MakeBox(5, 5, 5).Solid(), BRepPrimAPI_MakeSphere(gp_Pnt(2.5, 2.5, 2.5), 3).Solid())
          .Shape()};
  const Case open = realise(cell, block(3, 3, 3));
  const double caps = 6 * pi * 0.25 * (9 - 0.5) / 3;
  EXPECT_NEAR(open.measures.volume / (27 * (125 - (36 * pi - caps))), 1, 1e-9);
}

}  // namespace
}  // namespace meso::brep
