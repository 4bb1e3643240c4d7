// SPDX-License-Identifier: Apache-2.0
#include "prepare.hpp"

#include <algorithm>

#include "meso/eval/cell_fit.hpp"
#include "meso/operations/macrostructure_distance.hpp"
#include "meso/package/open_document.hpp"
#include "stopwatch.hpp"

namespace meso::operations {
namespace fs = std::filesystem;
namespace {

/// The first build item that is made and has mesh settings.
const MeshSettings* document_mesh(const Document& document, const std::string& part) {
  for (const BuildItem& item : document.build) {
    if (item.mesh && (part.empty() || item.part.text == part)) return &*item.mesh;
  }
  return nullptr;
}

}  // namespace

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

namespace {

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

std::optional<Prepared> prepare(const fs::path& document, const MakeOptions& options, DiagnosticSink& sink) {
  Stopwatch watch;
  const auto checked = open_checked_document(document, options.run, sink);
  if (!checked) return std::nullopt;
  const double read = watch.lap();
  auto evaluation = eval::Evaluation::make(*checked,
                                           {.overrides = options.overrides,
                                            .run = options.run,
                                            .distance = macrostructure_distance(options.overrides, options.run)},
                                           sink);
  if (!evaluation) return std::nullopt;
  eval::warn_of_misfits(*evaluation, sink);
  const auto fineness = mesh_fineness(*evaluation, options, sink);
  if (!fineness) return std::nullopt;
  return Prepared{.evaluation = std::move(*evaluation),
                  .realise = {.mesh = options.mesh,
                              .deflection_mm = fineness->deflection_mm,
                              .angle_rad = fineness->angle_rad,
                              .run = options.run},
                  .part_id = options.part,
                  .seconds = {.read = read, .evaluate = watch.lap()}};
}

bool check_is_document(const std::filesystem::path& in, DiagnosticSink& sink) {
  if (is_document(in)) return true;
  sink.report(
      {.code = Code::usage,
       .args = {"'" + in.string() + "' is a body, not a document; write a document that imports it: <import href=\"" +
                in.filename().string() + "\"/>"}});
  return false;
}

}  // namespace meso::operations
