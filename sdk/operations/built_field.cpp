// SPDX-License-Identifier: Apache-2.0
#include "built_field.hpp"

#include <algorithm>
#include <cmath>

#include "load_sdf_mesh.hpp"
#include "mesh_grid.hpp"
#include "meso/brep/read_step.hpp"
#include "meso/brep/triangle_mesh.hpp"
#include "meso/eval/pattern_reach.hpp"
#include "meso/import_surface_mesh/read_surface_mesh.hpp"
#include "meso/sdf/build_field.hpp"
#include "meso/sdf/clamped_values.hpp"
#include "meso/sdf/thinnest_wall.hpp"
#include "meso/sdf_document/words_and_documents.hpp"

namespace meso::operations {
namespace {

/// Curved faces of an exact body stand in the field as triangles this close, relative to the body's size.
constexpr double import_deflection = 1e-4, import_angle = 0.1;

std::optional<TriangleMesh> import_mesh(const eval::ImportShape& import, const RunOptions& run, DiagnosticSink& sink) {
  if (brep::is_exact_file(import.file.name())) {
    const auto body = brep::read_step(
        import.file, {.relative_deflection = import_deflection, .angle_rad = import_angle, .may_cross = false}, run,
        sink);
    return body ? std::optional(brep::triangle_mesh(*body)) : std::nullopt;
  }
  return read_surface_mesh_file(import.file, sink, run);
}

/// A document that is words means what these mean, to the bit.
std::optional<BuiltField> build_words(const sdf::Program& program, const std::string& part, const MakeOptions& options,
                                      DiagnosticSink& sink) {
  const auto load = [&](const std::string& path, DiagnosticSink& told) {
    return load_sdf_mesh(path, options.run, told);
  };
  const auto field = sdf::build_field(program, load, sink);
  if (!field) return std::nullopt;
  const auto wall = sdf::thinnest_wall(program);
  return BuiltField{
      .field = *field, .names = part, .smallest_feature_mm = wall ? wall->thickness : HUGE_VAL, .words = program};
}

std::optional<BuiltField> united(const eval::Evaluation& evaluation, const MakeOptions& options, DiagnosticSink& sink) {
  sdf::WhyNot why_not;
  if (const auto program = sdf::program_of(evaluation, options.part, why_not)) {
    const auto& parts = evaluation.document().build.items;
    return build_words(*program, options.part.empty() ? parts.front().part.text : options.part, options, sink);
  }
  const implicit::DocumentFieldOptions field_options{
      .imports = [&](const eval::ImportShape& import,
                     DiagnosticSink& told) { return import_mesh(import, options.run, told); },
      .run = options.run,
      .spacing_mm = options.spacing_mm.value_or(0)};
  std::optional<BuiltField> all;
  for (const PlacedPart& item : built_parts(evaluation, options.part, sink)) {
    const auto placement = evaluation.placement(item.placement, sink);
    const auto part = placement ? implicit::field_of_part(evaluation, *item.part, field_options, sink) : std::nullopt;
    if (!part) return std::nullopt;
    const implicit::Field placed = implicit::moved(part->field, *placement);
    if (!all)
      all = BuiltField{placed, item.part->id.text, item.part};
    else
      all->only_part = nullptr, all->field = implicit::union_of(all->field, placed),
      all->names += ", " + item.part->id.text;
    all->smallest_feature_mm = std::min(all->smallest_feature_mm, part->smallest_feature_mm);
    all->density_spacing_mm = std::min(all->density_spacing_mm, part->density_spacing_mm);
    all->cells.placed += part->cells_placed;
    all->cells.kept += part->cells_kept;
  }
  return all;
}

}  // namespace

std::optional<BuiltField> built_field(const eval::Evaluation& evaluation, const MakeOptions& options,
                                      DiagnosticSink& sink) {
  auto built = united(evaluation, options, sink);
  if (!built || !built->field.bounds().empty()) return built;
  sink.report(told_of_empty(*built, evaluation));
  return std::nullopt;
}

Diagnostic told_of_empty(const BuiltField& built, const eval::Evaluation& evaluation) {
  if (built.only_part != nullptr) return eval::empty_part(evaluation, *built.only_part);
  return {.code = Code::geometry_empty, .args = {built.names}};
}

void warn_of_clamped(const BuiltField& built, const Box3& box, DiagnosticSink& sink) {
  if (!built.words) return;
  std::vector<sdf::Clamped> clamped = sdf::clamped_values(*built.words, box);
  std::erase_if(clamped, [](const sdf::Clamped& c) { return c.made_by->verb != sdf::Verb::density; });
  sdf::report_clamped(clamped, sink);
}

}  // namespace meso::operations
