// SPDX-License-Identifier: Apache-2.0
#include "meso/import_field_file/read_field_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>

#include "meso/import_field_csv/read_csv.hpp"
#include "meso/import_field_frd/read_frd.hpp"
#include "meso/import_field_msh/read_msh.hpp"
#include "meso/import_field_vtk/read_vtk.hpp"
#ifdef MESO_FIELD_LIBRARIES
#include "meso/import_field_hdf5/read_hdf5.hpp"
#endif

namespace meso {
namespace {

std::shared_ptr<const ResourceBytes> open(const FieldFileRequest& request, DiagnosticSink& sink) {
  std::string error;
  auto file = ResourceBytes::open(request.file, error);
  if (!file) sink.report({.code = Code::import_unreadable, .args = {request.file.name().string(), error}});
  return file;
}

std::optional<fields::Records> map_raw(const FieldFileRequest& request,
                                       const std::shared_ptr<const ResourceBytes>& file, DiagnosticSink& sink) {
  const fields::RecordLayout layout{request.offset, request.stride, request.rows, request.columns};
  auto records = fields::Records::map(file, layout);
  if (!records) {
    const auto needed = fields::Records::bytes_needed(layout);
    sink.report({.code = Code::field_file_truncated,
                 .where = {.file = request.file.name().string()},
                 .args = {"after " + std::to_string(file->view().size()) + " of " +
                          (needed ? std::to_string(*needed) : "2^63 or more") + " bytes"}});
  }
  return records;
}

[[maybe_unused]] void report_no_reader(const FieldFileRequest& request, DiagnosticSink& sink) {
  sink.report({.code = Code::field_no_reader, .args = {request.file.name().string()}});
}

}  // namespace

std::optional<fields::Table> read_field_file(const FieldFileRequest& request, DiagnosticSink& sink) {
  const std::string name = request.file.name().string();
  if (request.format == ValueFormat::hdf5) {
#ifdef MESO_FIELD_LIBRARIES
    return read_field_hdf5(request.file, request.path, request.run, sink);
#else
    report_no_reader(request, sink);
    return std::nullopt;
#endif
  }
  const auto file = open(request, sink);
  if (!file) return std::nullopt;
  switch (request.format) {
    case ValueFormat::raw: {
      auto records = map_raw(request, file, sink);
      if (!records) return std::nullopt;
      fields::Table table;
      table.records = std::move(*records);
      return table;
    }
    case ValueFormat::csv:
      return read_field_csv(file->view(), name, request.run, sink);
    case ValueFormat::frd:
      return read_field_frd(file->view(), name, request.path, request.run, sink);
    case ValueFormat::msh:
      return read_field_msh(file->view(), name, request.path, request.run, sink);
    case ValueFormat::vtk:
      return read_field_vtk(file->view(), name, request.path, request.run, sink);
#ifdef MESO_FIELD_LIBRARIES
    case ValueFormat::vtu:
      return read_field_vtu(file->view(), name, request.path, request.run, sink);
#endif
    default:
      report_no_reader(request, sink);
      return std::nullopt;
  }
}

std::optional<std::vector<std::int64_t>> read_field_integers(const FieldFileRequest& request, DiagnosticSink& sink) {
#ifdef MESO_FIELD_LIBRARIES
  if (request.format == ValueFormat::hdf5)
    return read_field_hdf5_integers(request.file, request.path, request.run, sink);
#endif
  if (request.format != ValueFormat::raw) {
    report_no_reader(request, sink);
    return std::nullopt;
  }
  const auto file = open(request, sink);
  const auto records = file ? map_raw(request, file, sink) : std::nullopt;
  if (!records) return std::nullopt;
  std::vector<std::int64_t> integers;
  integers.reserve(records->rows() * records->columns());
  for (std::size_t r = 0; r < records->rows(); ++r) {
    for (std::size_t c = 0; c < records->columns(); ++c)
      integers.push_back(std::bit_cast<std::int64_t>((*records)(r, c)));
  }
  return integers;
}

std::optional<ValueFormat> field_file_format(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  static constexpr std::array<std::pair<std::string_view, ValueFormat>, 7> known{{{".h5", ValueFormat::hdf5},
                                                                                  {".hdf5", ValueFormat::hdf5},
                                                                                  {".csv", ValueFormat::csv},
                                                                                  {".vtk", ValueFormat::vtk},
                                                                                  {".vtu", ValueFormat::vtu},
                                                                                  {".frd", ValueFormat::frd},
                                                                                  {".msh", ValueFormat::msh}}};
  for (const auto& [text, format] : known) {
    if (text == extension) return format;
  }
  return std::nullopt;
}

}  // namespace meso
