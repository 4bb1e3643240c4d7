// SPDX-License-Identifier: Apache-2.0
#pragma once
// Results of CalculiX: .frd files, as text and binary.
//
//   const auto table = read_field_frd(bytes, "beam.frd", "", {}, sink);         // x y z D1 D2 D3 SXX SYY ... SZX
//   const auto stress = read_field_frd(bytes, "beam.frd", "STRESS", {}, sink);  // x y z SXX SYY ... SZX
// The third argument names one data set; empty means all.
//
// One row for each node, in the order of the file; columns have the names of the components (with the data set's name
// in front where two data sets share one). Of a data set that is there for several steps the last counts. Nodes without
// a value have NaN. Corners of tetrahedra and hexahedra of first and second order become `tetra` and `hexa`. Errors:
// FIELD_FILE_*, LIMIT_MEMORY, LIMIT_TIME, CANCELLED. Linear; no state.

#include <optional>
#include <string>
#include <string_view>

#include "meso/base/diagnostic.hpp"
#include "meso/base/run_options.hpp"
#include "meso/fields/table.hpp"

namespace meso {

[[nodiscard]] std::optional<fields::Table> read_field_frd(std::string_view bytes, const std::string& file,
                                                          const std::string& data_set, const RunOptions& run,
                                                          DiagnosticSink& sink);

}  // namespace meso
