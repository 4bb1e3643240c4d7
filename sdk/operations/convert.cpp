// SPDX-License-Identifier: Apache-2.0
#include "meso/operations/convert.hpp"

#include <algorithm>

#include "file_extension.hpp"
#include "meso/base/output_file.hpp"
#include "meso/brep/audit.hpp"
#include "meso/brep/gaps.hpp"
#include "meso/brep/triangles.hpp"
#include "meso/export_mesh/mesh_writer.hpp"
#ifdef MESO_WITH_IMPLICIT_ENGINE
#include "make_mesh.hpp"
#endif
#include "meso/import_surface_mesh/weld.hpp"
#include "prepare.hpp"
#include "stopwatch.hpp"

namespace meso::operations {
namespace fs = std::filesystem;

std::optional<Made> make_body(const fs::path& document, const MakeOptions& options, DiagnosticSink& sink) {
  Stopwatch watch;
  auto prepared = prepare(document, options, sink);
  if (!prepared) return std::nullopt;
  auto realisation = brep::realise_build(prepared->evaluation, prepared->part(), prepared->realise, sink);
  if (!realisation) return std::nullopt;
  Seconds seconds = prepared->seconds;
  seconds.total = watch.total();
  seconds.realise = seconds.total - seconds.read - seconds.evaluate;
  return Made{.evaluation = std::move(prepared->evaluation),
              .realisation = std::move(*realisation),
              .deflection_mm = prepared->realise.deflection_mm,
              .angle_rad = prepared->realise.angle_rad,
              .seconds = seconds};
}

namespace {

/// What the exact engine's triangles cannot be asked for.
bool is_for_fields(const MakeOptions& options) { return options.tolerance_mm || options.sharp || options.simplify_mm; }

/// Nothing speaks against the flags, or it was reported.
bool fits(const fs::path& out, const MakeOptions& options, const WriteOptions& write, DiagnosticSink& sink) {
  const auto refuse = [&](std::string why) {
    sink.report({.code = Code::usage, .args = {std::move(why)}});
    return false;
  };
  const auto needs_mesh = output_needs_mesh(out);
  if (!needs_mesh)
    return refuse("'" + out.string() + "': no format has this extension; convert writes .step .stp .brep, " +
                  std::string(mesh_extensions()) + ", and volumes .vtu .msh .inp .nrrd .vti .h5 .svg .png");
  const bool fine = options.deflection_mm || options.angle_rad,
             samples = options.spacing_mm || !options.samples.empty(), of_fields = is_for_fields(options);
  if (!*needs_mesh && fine) return refuse("--deflection and --angle have an effect for meshes only");
  if (!*needs_mesh && samples) return refuse("--spacing and --samples have an effect for meshes only");
  if (!*needs_mesh && of_fields) return refuse("--tolerance, --sharp and --simplify have an effect for meshes only");
  if (options.tolerance_mm && samples)
    return refuse("--tolerance picks the samples; --spacing and --samples have no effect beside it");
  if (!*needs_mesh && options.engine == Engine::implicit)
    return refuse("--engine implicit makes triangles; '" + out.string() + "' is to hold exact faces");
  if (options.engine == Engine::brep && samples)
    return refuse("--spacing and --samples have an effect for the implicit engine only; see --deflection");
  if (options.engine == Engine::brep && of_fields)
    return refuse(
        "--tolerance, --sharp and --simplify have an effect for the implicit engine only; the exact one keeps edges, "
        "and --deflection says how far its triangles may be off");
  if (options.engine == Engine::brep && options.measure)
    return refuse("--measure has an effect for the implicit engine only; the exact one always measures");
  if (options.engine == Engine::implicit && fine)
    return refuse("--deflection and --angle have an effect for the exact engine only; see --spacing");
  if (write.ascii && lower_extension(out) != ".stl") return refuse("--ascii has an effect for .stl only");
  return true;
}

/// "2 edges of one face, 1 open loops": what keeps a body from being closed.
std::string faults_of(const brep::Audit& audit) {
  std::string out;
  const auto add = [&](std::uint64_t count, const char* what) {
    if (count != 0) out += (out.empty() ? "" : ", ") + std::to_string(count) + " " + what;
  };
  add(audit.free_edges, "edges of one face");
  add(audit.multiple_edges, "edges of more than two faces");
  add(audit.conflicts, "edges of two faces that disagree");
  add(audit.open_loops, "open loops");
  add(audit.missing_faces, "missing faces");
  if (audit.components != audit.shells)
    add(audit.components, ("pieces of what should be " + std::to_string(audit.shells) + " shells").c_str());
  return out;
}

std::optional<ConvertReport> convert_exactly(const fs::path& in, const fs::path& out, const MakeOptions& options,
                                             const WriteOptions& write, DiagnosticSink& sink) {
  Stopwatch watch;
  auto made = make_body(in, options, sink);
  if (!made) return std::nullopt;
  const brep::Body& body = made->realisation.body;
  const brep::Audit audit = brep::audit(body);
  if (!audit.clean()) {
    sink.report({.code = Code::geometry_boolean,
                 .args = {"assembly", std::to_string(made->realisation.cells.kept), faults_of(audit)}});
    return std::nullopt;
  }
  Stopwatch writing;
  const auto written = write_body(body, out, write, sink);
  if (!written) return std::nullopt;
  ConvertReport report{.way = made->realisation.way,
                       .cells = made->realisation.cells,
                       .clip = made->realisation.clip,
                       .triangles = written->triangles,
                       .bytes = written->bytes,
                       .deflection_mm = made->deflection_mm,
                       .angle_rad = made->angle_rad,
                       .seconds = made->seconds};
  report.seconds.write = writing.lap();
  report.measures = brep::measure(body);
  if (report.triangles > 0) report.triangles_volume = brep::volume_of_triangles(body);
  report.dropped_fragments = report.cells.dropped;
  report.fragments = report.cells.fragments - report.cells.dropped;
  report.closed = true;  // the audit above
  report.seconds.total = watch.total();
  return report;
}

#ifdef MESO_WITH_IMPLICIT_ENGINE
/// What the exact engine answers where a part is beyond it; faults of the document or of the call are none of these.
const Diagnostic* beyond_exact_engine(const DiagnosticSink& told) {
  const auto error =
      std::ranges::find(told.diagnostics(), Severity::error, [](const Diagnostic& d) { return severity(d); });
  if (error == told.diagnostics().end()) return nullptr;
  if (error->code == Code::geometry_fragments || error->code == Code::geometry_empty) return nullptr;
  const int exit_code = info(error->code).exit_code;
  return exit_code == 4 || exit_code == 5 || error->code == Code::limit_booleans ? &*error : nullptr;
}

/// Geometry that the exact engine should have been able to make, not one that it is not made for.
const Diagnostic* failure(const DiagnosticSink& told) {
  const auto found = std::ranges::find_if(told.diagnostics(), [](const Diagnostic& d) {
    return d.code == Code::geometry_not_repeatable || info(d.code).exit_code == 5;
  });
  return found != told.diagnostics().end() ? &*found : nullptr;
}

/// Reading and evaluating the document once more says some of it once more.
bool is_told(const DiagnosticSink& sink, const Diagnostic& d) {
  return std::ranges::find(sink.diagnostics(), d) != sink.diagnostics().end();
}

void tell(std::string why, DiagnosticSink& sink) {
  sink.report({.code = Code::engine_chosen, .args = {"implicit", std::move(why)}});
}

std::optional<ConvertReport> convert_to_mesh(const fs::path& in, const fs::path& out, const MakeOptions& options,
                                             const WriteOptions& write, DiagnosticSink& sink) {
  Seconds seconds;
  const auto evaluation = open_document(in, options, seconds, sink);
  if (!evaluation) return std::nullopt;
  DiagnosticSink told;  // by the exact engine
  if (options.engine == Engine::automatic) {
    std::string why = reason_for_fields(*evaluation, options.part);
    if (why.empty() && (options.spacing_mm || !options.samples.empty())) why = "samples are asked for";
    if (why.empty() && is_for_fields(options)) why = "a tolerance, sharp edges or fewer triangles are asked for";
    if (why.empty()) {
      auto report = convert_exactly(in, out, options, write, told);
      const Diagnostic* beyond = beyond_exact_engine(told);
      if (report || beyond == nullptr) {
        for (const Diagnostic& d : told.diagnostics())
          if (!is_told(sink, d)) sink.report(d);
        return report;
      }
      if (const Diagnostic* failed = failure(told))
        sink.report({.code = Code::engine_fallback,
                     .where = failed->where,
                     .path = failed->path,
                     .args = {message(*failed)},
                     .related = failed->related});
      else
        why = "the exact one answers: " + message(*beyond);
    }
    if (!why.empty()) tell(std::move(why), sink);
  }
  auto report = make_mesh(*evaluation, out, options, write, sink);
  for (const Diagnostic& d : told.diagnostics())
    if (severity(d) == Severity::warning && !is_told(sink, d)) sink.report(d);
  if (!report) return std::nullopt;
  report->seconds.read = seconds.read;
  report->seconds.evaluate = seconds.evaluate;
  report->seconds.total += seconds.read + seconds.evaluate;
  return report;
}
#else
std::optional<ConvertReport> convert_to_mesh(const fs::path& in, const fs::path& out, const MakeOptions& options,
                                             const WriteOptions& write, DiagnosticSink& sink) {
  if (options.engine == Engine::automatic) return convert_exactly(in, out, options, write, sink);
  sink.report({.code = Code::engine_not_built, .args = {"implicit"}});
  return std::nullopt;
}
#endif

}  // namespace

std::optional<ConvertReport> convert(const fs::path& in, const fs::path& out, MakeOptions options,
                                     const WriteOptions& write, DiagnosticSink& sink) {
  if (!check_is_document(in, sink)) return std::nullopt;
  if (!fits(out, options, write, sink)) return std::nullopt;
  const ExistingFile existing = write.no_clobber ? ExistingFile::refuse : ExistingFile::replace;
  if (!OutputFile::can_create(out.string(), existing, sink)) return std::nullopt;
  options.mesh = *output_needs_mesh(out);
  return !options.mesh || options.engine == Engine::brep ? convert_exactly(in, out, options, write, sink)
                                                         : convert_to_mesh(in, out, options, write, sink);
}

}  // namespace meso::operations
