// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <map>
#include <numbers>

#include "lattice/primitive_field.hpp"
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

/// Struts along the axes between balls on the corners, all moved by `offset`.
LatticeCell cubic(Vec3 size, double strut, double ball, Vec3 offset = {}) {
  LatticeCell cell{.box = {{0, 0, 0}, size}, .primitives = {}};
  for (int i = 0; i < 8; ++i) {
    const Vec3 corner{i & 1 ? size.x : 0, i & 2 ? size.y : 0, i & 4 ? size.z : 0};
    cell.primitives.push_back(Ball{corner + offset, ball});
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (corner[axis] > 0) continue;
      Vec3 end = corner;
      end[axis] = size[axis];
      cell.primitives.push_back(Frustum{corner + offset, end + offset, strut, strut});
    }
  }
  return cell;
}

/// A strut that leaves a ball cuts a cap from it, and begins `height` from its centre.
struct Joint {
  double strut, ball;
  double height = std::sqrt(ball * ball - strut * strut);
  double sagitta = ball - height;
  double cap = pi * sagitta * sagitta * (3 * ball - sagitta) / 3;
  double ball_volume = 4 * pi / 3 * ball * ball * ball;

  /// Of `length` from centre to centre, less the caps at `ends`.
  [[nodiscard]] double strut_volume(double length, int ends) const {
    return pi * strut * strut * (length - ends * height) - ends * cap;
  }
};

double bcc_volume(Vec3 size, const Joint& joint) {
  return 2 * joint.ball_volume + 8 * joint.strut_volume(0.5 * norm(size), 2);
}
double cubic_volume(Vec3 size, const Joint& joint) {
  return joint.ball_volume + joint.strut_volume(size.x + size.y + size.z, 6);
}

LatticeSet subset(int x, int y, int z, std::function<bool(Index3)> inside) {
  return {.min = {0, 0, 0}, .max = {x - 1, y - 1, z - 1}, .inside = std::move(inside)};
}
LatticeSet block(int x, int y, int z) {
  return subset(x, y, z, [](Index3) { return true; });
}

struct Result {
  std::optional<Body> body;
  Audit audit;
  Measures measures;
};

/// The body, with every shell closed.
template <typename Cell>
Result realise(const Cell& cell, const LatticeSet& set, const LatticeOptions& options = {}) {
  DiagnosticSink sink;
  Result result{.body = lattice_body(cell, set, options, sink), .audit = {}, .measures = {}};
  for (const Diagnostic& d : sink.diagnostics()) ADD_FAILURE() << render(d);
  if (!result.body) return result;
  result.measures = measure(*result.body);
  result.audit = audit(*result.body);
  const Audit& a = result.audit;
  EXPECT_TRUE(a.clean()) << "free " << a.free_edges << ", multiple " << a.multiple_edges << ", conflicts "
                         << a.conflicts << ", open loops " << a.open_loops << ", components " << a.components << " of "
                         << a.shells;
  return result;
}

CellShape solid_cell(Vec3 size, const TopoDS_Shape& solid) {
  return {.box = {{0, 0, 0}, size}, .solids = {solid}, .primitives = {}};
}
TopoDS_Shape box_minus_ball(double edge, double radius) {
  const TopoDS_Shape ball = BRepPrimAPI_MakeSphere(gp_Pnt(edge / 2, edge / 2, edge / 2), radius).Solid();
  return BRepAlgoAPI_Cut(BRepPrimAPI_MakeBox(edge, edge, edge).Solid(), ball).Shape();
}

TEST(Lattice, BodyCentredCellsAddUp) {
  const Joint joint{0.5, 0.9};
  EXPECT_NEAR(bcc_volume({5, 5, 5}, joint), 22.928246, 1e-6);
  for (const int n : {1, 4, 8}) {
    const Result r = realise(bcc({5, 5, 5}, 0.5, 0.9), block(n, n, n));
    EXPECT_NEAR(r.measures.volume / (n * n * n * bcc_volume({5, 5, 5}, joint)), 1, 1e-8);
    EXPECT_EQ(r.measures.solids, 1u);
    EXPECT_NEAR(norm(r.measures.centroid - Vec3{2.5 * n, 2.5 * n, 2.5 * n}), 0, 1e-6);
  }
}

TEST(Lattice, APeriodThatIsNotDyadic) {
  const double a = 10.0 / 3;
  const Result r = realise(bcc({a, a, a}, 0.1 * a, 0.18 * a), block(3, 2, 3));
  EXPECT_NEAR(r.measures.volume / (18 * bcc_volume({a, a, a}, {0.1 * a, 0.18 * a})), 1, 1e-8);
}

TEST(Lattice, WallsBesideTheCentresOfBalls) {
  // Nodes written with six digits: the walls pass 3e-7 beside them, where OpenCASCADE divides nothing.
  const double a = 10.0 / 3, r = 0.4864;
  const Vec3 size{a, a, a}, corner{3.333333, 3.333333, 3.333333}, centre{1.666667, 1.666667, 1.666667};
  LatticeCell cell{.box = {{0, 0, 0}, size}, .primitives = {}};
  for (const Vec3 p : {Vec3{}, centre, corner}) cell.primitives.push_back(Ball{p, r});
  cell.primitives.push_back(Frustum{{}, centre, r, r});
  cell.primitives.push_back(Frustum{centre, corner, r, r});
  const Result result = realise(cell, block(2, 2, 1));
  // Four capsules, less what sticks out. Of a capsule along a space diagonal, beyond one wall through its end's centre,
  // beyond two, and beyond three: part of a half ball (Girard), and of the strut's end (linear over its disc).
  const double angle = std::acos(1 / std::sqrt(3.0));
  const double one = 2.0 / 3 * (pi - angle) + 2 * std::sqrt(2.0) / 3;
  const double two = (1.5 * pi - 2 * angle) / 3 + std::sqrt(2.0) / 3 * (2 - std::sqrt(3.0)), three = pi / 6;
  const double capsule = pi * r * r * std::sqrt(3.0) * a + 4 * pi / 3 * r * r * r;
  const double truth = 4 * capsule - (16 * one - 10 * two + 2 * three) * r * r * r;
  EXPECT_NEAR(result.measures.volume / truth, 1, 1e-5);
}

TEST(Lattice, AnisotropicBoxes) {
  const Vec3 size{5, 4, 6};
  const Result inside = realise(cubic(size, 0.5, 0.9), block(2, 3, 2));
  EXPECT_NEAR(inside.measures.volume / (12 * cubic_volume(size, {0.5, 0.9})), 1, 1e-8);
  // The narrowest angle between struts needs balls of 1.1: with 1.2 every strut ends in a circle.
  const Result diagonal = realise(bcc(size, 0.5, 1.2), block(2, 2, 2));
  EXPECT_NEAR(diagonal.measures.volume / (8 * bcc_volume(size, {0.5, 1.2})), 1, 1e-8);
}

TEST(Lattice, FacesAreWholeAcrossCells) {
  // Per cell a centre ball, eight struts and eight octants; walls show four quarter discs. Of 3x3x3 cells eight corner
  // balls are whole, one face for eight octants.
  const Result diagonal = realise(bcc({5, 5, 5}, 0.5, 0.9), block(3, 3, 3));
  EXPECT_EQ(diagonal.audit.faces, 27u * 9 + 27 * 8 - 8 * 7 + 54 * 4);
  // Per cell eight octants and twelve quarter struts; 36 struts inside are whole, one face for four. A wall is one
  // frame.
  const Result straight = realise(cubic({5, 5, 5}, 0.5, 0.9), block(3, 3, 3));
  EXPECT_EQ(straight.audit.faces, 27u * 8 - 8 * 7 + 27 * 12 - 36 * 3 + 54);
}

TEST(Lattice, BeamOf2240Cells) {
  const auto in_section = [](Index3 c) { return c[1] < 2 || c[1] >= 10 || c[0] == 4 || c[0] == 5; };
  const Result r = realise(bcc({5, 5, 5}, 0.5, 0.9), subset(10, 12, 40, in_section));
  EXPECT_NEAR(r.measures.volume / 51359.271, 1, 1e-6);
  EXPECT_EQ(r.measures.solids, 1u);
  EXPECT_NEAR(r.measures.box.max.z, 200, 1e-6);
}

TEST(Lattice, CellsThatReachFarIntoTheirNeighbours) {
  // Nodes at o + 5 k: each line of struts starts in its first ball and ends in the far wall, 15 away.
  const Vec3 o{2.5, 1.3, 1.7};
  const Joint joint{0.5, 0.9};
  double truth = 27 * joint.ball_volume;
  for (std::size_t axis = 0; axis < 3; ++axis) truth += 9 * joint.strut_volume(15 - o[axis], 5);
  const Result r = realise(cubic({5, 5, 5}, 0.5, 0.9, o), block(3, 3, 3));
  EXPECT_NEAR(r.measures.volume / truth, 1, 1e-6);
}

TEST(Lattice, ConesJoinAcrossFourCells) {
  // Lines along z on the box edges, waisted in the middle.
  LatticeCell cell{.box = {{0, 0, 0}, {5, 5, 6}}, .primitives = {}};
  for (int i = 0; i < 4; ++i) {
    const Vec3 foot{i & 1 ? 5.0 : 0, i & 2 ? 5.0 : 0, 0};
    cell.primitives.push_back(Frustum{foot, foot + Vec3{0, 0, 3}, 1, 0.5});
    cell.primitives.push_back(Frustum{foot + Vec3{0, 0, 3}, foot + Vec3{0, 0, 6}, 0.5, 1});
  }
  const Result r = realise(cell, block(4, 4, 2));
  EXPECT_NEAR(r.measures.volume / (32 * pi * 6 / 3 * (1 + 0.5 + 0.25)), 1, 1e-9);
  EXPECT_EQ(r.measures.solids, 25u);  // lines of struts, cut ones on the rim
  const Result whole = realise(cell, block(2, 2, 1));
  // The inner line: two whole cones. Four half and four quarter lines: quarter cones. Quarter discs at all ends, flat
  // walls on the rim.
  EXPECT_EQ(whole.audit.faces, (2u + 8) + 4 * (4 + 4 + 2) + 4 * (2 + 2 + 2));
}

TEST(Lattice, StrutsWithoutBallsStickOutOfTheirBoxes) {
  LatticeCell cell = bcc({5, 5, 5}, 0.5, 0.1);
  std::erase_if(cell.primitives, [](const CellPrimitive& p) { return std::holds_alternative<Ball>(p); });
  const Result r = realise(cell, block(2, 2, 1));
  double truth = 0;  // box by box, every placed strut, no boolean
  for (int box = 0; box < 4; ++box) {
    std::vector<CellPrimitive> all;
    for (int other = 0; other < 4; ++other)
      for (const CellPrimitive& p : cell.primitives)
        all.push_back(translated(p, {5.0 * (other % 2 - box % 2), 5.0 * (other / 2 - box / 2), 0}));
    truth += sampled_volume(all, cell.box);
  }
  EXPECT_NEAR(r.measures.volume / truth, 1, 4e-3);  // what sampling is good for
  EXPECT_EQ(r.measures.solids, 1u);
}

/// Every directed triangle edge has its opposite; points are equal only if they are so bit for bit.
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
  const LatticeOptions options{.mesh = MeshFineness{.deflection = 0.02, .angle = 0.3}};
  const LatticeSet set = subset(3, 3, 3, [](Index3 c) { return c[0] == 0 || c[1] == 0; });
  for (const Result& r :
       {realise(bcc({5, 5, 5}, 0.5, 0.9), set, options), realise(cubic({5, 4, 6}, 0.5, 0.9, {1, 2, 0}), set, options),
        realise(solid_cell({5, 5, 5}, box_minus_ball(5, 3)), set, options)}) {
    ASSERT_TRUE(r.body);
    double volume = 0;
    EXPECT_EQ(unmatched_half_edges(*r.body, volume), 0u);
    EXPECT_NEAR(volume / r.measures.volume, 1, 0.03);
  }
}

TEST(Lattice, FullBoxesLoseTheirCommonWalls) {
  const Result r = realise(solid_cell({5, 4, 6}, BRepPrimAPI_MakeBox(5, 4, 6).Solid()), block(3, 3, 3));
  EXPECT_EQ(r.audit.faces, 54u);
  EXPECT_NEAR(r.measures.volume, 27 * 120, 1e-8);
}

TEST(Lattice, BoxesThatTouchAlongEdgesAreSolidsOfTheirOwn) {
  const CellShape cell = solid_cell({5, 4, 6}, BRepPrimAPI_MakeBox(5, 4, 6).Solid());
  const Result checker = realise(cell, subset(4, 4, 4, [](Index3 c) { return (c[0] + c[1] + c[2]) % 2 == 0; }));
  EXPECT_EQ(checker.measures.solids, 32u);
  EXPECT_EQ(checker.body->fragments, 31u);
  EXPECT_NEAR(checker.measures.volume, 32 * 120, 1e-8);
}

TEST(Lattice, ASolidThatTouchesItselfAlongAnEdgeStaysOne) {
  const CellShape cell = solid_cell({5, 4, 6}, BRepPrimAPI_MakeBox(5, 4, 6).Solid());
  const Result towers = realise(cell, subset(2, 2, 2, [](Index3 c) { return c[2] == 0 || c[0] == c[1]; }));
  EXPECT_EQ(towers.measures.solids, 1u);
  EXPECT_NEAR(towers.measures.volume, 6 * 120, 1e-8);
}

TEST(Lattice, BallsInBoxesAreVoids) {
  const CellShape cell = solid_cell({5, 5, 5}, box_minus_ball(5, 2));
  const LatticeSet ring = subset(3, 3, 2, [](Index3 c) { return c[0] != 1 || c[1] != 1; });
  const Result r = realise(cell, ring);
  EXPECT_EQ(r.measures.solids, 1u);
  EXPECT_EQ(r.measures.shells, 17u);
  EXPECT_NEAR(r.measures.volume / (16 * (125 - 32 * pi / 3)), 1, 1e-9);
}

TEST(Lattice, BallsThatOpenTheWalls) {
  // The sphere's seam divides the circle in one wall only; the opposite one is divided alike.
  const Result r = realise(solid_cell({5, 5, 5}, box_minus_ball(5, 3)), block(3, 2, 3));
  const double cap = pi * 0.25 * (9 - 0.5) / 3;
  EXPECT_NEAR(r.measures.volume / (18 * (125 - 36 * pi + 6 * cap)), 1, 1e-9);
  EXPECT_EQ(r.measures.shells, 1u);
}

TEST(Lattice, WallsThatOverlapInPartAreLeftToTheGeneralPath) {
  // Discs of different radii on opposite walls.
  const TopoDS_Shape cone = BRepAlgoAPI_Common(BRepPrimAPI_MakeBox(5, 5, 5).Solid(),
                                               BRepPrimAPI_MakeCone(gp_Ax2(gp_Pnt(0, 2.5, 2.5), gp::DX()), 2, 1, 5))
                                .Shape();
  DiagnosticSink sink;
  EXPECT_FALSE(lattice_body(solid_cell({5, 5, 5}, cone), block(2, 1, 1), {}, sink));
  ASSERT_EQ(sink.diagnostics().size(), 1u);
  EXPECT_EQ(sink.diagnostics()[0].code, Code::geometry_not_repeatable);
  EXPECT_FALSE(sink.has_errors());
}

TEST(Lattice, PrimitivesWithoutExtentAreRefused) {
  DiagnosticSink sink;
  const LatticeCell cell{.box = {{0, 0, 0}, {5, 5, 5}}, .primitives = {Frustum{{1, 1, 1}, {1, 1, 1}, 1, 1}}};
  EXPECT_FALSE(lattice_body(cell, block(1, 1, 1), {}, sink));
  EXPECT_EQ(sink.diagnostics().size(), 1u);
}

}  // namespace
}  // namespace meso::brep
