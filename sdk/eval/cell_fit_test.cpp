// SPDX-License-Identifier: Apache-2.0
// Cells that stand closer than they are long, or farther apart.
#include "meso/eval/cell_fit.hpp"

#include <gtest/gtest.h>

#include "document_text.hpp"

namespace meso::eval {
namespace {

constexpr const char* beam =
    "<box dx='4' dy='4' dz='4'/><beams radius='0.3'><node id='a' x='0' y='0' z='0'/><node id='b' x='4' y='4' z='4'/>"
    "<beam from='a' to='b'/></beams>";
constexpr const char* ball = "<box dx='4' dy='4' dz='4'/><csg><sphere radius='1'/></csg>";

/// Codes and lines of what is told of cells side by side, 4 mm long, whose loops are given.
struct Told {
  std::vector<Code> codes;
  std::vector<std::string> arguments;
};

Told told_of(const std::string& loops, const char* body = beam, const std::string& operation = "union",
             const std::string& more_patterns = "") {
  const Evaluation evaluation = evaluation_of(
      "<macrostructures><macrostructure id='m'><csg><box dx='9' dy='9' "
      "dz='9'/></csg></macrostructure></macrostructures><unitCells><unitCell id='u'>" +
      std::string(body) + "</unitCell></unitCells><patterns><pattern id='p' unitCell='u'>" + loops + "</pattern>" +
      more_patterns + "</patterns><parts><part id='a' macrostructure='m'><apply pattern='p' operation='" + operation +
      "'/></part></parts>");
  DiagnosticSink sink;
  warn_of_misfits(evaluation, sink);
  Told told;
  for (const Diagnostic& d : sink.diagnostics()) {
    told.codes.push_back(d.code);
    told.arguments = d.args;
  }
  return told;
}

std::string loop(const std::string& index, const std::string& axis, const std::string& spacing) {
  return "<loop index='" + index + "' axis='" + axis + "' count='3' spacing='" + spacing + "'/>";
}
std::string two(const std::string& along_x, const std::string& along_y) {
  return loop("i", "x", along_x) + loop("j", "y", along_y);
}

using Codes = std::vector<Code>;

TEST(CellFit, SideBySideIsNotTold) { EXPECT_EQ(told_of(two("4", "4")).codes, Codes{}); }

TEST(CellFit, OneWordForThreeMisfits) {
  const Told overlap = told_of(two("4", "3"));
  EXPECT_EQ(overlap.codes, Codes{Code::cells_overlap});
  EXPECT_EQ(overlap.arguments, (std::vector<std::string>{"p", "j", "4 x 4 x 4", "3"}));
  EXPECT_EQ(told_of(two("4.5", "4")).codes, Codes{Code::cells_apart});
  EXPECT_EQ(told_of(two("0", "4")).codes, Codes{Code::cells_coincide});
}

TEST(CellFit, CellsThatCoincideAreNoLatticeOfEqualCells) {
  const CellStream cells = stream_of(evaluation_of(pattern_text(two("0", "4"))));
  EXPECT_FALSE(cells.lattice());
  EXPECT_TRUE(cells.lattice_of_places());
}

TEST(CellFit, GapsThatMayBeMeant) {
  EXPECT_EQ(told_of(two("8", "4"), beam, "difference").codes, Codes{});
  EXPECT_EQ(told_of(two("8", "4"), beam, "union", "<pattern id='q' unitCell='u'>" + two("8", "4") + "</pattern>").codes,
            Codes{});
  // Every second cell of a row is in the gaps of the row before.
  EXPECT_EQ(told_of(loop("i", "x", "8") + "<loop index='j' x='1' y='1' z='0' count='3' spacing='4*sqrt(2)'/>").codes,
            Codes{});
}

TEST(CellFit, BodiesOtherThanBeamsMayStandAsTheyLike) {
  EXPECT_EQ(told_of(two("3", "4.5"), ball).codes, Codes{});
  EXPECT_EQ(told_of(two("0", "4"), ball).codes, Codes{Code::cells_coincide});
}

TEST(CellFit, CellsThatTurnOrGrowAreLeftAlone) {
  EXPECT_EQ(told_of(loop("i", "x", "0") + "<rotate x='0' y='0' z='1' angle='30deg*i'/>").codes, Codes{});
  EXPECT_EQ(told_of(loop("i", "x", "3 + i")).codes, Codes{});
}

}  // namespace
}  // namespace meso::eval
