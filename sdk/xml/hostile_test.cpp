// SPDX-License-Identifier: Apache-2.0
// Input made to hurt: bounded time and memory, one diagnostic, no crash.
#include <gtest/gtest.h>

#include <chrono>

#include "meso/xml/read.hpp"
#include "structure_cases.hpp"

namespace meso {
namespace {

using xml::in_meso;

std::vector<Diagnostic> faults_of(const std::string& text, const ReadOptions& options = {}) {
  DiagnosticSink sink;
  const bool read = read_document(text, "h.meso", sink, options).has_value();
  EXPECT_EQ(read, !sink.has_errors());
  return sink.diagnostics();
}
std::string repeated(std::size_t count, std::string_view what) {
  std::string out;
  out.reserve(count * what.size());
  for (std::size_t i = 0; i < count; ++i) out += what;
  return out;
}

TEST(Hostile, EveryCutOfADocumentIsOneFault) {
  const std::string text =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?><!-- a --><meso xmlns=\"urn:meso-format:1.0\" version='1.0' "
      "unit=\"inch\"><?p q?><metadata name=\"t\">a &lt; b &#x41; \xC3\xA4<![CDATA[ x ]]></metadata>"
      "<v:f xmlns:v=\"u\"><w/></v:f><parts><part id=\"p\"><!-- c --></part></parts></meso>";
  EXPECT_TRUE(faults_of(text).empty());
  for (std::size_t n = 0; n < text.size(); ++n) {
    const auto faults = faults_of(text.substr(0, n));
    ASSERT_EQ(faults.size(), 1U) << n;
    EXPECT_EQ(info(faults[0].code).exit_code, 3) << n << " " << render(faults[0]);
  }
}

TEST(Hostile, EveryByteReplacedIsAnswered) {
  const std::string text = in_meso("<v:f xmlns:v=\"u\">t</v:f><parts><part id=\"p\"><!-- c --></part></parts>");
  for (std::size_t i = 0; i < text.size(); ++i) {
    for (const char c : {'\0', '<', '>', '&', '"', '/', ' ', ':', '!', '?', '\x80', 'q'}) {
      std::string changed = text;
      changed[i] = c;
      const auto faults = faults_of(changed);
      // No XML document holds either byte: U+0000 is no character, 0x80 alone no UTF-8.
      if (c == '\0' || c == '\x80') {
        EXPECT_FALSE(faults.empty()) << i;
      } else if (changed == text) {
        EXPECT_TRUE(faults.empty()) << i;
      }
    }
  }
}

TEST(Hostile, DeepNestingMeetsTheLimit) {
  const auto faults = faults_of(repeated(1'000'000, "<a>"));
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(faults[0].code, Code::xml_too_deep);
  const std::string unions = in_meso("<unitCells><unitCell id=\"c\"><csg>" + repeated(900, "<union>") +
                                     repeated(900, "</union>") + "</csg></unitCell></unitCells>");
  EXPECT_TRUE(faults_of(unions, {.max_depth = 1'000'000}).empty());
  const std::string foreign = in_meso("<f xmlns=\"u\">" + repeated(900, "<a>") + repeated(900, "</a>") + "</f>");
  EXPECT_TRUE(faults_of(foreign, {.max_depth = 1000}).empty());
}

TEST(Hostile, TooManyNodesMeetTheLimit) {
  const auto faults = faults_of(in_meso(repeated(1000, "<parts/>")), {.max_nodes = 500});
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(faults[0].code, Code::xml_too_many_nodes);
}

TEST(Hostile, BillionLaughsIsRefusedUnread) {
  const auto faults = faults_of("<!DOCTYPE a [<!ENTITY b \"ha\"><!ENTITY c \"&b;&b;&b;\">]>" + in_meso("&c;"));
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(faults[0].code, Code::xml_doctype);
}

TEST(Hostile, LongValuesAreReadAndMessagesStayShort) {
  const std::string value(10'000'000, 'x');
  EXPECT_TRUE(faults_of(in_meso("<metadata name=\"" + value + "\"/>")).empty());
  const auto faults = faults_of(in_meso("<parts><part id=\"1" + value + "\"/></parts>"));
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_LT(message(faults[0]).size(), 300U);
}

TEST(Hostile, TimeStaysLinear) {
  using Clock = std::chrono::steady_clock;
  std::string declarations, attributes;
  for (int i = 0; i < 100'000; ++i) {
    const std::string n = std::to_string(i);
    declarations += " xmlns:p" + n + "=\"u" + n + "\"";
    attributes += " p" + n + ":a=\"1\"";
  }
  const auto begin = Clock::now();
  EXPECT_TRUE(faults_of(in_meso("<f xmlns=\"u\"" + declarations + attributes + "/>")).empty());
  const auto faults = faults_of(in_meso(repeated(200'000, "<patern odd=\"1\"/>")));
  EXPECT_EQ(faults.size(), 100U);
  EXPECT_EQ(faults_of(in_meso(repeated(300'000, "&#") + "<parts/>")).size(), 1U);
  EXPECT_LT(Clock::now() - begin, std::chrono::seconds(20));
}

}  // namespace
}  // namespace meso
