// SPDX-License-Identifier: Apache-2.0
#include "meso/mesh_distance/mesh_field.hpp"

#include <gtest/gtest.h>

#include "test_meshes.hpp"

namespace meso::implicit {
namespace {

struct Made {
  std::shared_ptr<const MeshField> field;
  std::vector<Code> told;
};

Made make(const TriangleMesh& mesh, const RunOptions& options = {}) {
  DiagnosticSink sink;
  Made made{MeshField::make(mesh, "mesh", options, sink), {}};
  for (const Diagnostic& d : sink.diagnostics()) made.told.push_back(d.code);
  return made;
}

std::shared_ptr<const MeshField> field_of(const TriangleMesh& mesh) {
  Made made = make(mesh);
  EXPECT_TRUE(made.field);
  EXPECT_TRUE(made.told.empty());
  return made.field;
}

/// Distances against long double over all triangles, signs against the sum of solid angles, near the surface and far.
void expect_right(const MeshField& field, const TriangleMesh& mesh, double size, int points, unsigned seed) {
  Random random(seed);
  std::array<int, 2> seen{};
  for (int n = 0; n < points; ++n) {
    const auto& t = mesh.triangles[std::size_t(random.in(0, double(mesh.triangles.size())))];
    const Vec3 on = (mesh.points[t[0]] + mesh.points[t[1]] + mesh.points[t[2]]) / 3;
    const Vec3 p = on + size * std::exp(random.in(-16, 0)) * random.in_cube(1);
    const double d = field.value(p);
    const double exact = static_cast<double>(slow_distance(mesh, p));
    ASSERT_LE(std::abs(std::abs(d) - exact), 1e-12 * exact + 2e-16 * size) << p.x << " " << p.y << " " << p.z;
    const double winding = solid_angle_winding(mesh, p);
    ASSERT_EQ(d<0, std::abs(winding)> 0.5) << p.x << " " << p.y << " " << p.z << ": " << winding;
    ++seen[d < 0 ? 1 : 0];
  }
  EXPECT_GT(std::min(seen[0], seen[1]), points / 20);
}

TEST(MeshField, IcosphereIsABallUpToItsFacets) {
  const TriangleMesh mesh = icosphere(4);
  const auto field = field_of(mesh);
  const double sagitta = facet_sagitta(mesh);
  EXPECT_LT(sagitta, 2e-3);
  EXPECT_TRUE(field->quality().closed);
  Random random(1);
  for (int i = 0; i < 20'000; ++i) {
    const Vec3 p = random.in_cube(1.5);
    const double d = field->value(p);
    ASSERT_LE(d, norm(p) - 1 + sagitta + 1e-14);
    ASSERT_GE(d, norm(p) - 1 - 1e-14);
  }
}

TEST(MeshField, BoxIsExactAndZeroOnlyOnItsSurface) {
  const Vec3 low{-1, -0.5, 0.25}, high{0.75, 1, 2};
  const auto field = field_of(box_mesh(low, high));
  for (double x = -1.5; x <= 2.5; x += 0.25) {
    for (double y = -1.5; y <= 2.5; y += 0.25) {
      for (double z = -1.5; z <= 2.5; z += 0.25) {
        const double exact = box_distance(low, high, {x, y, z});
        ASSERT_NEAR(field->value({x, y, z}), exact, 1e-15);
        ASSERT_EQ(field->value({x, y, z}) == 0, exact == 0);
      }
    }
  }
  EXPECT_LT(field->value({std::nextafter(-1, 0), 0, 1}), 0);
  EXPECT_GT(field->value({std::nextafter(-1, -2), 0, 1}), 0);
  EXPECT_LT(norm(field->closest_point({5, 0.5, 1}) - Vec3{0.75, 0.5, 1}), 1e-15);
}

TEST(MeshField, SaddlesSpikesAndThinPlates) {
  for (const int teeth : {3, 12, 40}) {
    const TriangleMesh mesh = spiky_saddle(teeth);
    expect_right(*field_of(mesh), mesh, 0.5, 2000, unsigned(teeth));
  }
  for (const double thickness : {1e-3, 1e-6, 1e-9}) {
    const Vec3 low{-1, -1, 0}, high{1, 1, thickness};
    const auto field = field_of(box_mesh(low, high));
    Random random(7);
    for (int n = 0; n < 2000; ++n) {
      const Vec3 p{random.in(-1.1, 1.1), random.in(-1.1, 1.1), thickness * random.in(-1, 2)};
      ASSERT_NEAR(field->value(p), box_distance(low, high, p), 1e-12 * thickness + 1e-15);
      ASSERT_EQ(field->value(p) < 0, box_distance(low, high, p) < 0);
    }
  }
}

TEST(MeshField, SpikesHoldNoIslands) {
  // Every node of a grid: inside needs a neighbour inside or on the way to the nearest surface.
  const TriangleMesh mesh = spiky_saddle(6);
  const auto field = field_of(mesh);
  const Grid grid{.box = {{-1.1, -1.1, -0.7}, {1.1, 1.1, 0.7}}, .nodes = {33, 33, 33}};
  for (std::int32_t k = 0; k < 33; ++k) {
    for (std::int32_t j = 0; j < 33; ++j) {
      for (std::int32_t i = 0; i < 33; ++i) {
        const Vec3 p = grid.node(i, j, k);
        ASSERT_EQ(field->value(p) < 0, solid_angle_winding(mesh, p) > 0.5);
      }
    }
  }
}

TEST(MeshField, OverlapsShellsAndDoubledSurfaces) {
  const TriangleMesh ball = icosphere(2), apart = moved(ball, Affine::from_translation({0.7, 0.1, 0.2}));
  const TriangleMesh small = moved(ball, {{{0.5, 0, 0, 0, 0.5, 0, 0, 0, 0.5}}, {0.1, 0, 0}});
  expect_right(*make(together(ball, apart)).field, together(ball, apart), 0.5, 1000, 11);
  const TriangleMesh hollow = together(ball, inverted(small));
  expect_right(*field_of(hollow), hollow, 0.5, 1000, 12);
  EXPECT_GT(field_of(hollow)->value({0.1, 0, 0}), 0.4);
  const Made nested = make(together(ball, small));
  EXPECT_LT(nested.field->value({0.1, 0, 0}), 0);
  EXPECT_EQ(nested.told, std::vector{Code::mesh_overlaps});
  const TriangleMesh twice = together(ball, ball);
  expect_right(*field_of(twice), twice, 0.5, 1000, 13);
}

TEST(MeshField, BuriedWallsAreToldAndNeitherSurfaceNorOutside) {
  const TriangleMesh ball = icosphere(3), other = moved(ball, Affine::from_translation({0.9, 0.1, 0.2}));
  const auto one = field_of(ball), two = field_of(other);
  const Made made = make(together(ball, other));
  EXPECT_EQ(made.told, std::vector{Code::mesh_overlaps});
  EXPECT_GT(made.field->quality().buried, made.field->quality().looked_at / 10);
  Random random(24);
  int buried = 0;
  for (int n = 0; n < 5000; ++n) {
    const Vec3 p = random.in_cube(2);
    const double a = one->value(p), b = two->value(p), f = made.field->value(p);
    // Outside, and so for every offset that grows it, it is the body that both are together.
    if (std::min(a, b) > 0) {
      ASSERT_EQ(f, std::min(a, b));
    }
    // Inside, it is inside; as deep as the nearest wall is far, which is not as deep as the body.
    if (std::min(a, b) < 0) {
      ASSERT_EQ(f, -std::min(std::abs(a), std::abs(b)));
      buried += f > std::min(a, b) + 1e-3 ? 1 : 0;
    }
  }
  EXPECT_GT(buried, 100);
}

TEST(MeshField, BodiesThatTouchInEdgesAndCorners) {
  const Vec3 low{-1, -1, -1}, high{0, 0, 0};
  for (const Vec3 shift : {Vec3{1, 1, 0}, Vec3{1, 1, 1}, Vec3{1, 1, 0.5}}) {
    const TriangleMesh a = box_mesh(low, high);
    const auto field = field_of(together(a, moved(a, Affine::from_translation(shift))));
    Random random(25);
    for (int n = 0; n < 3000; ++n) {
      const Vec3 p = n % 3 == 0 ? std::exp(random.in(-20, 0)) * random.in_cube(1) : random.in_cube(1.5);
      const double exact = std::min(box_distance(low, high, p), box_distance(low + shift, high + shift, p));
      ASSERT_NEAR(field->value(p), exact, 1e-15);
      ASSERT_EQ(field->value(p) < 0, exact < 0);
    }
  }
  // Corners on faces and edges of another body, as T-shapes have them.
  const TriangleMesh post = box_mesh({-0.75, -0.75, 0}, {-0.25, -0.25, 2});
  const Made standing = make(together(box_mesh(low, high), post));
  EXPECT_EQ(standing.told, std::vector{Code::mesh_overlaps});  // where it stands there is a wall between them
  const auto& field = standing.field;
  EXPECT_LT(field->value({-0.5, -0.5, 1}), -0.2);
  EXPECT_LT(field->value({-0.5, -0.5, 0}), 0);
  EXPECT_LT(field->value({-0.5, -0.5, -0.5}), -0.2);
  EXPECT_NEAR(field->value({-0.5, 0.25, 1}), 0.5, 1e-15);
}

TEST(MeshField, SurfacesThatCrossThemselves) {
  // A bow tie as a prism: it goes round one half and, the other way, round the other.
  TriangleMesh bow;
  for (const double z : {-0.5, 0.5})
    for (const Vec3 p : {Vec3{-1, -1, z}, Vec3{1, 1, z}, Vec3{1, -1, z}, Vec3{-1, 1, z}}) bow.points.push_back(p);
  for (std::uint32_t i = 0; i < 4; ++i) {
    const std::uint32_t j = (i + 1) % 4;
    bow.triangles.insert(bow.triangles.end(), {{i, j, j + 4}, {i, j + 4, i + 4}});
  }
  bow.triangles.insert(bow.triangles.end(), {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7}});
  DiagnosticSink sink;
  const auto field = MeshField::make(bow, "bow", {}, sink);
  ASSERT_TRUE(field && field->quality().closed);
  expect_right(*field, bow, 1, 2000, 26);
  // Parts that face different ways are both bodies.
  const TriangleMesh ball = icosphere(2), away = moved(inverted(ball), Affine::from_translation({3, 0, 0}));
  expect_right(*make(together(ball, away)).field, together(ball, away), 0.5, 1000, 27);
}

TEST(MeshField, InsideOutIsTurnedAndTold) {
  const TriangleMesh mesh = inverted(icosphere(2));
  const Made made = make(mesh);
  EXPECT_EQ(made.told, std::vector{Code::mesh_inside_out});
  expect_right(*made.field, mesh, 0.5, 1000, 14);
}

TEST(MeshField, StrayTrianglesAreTurnedAndTold) {
  const TriangleMesh whole = icosphere(2);
  TriangleMesh mesh = whole;
  for (std::size_t t = 0; t < mesh.triangles.size(); t += 7) std::swap(mesh.triangles[t][0], mesh.triangles[t][1]);
  const Made made = make(mesh);
  EXPECT_EQ(made.told, std::vector{Code::mesh_turned});
  EXPECT_EQ(made.field->quality().turned, (mesh.triangles.size() + 6) / 7);
  EXPECT_TRUE(made.field->quality().closed);
  expect_right(*made.field, whole, 0.5, 1000, 15);
}

TEST(MeshField, RepeatedTrianglesAreLeftOut) {
  const TriangleMesh whole = icosphere(2);
  TriangleMesh once_more = whole;
  once_more.triangles.push_back(whole.triangles[5]);
  const Made repeated = make(once_more);
  EXPECT_EQ(repeated.told, std::vector{Code::mesh_repeated});
  expect_right(*repeated.field, whole, 0.5, 1000, 16);

  // Two boxes with a wall between them that has both sides, and a sheet of both sides all over.
  const TriangleMesh boxes =
      together(box_mesh({-1, -1, -1}, {0, 1, 1}),
               inverted(moved(box_mesh({-1, -1, -1}, {0, 1, 1}), {{{-1, 0, 0, 0, 1, 0, 0, 0, 1}}, {}})));
  const Made joined = make(boxes);
  EXPECT_EQ(joined.told, std::vector{Code::mesh_repeated});
  EXPECT_EQ(joined.field->quality().cancelled, 4u);
  Random random(17);
  for (int n = 0; n < 1000; ++n) {
    const Vec3 p = random.in_cube(1.5);
    ASSERT_NEAR(joined.field->value(p), box_distance({-1, -1, -1}, {1, 1, 1}, p), 1e-15);
  }
  const Made sheet = make(together(whole, inverted(whole)));
  EXPECT_EQ(sheet.field->quality().cancelled, whole.triangles.size());
  expect_right(*sheet.field, whole, 0.5, 1000, 18);
}

TEST(MeshField, OpenMeshesAreToldAndSignedByTheWindingNumber) {
  TriangleMesh bowl = icosphere(3);
  std::erase_if(bowl.triangles, [&](const auto& t) { return bowl.points[t[0]].z + bowl.points[t[1]].z > 0.1; });
  const Made made = make(bowl);
  EXPECT_EQ(made.told, std::vector{Code::mesh_not_closed});
  EXPECT_FALSE(made.field->quality().closed);
  EXPECT_GT(made.field->quality().open_edges, 20u);
  EXPECT_EQ(made.field->lipschitz(), HUGE_VAL);
  Random random(19);
  int inside = 0;
  for (int n = 0; n < 5000; ++n) {
    const Vec3 p = random.in_cube(1.2);
    const double winding = solid_angle_winding(bowl, p), d = made.field->value(p);
    inside += d < 0 ? 1 : 0;
    if (std::abs(std::abs(winding) - 0.5) > 0.03) {
      ASSERT_EQ(d<0, std::abs(winding)> 0.5) << winding;
    }
    ASSERT_NEAR(std::abs(d), static_cast<double>(slow_distance(bowl, p)), 1e-14);
  }
  EXPECT_GT(inside, 300);
  EXPECT_LT(made.field->value({0, 0, -0.9}), 0);
  EXPECT_GT(made.field->value({0, 0, -1.1}), 0);
}

TEST(MeshField, TJunctionsLeaveNoLeaks) {
  // One face of a box split at the middle of an edge that its neighbour does not split.
  const Vec3 low{-1, -1, -1}, high{1, 1, 1};
  TriangleMesh mesh = box_mesh(low, high);
  mesh.points.push_back({0, -1, -1});
  mesh.triangles.erase(mesh.triangles.begin() + 1);
  mesh.triangles.insert(mesh.triangles.end(), {{0, 3, 8}, {8, 3, 1}});
  const Made made = make(mesh);
  EXPECT_EQ(made.told, std::vector{Code::mesh_not_closed});
  Random random(20);
  for (int n = 0; n < 5000; ++n) {
    const Vec3 p = random.in_cube(1.5);
    ASSERT_NEAR(made.field->value(p), box_distance(low, high, p), 1e-15);
  }
}

TEST(MeshField, DegenerateTrianglesCountAsEdges) {
  TriangleMesh mesh = box_mesh({-1, -1, -1}, {1, 1, 1});
  mesh.points.push_back({3, 0, 0});
  mesh.triangles.insert(mesh.triangles.end(), {{1, 8, 1}, {5, 5, 5}});  // a hair and a point
  const auto field = field_of(mesh);
  EXPECT_EQ(field->quality().degenerate, 2u);
  EXPECT_TRUE(field->quality().closed);
  EXPECT_NEAR(field->value({3, 1, 0}), 1, 1e-15);
  EXPECT_NEAR(field->value({0, 0, 0.5}), -0.5, 1e-15);
}

TEST(MeshField, FarFromTheOriginAndSmall) {
  const TriangleMesh ball = icosphere(2);
  for (const auto& [scale, shift] : {std::pair{1.0, 1e6}, {1e-6, 0.0}, {1e-6, 1.0}, {1e6, 0.0}, {1e-12, 0.0}}) {
    const TriangleMesh mesh = moved(ball, {{{scale, 0, 0, 0, scale, 0, 0, 0, scale}}, {shift, -shift, 0.5 * shift}});
    expect_right(*field_of(mesh), mesh, 0.5 * scale + 1e-16 * shift, 1000, 21);
  }
}

TEST(MeshField, GradientHasNormOneAndTheFieldIsLipschitz) {
  const TriangleMesh mesh = together(icosphere(3), moved(spiky_saddle(12), Affine::from_translation({0.5, 0.9, 0})));
  const auto field = make(mesh).field;
  EXPECT_EQ(field->lipschitz(), 1);
  Random random(22);
  int off_axis = 0;
  for (int n = 0; n < 100'000; ++n) {
    const Vec3 p = random.in_cube(1.5), q = p + std::exp(random.in(-12, 1)) * random.in_cube(1);
    ASSERT_LE(std::abs(field->value(p) - field->value(q)), norm(p - q) + 1e-14);
    if (n % 10 != 0) continue;
    constexpr double h = 1e-6;
    const Vec3 slope{field->value(p + Vec3{h, 0, 0}) - field->value(p - Vec3{h, 0, 0}),
                     field->value(p + Vec3{0, h, 0}) - field->value(p - Vec3{0, h, 0}),
                     field->value(p + Vec3{0, 0, h}) - field->value(p - Vec3{0, 0, h})};
    off_axis += std::abs(norm(slope) / (2 * h) - 1) < 1e-6 ? 1 : 0;
  }
  EXPECT_GT(off_axis, 9800);  // the rest is next to the medial axis
}

TEST(MeshField, IntervalsAndBoundsHoldWhatTheySay) {
  for (const bool open : {false, true}) {
    TriangleMesh mesh = icosphere(3);
    if (open) std::erase_if(mesh.triangles, [&](const auto& t) { return mesh.points[t[0]].z > 0.5; });
    const auto field = make(mesh).field;
    Random random(23);
    for (int n = 0; n < 200; ++n) {
      Box3 box;
      box.extend(random.in_cube(1.5));
      box.extend(box.min + std::exp(random.in(-6, 0)) * random.in_cube(1));
      const Interval range = field->interval(box);
      for (int s = 0; s < 50; ++s) {
        const Vec3 p{random.in(box.min.x, box.max.x), random.in(box.min.y, box.max.y), random.in(box.min.z, box.max.z)};
        const double v = field->value(p);
        ASSERT_TRUE(range.contains(v));
        for (const double level : {-0.2, 0.0, 0.3}) {
          const Box3 bounds = field->bounds(level);
          if (v <= level) {
            ASSERT_TRUE(bounds.intersects({p, p}));
          }
        }
      }
    }
    EXPECT_EQ(field->bounds(-1.5).empty(), !open);
  }
}

TEST(MeshField, RefusesWhatIsNoMesh) {
  EXPECT_EQ(make({}).told, std::vector{Code::mesh_empty});
  TriangleMesh mesh = icosphere(0);
  mesh.points[3].y = NAN;
  EXPECT_EQ(make(mesh).told, std::vector{Code::mesh_coordinates});
  EXPECT_EQ(make(icosphere(2), {.max_memory_bytes = 10'000}).told, std::vector{Code::mesh_memory});
  EXPECT_EQ(make(icosphere(2), {.cancelled = [] { return true; }}).told, std::vector{Code::cancelled});
  EXPECT_EQ(make(icosphere(2), {.deadline = std::chrono::steady_clock::now()}).told, std::vector{Code::limit_time});
}

}  // namespace
}  // namespace meso::implicit
