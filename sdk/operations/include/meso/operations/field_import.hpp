// SPDX-License-Identifier: Apache-2.0
#pragma once
// A foreign field file as a vector field of a document, or as HDF5; and what is in it.
//
//   const auto report = operations::import_field("stress.frd", "stress.meso", {.data_set = "STRESS"}, sink);
//   report->records; report->columns[3].statistics.max; report->box;
//
// A .meso holds structure and values (base64): positions, or a grid, or tetrahedra, as the file has them; six columns
// that end in the places of a symmetric tensor become one, three that end in x y z or 1 2 3 a vector. A .h5 holds the
// columns, in one data set. Numbers that are not finite are an error: nothing is written. Errors: those of
// read_field_file(), FIELD_NOT_FINITE, WRITE_*. No state.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "meso/base/diagnostic.hpp"
#include "meso/base/output_file.hpp"
#include "meso/base/run_options.hpp"
#include "meso/base/unit.hpp"
#include "meso/base/vec.hpp"
#include "meso/fields/statistics.hpp"
#include "meso/fields/table.hpp"

namespace meso::operations {

struct FieldOptions {
  std::string data_set{};   ///< inside the file; empty: everything
  std::string unit = "mm";  ///< of the positions: um mm cm m in ft
  ExistingFile existing = ExistingFile::replace;
  RunOptions run{};
};

struct FieldColumnReport {
  std::string name, unit;
  fields::ColumnStatistics statistics;
};
struct FieldReport {
  std::size_t records = 0, tetra = 0, hexa = 0;
  std::vector<FieldColumnReport> columns;
  Box3 box;  ///< of x, y and z, in the file's unit; empty without them
};

[[nodiscard]] std::optional<FieldReport> field_info(const std::filesystem::path& in, const FieldOptions& options,
                                                    DiagnosticSink& sink);
[[nodiscard]] std::optional<FieldReport> import_field(const std::filesystem::path& in, const std::filesystem::path& out,
                                                      const FieldOptions& options, DiagnosticSink& sink);

}  // namespace meso::operations
