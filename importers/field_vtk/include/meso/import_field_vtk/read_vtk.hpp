// SPDX-License-Identifier: Apache-2.0
#pragma once
// Point data of VTK: legacy .vtk files (text and binary, versions 2 to 5) and, where the build has Expat and zlib,
// unstructured grids in XML (.vtu; text, base64, zlib, appended).
//
//   const auto table = read_field_vtk(bytes, "stress.vtk", "", {}, sink);   // x y z and every array
//
// One row for each point, in the order of the file; a grid's rows run x fastest, and `grid` says where it stands. An
// array of one number is a column with its name; of 3 name_x name_y name_z; of 6 name_xx name_yy name_zz name_xy
// name_yz name_xz; of 9 name_xx name_xy ... name_zz; of others name_1, name_2 ... Corners of tetrahedra and hexahedra
// of first and second order become `tetra` and `hexa`, pyramids and wedges become tetrahedra. Values of cells and
// cells of other kinds are left out, with the warning FIELD_LEFT_OUT. Errors: FIELD_FILE_*, LIMIT_MEMORY, LIMIT_TIME,
// CANCELLED. Linear; no state.

#include <optional>
#include <string>
#include <string_view>

#include "meso/base/diagnostic.hpp"
#include "meso/base/run_options.hpp"
#include "meso/fields/table.hpp"

namespace meso {

/// `array` takes one array by its name; empty: all.
[[nodiscard]] std::optional<fields::Table> read_field_vtk(std::string_view bytes, const std::string& file,
                                                          const std::string& array, const RunOptions& run,
                                                          DiagnosticSink& sink);
[[nodiscard]] std::optional<fields::Table> read_field_vtu(std::string_view bytes, const std::string& file,
                                                          const std::string& array, const RunOptions& run,
                                                          DiagnosticSink& sink);

}  // namespace meso
