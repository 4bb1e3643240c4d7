// SPDX-License-Identifier: Apache-2.0
#include "meso/xml/write.hpp"

#include <gtest/gtest.h>

#include "meso/xml/read.hpp"

namespace meso {
namespace {

Document read_good(const std::string& text) {
  DiagnosticSink sink;
  auto result = read_document(text, "t.meso", sink);
  for (const Diagnostic& d : sink.diagnostics()) ADD_FAILURE() << render(d);
  return result ? result->document : Document{};
}

constexpr auto sample = R"xml(<?xml version="1.0"?>
<!-- before -->
<meso xmlns="urn:meso-format:1.0" version="1.0" unit="millimeter">
  <metadata name="title">I-beam with a body-centred truss core</metadata>
  <parameters>
    <!-- the pitch -->
    <parameter id="pitch" value="5mm" min="1mm"/>
    <parameter id="strut" value="1mm"/>
  </parameters>
  <macrostructures>
    <macrostructure id="beam"><import href="ibeam.step"/></macrostructure>
  </macrostructures>
  <unitCells>
    <unitCell id="bcc">
      <parameter id="t" value="strut"/>
      <box x="0" y="0" z="0" dx="pitch" dy="pitch" dz="pitch"/>
      <beams radius="t/2" nodeRadius="0.9*t">
        <node id="a" x="0" y="0" z="0"/><node id="b" x="pitch" y="pitch" z="pitch"/>
        <beam from="a" to="b"/>
      </beams>
    </unitCell>
  </unitCells>
  <patterns>
    <pattern id="core" unitCell="bcc">
      <loop index="i" axis="x" count="ceil(50mm/pitch)"  start="-25mm" spacing="pitch"/>
      <when test="i &lt; 3"/>
    </pattern>
  </patterns>
  <parts>
    <part id="lightBeam" macrostructure="beam"><apply pattern="core" operation="intersection"/></part>
  </parts>
  <build><item part="lightBeam"/></build>
</meso>
<!-- after -->
)xml";

TEST(Write, KeepsEverythingOfADocument) {
  const Document d = read_good(sample);
  const std::string text = write_document(d);
  EXPECT_EQ(read_good(text), d) << text;
  EXPECT_EQ(write_document(read_good(text)), text);
  EXPECT_EQ(d.before.size(), 1U);
  EXPECT_EQ(d.after.size(), 1U);
  EXPECT_EQ(d.patterns.items.at(0).instructions.size(), 1U);
}

TEST(Canonical, HasTheseBytes) {
  const std::string text = canonical_document(read_good(
      R"(<m:meso unit="millimeter" version="1.0" xmlns:m="urn:meso-format:1.0"><!-- c --><m:build/>
         <m:parts><m:part macrostructure="b" id="p"/></m:parts>
         <m:parameters><m:parameter value="  1 +
           2" id="a"/></m:parameters><m:parts><!-- x --><m:part id='q'></m:part></m:parts></m:meso>)"));
  EXPECT_EQ(text, R"(<meso xmlns="urn:meso-format:1.0" version="1.0" unit="millimeter">
  <parameters>
    <parameter id="a" value="1 + 2"/>
  </parameters>
  <parts>
    <part id="p" macrostructure="b"/>
    <part id="q"/>
  </parts>
</meso>
)");
  EXPECT_EQ(canonical_document(read_good(text)), text);
}

}  // namespace
}  // namespace meso
