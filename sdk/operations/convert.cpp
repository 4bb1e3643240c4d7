// SPDX-License-Identifier: Apache-2.0
#include "meso/operations/convert.hpp"

#include "meso/base/output_file.hpp"
#include "meso/brep/audit.hpp"
#include "meso/brep/triangles.hpp"
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

std::optional<ConvertReport> convert(const fs::path& in, const fs::path& out, MakeOptions options,
                                     const WriteOptions& write, DiagnosticSink& sink) {
  const auto needs_mesh = output_needs_mesh(out);
  if (!needs_mesh) {
    sink.report(
        {.code = Code::usage,
         .args = {"'" + out.string() + "': no format has this extension; convert writes .step .stp .brep .stl"}});
    return std::nullopt;
  }
  if (!*needs_mesh && (options.deflection_mm || options.angle_rad)) {
    sink.report({.code = Code::usage, .args = {"--deflection and --angle have an effect for .stl only"}});
    return std::nullopt;
  }
  if (write.ascii && !*needs_mesh) {
    sink.report({.code = Code::usage, .args = {"--ascii has an effect for .stl only"}});
    return std::nullopt;
  }
  Stopwatch watch;
  options.mesh = *needs_mesh;
  auto made = make_body(in, options, sink);
  if (!made) return std::nullopt;
  const brep::Body& body = made->realisation.body;
  Stopwatch writing;
  const auto written = write_body(body, out, write, sink);
  if (!written) return std::nullopt;
  ConvertReport report{.way = made->realisation.way,
                       .cells = made->realisation.cells,
                       .fragments = body.fragments,
                       .triangles = written->triangles,
                       .bytes = written->bytes,
                       .deflection_mm = made->deflection_mm,
                       .angle_rad = made->angle_rad,
                       .seconds = made->seconds};
  report.seconds.write = writing.lap();
  report.measures = brep::measure(body);
  report.closed = brep::audit(body).clean();
  report.seconds.total = watch.total();
  return report;
}

TriangleMesh triangle_mesh(const brep::Body& body) {
  Weld weld;
  brep::visit_triangles(body, [&](std::span<const Triangle> block) {
    for (const Triangle& t : block) weld.add(t[0], t[1], t[2]);
  });
  return std::move(weld).mesh();
}

}  // namespace meso::operations
