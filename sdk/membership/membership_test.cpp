// SPDX-License-Identifier: Apache-2.0
// Parts: what the steps of a document leave, point by point and by volume.
#include "meso/membership/membership.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <numbers>

#include "document_for_test.hpp"
#include "meso/membership/volume_estimate.hpp"

namespace meso::membership {
namespace {

using std::numbers::pi;

const std::string block = macrostructure("<box x='0' y='-5' z='-5' dx='20' dy='10' dz='10'/>");
constexpr double ball = 4.0 / 3 * pi;

/// Balls of radius 1 in boxes of side 2, along x.
std::string balls(int count, double start, double spacing = 4) {
  return cells("<box x='-1' y='-1' z='-1' dx='2' dy='2' dz='2'/><csg><sphere radius='1'/></csg>",
               "<loop index='i' axis='x' count='" + std::to_string(count) + "' start='" + std::to_string(start) +
                   "' spacing='" + std::to_string(spacing) + "'/>");
}
std::string apply(const std::string& attributes) { return part_of("<apply pattern='c' " + attributes + "/>"); }

void expect_volume(const Membership& part, double volume, std::size_t count = 300'000) {
  ASSERT_TRUE(part.box());
  const JitteredPoints points(*part.box(), count, 11);
  const auto answers = answers_at(part, points, {});
  ASSERT_TRUE(answers);
  const VolumeEstimate found = estimate_volume(points, *answers);
  EXPECT_EQ(found.low, found.high);
  EXPECT_NEAR(found.low, volume, 3 * found.deviation);
}

TEST(Membership, Steps) {
  expect_volume(membership_of(block + part_of("")), 2000);
  expect_volume(membership_of(block + balls(7, 0) + apply("operation='difference'")), 2000 - 5 * ball);
  expect_volume(membership_of(block + balls(7, 0) + apply("operation='intersection'")), 5 * ball);
  expect_volume(membership_of(block + balls(7, 0) + apply("operation='union'")), 2000 + 2 * ball);
  expect_volume(membership_of(block + balls(3, 5, 1) + apply("operation='difference'")),
                2000 - (3 * ball - 2 * 5 * pi / 12));
}

TEST(Membership, FilletsAndSkinsAreNotJudged) {
  const Membership part = membership_of(block + balls(7, 0) + apply("operation='difference' skin='1'"));
  EXPECT_EQ(part.at({4, 0, 0}), Answer::unknown);
  EXPECT_EQ(part.at({10, 0, 4.9}), Answer::unknown);
  EXPECT_EQ(part.at({10, 0, 6}), Answer::outside);
  const Membership round = membership_of(block + balls(7, 0) + apply("operation='union' radius='1'"));
  EXPECT_EQ(round.at({10, 0, 5.9}), Answer::unknown);
  EXPECT_EQ(round.at({10, 0, 6.1}), Answer::outside);
}

TEST(Membership, BoundaryRules) {
  const auto intersection = [](const std::string& rule) {
    return membership_of(block + balls(7, 0) + apply("operation='intersection' boundary='" + rule + "'"));
  };
  expect_volume(intersection("dropPartial"), 4 * ball);
  expect_volume(intersection("keepWhole"), 6 * ball);
  expect_volume(membership_of(block + balls(7, 0) + apply("operation='difference' boundary='dropPartial'")),
                2000 - 4 * ball);
  // Boxes flush with the body's side are inside, with a clearance they are not.
  expect_volume(membership_of(block + balls(4, 1, 5) + apply("operation='difference' boundary='dropPartial'")),
                2000 - 4 * ball);
  expect_volume(
      membership_of(block + balls(4, 1, 5) + apply("operation='difference' boundary='dropPartial' clearance='0.5'")),
      2000 - 3 * ball);
}

TEST(Membership, RulesThatJudgeTheBody) {
  // A rod of radius 0.3 in a box of side 4: the box leaves the block, the rod does not.
  const std::string rod = cells(
      "<box x='-2' y='-2' z='-2' dx='4' dy='4' dz='4'/><csg><cylinder x1='-2' y1='0' z1='0' x2='2' "
      "y2='0' z2='0' radius='0.3'/></csg>",
      "<list><place at='10,4,0'/><place at='10,0,0'/><place at='10,8,0'/></list>");
  const Membership part =
      membership_of(block + rod + apply("operation='intersection' boundary='dropPartial' test='body'"));
  EXPECT_EQ(part.at({10, 0, 0}), Answer::inside);
  EXPECT_EQ(part.at({10, 4, 0}), Answer::unknown);  // only its box can be judged
  EXPECT_EQ(part.at({10, 8, 0}), Answer::outside);
  EXPECT_EQ(part.at({10, 2, 0}), Answer::outside);
}

TEST(Membership, CellsThatTurnGrowAndAreDropped) {
  const std::string graded = cells(
      "<parameter id='r' value='1'/><box dx='1' dy='1' dz='1'/><csg><cylinder x1='0' y1='0' z1='0' x2='3' y2='0' "
      "z2='0' radius='r'/></csg>",
      "<loop index='i' axis='y' count='4' spacing='10'/><set parameter='r' value='0.5+0.25*i'/><rotate x='0' y='0' "
      "z='1' "
      "angle='i*pi/2'/><scale factor='1+i'/><when test='i &lt; 3'/>");
  const Membership part = membership_of(graded + part_of("<apply pattern='c' operation='union'/>", false));
  expect_volume(part, 3 * pi * (0.25 + 0.5625 * 8 + 1 * 27), 1'000'000);
  EXPECT_EQ(part.at({0, 15, 0}), Answer::inside);     // the second along y, twice as long
  EXPECT_EQ(part.at({-8.9, 20, 0}), Answer::inside);  // the third against x, three times
  EXPECT_EQ(part.at({0, 30, 0}), Answer::outside);
}

TEST(Membership, CellsAreClippedToTheirBoxes) {
  const std::string cut = cells("<box x='-1' y='-1' z='-1' dx='2' dy='2' dz='2'/><csg><sphere radius='1.2'/></csg>",
                                "<loop index='i' axis='x' count='2' spacing='2'/>", "", "clipToBox='true'");
  const double cap = pi * 0.04 * (3 * 1.2 - 0.2) / 3;
  expect_volume(membership_of(cut + part_of("<apply pattern='c' operation='union'/>", false)),
                2 * (ball * 1.728 - 6 * cap));
}

TEST(Membership, ConformalCells) {
  const std::string polar =
      "<coordinateSystems><coordinateSystem id='s'><axis name='r' kind='distance' x='1'/><axis name='t' "
      "kind='circular' "
      "z='1'/><axis name='h' kind='linear' z='1'/></coordinateSystem></coordinateSystems>";
  const std::string rings =
      "<loop index='i' axis='r' count='2' start='3' spacing='3'/><loop index='j' axis='t' count='8' "
      "spacing='45deg'/><loop index='k' axis='h' count='1' spacing='4'/>";
  const std::string sectors =
      cells("<box dx='1' dy='1' dz='1'/><csg><box x='0.1' y='0.1' z='0.1' dx='0.8' dy='0.8' dz='0.8'/></csg>", rings,
            "coordinateSystem='s' mapping='conformal'");
  const auto ring = [](double r0, double r1) { return (r1 * r1 - r0 * r0) * pi * 0.8 * 3.2; };
  expect_volume(membership_of(macrostructure("<cylinder x1='0' y1='0' z1='0' x2='0' y2='0' z2='4' radius='10'/>") +
                              polar + sectors + apply("operation='difference'")),
                400 * pi - ring(3.3, 5.7) - ring(6.3, 8.7));
  // Beams run straight between mapped nodes: from (3, 0) to (6, 0) and every 45 degrees.
  const std::string spokes = cells(
      "<box dx='1' dy='1' dz='1'/><beams radius='0.3' cap='butt'><node id='a' x='0' y='0' z='0.5'/><node id='b' "
      "x='1' y='0' z='0.5'/><beam from='a' to='b'/></beams>",
      rings, "coordinateSystem='s' mapping='conformal'");
  expect_volume(membership_of(polar + spokes + part_of("<apply pattern='c' operation='union'/>", false)),
                16 * 3 * pi * 0.09);
}

TEST(Membership, PartsInPartsAndInCells) {
  const std::string sections =
      "<macrostructures><macrostructure id='m'><csg><box dx='8' dy='8' dz='8'/></csg></macrostructure>"
      "<macrostructure id='n'><csg><sphere radius='1'/></csg></macrostructure></macrostructures>"
      "<unitCells><unitCell id='u'><part ref='q'/></unitCell></unitCells>"
      "<patterns><pattern id='c' unitCell='u'><list><place at='2,2,2'/><place at='6,6,6'/></list></pattern></patterns>"
      "<parts><part id='q' macrostructure='n'/><part id='p' macrostructure='m'><apply pattern='c' "
      "operation='difference'/>"
      "<apply part='q' operation='union'><placement matrix='1, 0, 0, 4, 0, 1, 0, 4, 0, 0, 1, "
      "8'/></apply></part></parts>";
  const Membership part = membership_of(sections);
  EXPECT_EQ(part.at({2.5, 2, 2}), Answer::outside);
  EXPECT_EQ(part.at({4, 4, 8.5}), Answer::inside);
  expect_volume(part, 512 - 2 * ball + ball / 2);
}

TEST(Membership, DroppedFragmentsAreNotKnown) {
  const Membership part = membership_of(block + balls(7, 0) + apply("operation='intersection' fragments='drop'"));
  EXPECT_EQ(part.at({4, 0, 0}), Answer::unknown);
  EXPECT_EQ(part.at({6, 0, 0}), Answer::outside);
}

TEST(Membership, NearASurfaceNothingIsClear) {
  const Membership part = membership_of(block + part_of(""));
  EXPECT_EQ(part.clear_at({10, 0, 0}, 0.1), Answer::inside);
  EXPECT_EQ(part.clear_at({10, 4.95, 0}, 0.1), Answer::unknown);
  EXPECT_EQ(part.clear_at({10, 5.05, 0}, 0.1), Answer::unknown);
  EXPECT_EQ(part.clear_at({10, 5.2, 0}, 0.1), Answer::outside);
  EXPECT_EQ(part.clear_at({20.04, 5.04, 5.04}, 0.1), Answer::unknown);  // beyond a corner: by the diagonal
}

TEST(Membership, LimitsAndStops) {
  const std::string document = block + balls(7, 0) + apply("operation='difference'");
  Options options;
  options.run.max_cells = 6;
  EXPECT_THROW((void)membership_of(document, options), std::invalid_argument);
  options = {};
  options.run.cancelled = [] { return true; };
  EXPECT_THROW((void)membership_of(document, options), std::invalid_argument);
}

TEST(Membership, AHundredThousandCellsTakeSeconds) {
  const std::string lattice = cells(
      "<box dx='5' dy='5' dz='5'/><beams radius='0.5' nodeRadius='0.9'><node id='m' x='2.5' y='2.5' z='2.5'/><node "
      "id='a' x='0' y='0' z='0'/>"
      "<node id='b' x='5' y='5' z='5'/><beam from='m' to='a'/><beam from='m' to='b'/></beams>",
      "<loop index='i' axis='x' count='40' spacing='5'/><loop index='j' axis='y' count='50' spacing='5'/><loop "
      "index='k' axis='z' "
      "count='50' spacing='5'/><rotate x='0' y='0' z='1' angle='0'/><when test='1'/>");
  const auto start = std::chrono::steady_clock::now();
  const Membership part = membership_of(lattice + part_of("<apply pattern='c' operation='union'/>", false));
  const JitteredPoints points(*part.box(), 200'000, 3);
  const auto answers = answers_at(part, points, {.jobs = 1});
  ASSERT_TRUE(answers);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  EXPECT_GT(estimate_volume(points, *answers).low, 1e5);
  EXPECT_LT(seconds.count(), 10);  // 0.5 s on a quiet machine
}

}  // namespace
}  // namespace meso::membership
