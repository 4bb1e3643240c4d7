// SPDX-License-Identifier: Apache-2.0
// A deep check must pass what is right and see what is not: bodies are damaged on purpose.
#include "deep_verify.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

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
  void write(const std::string& macrostructure = "<box x='0' y='-5' z='-5' dx='20' dy='10' dz='10'/>") {
    std::ofstream(file_)
        << "<meso xmlns='urn:meso-format:1.0' version='1.0' unit='millimeter'><macrostructures>"
           "<macrostructure id='m'><csg>" +
               macrostructure +
               "</csg></macrostructure></macrostructures>"
               "<unitCells><unitCell id='u'><box x='-1' y='-1' z='-1' dx='2' dy='2' dz='2'/><csg><sphere "
               "radius='1'/></csg></unitCell></unitCells><patterns><pattern id='c' unitCell='u'><loop "
               "index='i' axis='x' count='4' start='4' spacing='4'/></pattern></patterns><parts><part id='p' "
               "macrostructure='m'><apply pattern='c' operation='difference'/></part></parts></meso>";
  }
  /// Names of the checks that fail after `damage`.
  template <class Damage>
  std::vector<std::string> failures(Damage damage) {
    auto made = make_body(file_, {.part = "p", .mesh = true, .deflection_mm = 0.01}, sink_);
    if (!made) return {"not made"};
    damage(made->realisation.body);
    VerifyReport report;
    EXPECT_TRUE(check_deep(report, *made, *made->evaluation.find_part("p"), {.points = 100'000}, {}, sink_));
    std::vector<std::string> names;
    for (const Check& c : report.checks)
      if (!c.passed) names.push_back(c.what);
    return names;
  }
  std::filesystem::path file_;
  DiagnosticSink sink_;
};

using Names = std::vector<std::string>;

TEST_F(DeepVerify, AWholeBodyPasses) {
  write();
  EXPECT_EQ(failures([](brep::Body&) {}), Names{});
}

TEST_F(DeepVerify, AMissingVoid) {
  write();
  EXPECT_EQ(failures([](brep::Body& body) { body.solids[0].voids.pop_back(); }),
            (Names{"volume by points", "points misjudged"}));
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
  EXPECT_EQ(found, (Names{"solids", "volume by points", "points misjudged"}));
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
