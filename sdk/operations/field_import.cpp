// SPDX-License-Identifier: Apache-2.0
#include "meso/operations/field_import.hpp"

#include <algorithm>

#include "field_document.hpp"
#include "meso/import_field_file/read_field_file.hpp"
#include "meso/package/open_document.hpp"
#include "meso/xml/write.hpp"
#ifdef MESO_FIELD_LIBRARIES
#include "meso/import_field_hdf5/read_hdf5.hpp"
#endif

namespace meso::operations {
namespace fs = std::filesystem;
namespace {

std::optional<fields::Table> read(const fs::path& in, const FieldOptions& options, DiagnosticSink& sink) {
  const auto format = field_file_format(in);
  if (!format) {
    sink.report(
        {.code = Code::usage, .args = {"'" + in.string() + "': field reads .csv .h5 .hdf5 .vtk .vtu .frd .msh"}});
    return std::nullopt;
  }
  const auto file = open_resource(in, options.run, sink);
  if (!file) return std::nullopt;
  auto table = read_field_file({.file = *file, .format = *format, .path = options.data_set, .run = options.run}, sink);
  if (!table) return std::nullopt;
  for (std::size_t c = table->columns.size(); c < table->records.columns(); ++c)
    table->columns.push_back({"c" + std::to_string(c + 1), {}});
  return table;
}

/// Nothing: `run` asked to stop.
std::optional<FieldReport> describe(const fields::Table& table, const RunOptions& run, DiagnosticSink& sink) {
  FieldReport report{.records = table.records.rows(), .tetra = table.tetra.size() / 4, .hexa = table.hexa.size() / 8};
  const auto all = fields::statistics(table.records, run);
  if (!all) {
    sink.report({.code = run.out_of_time() ? Code::limit_time : Code::cancelled});
    return std::nullopt;
  }
  std::size_t places = 0;
  Box3 box{{0, 0, 0}, {0, 0, 0}};
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    report.columns.push_back({table.columns[c].name, table.columns[c].unit, (*all)[c]});
    const std::size_t axis = std::string("xyz").find(table.columns[c].name);
    if (table.columns[c].name.size() != 1 || axis > 2) continue;
    box.min[axis] = (*all)[c].min;
    box.max[axis] = (*all)[c].max;
    ++places;
  }
  if (places == 3) report.box = box;
  return report;
}

bool is_finite(const fs::path& in, const FieldReport& report, DiagnosticSink& sink) {
  for (const FieldColumnReport& column : report.columns) {
    const fields::ColumnStatistics& s = column.statistics;
    if (s.nan + s.infinite == 0) continue;
    sink.report({.code = Code::field_not_finite,
                 .where = {.file = in.string()},
                 .args = {in.filename().string(), column.name, std::to_string(s.nan + s.infinite),
                          std::to_string(report.records), std::to_string(s.first_not_finite)}});
    return false;
  }
  return true;
}

bool write_meso(const fields::Table& table, const fs::path& out, const FieldOptions& options, DiagnosticSink& sink) {
  // Base64 in the document, and in the text that is written.
  const std::uint64_t bytes =
      sizeof(double) * (table.records.rows() * table.records.columns() + table.tetra.size() + table.hexa.size());
  if (bytes > options.run.max_memory_bytes / 3) {
    sink.report({.code = Code::limit_memory, .args = {std::to_string(options.run.max_memory_bytes >> 20) + " MiB"}});
    return false;
  }
  auto file = OutputFile::create(out.string(), options.existing, sink);
  if (!file) return false;
  (void)file->write(write_document(field_document(table, fields::column_name(out.stem().string()), options.unit)));
  return file->commit(sink);
}

bool write_hdf5([[maybe_unused]] const fields::Table& table, const fs::path& out,
                [[maybe_unused]] const FieldOptions& options, DiagnosticSink& sink) {
#ifdef MESO_FIELD_LIBRARIES
  // The library writes by name: into the temporary, which the commit puts in place.
  auto file = OutputFile::create(out.string(), options.existing, sink);
  if (!file) return false;
  const std::string& temporary = file->temporary_path();
  return write_field_hdf5(table, temporary.empty() ? out.string() : temporary, sink) && file->commit(sink);
#else
  sink.report({.code = Code::field_no_reader, .args = {out.string()}});
  return false;
#endif
}

}  // namespace

std::optional<FieldReport> field_info(const fs::path& in, const FieldOptions& options, DiagnosticSink& sink) {
  const auto table = read(in, options, sink);
  return table ? describe(*table, options.run, sink) : std::nullopt;
}

std::optional<FieldReport> import_field(const fs::path& in, const fs::path& out, const FieldOptions& options,
                                        DiagnosticSink& sink) {
  const std::string extension = out.extension().string();
  const bool is_meso = extension == ".meso";
  if (!is_meso && extension != ".h5" && extension != ".hdf5") {
    sink.report({.code = Code::usage, .args = {"'" + out.string() + "': field import writes .meso .h5"}});
    return std::nullopt;
  }
  const auto table = read(in, options, sink);
  if (!table) return std::nullopt;
  auto report = describe(*table, options.run, sink);
  if (!report || !is_finite(in, *report, sink)) return std::nullopt;
  const bool written = is_meso ? write_meso(*table, out, options, sink) : write_hdf5(*table, out, options, sink);
  return written ? std::move(report) : std::nullopt;
}

}  // namespace meso::operations
