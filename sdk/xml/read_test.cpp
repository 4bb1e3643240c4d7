// SPDX-License-Identifier: Apache-2.0
#include "meso/xml/read.hpp"

#include <gtest/gtest.h>

#include "structure_cases.hpp"

namespace meso {
namespace {

using xml::in_cell;
using xml::in_meso;

struct Outcome {
  std::optional<ReadResult> result;
  std::vector<Diagnostic> diagnostics;
};
Outcome read(const std::string& text, const ReadOptions& options = {}) {
  DiagnosticSink sink;
  auto result = read_document(text, "t.meso", sink, options);
  return {std::move(result), sink.diagnostics()};
}
std::string all_of(const std::vector<Diagnostic>& all) {
  std::string out;
  for (const Diagnostic& d : all) out += render(d) + "\n";
  return out;
}

TEST(Read, AnswersEveryFaultWithOneDiagnosticAtItsPlace) {
  for (const xml::StructureCase& c : xml::structure_cases()) {
    std::string text = c.marked_text;
    const std::size_t mark = text.find('^');
    if (mark != std::string::npos) text.erase(mark, 1);
    const Outcome o = read(text);
    if (!c.fault) {
      EXPECT_TRUE(o.result && o.diagnostics.empty()) << c.name << "\n" << all_of(o.diagnostics);
      continue;
    }
    EXPECT_FALSE(o.result) << c.name;
    ASSERT_EQ(o.diagnostics.size(), 1U) << c.name << "\n" << all_of(o.diagnostics);
    EXPECT_EQ(info(o.diagnostics[0].code).name, info(*c.fault).name) << c.name;
    EXPECT_EQ(o.diagnostics[0].where.offset, mark) << c.name << "\n" << all_of(o.diagnostics);
  }
}

TEST(Read, ReportsIndependentFaultsInTheOrderOfTheFile) {
  const Outcome o =
      read(in_meso("<build><item/></build>\n<parts><part id=\"1\"/></parts>\n<pattern/>\n<parts nam=\"\"/>"));
  ASSERT_EQ(o.diagnostics.size(), 4U) << all_of(o.diagnostics);
  EXPECT_EQ(o.diagnostics[0].code, Code::attribute_missing);
  EXPECT_EQ(o.diagnostics[1].code, Code::value_name);
  EXPECT_EQ(o.diagnostics[2].code, Code::element_unknown);
  EXPECT_EQ(o.diagnostics[2].where.line, 3U);
  EXPECT_EQ(o.diagnostics[2].args[2], "; did you mean <patterns>?");
  EXPECT_EQ(o.diagnostics[3].code, Code::attribute_unknown);
}

TEST(Read, AMistypedAttributeIsNotMissingAsWell) {
  const Outcome o = read(in_meso("<build><item prat=\"a\"/></build>"));
  ASSERT_EQ(o.diagnostics.size(), 1U) << all_of(o.diagnostics);
  EXPECT_EQ(o.diagnostics[0].code, Code::attribute_unknown);
}

TEST(Read, KnowsUnitsThatAreWrittenShort) {
  const Outcome o = read("<meso xmlns=\"urn:meso-format:1.0\" version=\"1.0\" unit=\"mm\"/>");
  ASSERT_EQ(o.diagnostics.size(), 1U) << all_of(o.diagnostics);
  EXPECT_EQ(o.diagnostics[0].code, Code::value_choice);
  EXPECT_EQ(o.diagnostics[0].args[3], "; did you mean 'millimeter'?");
}

TEST(Read, GivesPathsOfMergedSections) {
  const Outcome o = read(in_meso("<parts><part id=\"a\"/></parts><parts><part id=\"b\"/></parts>"));
  ASSERT_TRUE(o.result);
  const Part& b = o.result->document.parts.items.at(1);
  EXPECT_EQ(o.result->source.path(b.id_in_source, "id"), "/meso/parts/part[2]/@id");
}

TEST(Read, PlacesAttributesInTheText) {
  const std::string text = in_cell("\n <box dx=\"1 &lt; 2\" dy='1' dz='1'/>");
  const Outcome o = read(text);
  ASSERT_TRUE(o.result);
  const CellBox& box = *o.result->document.unit_cells.items.at(0).box;
  EXPECT_EQ(box.dx.text, "1 < 2");
  EXPECT_EQ(o.result->source.span(box.id_in_source, "dx", 4).offset, text.find("2\" dy"));
  EXPECT_EQ(o.result->source.span(box.id_in_source).line, 2U);
}

TEST(Read, KeepsTriviaWithTheElementBehindIt) {
  const Outcome o =
      read(in_meso("<parts><!--1--></parts><!--2--><parts><!--3--><part id=\"a\"/><!--4--></parts><!--5-->"));
  ASSERT_TRUE(o.result);
  const Document& d = o.result->document;
  ASSERT_EQ(d.parts.items.at(0).before.size(), 3U);
  EXPECT_EQ(d.parts.items[0].before[1].text, "<!--2-->");
  EXPECT_EQ(d.parts.inside.at(0).text, "<!--4-->");
  EXPECT_EQ(d.inside.at(0).text, "<!--5-->");
}

TEST(Read, MakesForeignContentSelfContained) {
  const Outcome o = read(
      "<m:meso xmlns:m=\"urn:meso-format:1.0\" xmlns:r=\"urn:r\" version=\"1.0\" unit=\"inch\">"
      "<m:parts xmlns:v=\"urn:v\" xmlns=\"urn:d\"><v:a r:b=\"1\"><c/><m:box/></v:a><m:part id=\"p\" "
      "v:n=\"1\"/></m:parts>"
      "</m:meso>");
  ASSERT_TRUE(o.result) << all_of(o.diagnostics);
  const Part& p = o.result->document.parts.items.at(0);
  EXPECT_EQ(p.before.at(0).text,
            "<v:a xmlns:m=\"urn:meso-format:1.0\" xmlns:v=\"urn:v\" xmlns=\"urn:d\" r:b=\"1\"><c/><m:box/></v:a>");
  const std::vector<ForeignAttribute> expected = {{"xmlns:v", "urn:v"}, {"v:n", "1"}};
  EXPECT_EQ(p.foreign, expected);
  EXPECT_EQ(o.result->document.foreign.at(0).name, "xmlns:r");
}

TEST(Read, TakesUtf16WithByteOrderMark) {
  for (const bool big : {false, true}) {
    std::string bytes = big ? "\xFE\xFF" : "\xFF\xFE";
    for (const char c : in_meso("<parts/>\n<odd/>")) {
      bytes += big ? '\0' : c;
      bytes += big ? c : '\0';
    }
    const Outcome o = read(bytes);
    ASSERT_EQ(o.diagnostics.size(), 1U);
    EXPECT_EQ(o.diagnostics[0].code, Code::element_unknown);
    EXPECT_EQ(o.diagnostics[0].where.line, 2U);
    EXPECT_EQ(o.diagnostics[0].where.column, 1U);
  }
  EXPECT_EQ(read("\xFF\xFE<").diagnostics.at(0).code, Code::xml_invalid_utf16);
  EXPECT_TRUE(read("\xEF\xBB\xBF" + in_meso("")).result);
}

TEST(Read, UnderstandsWhatItIsToldTo) {
  const std::string text = "<meso xmlns=\"urn:meso-format:1.0\" version=\"1.0\" unit=\"inch\" requires=\" a  b\"/>";
  EXPECT_TRUE(read(text, {.understood = {"a", "b"}}).result);
  const Outcome o = read(text, {.understood = {"a"}});
  EXPECT_EQ(o.diagnostics.at(0).args.at(0), "'b'");
}

TEST(Read, AnswersMissingAndEndlessFiles) {
  DiagnosticSink sink;
  EXPECT_FALSE(read_document_file("/nowhere/a.meso", sink));
  EXPECT_FALSE(read_document_file("/", sink));
  EXPECT_FALSE(read_document_file("/dev/zero", sink, {.max_bytes = 1000}));
  ASSERT_EQ(sink.diagnostics().size(), 3U);
  EXPECT_EQ(sink.diagnostics()[0].code, Code::file_not_found);
  EXPECT_EQ(sink.diagnostics()[1].code, Code::file_not_found);
  EXPECT_EQ(sink.diagnostics()[2].code, Code::file_too_large);
}

}  // namespace
}  // namespace meso
