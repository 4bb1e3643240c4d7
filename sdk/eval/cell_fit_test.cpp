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

/// Diagonals of a cube of 4 mm: the middles of its edges and faces are 4 / sqrt(6) = 1.633 mm from all of them.
std::string diagonals(const std::string& radius, const std::string& box = "dx='4' dy='4' dz='4'") {
  std::string nodes, beams;
  for (int corner = 0; corner < 8; ++corner) {
    const std::string id = "n" + std::to_string(corner);
    nodes += "<node id='" + id + "' x='" + (corner & 1 ? "4" : "0") + "' y='" + (corner & 2 ? "4" : "0") + "' z='" +
             (corner & 4 ? "4" : "0") + "'/>";
    if (corner < 4) beams += "<beam from='" + id + "' to='n" + std::to_string(7 - corner) + "'/>";
  }
  return "<box " + box + "/><beams radius='" + radius + "'>" + nodes + beams + "</beams>";
}

TEST(CellFit, BeamsThatFillTheirCellAreTold) {
  EXPECT_EQ(told_of(two("4", "4"), diagonals("1.63").c_str()).codes, Codes{});
  const Told full = told_of(two("4", "4"), diagonals("1.635").c_str());
  ASSERT_EQ(full.codes, Codes{Code::beams_fill_cell});
  EXPECT_EQ(full.arguments[0], "u");
  EXPECT_EQ(full.arguments[1], "1.635");
  EXPECT_EQ(full.arguments[2], "4 x 4 x 4");
  // Two patterns of one cell are one fault of it.
  EXPECT_EQ(told_of(two("4", "4"), diagonals("2.5").c_str(), "difference",
                    "<pattern id='q' unitCell='u'>" + two("4", "4") + "</pattern>")
                .codes,
            Codes{Code::beams_fill_cell});
}

TEST(CellFit, BallsThatFillTheirCellAreNamed) {
  // Two struts 0.01 radians apart: r / sin(angle / 2) = 60 mm.
  const Told told = told_of(two("4", "4"),
                            "<box dx='4' dy='4' dz='4'/><beams radius='0.3' nodeRadius='auto'><node id='a' x='0' y='0' "
                            "z='0'/><node id='b' x='4' y='0' z='0'/><node id='c' x='4' y='0.04' z='0'/><beam from='a' "
                            "to='b'/><beam from='a' to='c'/></beams>");
  ASSERT_EQ(told.codes, Codes{Code::beams_fill_cell});
  EXPECT_EQ(told.arguments[3].find("with balls of radius 60.0"), 0u);
}

TEST(CellFit, StrutsAsThickAsTheirBoxAreTold) {
  const std::string along =
      "<node id='a' x='2' y='2' z='0.5'/><node id='b' x='6' y='2' z='0.5'/><beam from='a' to='b'/>";
  const std::string flat = "<box dx='4' dy='4' dz='1'/><beams radius='0.5'>" + along + "</beams>";
  const std::string layers = two("4", "4") + loop("k", "z", "1");
  EXPECT_EQ(told_of(layers, flat.c_str()).codes, Codes{Code::beams_fill_cell});
  // One layer is as thick as its struts are, whatever its box.
  EXPECT_EQ(told_of(two("4", "4"), flat.c_str()).codes, Codes{});
  // Some cells of a gradient may be full.
  EXPECT_EQ(told_of(two("4", "4"), ("<parameter id='t' value='1 + i'/>" + diagonals("t")).c_str()).codes, Codes{});
}

TEST(CellFit, CellsThatTurnOrGrowAreLeftAlone) {
  EXPECT_EQ(told_of(loop("i", "x", "0") + "<rotate x='0' y='0' z='1' angle='30deg*i'/>").codes, Codes{});
  EXPECT_EQ(told_of(loop("i", "x", "3 + i")).codes, Codes{});
}

}  // namespace
}  // namespace meso::eval
