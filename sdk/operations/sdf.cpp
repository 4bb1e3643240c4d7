// SPDX-License-Identifier: Apache-2.0
#include "meso/operations/sdf.hpp"

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "measured_mesh_sink.hpp"
#include "meso/export_mesh/mesh_writer.hpp"
#include "meso/implicit/compile.hpp"
#include "meso/implicit/contour.hpp"
#include "meso/import_surface_mesh/read_surface_mesh.hpp"
#include "meso/mesh_distance/mesh_field.hpp"
#include "meso/sdf/build_field.hpp"
#include "stopwatch.hpp"

namespace meso::operations {
namespace fs = std::filesystem;

namespace {

std::optional<MeshFormat> format_of(const std::string& output, const SdfOptions& options, DiagnosticSink& sink) {
  const auto format = mesh_format_of(output);
  const auto refuse = [&](const char* why) {
    sink.report({.code = Code::usage, .args = {why}});
    return std::nullopt;
  };
  if (!format) sink.report({.code = Code::sdf_extension, .args = {output}});
  if (options.double_coordinates && format != MeshFormat::ply) return refuse("--double has an effect for .ply only");
  if (options.ascii && format != MeshFormat::stl) return refuse("--ascii has an effect for .stl only");
  if (options.double_coordinates) return MeshFormat::ply_double;
  return options.ascii ? MeshFormat::stl_ascii : format;
}

std::shared_ptr<const implicit::ExternalField> load_field(const std::string& path, const RunOptions& run,
                                                          DiagnosticSink& sink) {
  const auto mesh = read_surface_mesh_file(path, sink);
  return mesh ? implicit::MeshField::make(*mesh, path, run, sink) : nullptr;
}

implicit::Grid grid_of(const sdf::Program& program, const Box3& box) {
  implicit::Grid grid{.box = box};
  if (program.samples.size() == 1) {
    grid.nodes = implicit::nodes_for_total(box, program.samples[0]);
  } else {
    for (std::size_t i = 0; i < 3; ++i) grid.nodes[i] = static_cast<std::int32_t>(program.samples[i]);
  }
  return grid;
}

/// A field that certainly has no inside needs no samples.
class Nothing final : public implicit::GridSource {
 public:
  explicit Nothing(const Box3& box) : grid_{.box = box} {}
  [[nodiscard]] const implicit::Grid& grid() const override { return grid_; }
  [[nodiscard]] std::unique_ptr<implicit::GridSampler> sampler() const override { return std::make_unique<Sampler>(); }

 private:
  class Sampler final : public implicit::GridSampler {
    void begin_slab(std::int32_t, std::int32_t) override {}
    void row(std::int32_t, std::int32_t, float* values, std::uint64_t* inside) override {
      std::fill_n(values, 2, 1.0f);
      *inside = 0;
    }
    void values_at(std::span<const Vec3> points, double* out) override { std::fill_n(out, points.size(), 1.0); }
  };
  implicit::Grid grid_;
};

/// Contours into a file; the file's own faults are told by commit().
bool write_surface(const implicit::GridSource& source, MeshFormat format, const sdf::Program& program,
                   const SdfOptions& options, SdfReport& report, DiagnosticSink& sink) {
  auto file = OutputFile::create(program.output, options.existing, sink);
  if (!file) return false;
  const auto writer = make_mesh_writer(format, *file);
  MeasuredMeshSink measured(*writer);
  const std::size_t errors = sink.error_count();
  const auto contoured =
      implicit::contour(source, options.measure ? measured : *writer,
                        {.polish = options.polish, .collapse_slivers = options.no_slivers}, options.run, sink);
  if (!contoured && sink.error_count() == errors && options.run.cancelled && options.run.cancelled()) {
    sink.report({.code = Code::cancelled});
  }
  if (sink.error_count() > errors || !file->commit(sink) || !contoured) return false;
  report.points = contoured->points;
  report.triangles = contoured->triangles;
  report.euler = contoured->euler;
  if (options.measure) report.measures = measured.measures();
  std::error_code error;
  const auto bytes = fs::file_size(program.output, error);
  report.bytes = error ? 0 : bytes;
  if (report.triangles == 0) sink.report({.code = Code::sdf_empty, .args = {program.output}});
  return true;
}

}  // namespace

std::optional<SdfReport> run_sdf(const sdf::Program& program, const SdfOptions& options, DiagnosticSink& sink) {
  Stopwatch watch;
  const auto format = format_of(program.output, options, sink);
  if (!format) return std::nullopt;
  const auto load = [&](const std::string& path, DiagnosticSink& told) { return load_field(path, options.run, told); };
  const auto field = sdf::build_field(program, load, sink);
  if (!field) return std::nullopt;
  const auto box = sdf::box_of(program, *field, sink);
  if (!box) return std::nullopt;
  SdfReport report{.grid = grid_of(program, box->box)};
  report.seconds.read = watch.lap();
  std::unique_ptr<implicit::GridSource> source;
  if (box->certainly_empty) {
    source = std::make_unique<Nothing>(box->box);
  } else {
    source = implicit::compile(field->term(), report.grid, {.strict_math = options.strict_math});
  }
  if (!write_surface(*source, *format, program, options, report, sink)) return std::nullopt;
  report.seconds.contour = watch.lap();
  report.seconds.total = watch.total();
  return report;
}

sdf::ProgramOptions::Text read_text(const std::string& path) {
  constexpr std::size_t most_text_bytes = std::size_t{16} << 20;
  std::error_code error;
  if (fs::is_directory(path, error)) return {.why_not = std::make_error_code(std::errc::is_a_directory).message()};
  std::ifstream in(path, std::ios::binary);
  if (!in) return {.why_not = std::generic_category().message(errno)};
  // Words of a program, not data: whatever never ends (/dev/zero, a pipe) must not fill the memory.
  std::string text(most_text_bytes + 1, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  if (text.size() > most_text_bytes) return {.why_not = "it holds more than 16 MiB"};
  return {.text = std::move(text)};
}

}  // namespace meso::operations
