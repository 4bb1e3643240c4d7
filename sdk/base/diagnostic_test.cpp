// SPDX-License-Identifier: Apache-2.0
#include "meso/base/diagnostic.hpp"

#include <gtest/gtest.h>

#include "meso/base/help.hpp"

namespace meso {
namespace {

TEST(Diagnostic, RendersPlaceCodeAndArguments) {
  const Diagnostic d{.code = Code::file_not_found,
                     .where = {.file = "a.meso", .offset = 3, .length = 1, .line = 2, .column = 7},
                     .args = {"b.step", "no such file"}};
  EXPECT_EQ(render(d), "a.meso:2:7: error FILE_NOT_FOUND: cannot open 'b.step': no such file");
}

TEST(Diagnostic, NamesThePathWhereNoTextExists) {
  const Diagnostic d{.code = Code::internal, .path = "/meso/parts/part[1]", .args = {"x"}};
  EXPECT_EQ(render(d), "/meso/parts/part[1]: error INTERNAL: internal error: x");
}

TEST(Diagnostic, HasAdviceForWhoeverShowsIt) {
  EXPECT_EQ(help(Code::xml_text_outside_root), "Remove it.");
  EXPECT_NE(help(Code::geometry_empty), help(Code::geometry_boolean));
}

TEST(DiagnosticSink, CountsErrorsBeyondItsLimit) {
  DiagnosticSink sink(1);
  sink.report({.code = Code::internal});
  sink.report({.code = Code::internal});
  EXPECT_EQ(sink.diagnostics().size(), 1U);
  EXPECT_EQ(sink.error_count(), 2U);
  EXPECT_TRUE(sink.truncated());
}

}  // namespace
}  // namespace meso
