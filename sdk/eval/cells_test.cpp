// SPDX-License-Identifier: Apache-2.0
// Loops, list, fill: coordinates, order, restart, limits.
#include <gmock/gmock.h>

#include <numbers>
#include <thread>

#include "document_text.hpp"

namespace meso::eval {
namespace {

using testing::ElementsAre;

std::vector<double> q0(const std::vector<CellCopy>& cells) {
  std::vector<double> result;
  for (const CellCopy& c : cells) result.push_back(c.q[0]);
  return result;
}

TEST(Loops, LastIsFastestAndPositionsFollowTheFormula) {
  const auto cells = cells_of(pattern_text(
      "<loop index='i' axis='x' count='2' start='-1' spacing='5'/><loop index='j' axis='z' count='3' spacing='0.1'/>"));
  ASSERT_EQ(cells.size(), 6U);
  for (std::size_t n = 0; n < 6; ++n) {
    const auto i = static_cast<double>(n / 3), j = static_cast<double>(n % 3);
    EXPECT_EQ(cells[n].ordinal, n);
    EXPECT_THAT(cells[n].index, ElementsAre(n / 3, n % 3));
    EXPECT_EQ(cells[n].world_from_cell.translation, (Vec3{-1 + i * 5, 0, j * 0.1}));
  }
}

TEST(Loops, ResultsAreMillimetres) {
  const auto cells = cells_of(pattern_text("<loop index='i' axis='x' count='2' start='1' spacing='2'/>"), "inch");
  EXPECT_EQ(cells[1].world_from_cell.translation.x, 3 * 25.4);
  EXPECT_EQ(cells[1].q[0], 3 * 25.4);
}

TEST(Loops, SpacingThatNamesTheIndexAddsUp) {
  // 1 + sum of (m + 1) for m < i: 1, 2, 4, 7, 11
  EXPECT_THAT(q0(cells_of(pattern_text("<loop index='i' axis='x' count='5' start='1' spacing='i + 1'/>"))),
              ElementsAre(1, 2, 4, 7, 11));
}

TEST(Loops, PositionIsDirect) {
  EXPECT_THAT(q0(cells_of(pattern_text("<loop index='i' axis='x' count='4' position='i^2'/>"))),
              ElementsAre(0, 1, 4, 9));
}

TEST(Loops, CountTakesTheNearestInteger) {
  EXPECT_EQ(cells_of(pattern_text("<loop index='i' axis='x' count='0.3/0.1' spacing='1'/>")).size(), 3U);
  EXPECT_EQ(cells_of(pattern_text("<loop index='i' axis='x' count='0' spacing='1'/>")).size(), 0U);
}

TEST(Loops, CountMayUseOuterIndices) {
  const auto cells = cells_of(pattern_text(
      "<loop index='i' axis='x' count='4' spacing='1'/><loop index='j' axis='y' count='i' start='i' spacing='1'/>"));
  std::vector<std::vector<std::int64_t>> expected;
  for (std::int64_t i = 0; i < 4; ++i)
    for (std::int64_t j = 0; j < i; ++j) expected.push_back({i, j});
  ASSERT_EQ(cells.size(), expected.size());
  for (std::size_t n = 0; n < cells.size(); ++n) {
    EXPECT_EQ(cells[n].index, expected[n]);
    EXPECT_EQ(cells[n].q[1], static_cast<double>(expected[n][0] + expected[n][1]));
  }
}

TEST(Loops, ADirectionIsNormalised) {
  const auto cells = cells_of(pattern_text("<loop index='i' count='3' x='3' z='4' start='1' spacing='5'/>"));
  expect_near(cells[2].world_from_cell.translation, {11 * 0.6, 0, 11 * 0.8});
}

TEST(Loops, WithoutAxisOrDirectionOnlyCounts) {
  const auto cells = cells_of(pattern_text("<loop index='i' count='3'/>"));
  ASSERT_EQ(cells.size(), 3U);
  EXPECT_EQ(cells[2].world_from_cell, Affine{});
}

TEST(Loops, PolarRings) {
  const std::string systems = R"(<coordinateSystems><coordinateSystem id="polar"><axis name="r" kind="distance" x="1"/>
    <axis name="phi" kind="circular" z="1"/></coordinateSystem></coordinateSystems>)";
  const auto cells =
      cells_of(pattern_text("<loop index='i' axis='r' count='3' start='2' spacing='1.5'/>"
                            "<loop index='j' axis='phi' count='6*(i + 1)' spacing='2*pi/(6*(i + 1))'/>",
                            "<csg><box dx='1' dy='1' dz='1'/></csg>", "coordinateSystem='polar'", systems));
  ASSERT_EQ(cells.size(), 6U + 12 + 18);
  for (const CellCopy& c : cells) {
    const double r = 2 + 1.5 * static_cast<double>(c.index[0]);
    const double phi =
        2 * std::numbers::pi * static_cast<double>(c.index[1]) / static_cast<double>(6 * (c.index[0] + 1));
    expect_near(c.world_from_cell.translation, {r * std::cos(phi), r * std::sin(phi), 0});
    expect_near(c.world_from_cell.linear.column(1), {-std::sin(phi), std::cos(phi), 0});
  }
}

TEST(List, PlacesInOrderAxesLeftOutAreZero) {
  const auto cells = cells_of(pattern_text("<list index='n'><place at='1,2,3'/><place at='4'/></list>"));
  ASSERT_EQ(cells.size(), 2U);
  EXPECT_EQ(cells[0].world_from_cell.translation, (Vec3{1, 2, 3}));
  EXPECT_EQ(cells[1].world_from_cell.translation, (Vec3{4, 0, 0}));
  EXPECT_THAT(cells[1].index, ElementsAre(1));
}

TEST(Fill, TakesWholeStepsWithinTolerance) {
  const auto fill = [](const std::string& from, const std::string& to, const std::string& step) {
    std::vector<std::int64_t> result;
    for (const CellCopy& c : cells_of(
             pattern_text("<fill><range axis='x' from='" + from + "' to='" + to + "' step='" + step + "'/></fill>")))
      result.push_back(c.index[0]);
    return result;
  };
  EXPECT_THAT(fill("-1", "2", "1"), ElementsAre(-1, 0, 1));
  EXPECT_THAT(fill("-0.9", "2.9", "1"), ElementsAre(0, 1));
  EXPECT_THAT(fill("0.1*3", "0.6", "0.1"), ElementsAre(3, 4, 5));  // 0.1*3 lies above 3 steps by rounding
  EXPECT_THAT(fill("0", "1 - 1e-10", "1"), ElementsAre(0));
  EXPECT_THAT(fill("0", "1 - 1e-8", "1"), ElementsAre());
}

/// Loops of every kind at once: dependent count, cumulative spacing, position, direction, when, set.
const std::string rich = pattern_text(
    R"(<loop index='i' axis='x' count='6' spacing='1 + 0.1*i'/>
       <loop index='j' axis='y' count='mod(i, 3)' start='0.3*i' spacing='0.7/(j + i)'/>
       <loop index='k' count='i + 2' x='1' y='i' position='sin(k*0.3)'/>
       <set parameter='a' value='global.x*0.1 + k'/>
       <when test='mod(i + j + k, 4) != 1'/>
       <rotate x='1' y='0' z='j' angle='0.2*k'/>
       <set parameter='b' value='sqrt(a + 1)'/>)",
    R"(<parameter id='a' value='0'/><parameter id='b' value='a + y'/><parameter id='d' value='2*b'/>
       <csg><box dx='1' dy='1' dz='1'/></csg>)");

TEST(Order, AnyRangeIsThePartOfTheWhole) {
  const CellStream stream = stream_of(evaluation_of(rich));
  const auto whole = cells_of(stream);
  std::uint64_t total = 0;
  for (int i = 0; i < 6; ++i) total += static_cast<std::uint64_t>(i % 3) * static_cast<std::uint64_t>(i + 2);
  ASSERT_EQ(stream.size(), total);
  for (std::uint64_t first = 0; first <= total; ++first) {
    for (const std::uint64_t last : {first + 1, first + 7, total}) {
      std::vector<CellCopy> expected;
      for (const CellCopy& c : whole)
        if (c.ordinal >= first && c.ordinal < last) expected.push_back(c);
      ASSERT_EQ(cells_of(stream, first, last), expected) << first << " to " << last;
    }
  }
}

TEST(Order, ThreadsSplitTheWorkWithoutATrace) {
  const CellStream stream = stream_of(evaluation_of(rich));
  const auto whole = cells_of(stream);
  for (const std::uint64_t parts : {1U, 2U, 7U}) {
    std::vector<std::vector<CellCopy>> pieces(parts);
    std::vector<std::thread> threads;
    for (std::uint64_t p = 0; p < parts; ++p)
      threads.emplace_back(
          [&, p] { pieces[p] = cells_of(stream, stream.size() * p / parts, stream.size() * (p + 1) / parts); });
    for (std::thread& t : threads) t.join();
    std::vector<CellCopy> joined;
    for (const auto& piece : pieces) joined.insert(joined.end(), piece.begin(), piece.end());
    EXPECT_EQ(joined, whole);
  }
}

TEST(Order, CompiledAndWalkedExpressionsGiveTheSameCells) {
  const CellStream stream = stream_of(evaluation_of(pattern_text(
      "<loop index='i' axis='x' count='3000' spacing='0.1'/><set parameter='a' value='sin(x)^2 + floor(0.3*i)'/>",
      "<parameter id='a' value='0'/><csg><box dx='1' dy='1' dz='1'/></csg>")));
  const auto whole = cells_of(stream);  // enough cells to be compiled
  for (const std::uint64_t n : {0U, 1U, 17U, 2999U}) EXPECT_EQ(cells_of(stream, n, n + 1).at(0), whole[n]);
}

TEST(Limits, TooManyCellsAreToldAtOnce) {
  EXPECT_THAT(faults_of(pattern_text("<loop index='i' axis='x' count='1e12' spacing='1'/>")),
              ElementsAre("LIMIT_CELLS"));
  EXPECT_THAT(faults_of(pattern_text("<loop index='i' axis='x' count='1e12' spacing='1'/>"
                                     "<loop index='j' axis='y' count='i' spacing='1'/>")),
              ElementsAre("LIMIT_CELLS"));
  EXPECT_THAT(faults_of(pattern_text("<loop index='i' axis='x' count='1e12' spacing='1'/>"
                                     "<loop index='j' axis='y' count='0*i' spacing='1'/>")),
              ElementsAre("LIMIT_CELLS"));
  EXPECT_THAT(faults_of(pattern_text("<loop index='i' axis='x' count='11' spacing='1'/>"), {.run = {.max_cells = 10}}),
              ElementsAre("LIMIT_CELLS"));
  EXPECT_THAT(faults_of(pattern_text("<loop index='i' axis='x' count='10' spacing='1'/>"), {.run = {.max_cells = 10}}),
              ElementsAre());
}

TEST(Limits, ACountThatIsNotExactSaysSo) {
  const auto count_told = [](const std::string& loops) {
    const Evaluation evaluation = evaluation_of(pattern_text(loops));
    DiagnosticSink sink;
    (void)evaluation.cells(*evaluation.find_pattern("p"), sink);
    return sink.diagnostics().empty() ? "" : sink.diagnostics().front().args.at(1);
  };
  const auto loop = [](const std::string& index, const std::string& count) {
    const std::string axis = index == "i" ? "x" : index == "j" ? "y" : "z";
    return "<loop index='" + index + "' axis='" + axis + "' count='" + count + "' spacing='1'/>";
  };
  EXPECT_EQ(count_told(loop("i", "1e12")), "1000000000000");
  EXPECT_EQ(count_told(loop("i", "1e6") + loop("j", "3e9")), "3000000000000000");
  // More than an integer holds; and an inner count that was given up.
  EXPECT_EQ(count_told(loop("i", "1e9") + loop("j", "1e9") + loop("k", "1e9")).find("more than "), 0u);
  EXPECT_EQ(count_told(loop("i", "3") + loop("j", "1e12") + loop("k", "j")).find("more than "), 0u);
}

TEST(Limits, CancellationStopsAVisit) {
  EXPECT_THAT(faults_of(pattern_text("<loop index='i' axis='x' count='10' spacing='1'/>"),
                        {.run = {.cancelled = [] { return true; }}}),
              ElementsAre("CANCELLED"));
}

TEST(Faults, NameTheCell) {
  EXPECT_THAT(faults_of(pattern_text("<loop index='i' axis='x' count='20' spacing='1'/>"
                                     "<loop index='j' axis='y' count='2' spacing='1'/>"
                                     "<translate x='1/(i - 17)'/>")),
              ElementsAre("EXPRESSION_DOMAIN in cell (17, 0) of pattern 'p'"));
  EXPECT_THAT(faults_of(pattern_text("<loop index='i' axis='x' count='3' spacing='1'/>"
                                     "<loop index='j' axis='y' count='1.5 - i' spacing='1'/>")),
              ElementsAre("VALUE_NOT_WHOLE in cell (0) of pattern 'p'"));
}

TEST(Faults, PointAtTheSubexpression) {
  const Evaluation e =
      evaluation_of(pattern_text("<loop index='i' axis='x' count='2' spacing='1'/>"
                                 "<translate x='3 + 1/(i - 1)'/>"));
  DiagnosticSink sink;
  EXPECT_FALSE(stream_of(e).visit(
      0, 2, [](const PlacedCell&) { return true; }, sink));
  ASSERT_EQ(sink.diagnostics().size(), 1U);
  EXPECT_THAT(sink.diagnostics()[0].args, ElementsAre("1/(i - 1)"));
}

TEST(Faults, NegativeDistances) {
  const std::string systems = R"(<coordinateSystems><coordinateSystem id="polar"><axis name="r" kind="distance" x="1"/>
    <axis name="phi" kind="circular" z="1"/></coordinateSystem></coordinateSystems>)";
  const auto faults = [&](const std::string& loop) {
    return faults_of(pattern_text(loop, "<csg><box dx='1' dy='1' dz='1'/></csg>", "coordinateSystem='polar'", systems));
  };
  EXPECT_THAT(faults("<loop index='i' axis='r' count='3' start='1' spacing='-1'/>"),
              ElementsAre("DISTANCE_NEGATIVE in cell (2) of pattern 'p'"));
  EXPECT_THAT(faults("<loop index='i' axis='r' count='4' start='0.3' spacing='-0.1'/>"), ElementsAre());
}

}  // namespace
}  // namespace meso::eval
