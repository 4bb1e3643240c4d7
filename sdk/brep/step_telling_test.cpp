// SPDX-License-Identifier: Apache-2.0
// Where faults of a lattice are told, and what is advised.
#include "step_telling.hpp"

#include <algorithm>

#include "realise_fixture.hpp"

namespace meso::brep {
namespace {

constexpr const char* body =
    R"(<macrostructures><macrostructure id="m"><csg><box dx="5" dy="9" dz="9"/></csg></macrostructure></macrostructures>)";

/// Line 3: the beams. Line 6: the first loop. Line 8: the step.
std::string bars(const std::string& beams, const std::string& start = " start=\"1\"") {
  std::string out = body;
  out += "<unitCells><unitCell id=\"u\">\n<beams radius=\"0.4\" ";
  out += beams;
  out += R"(><node id="a" x="0" y="0" z="0"/><node id="b" x="2" y="0" z="0"/><node id="c" x="2" y="2" z="0"/>)";
  out += "<beam from=\"a\" to=\"b\"/><beam from=\"b\" to=\"c\"/></beams>\n</unitCell></unitCells>\n";
  out += "<patterns><pattern id=\"p\" unitCell=\"u\">\n<loop index=\"i\" axis=\"x\" count=\"2\" spacing=\"2\"";
  out += start;
  out += "/>\n</pattern></patterns><parts><part id=\"a\" macrostructure=\"m\">\n";
  out += "<apply pattern=\"p\" operation=\"intersection\"/></part></parts>";
  return out;
}

class StepTellingTest : public ::testing::Test {
 protected:
  /// What becomes of `code`, reported at the beams.
  std::optional<Diagnostic> passed_on(const std::string& text, Code code, bool at_beams) {
    DiagnosticSink sink;
    auto read = read_document(head + "\n" + text + "</meso>", "test.meso", sink);
    const auto checked = read ? validate(std::move(read->document), std::move(read->source), ".", sink) : std::nullopt;
    const auto evaluation = checked ? eval::Evaluation::make(*checked, {}, sink) : std::nullopt;
    if (!evaluation) return {};
    const Document& document = evaluation->document();
    const auto cells = evaluation->cells(document.patterns.items.front(), sink);
    const RunOptions run;
    const SolidContext solid{checked->source(), run, sink};
    const FoldContext step{solid, document.parts.items.front().steps.front()};
    StepTelling telling(*cells, step, true);
    if (at_beams)
      telling.context().solid.report(code, std::get<BeamsBody>(cells->unit_cell().body).id_in_source, {"x"});
    else
      telling.context().solid.sink.report({.code = code, .args = {"x"}});
    EXPECT_TRUE(sink.diagnostics().empty());
    telling.pass_on();
    return sink.diagnostics().size() == 1 ? std::optional(sink.diagnostics().front()) : std::nullopt;
  }
};

TEST_F(StepTellingTest, WhatMovesTheLatticeIsPointedAt) {
  const auto told = passed_on(bars("nodeRadius=\"auto\""), Code::geometry_not_repeatable, false);
  ASSERT_TRUE(told);
  EXPECT_EQ(told->where.line, 6u);
  EXPECT_EQ(told->path, "/meso/patterns/pattern[1]/loop[1]/@start");
  EXPECT_TRUE(told->related.empty());
  const auto without = passed_on(bars("nodeRadius=\"auto\"", ""), Code::geometry_not_repeatable, false);
  ASSERT_TRUE(without);
  EXPECT_EQ(without->path, "/meso/patterns/pattern[1]/loop[1]");
}

TEST_F(StepTellingTest, ABooleanOfOneCellIsNotAFaultOfItsBeams) {
  const auto told = passed_on(bars("nodeRadius=\"auto\""), Code::geometry_boolean, true);
  ASSERT_TRUE(told);
  EXPECT_EQ(told->where.line, 6u);
  ASSERT_EQ(told->related.size(), 1u);
  EXPECT_EQ(told->related[0].where.line, 3u);
}

TEST_F(StepTellingTest, AutomaticBallsAreAdvisedWhereThereAreNone) {
  const auto advice = [&](const std::string& beams) {
    const auto told = passed_on(bars(beams), Code::limit_booleans, false);
    EXPECT_TRUE(told && told->where.line == 8);
    return told && std::any_of(told->related.begin(), told->related.end(), [](const Related& r) {
             return r.note.find("nodeRadius=\"auto\"") == 0 && r.where.line == 3;
           });
  };
  EXPECT_TRUE(advice(""));
  EXPECT_TRUE(advice("nodeRadius=\"0.41\""));
  EXPECT_FALSE(advice("nodeRadius=\"auto\""));
  EXPECT_FALSE(advice("nodeRadius=\"0.6\""));  // 0.4 / sin(45 degrees) = 0.57
}

TEST_F(StepTellingTest, OtherFaultsStayWhereTheyAre) {
  const auto told = passed_on(bars(""), Code::geometry_size, true);
  ASSERT_TRUE(told);
  EXPECT_EQ(told->where.line, 3u);
  EXPECT_TRUE(told->related.empty());
}

}  // namespace
}  // namespace meso::brep
