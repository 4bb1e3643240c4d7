// SPDX-License-Identifier: Apache-2.0
#pragma once
// Documents of tests: text in, the membership of the part "p" out.

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "meso/membership/membership.hpp"
#include "meso/validate/validate.hpp"
#include "meso/xml/read.hpp"

namespace meso::membership {

inline Membership membership_of(const std::string& content, const Options& options = {}) {
  DiagnosticSink sink;
  const auto stop = [&]() -> Membership {
    std::string text;
    for (const Diagnostic& d : sink.diagnostics()) text += render(d) + "\n";
    throw std::invalid_argument(text);
  };
  auto read =
      read_document("<meso xmlns=\"urn:meso-format:1.0\" version=\"1.0\" unit=\"millimeter\">" + content + "</meso>",
                    "test.meso", sink);
  const auto checked = read ? validate(std::move(read->document), std::move(read->source), ".", sink) : std::nullopt;
  const auto evaluation = checked ? eval::Evaluation::make(*checked, {}, sink) : std::nullopt;
  if (!evaluation) return stop();
  const auto part = Membership::make(*evaluation, *evaluation->find_part("p"), options, sink);
  return part ? *part : stop();
}

inline std::string macrostructure(const std::string& csg) {
  return "<macrostructures><macrostructure id='m'><csg>" + csg + "</csg></macrostructure></macrostructures>";
}
inline std::string part_of(const std::string& steps, bool with_body = true) {
  return std::string("<parts><part id='p'") + (with_body ? " macrostructure='m'" : "") + ">" + steps +
         "</part></parts>";
}
/// The pattern "c" of the unit cell "u".
inline std::string cells(const std::string& cell, const std::string& generator, const std::string& attributes = "",
                         const std::string& cell_attributes = "") {
  return "<unitCells><unitCell id='u' " + cell_attributes + ">" + cell +
         "</unitCell></unitCells><patterns><pattern id='c' unitCell='u' " + attributes + ">" + generator +
         "</pattern></patterns>";
}

}  // namespace meso::membership
