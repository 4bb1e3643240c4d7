// SPDX-License-Identifier: Apache-2.0
// Lattices, and the box query against brute force.
#include <gmock/gmock.h>

#include <random>
#include <set>

#include "document_text.hpp"
#include "meso/eval/bounds.hpp"

namespace meso::eval {
namespace {

const std::string box = "<box dx='1' dy='1' dz='1'/>";
const std::string grid =
    "<loop index='i' axis='x' count='4' start='-2' spacing='1.5'/><loop index='j' axis='y' count='3' spacing='2'/>"
    "<loop index='k' axis='z' count='5' start='1' spacing='-1'/>";

TEST(Lattice, IsFoundAndPlacesEveryCell) {
  const CellStream stream =
      stream_of(evaluation_of(pattern_text(grid + "<rotate x='1' y='1' z='0' angle='0.3'/><translate x='0.25'/>",
                                           box + "<csg><sphere radius='0.5'/></csg>")));
  const auto lattice = stream.lattice();
  ASSERT_TRUE(lattice);
  EXPECT_EQ(lattice->count, (std::array<std::int64_t, 3>{4, 3, 5}));
  for (const CellCopy& c : cells_of(stream)) {
    const Vec3 n{static_cast<double>(c.index[0]), static_cast<double>(c.index[1]), static_cast<double>(c.index[2])};
    expect_near(c.world_from_cell.translation, lattice->world_from_first.translation + lattice->lattice * n);
    EXPECT_EQ(c.world_from_cell.linear, lattice->world_from_first.linear);
  }
}

TEST(Lattice, IsNotClaimedWhereCellsDiffer) {
  const std::string cell = "<parameter id='t' value='1'/>" + box + "<csg><sphere radius='0.5'/></csg>";
  const auto has = [&](const std::string& generator) {
    return stream_of(evaluation_of(pattern_text(generator, cell))).lattice().has_value();
  };
  EXPECT_TRUE(has(grid + "<set parameter='t' value='2'/>"));
  EXPECT_FALSE(has(grid + "<set parameter='t' value='2 + i'/>"));
  EXPECT_FALSE(has(grid + "<when test='i &lt; 2'/>"));
  EXPECT_FALSE(has(grid + "<rotate x='1' y='0' z='0' angle='j'/>"));
  EXPECT_FALSE(has("<loop index='i' axis='x' count='4' spacing='1 + i'/>"));
  EXPECT_FALSE(has("<loop index='i' axis='x' count='4' position='2*i'/>"));
  EXPECT_FALSE(has("<loop index='i' axis='x' count='4' spacing='1'/><loop index='j' axis='y' count='i' spacing='1'/>"));
}

/// No cell whose box or body meets the region may be missing.
void expect_no_miss(const std::string& document, unsigned seed) {
  const CellStream stream = stream_of(evaluation_of(document));
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> center(-8, 8), size(0, 3);
  for (int n = 0; n < 30; ++n) {
    Box3 region;
    region.extend({center(random), center(random), center(random)});
    region.extend(region.min + Vec3{size(random), size(random), size(random)});
    DiagnosticSink sink;
    std::set<std::uint64_t> found;
    ASSERT_TRUE(stream.visit_touching(
        region, [&](const PlacedCell& c) { return found.insert(c.ordinal).second; }, sink))
        << render_all(sink);
    ASSERT_TRUE(stream.visit(
        0, stream.size(),
        [&](const PlacedCell& c) {
          // Points of the cell's body: the sphere of radius 0.5 about the box's corner at 0, densely sampled.
          for (int s = 0; s < 200; ++s) {
            const double z = -1 + (s + 0.5) / 100, phi = 2.399963 * s, r = std::sqrt(1 - z * z);
            const Vec3 p = c.world_from_cell * (0.5 * Vec3{r * std::cos(phi), r * std::sin(phi), z});
            bool inside = true;
            for (std::size_t i = 0; i < 3; ++i) inside = inside && p[i] >= region.min[i] && p[i] <= region.max[i];
            if (inside) {
              EXPECT_TRUE(found.contains(c.ordinal)) << "cell " << c.ordinal;
              break;
            }
          }
          return true;
        },
        sink));
  }
}

const std::string ball = box + "<csg><sphere radius='0.5'/></csg>";

TEST(Touching, LatticeQueriesMissNothing) {
  expect_no_miss(pattern_text(grid, ball), 1);
  expect_no_miss(pattern_text(grid + "<rotate x='1' y='2' z='0' angle='0.7'/><scale x='2' y='0.5'/>", ball), 2);
  expect_no_miss(
      pattern_text("<loop index='i' count='5' x='1' y='1' spacing='1'/><loop index='j' count='6' x='1' z='1' "
                   "start='-3' spacing='1'/>",
                   ball),
      3);
}

TEST(Touching, OtherQueriesMissNothing) {
  expect_no_miss(pattern_text(grid + "<when test='mod(i + j, 2) == 0'/><rotate x='1' y='2' z='0' angle='k'/>", ball),
                 4);
  expect_no_miss(pattern_text("<loop index='i' axis='x' count='9' start='-5' spacing='1 + 0.1*i'/>"
                              "<orient axis='x' x='1' y='i' z='0'/><scale factor='1 + 0.3*i'/>",
                              ball),
                 5);
}

TEST(Touching, LatticeQueriesAreNarrow) {
  const CellStream stream = stream_of(evaluation_of(pattern_text(
      "<loop index='i' axis='x' count='200' spacing='1'/><loop index='j' axis='y' count='200' spacing='1'/>"
      "<loop index='k' axis='z' count='200' spacing='1'/>",
      box + "<csg><box dx='1' dy='1' dz='1'/></csg>")));
  Box3 region;
  region.extend({100.5, 100.5, 100.5});
  int seen = 0;
  DiagnosticSink sink;
  EXPECT_TRUE(stream.visit_touching(
      region, [&](const PlacedCell&) { return ++seen, true; }, sink));
  EXPECT_EQ(seen, 1);
}

TEST(Bounds, ConformalCellsLieInTheirBounds) {
  const CellStream stream = stream_of(evaluation_of(pattern_text(
      "<loop index='i' axis='r' count='3' start='1' spacing='1'/><loop index='j' axis='lon' count='8' spacing='45deg'/>"
      "<loop index='k' axis='lat' count='4' start='-80deg' spacing='40deg'/>",
      box + "<csg><box dx='1' dy='1' dz='1'/></csg>", "mapping='conformal' coordinateSystem='s'",
      R"(<coordinateSystems><coordinateSystem id="s"><axis name="r" kind="distance" x="1"/>
         <axis name="lon" kind="circular" z="1"/><axis name="lat" kind="circular" y="-1"/></coordinateSystem></coordinateSystems>)")));
  DiagnosticSink sink;
  ASSERT_TRUE(stream.visit(
      0, stream.size(),
      [&](const PlacedCell& c) {
        const auto shape = stream.shape(c, sink);
        const Box3 around = bounds(*shape).value();
        const auto& e = std::get<VolumeElementShape>(shape->value);
        for (int n = 0; n < 125; ++n) {
          const double q[] = {e.from[0] + (e.to[0] - e.from[0]) * (n % 5) / 4,
                              e.from[1] + (e.to[1] - e.from[1]) * (n / 5 % 5) / 4,
                              e.from[2] + (e.to[2] - e.from[2]) * (n / 25) / 4};
          Box3 point;
          point.extend(e.system->point(q));
          EXPECT_TRUE(around.intersects(point));
        }
        return true;
      },
      sink))
      << render_all(sink);
}

}  // namespace
}  // namespace meso::eval
