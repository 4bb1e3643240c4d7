// SPDX-License-Identifier: Apache-2.0
#pragma once
// HDF5 data sets of one or two dimensions.
//
//   const auto table = read_field_hdf5("field.h5", "/stress", run, sink);   // rows are records
//
// Several paths, separated by commas, stand side by side ("/points,/stress"); all have equally many rows. A path that
// names a group means all data sets in it, by name. Numbers of any integer or floating-point type become doubles; data
// sets that lie in the file as doubles in one piece are mapped, others read in blocks of rows,
// into memory or, if they are many, into a temporary file (number_block.hpp). Columns of a data set
// with an attribute `components` (texts) have these names, others that of the data set (and _1, _2 ...); `unit` or
// `units` is their unit. Errors: IMPORT_UNREADABLE (no HDF5 file, cut), FIELD_COLUMN where there is no such data set,
// FIELD_FILE_UNSUPPORTED (texts, three dimensions, links to other files and numbers in them), FIELD_RECORD_COUNT,
// LIMIT_MEMORY. Thread rule: one call at a time, as Debian's library has no lock; the room holds one.

#include <optional>
#include <string>
#include <vector>

#include "meso/base/diagnostic.hpp"
#include "meso/base/run_options.hpp"
#include "meso/fields/table.hpp"
#include "meso/resource/resource.hpp"

namespace meso {

[[nodiscard]] std::optional<fields::Table> read_field_hdf5(const Resource& file, const std::string& path,
                                                           const RunOptions& run, DiagnosticSink& sink);

[[nodiscard]] std::optional<std::vector<std::int64_t>> read_field_hdf5_integers(const Resource& file,
                                                                                const std::string& path,
                                                                                const RunOptions& run,
                                                                                DiagnosticSink& sink);

/// One data set "/records" of rows x columns doubles, its columns' names and units beside it. False after an error.
[[nodiscard]] bool write_field_hdf5(const fields::Table& table, const std::string& file, DiagnosticSink& sink);

}  // namespace meso
