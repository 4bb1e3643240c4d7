// SPDX-License-Identifier: Apache-2.0
#pragma once
// Documents of a few lines, realised, for the tests of this room.

#include <gtest/gtest.h>

#include <cstdio>
#include <optional>
#include <string>

#include "meso/brep/audit.hpp"
#include "meso/brep/measure.hpp"
#include "meso/brep/realise.hpp"
#include "meso/validate/validate.hpp"
#include "meso/xml/read.hpp"

namespace meso::brep {

inline const std::string head = R"(<meso xmlns="urn:meso-format:1.0" version="1.0" unit="millimeter">)";

class RealiseTest : public ::testing::Test {
 protected:
  std::optional<Realisation> realised(const std::string& sections, const RealiseOptions& options = {}) {
    sink_ = DiagnosticSink();
    auto read = read_document(head + sections + "</meso>", "test.meso", sink_);
    if (!read) return {};
    const auto checked = validate(std::move(read->document), std::move(read->source), ".", sink_);
    if (!checked) return {};
    const auto evaluation = eval::Evaluation::make(*checked, {}, sink_);
    return evaluation ? realise_build(*evaluation, {}, options, sink_) : std::nullopt;
  }
  void TearDown() override {
    if (HasFailure())
      for (const Diagnostic& d : sink_.diagnostics()) std::puts(render(d).c_str());
  }
  Code first_code() const { return sink_.diagnostics().empty() ? Code{} : sink_.diagnostics().front().code; }

  DiagnosticSink sink_;
};

inline std::string macrostructure(const std::string& csg) {
  return "<macrostructures><macrostructure id=\"m\"><csg>" + csg + "</csg></macrostructure></macrostructures>";
}
inline std::string part(const std::string& apply, bool with_body = true) {
  return std::string("<parts><part id=\"p\"") + (with_body ? " macrostructure=\"m\"" : "") + ">" + apply +
         "</part></parts>";
}
inline void expect_body(const std::optional<Realisation>& made, const std::string& way, double volume) {
  ASSERT_TRUE(made);
  EXPECT_EQ(made->way, way);
  EXPECT_NEAR(measure(made->body).volume / volume, 1, 1e-6);
  EXPECT_TRUE(audit(made->body).clean());
}

}  // namespace meso::brep
