// SPDX-License-Identifier: Apache-2.0
#pragma once
// Node data of Gmsh: .msh files of version 2.2 (text) and 4.1 (text and binary).
//
//   const auto table = read_field_msh(bytes, "view.msh", "", {}, sink);   // x y z and every $NodeData
//
// One row for each node, in the order of the file. A view of one number is a column with the view's name; of three
// numbers name_x name_y name_z; of nine numbers name_xx name_xy ... name_zz. Of a view that is there for several steps
// the last counts. Nodes without a value have NaN. Corners of tetrahedra and hexahedra of first and second order become
// `tetra` and `hexa`. Errors: FIELD_FILE_*, LIMIT_MEMORY,
// LIMIT_TIME, CANCELLED. Linear; no state.

#include <optional>
#include <string>
#include <string_view>

#include "meso/base/diagnostic.hpp"
#include "meso/base/run_options.hpp"
#include "meso/fields/table.hpp"

namespace meso {

/// `view` takes one view by its name; empty: all.
[[nodiscard]] std::optional<fields::Table> read_field_msh(std::string_view bytes, const std::string& file,
                                                          const std::string& view, const RunOptions& run,
                                                          DiagnosticSink& sink);

}  // namespace meso
