// SPDX-License-Identifier: Apache-2.0
#pragma once
// Tables of numbers as text.
//
//   const std::optional<fields::Table> table = read_field_csv("x,y,z,stress [MPa]\n0,0,0,12.5\n", "stress.csv", {},
//   sink);
//
// Cells are separated by commas, semicolons or tabs: by the first of these that the first line holds. Numbers have a
// decimal point, in any locale. If a cell of the first line is no number, that line is a heading: names, with a unit in
// brackets behind them. A file without one is read all the same, with the warning FIELD_NO_HEADING: its columns
// have no names. Empty lines and lines that begin with # mean nothing. Errors: FIELD_FILE_SYNTAX with line and column,
// FIELD_FILE_EMPTY, LIMIT_MEMORY, LIMIT_TIME, CANCELLED. Linear; no state.

#include <optional>
#include <string>
#include <string_view>

#include "meso/base/diagnostic.hpp"
#include "meso/base/run_options.hpp"
#include "meso/fields/table.hpp"

namespace meso {

/// `file` names the text in diagnostics.
[[nodiscard]] std::optional<fields::Table> read_field_csv(std::string_view text, const std::string& file,
                                                          const RunOptions& run, DiagnosticSink& sink);

}  // namespace meso
