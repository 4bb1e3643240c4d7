// SPDX-License-Identifier: Apache-2.0
#include "meso/sdf/build_field.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace meso::sdf {
namespace {

using implicit::Field;

std::optional<Program> program_of(const std::string& line) {
  DiagnosticSink sink;
  auto words = words_of_text(line, "line", sink);
  auto program = parse_program(std::move(*words), {}, sink);
  for (const Diagnostic& d : sink.diagnostics()) ADD_FAILURE() << render(d);
  return program;
}

Field field_of(const std::string& line) {
  DiagnosticSink sink;
  const auto program = program_of(line);
  return *build_field(*program, {}, sink);
}

/// Both have the same sign of value, and the same value up to rounding, at points of the box of half size `reach`.
void expect_same(const std::string& a, const std::string& b, double reach = 2) {
  const Field fa = field_of(a), fb = field_of(b);
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> in(-reach, reach);
  for (int i = 0; i < 500; ++i) {
    const Vec3 p{in(random), in(random), in(random)};
    EXPECT_NEAR(fa.value(p), fb.value(p), 1e-12) << a << " | " << b;
  }
}

TEST(BuildField, Identities) {
  expect_same("ball box union", "ball complement box complement intersection complement");
  expect_same("tpms.d offset 0.3 complement complement", "tpms.d offset 0.3");
  expect_same("box tpms.p difference", "box tpms.p complement intersection");
  expect_same("box move 1,2,3 move -.5,1,0", "box move 0.5,3,3", 5);
  expect_same("tpms.lidinoid rotate 1,2,3 tau", "tpms.lidinoid", 1);
  // The gyroid is odd under inversion; the exoskeleton of a level set is its complement.
  expect_same("tpms.gyroid offset 0.2 scale -1", "tpms.gyroid offset -0.2 complement");
  expect_same("tpms.s scale 2 scale 1/2", "tpms.s");
  expect_same("ball move 0,0,1 mirror 0,0,2", "ball move 0,0,-1");
  expect_same("ball eccentric-shell -.25,.25", "ball shell 0.5");
  expect_same("expression '(x+y+z-1)/sqrt(3)'", "half-space 1,1,1,1/sqrt(3)");
}

TEST(BuildField, DifferenceTakesTheUpperFromTheLower) {
  const Field f = field_of("box scale 2 ball difference");
  EXPECT_LT(f.value({1.5, 1.5, 1.5}), 0);
  EXPECT_GT(f.value({0, 0, 0}), 0);
}

TEST(BuildField, RotationIsRightHandedInRadians) {
  const Field f = field_of("ball move 1,0,0 rotate 0,0,5 pi/2");
  EXPECT_NEAR(f.value({0, 1, 0}), -1, 1e-15);
  const Field cylinder = field_of("cylinder orient 1,2,2");
  for (const double t : {-3., 0., 7.}) EXPECT_NEAR(cylinder.value({t, 2 * t, 2 * t}), -1, 1e-12);
}

TEST(BuildField, OrderOfOffsetAndScaleMatters) {
  // kappa (f(x / kappa) - xi) against f_kappa - xi
  const Vec3 p{0.3, 0.1, 0.7};
  const Field level = field_of("tpms.gyroid offset 0.2 scale 2"), length = field_of("tpms.gyroid scale 2 offset 0.2");
  EXPECT_NEAR(length.value(p) - level.value(p), 0.2, 1e-14);
}

TEST(BuildField, MeshesComeFromTheCallerOnce) {
  class Slab final : public implicit::ExternalField {
   public:
    [[nodiscard]] double value(Vec3 p) const override { return std::abs(p.x) - 3; }
    [[nodiscard]] implicit::Interval interval(const Box3&) const override { return implicit::Interval::everything(); }
    [[nodiscard]] double lipschitz() const override { return 1; }
    [[nodiscard]] Box3 bounds(double) const override { return {{-3, -1, -1}, {3, 1, 1}}; }
    [[nodiscard]] std::unique_ptr<Prepared> prepare(const implicit::Grid&, const Affine&, double,
                                                    const RunOptions&) const override {
      return nullptr;
    }
  };
  int loads = 0;
  const MeshLoader load = [&](const std::string& path,
                              DiagnosticSink& sink) -> std::shared_ptr<const implicit::ExternalField> {
    ++loads;
    if (path == "slab.ply") return std::make_shared<Slab>();
    sink.report({.code = Code::file_not_found, .args = {path, "gone"}});
    return nullptr;
  };
  DiagnosticSink sink;
  const auto field = build_field(*program_of("file slab.ply file slab.ply move 1,0,0 intersection"), load, sink);
  ASSERT_TRUE(field);
  EXPECT_EQ(loads, 1);
  EXPECT_EQ(field->value({-2.5, 0, 0}), 0.5);
  EXPECT_FALSE(build_field(*program_of("ball file none.ply union"), load, sink));
  ASSERT_EQ(sink.diagnostics().size(), 1u);
  EXPECT_EQ(sink.diagnostics()[0].code, Code::file_not_found);
  EXPECT_EQ(sink.diagnostics()[0].where.offset, 5u);
}

TEST(BoxOf, IsTheSolidsOwnWithUnboundedSidesAtOne) {
  const auto box = [](const std::string& line) {
    DiagnosticSink sink;
    const auto program = program_of(line);
    return box_of(*program, field_of(line), sink)->box;
  };
  EXPECT_EQ(box("tpms.gyroid"), (Box3{{-1, -1, -1}, {1, 1, 1}}));
  EXPECT_EQ(box("cylinder scale 1/2 orient 1,0,0").min.x, -1);
  EXPECT_NEAR(box("cylinder scale 1/2 orient 1,0,0").max.z, 0.5, 1e-12);
  EXPECT_EQ(box("ball -b 0,0,0,5,6,7"), (Box3{{0, 0, 0}, {5, 6, 7}}));
  const Box3 shell = box("ball shell 0.2");
  EXPECT_NEAR(shell.max.y, 1.1, 1e-12);
  EXPECT_NEAR(
      box("cylinder move 0,-2,0 cylinder move 0,2,0 union scale 1/2 orient 1,0,0 complement box intersection").max.z, 1,
      1e-12);
  EXPECT_NEAR(box("box complement complement").min.z, -1, 1e-12);
  // Anisotropic scaling: an offset grows the longest axis by more than itself (values are lower bounds).
  const Box3 grown = box("ball scale 1,2,3 offset 0.1");
  EXPECT_GE(grown.max.z, 3.1);
  EXPECT_NEAR(grown.max.z, 3.3, 1e-12);
}

TEST(BoxOf, ThatIsEmptyOrInverted) {
  DiagnosticSink sink;
  const auto far = program_of("ball ball move 5,0,0 intersection");
  EXPECT_TRUE(box_of(*far, field_of("ball ball move 5,0,0 intersection"), sink)->certainly_empty);
  EXPECT_FALSE(sink.has_errors());
  const auto up = program_of("half-space 0,0,-1,-5");  // z >= 5: from 5 to 1
  EXPECT_FALSE(box_of(*up, field_of("half-space 0,0,-1,-5"), sink));
  EXPECT_EQ(sink.diagnostics()[0].code, Code::sdf_box);
}

}  // namespace
}  // namespace meso::sdf
