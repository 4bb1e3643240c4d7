// SPDX-License-Identifier: Apache-2.0
// A deep check must pass what is right and see what is not: bodies are damaged on purpose.
#include "deep_verify.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <numbers>

namespace meso::operations {
namespace {

class DeepVerify : public ::testing::Test {
 protected:
  void SetUp() override {
    file_ = std::filesystem::path(::testing::TempDir()) /
            ("deep_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()) + ".meso");
  }
  void TearDown() override { std::filesystem::remove(file_); }

  /// A block with four balls in it.
  void write(const std::string& macrostructure = "<box x='0' y='-5' z='-5' dx='20' dy='10' dz='10'/>",
             const std::string& rule = "") {
    std::ofstream(file_)
        << "<meso xmlns='urn:meso-format:1.0' version='1.0' unit='millimeter'><macrostructures>"
           "<macrostructure id='m'><csg>" +
               macrostructure +
               "</csg></macrostructure></macrostructures>"
               "<unitCells><unitCell id='u'><box x='-1' y='-1' z='-1' dx='2' dy='2' dz='2'/><csg><sphere "
               "radius='1'/></csg></unitCell></unitCells><patterns><pattern id='c' unitCell='u'><loop "
               "index='i' axis='x' count='4' start='4' spacing='4'/></pattern></patterns><parts><part id='p' "
               "macrostructure='m'><apply pattern='c' operation='difference' " +
               rule + "/></part></parts></meso>";
  }
  /// Names of the checks that fail after `damage`.
  template <class Damage>
  std::vector<std::string> failures(Damage damage, std::optional<std::size_t> points = 100'000) {
    auto made = make_body(file_, {.part = "p", .mesh = true, .deflection_mm = 0.01}, sink_);
    if (!made) return {"not made"};
    damage(made->realisation.body);
    VerifyReport report;
    EXPECT_TRUE(check_deep(report, *made, *made->evaluation.find_part("p"), {.points = points}, {}, sink_));
    if (!report.deep.empty()) figures_ = report.deep.front();
    notes_ = report.notes;
    told_ = {};
    for (const Check& c : report.checks) told_.push_back(c.what);
    std::vector<std::string> names;
    for (const Check& c : report.checks)
      if (!c.passed) names.push_back(c.what);
    return names;
  }
  /// A template that is like that of the outer shell, but for `change`.
  template <class Change>
  static void change_outer(brep::Body& body, Change change) {
    brep::Template changed = *body.solids[0].outer.geometry;
    change(changed);
    body.solids[0].outer.geometry = std::make_shared<const brep::Template>(std::move(changed));
  }
  std::filesystem::path file_;
  DiagnosticSink sink_;
  DeepFigures figures_;
  std::vector<std::string> notes_, told_;
};

using Names = std::vector<std::string>;

TEST_F(DeepVerify, AWholeBodyPasses) {
  write();
  EXPECT_EQ(failures([](brep::Body&) {}), Names{});
  const double volume = 2000 - 16 * std::numbers::pi / 3;
  EXPECT_NEAR(figures_.shells_volume, volume, 1e-6);
  EXPECT_NEAR(figures_.pieces_volume, volume, 1e-6);
  EXPECT_NEAR(figures_.points_volume, volume, 4 * figures_.sigma);
  EXPECT_NEAR(figures_.triangles_volume + figures_.triangles_gap_volume, volume, 5e-3);
  EXPECT_LT(figures_.edge_gap, 1e-6);
  EXPECT_EQ(figures_.solids, 1u);
  ASSERT_EQ(figures_.shell_volumes.size(), 5u);
  ASSERT_EQ(figures_.read_back_volumes.size(), 5u);
  EXPECT_NEAR(figures_.read_back_volumes.back(), 2000, 1e-3);
}

TEST_F(DeepVerify, EnoughPointsForHalfAPercent) {
  write();
  EXPECT_EQ(failures([](brep::Body&) {}, std::nullopt), Names{});
  EXPECT_LE(figures_.sigma, 1.05e-3 * figures_.shells_volume);
}

TEST_F(DeepVerify, AMissingVoid) {
  write();
  EXPECT_EQ(failures([](brep::Body& body) { body.solids[0].voids.pop_back(); }),
            (Names{"volume of pieces", "volume by points", "points misjudged"}));
}

TEST_F(DeepVerify, DroppingWhatIsNotThereHidesNothing) {
  write("<box x='0' y='-5' z='-5' dx='20' dy='10' dz='10'/>", "fragments='drop'");
  EXPECT_EQ(failures([](brep::Body&) {}), Names{});
  EXPECT_TRUE(std::ranges::count(told_, "volume by points"));
  const Names found = failures([](brep::Body& body) { body.solids[0].voids.pop_back(); });
  EXPECT_TRUE(std::ranges::count(found, "volume by points"));
  EXPECT_TRUE(std::ranges::count(found, "points misjudged"));
}

// Around a point of a cylinder, close to where the next one touches it, everything is inside one of both.
TEST_F(DeepVerify, CylindersThatTouchInLines) {
  std::ofstream(file_)
      << "<meso xmlns='urn:meso-format:1.0' version='1.0' unit='millimeter'><unitCells><unitCell id='u'>"
         "<csg><cylinder x1='0' y1='0' z1='-5' x2='0' y2='0' z2='5' radius='1'/></csg></unitCell>"
         "</unitCells><patterns><pattern id='c' unitCell='u'><loop index='i' axis='x' count='4' "
         "spacing='2'/></pattern></patterns><parts><part id='p'><apply pattern='c' "
         "operation='union'/></part></parts></meso>";
  EXPECT_EQ(failures([](brep::Body&) {}, 300'000), Names{});
  EXPECT_EQ(figures_.solids, 4u);
  const Names found = failures([](brep::Body& body) { body.solids.pop_back(); }, 300'000);
  EXPECT_TRUE(std::ranges::count(found, "points misjudged"));
}

TEST_F(DeepVerify, WhatPointsCannotTellIsNoted) {
  write("<cylinder x1='0' y1='0' z1='0' x2='20' y2='0' z2='0' radius='0.5'/>", "fragments='drop'");
  EXPECT_EQ(failures([](brep::Body&) {}), Names{});
  EXPECT_EQ(figures_.solids, 1u);
  EXPECT_FALSE(std::ranges::count(told_, "volume by points"));
  EXPECT_TRUE(
      std::ranges::any_of(notes_, [](const auto& n) { return n.starts_with("volume by points: not checked"); }));
  EXPECT_TRUE(std::ranges::any_of(notes_, [](const auto& n) { return n.starts_with("points misjudged: no point"); }));
}

TEST_F(DeepVerify, TrianglesFarFromTheirFaces) {
  write();
  const Names found = failures([](brep::Body& body) {
    brep::Template changed = *body.solids[0].voids[0].geometry;
    for (brep::FaceTemplate& face : changed.faces)
      for (brep::MeshPoint& p : face.mesh.points) {
        const Vec3 centre = std::get<brep::SphereSurface>(face.surface).frame.origin;
        p.point = centre + 0.9 * (p.point - centre);
      }
    body.solids[0].voids[0].geometry = std::make_shared<const brep::Template>(std::move(changed));
  });
  EXPECT_TRUE(std::ranges::count(found, "triangles from faces"));
}

TEST_F(DeepVerify, AMissingShell) {
  write();
  const Names found = failures([](brep::Body& body) {
    brep::Solid& solid = body.solids[0];
    solid.outer = solid.voids.back();
    solid.voids.clear();
  });
  EXPECT_TRUE(std::ranges::count(found, "volume of pieces"));
  EXPECT_TRUE(std::ranges::count(found, "volume by points"));
}

TEST_F(DeepVerify, AFlippedFace) {
  write();
  const Names found = failures([](brep::Body& body) {
    change_outer(body, [](brep::Template& geometry) {
      brep::FaceTemplate& face = geometry.faces[0];
      face.reversed = !face.reversed;
      for (auto& loop : face.loops) {
        std::ranges::reverse(loop);
        for (brep::Coedge& use : loop) use.reversed = !use.reversed;
      }
      for (auto& triangle : face.mesh.triangles) std::swap(triangle[0], triangle[1]);
      for (Vec3* moment : {&face.moments.volume_moment, &face.moments.vector_area, &face.moments.centroid_moment})
        *moment = -*moment;
    });
  });
  EXPECT_TRUE(std::ranges::count(found, "orientation conflicts"));
  EXPECT_TRUE(std::ranges::count(found, "unmatched half-edges"));
  EXPECT_EQ(figures_.unmatched_half_edges, 8u);  // the face's four sides, each used twice in one direction
}

TEST_F(DeepVerify, AMovedVertex) {
  write();
  EXPECT_EQ(failures([](brep::Body& body) {
              change_outer(body, [](brep::Template& geometry) { geometry.vertices[0].x += 0.01; });
            }).front(),
            "vertices from edges");
}

TEST_F(DeepVerify, ATriangleThatIsElsewhere) {
  write();
  const Names found = failures([](brep::Body& body) {
    change_outer(body, [](brep::Template& geometry) { geometry.faces[0].mesh.points[0].point.x += 1e-3; });
  });
  EXPECT_TRUE(std::ranges::count(found, "unmatched half-edges"));
}

TEST_F(DeepVerify, ABodyThatIsSlightlyTooLarge) {
  write();
  const double scale = std::cbrt(1.006);
  const auto enlarge = [&](brep::Body& body) {
    for (brep::Solid& solid : body.solids) {
      solid.outer.placement = Affine{Mat3::from_columns({scale, 0, 0}, {0, scale, 0}, {0, 0, scale}), {}};
      for (brep::Shell& hollow : solid.voids) hollow.placement = solid.outer.placement * hollow.placement;
    }
    body.pieces_volume *= 1.006;  // as if nobody had known
  };
  const Names found = failures(enlarge, std::nullopt);
  EXPECT_TRUE(std::ranges::count(found, "volume by points"));
  EXPECT_GT(figures_.difference, 3 * figures_.sigma);
}

TEST_F(DeepVerify, AVoidThatIsElsewhere) {
  write();
  EXPECT_EQ(failures([](brep::Body& body) { body.solids[0].voids[2].placement.translation.y += 0.5; }),
            Names{"points misjudged"});
}

TEST_F(DeepVerify, AMissingFace) {
  write();
  const Names found = failures([](brep::Body& body) {
    brep::Shell& shell = body.solids[0].outer;
    shell.visit = [all = shell.visit](const std::function<void(const brep::FaceInstance&)>& callback) {
      bool first = true;
      all([&](const brep::FaceInstance& face) {
        if (!std::exchange(first, false)) callback(face);
      });
    };
  });
  EXPECT_TRUE(std::ranges::count(found, "free edges"));
  EXPECT_TRUE(std::ranges::any_of(found, [](const std::string& name) { return name.starts_with("volume by "); }));
}

TEST_F(DeepVerify, ASolidTooMany) {
  write();
  const Names found = failures([](brep::Body& body) {
    body.solids.push_back(body.solids[0]);
    body.solids[1].outer.placement.translation.x += 30;
    for (brep::Shell& hollow : body.solids[1].voids) hollow.placement.translation.x += 30;
  });
  EXPECT_EQ(found, (Names{"volume of pieces", "solids", "volume by points", "points misjudged"}));
}

TEST_F(DeepVerify, DocumentsWithoutStatedValues) {
  write("<cylinder x1='0' y1='0' z1='0' x2='20' y2='0' z2='0' radius='4'/>");
  EXPECT_FALSE(verify(file_, {}, {}, sink_));
  sink_ = DiagnosticSink();
  const auto report = verify(file_, {}, DeepCheck{.points = 50'000}, sink_);
  ASSERT_TRUE(report);
  EXPECT_TRUE(report->passed());
  EXPECT_GT(report->checks.size(), 10u);
}

TEST_F(DeepVerify, AStopIsObeyed) {
  write();
  MakeOptions options;
  options.run.deadline = std::chrono::steady_clock::now() - std::chrono::seconds(1);
  EXPECT_FALSE(verify(file_, options, DeepCheck{}, sink_));
  EXPECT_TRUE(sink_.has_errors());
}

}  // namespace
}  // namespace meso::operations
