// SPDX-License-Identifier: Apache-2.0
#include "meso/operations/convert_volume.hpp"

#include "built_field.hpp"
#include "make_mesh.hpp"
#include "mesh_grid.hpp"
#include "prepare.hpp"

namespace meso::operations {
namespace {

constexpr double default_elements = 1e6;

/// Nothing speaks against the flags, or it was reported.
bool fits(const std::string& out, const MakeOptions& options, const VolumeOptions& volume, DiagnosticSink& sink) {
  const auto refuse = [&](std::string why) {
    sink.report({.code = Code::usage, .args = {std::move(why)}});
    return false;
  };
  if (options.engine == Engine::brep) return refuse("'" + out + "' is a volume, which the implicit engine makes");
  if (options.deflection_mm || options.angle_rad)
    return refuse("--deflection and --angle have an effect for the exact engine only; see --spacing");
  if (options.tolerance_mm || options.sharp || options.simplify_mm || options.measure)
    return refuse("--tolerance, --sharp, --simplify and --measure have an effect for meshes of triangles only");
  if (volume.elements && (options.spacing_mm || !options.samples.empty()))
    return refuse("--elements says how fine; --spacing and --samples have no effect beside it");
  return check_volume_options(out, volume, sink);
}

}  // namespace

std::optional<VolumeReport> convert_to_volume(const std::filesystem::path& in, const std::string& out,
                                              const MakeOptions& options, const VolumeOptions& volume,
                                              DiagnosticSink& sink) {
  if (!check_is_document(in, sink) || !fits(out, options, volume, sink)) return std::nullopt;
  Seconds seconds;
  const auto evaluation = open_document(in, options, seconds, sink);
  const auto built = evaluation ? built_field(*evaluation, options, sink) : std::nullopt;
  const auto grid =
      built ? mesh_grid(*evaluation, options, built->field.bounds(), built->smallest_feature_mm, sink) : std::nullopt;
  if (!grid) return std::nullopt;
  VolumeOptions how = volume;
  if (is_tetrahedra_output(out) && !options.spacing_mm && options.samples.empty() && !how.elements &&
      !states_samples(evaluation->document(), options.part))
    how.elements = default_elements;
  DiagnosticSink told;
  auto report =
      write_volume(out, {built->field, grid->box, grid->nodes, built->words ? &*built->words : nullptr}, how, told);
  pass_on_of_grid(told, *evaluation, options, sink);
  if (!report) return std::nullopt;
  warn_of_clamped(*built, grid->box, sink);
  report->seconds += seconds.read + seconds.evaluate;
  return report;
}

}  // namespace meso::operations
