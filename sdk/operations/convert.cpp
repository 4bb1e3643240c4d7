// SPDX-License-Identifier: Apache-2.0
#include "meso/operations/convert.hpp"

#include <algorithm>

#include "meso/base/output_file.hpp"
#include "meso/brep/audit.hpp"
#include "meso/brep/triangles.hpp"
#include "meso/import_surface_mesh/weld.hpp"
#include "meso/validate/validate.hpp"
#include "meso/xml/read.hpp"
#include "stopwatch.hpp"

namespace meso::operations {
namespace fs = std::filesystem;
namespace {

std::optional<CheckedDocument> open(const fs::path& file, DiagnosticSink& sink) {
  auto read = read_document_file(file, sink);
  if (!read) return std::nullopt;
  return validate(std::move(read->document), std::move(read->source), file.parent_path(), sink);
}

/// The first build item that is made and has mesh settings.
const MeshSettings* document_mesh(const Document& document, const std::string& part) {
  for (const BuildItem& item : document.build) {
    if (item.mesh && (part.empty() || item.part.text == part)) return &*item.mesh;
  }
  return nullptr;
}

/// Smallest edge of the constant cell boxes, in millimetres.
std::optional<double> smallest_cell_edge(const eval::Evaluation& evaluation) {
  std::optional<double> smallest;
  DiagnosticSink ignored;
  for (const Pattern& pattern : evaluation.document().patterns) {
    const auto cells = evaluation.cells(pattern, ignored);
    if (!cells || cells->size() == 0) continue;
    (void)cells->visit(
        0, 1,
        [&](const eval::PlacedCell& cell) {
          if (const auto box = cells->cell_box(cell, ignored)) {
            const double edge = std::min({box->size.x, box->size.y, box->size.z});
            smallest = smallest ? std::min(*smallest, edge) : edge;
          }
          return false;
        },
        ignored);
  }
  return smallest;
}

struct Fineness {
  double deflection_mm = 0, angle_rad = 0;
};

std::optional<Fineness> mesh_fineness(const eval::Evaluation& evaluation, const MakeOptions& options,
                                      DiagnosticSink& sink) {
  Fineness out{.angle_rad = 0.5};
  const MeshSettings* stated = document_mesh(evaluation.document(), options.part);
  if (stated != nullptr && stated->angle) {
    const auto angle = evaluation.value(*stated->angle, stated->id_in_source, "angle", sink);
    if (!angle) return std::nullopt;
    out.angle_rad = *angle;
  }
  if (stated != nullptr && stated->deflection) {
    const auto deflection = evaluation.value(*stated->deflection, stated->id_in_source, "deflection", sink);
    if (!deflection) return std::nullopt;
    out.deflection_mm = *deflection * millimeters_per(evaluation.document().unit);
  } else {
    out.deflection_mm = 0.02 * smallest_cell_edge(evaluation).value_or(5.0);
  }
  out.deflection_mm = options.deflection_mm.value_or(out.deflection_mm);
  out.angle_rad = options.angle_rad.value_or(out.angle_rad);
  return out;
}

}  // namespace

std::optional<Made> make_body(const fs::path& document, const MakeOptions& options, DiagnosticSink& sink) {
  Stopwatch watch;
  const auto checked = open(document, sink);
  if (!checked) return std::nullopt;
  const double read = watch.lap();
  auto evaluation = eval::Evaluation::make(*checked, {.overrides = options.overrides, .run = options.run}, sink);
  if (!evaluation) return std::nullopt;
  const auto fineness = mesh_fineness(*evaluation, options, sink);
  if (!fineness) return std::nullopt;
  const double evaluate = watch.lap();
  const brep::RealiseOptions realise{.mesh = options.mesh,
                                     .deflection_mm = fineness->deflection_mm,
                                     .angle_rad = fineness->angle_rad,
                                     .run = options.run};
  auto realisation = brep::realise_build(
      *evaluation, options.part.empty() ? std::nullopt : std::optional<std::string_view>(options.part), realise, sink);
  if (!realisation) return std::nullopt;
  Seconds seconds{.read = read, .evaluate = evaluate, .realise = watch.lap()};
  seconds.total = watch.total();
  return Made{.evaluation = std::move(*evaluation),
              .realisation = std::move(*realisation),
              .deflection_mm = fineness->deflection_mm,
              .angle_rad = fineness->angle_rad,
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
