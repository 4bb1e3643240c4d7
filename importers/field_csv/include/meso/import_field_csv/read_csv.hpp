// SPDX-License-Identifier: Apache-2.0
#pragma once
// Tables of numbers as text.
//
//   const std::optional<fields::Table> table = read_field_csv("x,y,z,stress [MPa]\n0,0,0,12.5\n", "stress.csv", sink);
//
// Cells are separated by commas, semicolons or tabs: by the first of these that the first line holds. Numbers have a
// decimal point, in any locale. If a cell of the first line is no number, that line is a heading: names, with a unit in
// brackets behind them. Empty lines and lines that begin with # mean nothing. Errors: FIELD_FILE_SYNTAX with line and
// column, FIELD_FILE_EMPTY. Linear; no state.

#include <optional>
#include <string>
#include <string_view>

#include "meso/base/diagnostic.hpp"
#include "meso/fields/table.hpp"

namespace meso {

/// `file` names the text in diagnostics.
[[nodiscard]] std::optional<fields::Table> read_field_csv(std::string_view text, const std::string& file,
                                                          DiagnosticSink& sink);

}  // namespace meso
