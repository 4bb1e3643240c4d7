// SPDX-License-Identifier: Apache-2.0
#include "meso/sdf/build_field.hpp"

#include <gtest/gtest.h>

#include <algorithm>
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

double value_of(const std::string& line, Vec3 p) { return field_of(line).value(p); }

TEST(BuildField, GradedLevelsAreThoseOfThePoint) {
  for (const Vec3 p : {Vec3{0.3, -0.2, 0.7}, Vec3{-1, 0.4, 0.1}, Vec3{0.2, 0.9, -0.6}}) {
    const double f = value_of("tpms.gyroid", p);
    EXPECT_NEAR(value_of("tpms.gyroid offset '0.1*x + y'", p), f - (0.1 * p.x + p.y), 1e-12);
    EXPECT_NEAR(value_of("tpms.gyroid shell '0.3 + z^2'", p), std::abs(f) - (0.3 + p.z * p.z) / 2, 1e-12);
    EXPECT_NEAR(value_of("tpms.gyroid eccentric-shell 'x,0.4 + tau'", p),
                std::max(p.x - f, f - (0.4 + 2 * std::numbers::pi)), 1e-12);
    const double g = value_of("tpms.p", p), w = std::clamp((p.x + 1) / 2, 0.0, 1.0);
    EXPECT_NEAR(value_of("tpms.gyroid tpms.p blend '(x + 1)/2'", p), f + w * (g - f), 1e-12);
  }
}

/// The share of the unit cube inside, at points of a lattice that fits no period.
double share(const Field& f) {
  std::vector<Vec3> points;
  for (int k = 0; k < 29; ++k)
    for (int j = 0; j < 27; ++j)
      for (int i = 0; i < 25; ++i) points.push_back({(i + 0.5) / 25, (j + 0.5) / 27, (k + 0.5) / 29});
  std::vector<double> values(points.size());
  f.values(points, values);
  const auto inside = std::count_if(values.begin(), values.end(), [](double v) { return v < 0; });
  return static_cast<double>(inside) / static_cast<double>(points.size());
}

TEST(BuildField, DensityFillsItsShareOfThePeriod) {
  EXPECT_NEAR(share(field_of("tpms.gyroid density 0.3")), 0.3, 4e-3);
  EXPECT_NEAR(share(field_of("tpms.iwp shell 0.1 density 0.2")), 0.2, 4e-3);
  EXPECT_NEAR(share(field_of("tpms.p scale 1/2 density 0.4")), 0.4, 4e-3);
  // From 0.2 to 0.4 over the cube: 0.3 on the whole of it.
  EXPECT_NEAR(share(field_of("tpms.gyroid scale 1/4 density '0.2 + 0.2*x'")), 0.3, 5e-3);
}

// Half of one function and half of another, each at its own level, would fill 0.196 of the first of these cubes.
TEST(BuildField, BlendsOfDensitiesKeepTheShare) {
  EXPECT_NEAR(share(field_of("tpms.gyroid density 0.3 tpms.p density 0.3 blend 0.5")), 0.3, 4e-3);
  EXPECT_NEAR(share(field_of("tpms.gyroid density 0.15 tpms.iwp density 0.15 blend 0.7")), 0.15, 4e-3);
  EXPECT_NEAR(share(field_of("tpms.gyroid density 0.2 tpms.p density 0.4 blend 0.5")), 0.3, 4e-3);
  EXPECT_NEAR(share(field_of("strut.bcc 0.1 scale 1/2 density 0.2 tpms.p scale 1/2 density 0.2 blend 0.3")), 0.2, 4e-3);
  const Field three = field_of("tpms.gyroid density 0.3 tpms.p density 0.3 blend y/4 tpms.d density 0.3 blend z/4");
  EXPECT_NEAR(share(three.scaled(0.25)), 0.3, 6e-3);
  // Moved and scaled behind the density: still a share of each period.
  EXPECT_NEAR(share(field_of("tpms.gyroid density 0.3 move 0.2,0,0 scale 0.5 tpms.p scale 0.5 density 0.3 blend 0.5")),
              0.3, 4e-3);
}

TEST(BuildField, AtItsEndsABlendOfDensitiesIsOneOfTheTwo) {
  const std::string one = "tpms.gyroid density 0.3", other = "tpms.p density 0.4", both = one + " " + other + " blend ";
  for (const auto& [end, same] :
       {std::pair(field_of(both + "0"), field_of(one)), {field_of(both + "1"), field_of(other)}})
    for (const Vec3 p : {Vec3{0.1, 0.2, 0.3}, Vec3{0.7, 0.2, 0.1}, Vec3{0.4, 0.45, 0.9}, Vec3{0.9, 0.6, 0.2}})
      EXPECT_EQ(end.value(p) < 0, same.value(p) < 0);
}

TEST(BuildField, DensitiesOfDifferentPeriodsBlendAsTheyAre) {
  const Vec3 p{0.3, 0.1, 0.4};
  const double f = value_of("tpms.gyroid density 0.3", p), g = value_of("tpms.p scale 2 density 0.3", p);
  EXPECT_NEAR(value_of("tpms.gyroid density 0.3 tpms.p scale 2 density 0.3 blend 0.25", p), 0.75 * f + 0.25 * g, 1e-12);
}

TEST(BuildField, AtMostThreeDensitiesBlendByFormulas) {
  DiagnosticSink sink;
  const auto program = program_of(
      "tpms.gyroid density 0.3 tpms.p density 0.3 blend x tpms.d density 0.3 blend y tpms.iwp density 0.3 blend z");
  EXPECT_FALSE(build_field(*program, {}, sink));
  ASSERT_EQ(sink.diagnostics().size(), 1u);
  EXPECT_EQ(sink.diagnostics()[0].code, Code::sdf_value);
}

TEST(BuildField, WhatIsLookedUpIsBentAsWell) {
  const Field tube = field_of("tpms.gyroid density '0.3 + 0.05*z' cylindrical 8");
  EXPECT_NEAR(tube.value({1.25, 0, 0.4}), value_of("tpms.gyroid density '0.3 + 0.05*z'", {1.25, 0, 0.4}), 1e-12);
  const double turn = 2 * std::numbers::pi / 8;
  EXPECT_NEAR(tube.value({1.25 * std::cos(turn), 1.25 * std::sin(turn), 0.4}), tube.value({1.25, 0, 0.4}), 1e-9);
}

TEST(BuildField, StrutsAreDistancesToTheLibrarysStruts) {
  // The centre of a body-centred cell is a node with a ball of 1.8 radii; its struts end at the corners.
  EXPECT_NEAR(value_of("strut.bcc 0.05", {0.5, 0.5, 0.5}), -0.09, 1e-12);
  EXPECT_NEAR(value_of("strut.bcc 0.05", {0.25, 0.25, 0.25}), -0.05, 1e-12);
  EXPECT_NEAR(value_of("strut.bcc 0.05", {2.25, -0.75, 5.25}), -0.05, 1e-12);
  EXPECT_NEAR(value_of("strut.sc 0.1 scale 4", {2, 0.3, 0}), 0.3 - 0.4, 1e-12);
  // Beside a cell's side, that of struts on both sides.
  EXPECT_NEAR(value_of("strut.sc 0.05", {0.5, -0.08, 0}), 0.03, 1e-12);
}

TEST(BuildField, BendsAndRepetitions) {
  // Eight gyroids a turn: what is at angle 0 is there again an eighth of a turn further.
  const double a = std::numbers::pi / 4;
  const Field tube = field_of("tpms.gyroid cylindrical 8");
  for (const double rho : {0.7, 1.9})
    EXPECT_NEAR(tube.value({rho, 0, 0.3}), tube.value({rho * std::cos(a), rho * std::sin(a), 0.3}), 1e-9);
  EXPECT_NEAR(tube.value({-1.3, 1e-12, 0.2}), tube.value({-1.3, -1e-12, 0.2}), 1e-9) << "the seam is closed";
  EXPECT_NEAR(tube.value({1.25, 0, 0.4}), value_of("tpms.gyroid", {1.25, 0, 0.4}), 1e-12);
  const Field globe = field_of("tpms.p spherical 6,3");
  EXPECT_NEAR(globe.value({0, 0, 1.2}), value_of("tpms.p", {1.2, 0, 0}), 1e-12) << "the north pole";
  EXPECT_NEAR(globe.value({0, 0, -1.2}), value_of("tpms.p", {1.2, 0, 3}), 1e-9) << "the south pole";
  const Field balls = field_of("ball scale 0.3 repeat 1,2,0");
  EXPECT_NEAR(balls.value({5.1, -4, 0.1}), std::hypot(0.1, 0.1) - 0.3, 1e-12);
  EXPECT_GT(balls.value({0, 0, 1}), 0);
}

TEST(BuildField, AHelixTurnsAndRises) {
  // A disc beside the axis, swept: Pappus counts its area times the way of its centre around the axis, and the rise
  // shears that without changing the volume. An ellipse as high as the helix is long for its turn has pi r^2 times the
  // helix's length.
  const double r = 0.3, ring = 1.2, pitch = 1.5;
  const double turn = 2 * std::numbers::pi * ring, length = std::hypot(turn, pitch);
  const Field pipe = field_of(
      "cylinder scale 0.3,0.3*sqrt((2*pi*1.2)^2+1.5^2)/(2*pi*1.2),1 orient 0,1,0 move 1.2,0,0 "
      "repeat 0,0,1.5 helix 1,1.5");
  int inside = 0;
  constexpr int n = 120;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k)
        inside +=
            pipe.value({3.2 * (i + 0.37) / n - 1.6, 3.2 * (j + 0.61) / n - 1.6, pitch * (k + 0.43) / n}) < 0 ? 1 : 0;
  EXPECT_NEAR(3.2 * 3.2 * pitch * inside / (n * n * n), std::numbers::pi * r * r * length, 0.01);

  // An eighth of a turn up the screw everything is there again.
  const double a = std::numbers::pi / 4;
  const Field cells = field_of("tpms.gyroid helix 8,2");
  for (const Vec3 p : {Vec3{0.7, 0.1, 0.3}, Vec3{1.4, -0.2, -0.8}, Vec3{-1.1, 0.6, 0.2}})
    EXPECT_NEAR(cells.value(p),
                cells.value({p.x * std::cos(a) - p.y * std::sin(a), p.x * std::sin(a) + p.y * std::cos(a), p.z + 0.25}),
                1e-9);
  EXPECT_NEAR(cells.value({-1.3, 1e-12, 0.2}), cells.value({-1.3, -1e-12, 0.2}), 1e-9) << "the seam is closed";
  expect_same("tpms.p helix 6,0", "tpms.p cylindrical 6");
}

TEST(BuildField, StackWordsMoveSolids) {
  expect_same("ball box move 1,0,0 swap difference", "box move 1,0,0 ball difference");
  expect_same("ball dup move 1,0,0 union", "ball ball move 1,0,0 union");
  expect_same("ball box scale 0.5 over drop difference", "ball box scale 0.5 difference");
  expect_same("ball box move 1,0,0 over swap intersection union", "ball ball box move 1,0,0 intersection union");
  expect_same("ball move 0,1,0 def a box recall a difference recall a scale 0.3 union",
              "box ball move 0,1,0 difference ball move 0,1,0 scale 0.3 union");
}

TEST(BuildField, SmoothUnionRoundsWhereBothMeet) {
  // Two planes at right angles, and a fillet of radius 1 between them.
  const Field f = field_of("half-space 1,0,0,0 half-space 0,1,0,0 smooth-union 1");
  EXPECT_NEAR(f.value({1 - std::sqrt(0.5), 1 - std::sqrt(0.5), 0}), 0, 1e-12);
  EXPECT_NEAR(f.value({0, 5, 0}), 0, 1e-12);
}

TEST(BuildField, WhatHasNoPeriodHasNoDensity) {
  DiagnosticSink sink;
  const auto program = program_of("ball density 0.5");
  EXPECT_FALSE(build_field(*program, {}, sink));
  ASSERT_EQ(sink.diagnostics().size(), 1u);
  EXPECT_EQ(sink.diagnostics()[0].code, Code::sdf_value);
}

}  // namespace
}  // namespace meso::sdf
