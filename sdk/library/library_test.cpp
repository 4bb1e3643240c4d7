// SPDX-License-Identifier: Apache-2.0
// Every cell of the library stands on its own; what a document makes of one is a matter of names and values.
#include "meso/library/library.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "meso/validate/validate.hpp"
#include "meso/xml/read.hpp"
#include "meso/xml/write.hpp"

namespace meso {
namespace {

using ::testing::ElementsAre;

std::string document(const std::string& cell) {
  return "<meso xmlns=\"urn:meso-format:1.0\" version=\"1.0\" unit=\"millimeter\"><unitCells>" + cell +
         "</unitCells></meso>";
}

class Library : public ::testing::Test {
 protected:
  std::optional<CheckedDocument> checked(const std::string& cell) {
    auto read = read_document(document(cell), "test.meso", sink_);
    return read ? validate(std::move(read->document), std::move(read->source), ".", sink_) : std::nullopt;
  }
  [[nodiscard]] std::string told() const {
    std::string all;
    for (const Diagnostic& d : sink_.diagnostics()) all += render(d) + "\n";
    return all;
  }
  DiagnosticSink sink_;
};

TEST_F(Library, EveryCellIsFoundUnderItsIdAndValid) {
  for (const std::string_view name : library_cell_names()) {
    const UnitCell* cell = find_library_cell(name);
    ASSERT_NE(cell, nullptr) << name;
    EXPECT_TRUE(cell->box) << name;
    EXPECT_TRUE(checked("<unitCell id=\"c\" library=\"" + std::string(name) + "\"/>")) << name << "\n" << told();
  }
  EXPECT_EQ(library_cell_names().size(), 9u);
}

TEST_F(Library, AnUnknownNameHasANearOne) {
  EXPECT_EQ(find_library_cell("octett"), nullptr);
  EXPECT_FALSE(checked(R"(<unitCell id="c" library="octett"/>)"));
  ASSERT_EQ(sink_.diagnostics().size(), 1u);
  EXPECT_EQ(sink_.diagnostics()[0].code, Code::link_unknown_library_cell);
  EXPECT_THAT(sink_.diagnostics()[0].args, ElementsAre("octett", "; did you mean 'octet'?"));
}

TEST_F(Library, GivenValuesReplaceThoseOfTheLibraryInItsOrder) {
  const auto filled = checked(
      R"(<unitCell id="c" library="bcc"><parameter id="strutRadius" value="0.4" max="1"/><parameter id="cellEdge" value="7"/></unitCell>)");
  ASSERT_TRUE(filled);
  const UnitCell& cell = filled->document().unit_cells.items.front();
  ASSERT_EQ(cell.parameters.size(), 2u);
  EXPECT_EQ(cell.parameters[0].name.text, "cellEdge");
  EXPECT_EQ(cell.parameters[0].value.text, "7");
  EXPECT_EQ(cell.parameters[1].value.text, "0.4");
  EXPECT_EQ(cell.parameters[1].max->text, "1");
  EXPECT_EQ(std::get<BeamsBody>(cell.body).beams.size(), 8u);
}

TEST_F(Library, ParametersItDoesNotHaveAndBodiesAreRefused) {
  EXPECT_FALSE(checked(R"(<unitCell id="c" library="bcc"><parameter id="strutRadios" value="1"/></unitCell>)"));
  EXPECT_FALSE(checked(R"(<unitCell id="c" library="bcc"><box dx="1" dy="1" dz="1"/></unitCell>)"));
  ASSERT_EQ(sink_.diagnostics().size(), 2u);
  EXPECT_EQ(sink_.diagnostics()[0].code, Code::link_unknown_parameter);
  EXPECT_THAT(sink_.diagnostics()[0].args, ElementsAre("bcc", "strutRadios", "; did you mean 'strutRadius'?"));
  EXPECT_EQ(sink_.diagnostics()[1].code, Code::library_cell_complete);
}

TEST_F(Library, FaultsInAFilledCellPointAtTheUnitCell) {
  const std::string text =
      document(R"(<unitCell id="c" library="bcc"><parameter id="cellEdge" value="-1"/></unitCell>)");
  auto read = read_document(text, "test.meso", sink_);
  ASSERT_TRUE(read);
  (void)validate(std::move(read->document), std::move(read->source), ".", sink_);
  for (const Diagnostic& d : sink_.diagnostics()) EXPECT_EQ(d.where.offset, text.find("<unitCell ")) << render(d);
}

TEST_F(Library, TheCanonicalFormKeepsTheName) {
  const auto read = read_document(document(R"(<unitCell id="c" library="bcc"/>)"), "test.meso", sink_);
  ASSERT_TRUE(read);
  EXPECT_NE(canonical_document(read->document).find("<unitCell id=\"c\" library=\"bcc\"/>"), std::string::npos);
}

}  // namespace
}  // namespace meso
