// SPDX-License-Identifier: Apache-2.0
#include "step_outline.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

namespace meso::operations {
namespace {

std::string beam() {
  std::ifstream file(std::string(MESO_SOURCE_DIR) + "/examples/ibeam/ibeam.step", std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

StepOutline outline_of(const std::string& text) {
  std::string fault;
  const auto outline = outline_step(text, {}, fault);
  EXPECT_TRUE(outline) << fault;
  return outline.value_or(StepOutline{});
}

TEST(StepOutline, AClosedSolid) {
  const StepOutline found = outline_of(beam());
  EXPECT_EQ(found.solids, 1u);
  EXPECT_EQ(found.shells, 1u);
  EXPECT_EQ(found.faces, 14u);  // an extruded I of twelve sides
  EXPECT_EQ(found.edges, 36u);
  EXPECT_EQ(found.free_edges + found.multiple_edges + found.conflicts + found.open_loops, 0u);
  EXPECT_EQ(count_step_faces(beam()), 14u);
}

TEST(StepOutline, AFaceLess) {
  std::string text = beam();
  const auto shell = text.find("CLOSED_SHELL("), first = text.find('#', shell), second = text.find('#', first + 1);
  text.erase(first, second - first);
  const StepOutline found = outline_of(text);
  EXPECT_EQ(found.faces, 13u);
  EXPECT_GE(found.free_edges, 4u);
}

TEST(StepOutline, AFaceThatIsTurned) {
  std::string text = beam();
  const auto bound = text.find("FACE_BOUND("), sense = text.find(".T.", bound);
  ASSERT_NE(sense, std::string::npos);
  text[sense + 1] = 'F';
  EXPECT_GE(outline_of(text).conflicts, 4u);
}

TEST(StepOutline, AnEdgeThatIsTurnedOpensItsLoop) {
  std::string text = beam();
  const auto use = text.find("ORIENTED_EDGE("), sense = text.find('.', use);
  text[sense + 1] = text[sense + 1] == 'T' ? 'F' : 'T';
  const StepOutline found = outline_of(text);
  EXPECT_EQ(found.open_loops, 1u);
  EXPECT_EQ(found.conflicts, 1u);
}

TEST(StepOutline, StringsAndCommentsArePassedOver) {
  std::string text = beam();
  text.insert(text.find("DATA;"), "FILE_NAME('part #3 (rev B''s)'); /* it's #1 = ( */ ");
  const auto shell = text.find("CLOSED_SHELL(");
  text.insert(shell, "/* it's; */");
  text.insert(text.find('(', shell) + 1, "/* ; ' */ ");
  const StepOutline found = outline_of(text);
  EXPECT_EQ(found.faces, 14u);
  EXPECT_EQ(found.edges, 36u);
  EXPECT_EQ(found.free_edges + found.multiple_edges + found.conflicts + found.open_loops, 0u);
}

TEST(StepOutline, WhatIsNoLoopIsToldAndNotTakenForAVertex) {
  std::string text = beam();
  const auto use = text.find("EDGE_LOOP(");
  text.replace(use, 9, "POLY_LOOP");
  std::string fault;
  EXPECT_FALSE(outline_step(text, {}, fault));
  EXPECT_NE(fault.find("is not what refers to it expects"), std::string::npos);
}

TEST(StepOutline, AShellThatIsItselfTurned) {
  std::string fault;
  EXPECT_FALSE(outline_step("#1=ORIENTED_CLOSED_SHELL('',*,#1,.T.);#2=BREP_WITH_VOIDS('',#1);", {}, fault));
  EXPECT_FALSE(outline_step("#1=CLOSED_SHELL('',());#2=MANIFOLD_SOLID_BREP('',#1);", {}, fault));
  EXPECT_EQ(fault, "shell #1 has no faces");
}

TEST(StepOutline, WhatIsNoSolid) {
  std::string fault;
  EXPECT_FALSE(outline_step("ISO-10303-21;", {}, fault));
  EXPECT_EQ(fault, "no solid in it");
  const std::string text = beam();
  EXPECT_FALSE(outline_step(text.substr(0, text.find("EDGE_LOOP(") + 9), {}, fault));
  EXPECT_FALSE(outline_step("#1=MANIFOLD_SOLID_BREP('',#2);", {}, fault));
  EXPECT_EQ(fault, "#2 is not what refers to it expects");
  RunOptions run;
  run.cancelled = [] { return true; };
  EXPECT_FALSE(outline_step(text, run, fault));
}

}  // namespace
}  // namespace meso::operations
