// SPDX-License-Identifier: Apache-2.0
#pragma once
// A field file of any format, as one neutral table.
//
//   const auto table = read_field_file({.file = "stress.frd", .format = ValueFormat::frd}, sink);
//   table->columns[3].name;      // "SXX"
//   table->records(0, 3);
//
// What the columns of each format are called is of docs/specification/meaning.md. Raw files and contiguous
// HDF5 data sets are mapped, not read. Errors: IMPORT_UNREADABLE, FIELD_FILE_* with the place in the file,
// FIELD_NO_READER where a format was left out of the build, LIMIT_MEMORY. No state.

#include <filesystem>
#include <optional>

#include "meso/base/diagnostic.hpp"
#include "meso/base/run_options.hpp"
#include "meso/fields/table.hpp"
#include "meso/model/field.hpp"
#include "meso/resource/resource.hpp"

namespace meso {

struct FieldFileRequest {
  Resource file;
  ValueFormat format = ValueFormat::raw;
  std::string path{};                    ///< data set inside the file; of the other formats all, or one by its name
  std::uint64_t offset = 0, stride = 0;  ///< bytes, raw only; stride 0: dense
  std::size_t rows = 0, columns = 0;     ///< raw only
  RunOptions run{};
};

[[nodiscard]] std::optional<fields::Table> read_field_file(const FieldFileRequest& request, DiagnosticSink& sink);

/// 64-bit integers of a raw file or an HDF5 data set.
[[nodiscard]] std::optional<std::vector<std::int64_t>> read_field_integers(const FieldFileRequest& request,
                                                                           DiagnosticSink& sink);

/// By the extension: .h5 .hdf5 .csv .vtk .vtu .frd .msh; nothing for another one.
[[nodiscard]] std::optional<ValueFormat> field_file_format(const std::filesystem::path& file);

}  // namespace meso
