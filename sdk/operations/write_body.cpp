// SPDX-License-Identifier: Apache-2.0
#include <cerrno>
#include <cstdlib>
#include <system_error>

#include "file_extension.hpp"
#include "meso/base/memory_mesh_sink.hpp"
#include "meso/base/number.hpp"
#include "meso/base/output_file.hpp"
#include "meso/brep/read_step.hpp"
#include "meso/brep/triangle_mesh.hpp"
#include "meso/brep/triangles.hpp"
#include "meso/brep/write_brep.hpp"
#include "meso/export_mesh/mesh_writer.hpp"
#include "meso/export_step/write_step.hpp"
#include "meso/export_stl/write_stl.hpp"
#include "meso/operations/convert.hpp"
#include "read_mesh.hpp"

namespace meso::operations {
namespace {

enum class Format { step, brep, stl, mesh };

std::optional<Format> format_of(const std::filesystem::path& file) {
  const std::string extension = lower_extension(file);
  if (extension == ".step" || extension == ".stp") return Format::step;
  if (extension == ".brep") return Format::brep;
  if (extension == ".stl") return Format::stl;
  return mesh_format_of(file.string()) ? std::optional(Format::mesh) : std::nullopt;
}

/// The header's date is fixed unless the build environment states one (reproducible-builds.org).
std::int64_t source_date_epoch() {
  const char* text =
      std::getenv("SOURCE_DATE_EPOCH");  // NOLINT(concurrency-mt-unsafe): nothing here writes the environment
  return text == nullptr ? 0 : parse_integer(text).value_or(0);
}

std::optional<Written> write_format(Format format, const brep::Body& body, const std::string& name,
                                    const WriteOptions& options, ByteSink& out, DiagnosticSink& sink) {
  const unsigned jobs = options.run.jobs;
  switch (format) {
    case Format::mesh:
      break;  // see write_shared_mesh()
    case Format::step: {
      const StepCounts counts = write_step(body, {.name = name, .timestamp = source_date_epoch(), .jobs = jobs}, out);
      if (counts.touching_faces > 0)
        sink.report({.code = Code::step_balls_touch, .args = {std::to_string(counts.touching_faces)}});
      return Written{.bytes = counts.bytes};
    }
    case Format::stl: {
      const StlCounts counts =
          write_stl(brep::triangle_ranges(body), options.ascii ? StlFormat::ascii : StlFormat::binary, out, jobs);
      return Written{.bytes = counts.bytes, .triangles = counts.triangles};
    }
    case Format::brep: {
      const auto bytes = brep::write_brep(body, out, sink);
      return bytes ? std::optional(Written{.bytes = *bytes}) : std::nullopt;
    }
  }
  return std::nullopt;
}

/// Formats whose triangles share points.
std::optional<Written> write_shared_mesh(const brep::Body& body, const std::filesystem::path& file, OutputFile& out) {
  const TriangleMesh mesh = brep::triangle_mesh(body);
  const auto writer = make_mesh_writer(*mesh_format_of(file.string()), out);
  if (!write_mesh(mesh, *writer)) return std::nullopt;
  return Written{.triangles = mesh.triangles.size()};
}

/// Stops a writer when the user or the clock does.
class StoppableSink final : public ByteSink {
 public:
  StoppableSink(ByteSink& out, const RunOptions& run) : out_(out), run_(run) {}
  [[nodiscard]] bool write(std::string_view bytes) override { return !run_.should_stop() && out_.write(bytes); }

 private:
  ByteSink& out_;
  const RunOptions& run_;
};

}  // namespace

bool is_step_file(const std::filesystem::path& file) {
  const std::string extension = lower_extension(file);
  return extension == ".step" || extension == ".stp";
}

bool is_document(const std::filesystem::path& file) { return !brep::is_exact_file(file) && !is_mesh_file(file); }

std::optional<bool> output_needs_mesh(const std::filesystem::path& file) {
  const auto format = format_of(file);
  return format ? std::optional(*format == Format::mesh || *format == Format::stl) : std::nullopt;
}

std::optional<Written> write_body(const brep::Body& body, const std::filesystem::path& file,
                                  const WriteOptions& options, DiagnosticSink& sink) {
  const auto format = format_of(file);
  if (!format) {
    sink.report(
        {.code = Code::usage, .args = {"'" + file.string() + "': the extension names no format that is written here"}});
    return std::nullopt;
  }
  auto out = OutputFile::create(file.string(), options.no_clobber ? ExistingFile::refuse : ExistingFile::replace, sink);
  if (!out) return std::nullopt;
  const std::size_t errors = sink.error_count();
  StoppableSink stoppable(*out, options.run);
  auto written = *format == Format::mesh ? write_shared_mesh(body, file, *out)
                                         : write_format(*format, body, file.stem().string(), options, stoppable, sink);
  if (options.run.should_stop()) {
    sink.report({.code = options.run.out_of_time() ? Code::limit_time : Code::cancelled});
    return std::nullopt;
  }
  if (!written && sink.error_count() > errors) return std::nullopt;
  if (!written) (void)out->fail(EIO);  // unless the file knows better
  if (!out->commit(sink)) return std::nullopt;
  std::error_code error;
  if (written->bytes == 0) written->bytes = std::filesystem::file_size(file, error);
  return written;
}

}  // namespace meso::operations
