// SPDX-License-Identifier: Apache-2.0
// What the conformance cases cannot see: documents built in memory, arguments and related places of diagnostics, the
// checked document, and cost. Every rule has its cases in conformance/cases.
#include "meso/validate/validate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>

#include "meso/xml/read.hpp"

namespace meso {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

std::vector<Diagnostic> faults(const std::string& content) {
  DiagnosticSink sink;
  auto read = read_document(
      R"(<meso xmlns="urn:meso-format:1.0" version="1.0" unit="millimeter">)" + content + "</meso>", "test.meso", sink);
  if (read) (void)validate(std::move(read->document), std::move(read->source), ".", sink);
  return sink.diagnostics();
}

std::string parameters(const std::string& items) { return "<parameters>" + items + "</parameters>"; }

TEST(Validate, ChecksADocumentBuiltInMemory) {
  Document d;
  d.parameters.items.push_back({.id = {"pitch"}, .value = {"5mm"}});
  DiagnosticSink sink;
  const auto checked = validate(d, {}, "folder", sink);
  ASSERT_TRUE(checked);
  EXPECT_EQ(checked->document(), d);
  EXPECT_TRUE(checked->resources().find("body.step")->name().string().ends_with("folder/body.step"));
}

TEST(Validate, ReportsWithoutPlacesInADocumentBuiltInMemory) {
  Document d;
  d.parameters.items.push_back({.id = {"two words"}, .value = {""}});
  DiagnosticSink sink;
  EXPECT_FALSE(validate(d, {}, ".", sink));
  ASSERT_THAT(sink.diagnostics(), SizeIs(2));
  EXPECT_EQ(sink.diagnostics()[0].code, Code::value_name);
  EXPECT_EQ(sink.diagnostics()[1].code, Code::expression_empty);
  EXPECT_EQ(sink.diagnostics()[0].where.line, 0u);
}

TEST(Validate, KeepsEarlierErrorsOfTheSinkApart) {
  DiagnosticSink sink;
  sink.report({.code = Code::usage, .args = {"of someone else"}});
  EXPECT_TRUE(validate(Document{}, {}, ".", sink));
}

TEST(Links, SuggestTheNearestIdOfTheKind) {
  const auto told = faults(parameters(R"(<parameter id="core" value="1"/>)") +
                           R"(<parts><part id="coreA" macrostructure="m"/></parts><build><item part="cora"/></build>)");
  ASSERT_THAT(told, SizeIs(2));
  EXPECT_EQ(told[1].code, Code::link_unknown_id);
  EXPECT_THAT(told[1].args, ElementsAre("part", "cora", "; did you mean 'coreA'?"));
}

TEST(Links, SayWhereTheOtherIdIs) {
  const auto told = faults(parameters(R"(<parameter id="a" value="1"/><parameter id="a" value="1"/>)"));
  ASSERT_THAT(told, SizeIs(1));
  ASSERT_THAT(told[0].related, SizeIs(1));
  EXPECT_LT(told[0].related[0].where.offset, told[0].where.offset);
  EXPECT_EQ(told[0].path, "/meso/parameters/parameter[2]/@id");
}

TEST(Cycles, NameTheWholeCircle) {
  const auto told = faults(
      R"(<unitCells><unitCell id="u"><part ref="a"/></unitCell></unitCells>)"
      R"(<patterns><pattern id="p" unitCell="u"><loop index="i" axis="x" count="1" spacing="1"/></pattern></patterns>)"
      R"(<parts><part id="a"><apply pattern="p" operation="union"/></part></parts>)");
  ASSERT_THAT(told, SizeIs(1));
  EXPECT_THAT(told[0].args, ElementsAre("part a -> pattern p -> unitCell u -> part a"));
}

TEST(Cycles, SurviveAChainLongerThanTheStack) {
  Document d;
  constexpr int length = 200'000;
  for (int i = 0; i < length; ++i) {
    Part part{.id = {"p" + std::to_string(i)}};
    part.steps.push_back({.part = Ref<Part>{"p" + std::to_string((i + 1) % length)}});
    d.parts.items.push_back(std::move(part));
  }
  DiagnosticSink sink;
  EXPECT_FALSE(validate(std::move(d), {}, ".", sink));
  ASSERT_THAT(sink.diagnostics(), SizeIs(1));
  EXPECT_EQ(sink.diagnostics()[0].code, Code::link_cycle);
}

TEST(Expressions, SuggestTheNearestVisibleName) {
  const auto told = faults(parameters(R"(<parameter id="pitch" value="1"/><parameter id="b" value="2*pich"/>)"));
  ASSERT_THAT(told, SizeIs(1));
  EXPECT_THAT(told[0].args, ElementsAre("pich", "; did you mean 'pitch'?"));
  EXPECT_EQ(told[0].where.length, 4u);
}

TEST(Expressions, NameTheOperationWithoutValue) {
  const auto told = faults(parameters(R"-(<parameter id="a" value="1 + sqrt(0 - 4)"/>)-"));
  ASSERT_THAT(told, SizeIs(1));
  EXPECT_THAT(told[0].args, ElementsAre("sqrt(0 - 4)"));
}

TEST(Dimensions, SayWhichTwoDoNotMeet) {
  const auto told = faults(parameters(R"-(<parameter id="a" value="1 + (5mm - 3deg)"/>)-"));
  ASSERT_THAT(told, SizeIs(1));
  EXPECT_EQ(told[0].code, Code::expression_units);
  EXPECT_THAT(told[0].args, ElementsAre("5mm", "a length", "3deg", "an angle"));
}

TEST(Dimensions, NoConsequenceOfAClashIsTold) {
  const auto told = faults(parameters(R"-(<parameter id="a" value="5.2mm + 3deg"/><parameter id="b" value="a/2"/>)-") +
                           R"(<unitCells><unitCell id="u"><csg><sphere radius="1"/></csg></unitCell></unitCells>)"
                           R"(<patterns><pattern id="p" unitCell="u"><loop index="i" axis="x" count="b" spacing="1"/>)"
                           R"(</pattern></patterns>)");
  ASSERT_THAT(told, SizeIs(1));
  EXPECT_EQ(told[0].code, Code::expression_units);
}

TEST(Links, ListTheParametersOfACellWhereNoneIsNear) {
  const auto told = faults(
      R"(<unitCells><unitCell id="u"><parameter id="wall" value="1"/><csg><sphere radius="wall"/></csg></unitCell></unitCells>)"
      R"(<patterns><pattern id="p" unitCell="u"><loop index="i" axis="x" count="1" spacing="1"/>)"
      R"(<set parameter="strutRadius" value="1" at="cell"/></pattern></patterns>)");
  ASSERT_THAT(told, SizeIs(1));
  EXPECT_THAT(told[0].args, ElementsAre("u", "strutRadius", "; its parameters: wall"));
}

TEST(Dimensions, SayWhatIsAskedFor) {
  const auto told = faults(parameters(R"(<parameter id="t" value="4deg"/>)") +
                           R"(<macrostructures><macrostructure id="m"><csg><sphere radius=" t + 1 "/></csg>)"
                           R"(</macrostructure></macrostructures>)");
  ASSERT_THAT(told, SizeIs(1));
  EXPECT_EQ(message(told[0]), "'t + 1' is an angle, and radius is a length; write mm, cm, m, um, in or ft");
  EXPECT_EQ(told[0].where.length, 5u);
}

// R-5.1.10: a text without a tree has no dimension, and a broken link no axis.
TEST(Dimensions, SayNothingOfWhatWasTold) {
  EXPECT_THAT(faults(parameters(R"(<parameter id="a" value="5mm + "/><parameter id="b" value="a + 3deg"/>)")),
              SizeIs(1));
}

TEST(Dimensions, OfThousandsOfParametersStayCheap) {
  std::string items, cells;
  for (int i = 0; i < 5'000; ++i) {
    items += "<parameter id=\"p" + std::to_string(i) + "\" value=\"1mm\"/>";
    cells += "<unitCell id=\"u" + std::to_string(i) + "\"><csg><sphere radius=\"p0\"/></csg></unitCell>";
  }
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_THAT(faults(parameters(items) + "<unitCells>" + cells + "</unitCells>"), IsEmpty());
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(5));
}

TEST(Validate, ThousandsOfFaultsStayCheap) {
  std::string items;
  for (int i = 0; i < 20'000; ++i)
    items += "<parameter id=\"p" + std::to_string(i) + "\" value=\"nothing" + std::to_string(i) + "\"/>";
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_THAT(faults(parameters(items)), SizeIs(100));
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(10));
}

TEST(Validate, AHugeCountCostsNothing) {
  EXPECT_THAT(
      faults(
          R"(<unitCells><unitCell id="u"><csg><sphere radius="1"/></csg></unitCell></unitCells>)"
          R"(<patterns><pattern id="p" unitCell="u"><loop index="i" axis="x" count="10^12" spacing="1"/></pattern></patterns>)"),
      IsEmpty());
}

TEST(Values, AreShownAsEvaluated) {
  const auto told = faults(R"(<macrostructures><macrostructure id="m"><csg><sphere radius="1mm - 2cm"/></csg>)"
                           R"(</macrostructure></macrostructures>)");
  ASSERT_THAT(told, SizeIs(1));
  EXPECT_THAT(message(told[0]), HasSubstr("radius must be greater than 0, it is -19"));
}

}  // namespace
}  // namespace meso
