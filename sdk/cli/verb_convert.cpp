// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <CLI/CLI.hpp>

#include "accuracy_json.hpp"
#include "make_options.hpp"
#include "meso/expr/expression.hpp"
#include "meso/operations/convert.hpp"
#include "run.hpp"
#ifdef MESO_CLI_IMPLICIT
#include "meso/operations/convert_volume.hpp"
#include "sdf_volumes.hpp"
#endif

namespace meso::cli {
namespace {

void print_grid(const operations::ConvertReport& r, const std::string& out) {
  fmt::print(stderr, "{}: {} bytes, {} triangles; {} x {} x {} samples, {:g} mm apart\n", out, r.bytes, r.triangles,
             r.grid_nodes[0], r.grid_nodes[1], r.grid_nodes[2], r.spacing_mm);
  if (r.cells.placed > 0) fmt::print(stderr, "cells: {} placed\n", r.cells.placed);
  if (r.accuracy)
    fmt::print(stderr, "within {:g} mm of the surface; {} samples of the field beside the grid's\n",
               r.accuracy->distance, r.accuracy->surface_samples);
  if (r.mesh)
    fmt::print(stderr, "volume {:.6f} mm3, area {:.6f} mm2, {} in {} piece{}{}; ", r.mesh->volume, r.mesh->area,
               r.mesh->closed ? "closed" : "NOT CLOSED", r.mesh->components, r.mesh->components == 1 ? "" : "s",
               r.mesh->cavities == 0 ? "" : fmt::format(" with {} closed cavities", r.mesh->cavities));
  fmt::print(stderr, "engine {} ({}), {:.2f} s\n", r.engine, r.way, r.seconds.total);
}

void print_summary(const operations::ConvertReport& r, const std::string& out) {
  if (r.spacing_mm > 0) return print_grid(r, out);
  fmt::print(stderr, "{}: {} bytes, {} solid{}, {} faces", out, r.bytes, r.measures.solids,
             r.measures.solids == 1 ? "" : "s", r.measures.faces);
  if (r.triangles > 0)
    fmt::print(stderr, ", {} triangles (deflection {:g} mm, angle {:g} rad)", r.triangles, r.deflection_mm,
               r.angle_rad);
  fmt::print(stderr, "\n");
  if (r.cells.placed > 0) {
    fmt::print(stderr, "cells: {} placed, {} kept, {} crossing the boundary", r.cells.placed, r.cells.kept,
               r.cells.crossing);
    if (r.clip.distinct > 0) fmt::print(stderr, " in {} distinct ways", r.clip.distinct);
    if (r.fragments > 0) fmt::print(stderr, "; {} loose fragments", r.fragments);
    if (r.dropped_fragments > 0) fmt::print(stderr, "; {} fragments dropped", r.dropped_fragments);
    fmt::print(stderr, "\n");
  }
  if (r.triangles > 0) fmt::print(stderr, "volume {:.6f} mm3 in the triangles; exact body: ", r.triangles_volume);
  fmt::print(stderr, "volume {:.6f} mm3, area {:.6f} mm2, {}; engine {} ({}), {:.2f} s\n", r.measures.volume,
             r.measures.area, r.closed ? "closed" : "NOT CLOSED", r.engine, r.way, r.seconds.total);
}

Json report_json(const operations::ConvertReport& r, const std::string& in, const std::string& out) {
  Json j;
  j["input"] = in;
  j["output"] = out;
  j["engine"] = r.engine;
  j["way"] = r.way;
  if (r.spacing_mm > 0) {
    j["grid"] = {{"nodes", r.grid_nodes}, {"spacing", r.spacing_mm}};
    j["cells"] = {{"placed", r.cells.placed}};
    j["triangles"] = r.triangles;
    if (r.accuracy) j["accuracy"] = accuracy_json(*r.accuracy);
    if (r.mesh) {
      j["volume"] = r.mesh->volume;
      j["area"] = r.mesh->area;
      j["closed"] = r.mesh->closed;
      j["components"] = r.mesh->components;
      j["cavities"] = r.mesh->cavities;
    }
    j["bytes"] = r.bytes;
    j["seconds"] = seconds_json(r.seconds);
    j["peakBytes"] = peak_memory_bytes();
    return j;
  }
  j["cells"] = {{"placed", r.cells.placed}, {"kept", r.cells.kept}, {"crossing", r.cells.crossing}};
  if (r.clip.distinct > 0)
    j["boundary"] = {
        {"distinct", r.clip.distinct}, {"attempts", r.clip.attempts}, {"edgeTolerance", r.clip.edge_tolerance}};
  j["solids"] = r.measures.solids;
  j["faces"] = r.measures.faces;
  j["triangles"] = r.triangles;
  j["volume"] = r.measures.volume;
  j["area"] = r.measures.area;
  j["closed"] = r.closed;
  if (r.triangles > 0) j["trianglesVolume"] = r.triangles_volume;
  j["fragments"] = r.fragments;
  if (r.dropped_fragments > 0) j["droppedFragments"] = r.dropped_fragments;
  j["bytes"] = r.bytes;
  j["seconds"] = seconds_json(r.seconds);
  j["peakBytes"] = peak_memory_bytes();
  return j;
}

/// "100^3" or "50,60,200": constant expressions. Nothing if it is neither; reported.
std::optional<std::vector<double>> sample_counts(Run& run, const std::string& text) {
  std::vector<double> result;
  for (const expr::ListItem& item : expr::split_list(text)) {
    const auto parsed = expr::parse_expression(item.text, LengthUnit::millimeter);
    const auto value = parsed.expression && parsed.expression->is_constant() ? expr::evaluate(*parsed.expression, {})
                                                                             : expr::EvalResult{.failed_length = 1};
    if (!value || !(value.value >= 2))
      return run.usage_error("--samples takes one number or three, from 2: '" + text + "'"), std::nullopt;
    result.push_back(value.value);
  }
  if (result.size() == 1 || result.size() == 3) return result;
  run.usage_error("--samples takes one number or three: '" + text + "'");
  return std::nullopt;
}

/// Of this verb alone.
struct ConvertFlags {
  bool ascii = false, measure = false, sharp = false;
  std::string spacing, samples, tolerance, simplify;
#ifdef MESO_CLI_IMPLICIT
  operations::VolumeOptions volume;
#endif
};

int convert_verb(Run& run, const std::string& in, const std::string& out, const ConvertFlags& flags) {
  if (operations::output_needs_mesh(out) == false) {
    run.refuse_without_effect({{"--deflection", !run.flags.deflection.empty()},
                               {"--angle", !run.flags.angle.empty()},
                               {"--measure", flags.measure}},
                              "for meshes");
  }
  auto options = make_options(run);
  if (options && !flags.spacing.empty())
    options->spacing_mm = run.length_mm(flags.spacing, LengthUnit::millimeter, "--spacing");
  if (options && !flags.samples.empty()) {
    if (!flags.spacing.empty()) run.usage_error("--spacing and --samples say the same twice");
    options->samples = sample_counts(run, flags.samples).value_or(std::vector<double>{});
  }
  const auto length = [&](const std::string& text, const char* flag, std::optional<double>& to) {
    if (options && !text.empty()) to = run.length_mm(text, LengthUnit::millimeter, flag);
  };
  if (options) length(flags.tolerance, "--tolerance", options->tolerance_mm);
  if (options) length(flags.simplify, "--simplify", options->simplify_mm);
  if (!options || run.sink.has_errors()) return run.finish();
  options->measure = flags.measure;
  options->sharp = flags.sharp;
#ifdef MESO_CLI_IMPLICIT
  operations::VolumeOptions volume = flags.volume;
  volume.ascii = flags.ascii;
  volume.existing = run.flags.no_clobber ? ExistingFile::refuse : ExistingFile::replace;
  volume.run = options->run;
  if (operations::is_volume_output(out))
    return finish_volume(run, operations::convert_to_volume(in, out, *options, volume, run.sink), out);
  volume.ascii = false;  // convert() looks at that
  if (!operations::check_volume_options(out, volume, run.sink)) return run.finish();
#endif
  const auto report = operations::convert(
      in, out, *options, {.ascii = flags.ascii, .no_clobber = run.flags.no_clobber, .run = options->run}, run.sink);
  if (!report) return run.finish(Json{{"input", in}, {"output", out}});
  const int code = run.finish(report_json(*report, in, out));
  if (!run.flags.json) print_summary(*report, out);
  return code;
}

}  // namespace

void add_convert(CLI::App& app, Run& run) {
  CLI::App* verb = app.add_subcommand("convert",
                                      "Realise a document: .step .stp .brep .stl .3mf .ply .obj .off .vtk, or as a "
                                      "volume .vtu .msh .inp .nrrd .vti .h5 "
                                      ".svg .png, by the output's extension");
  static std::string in, out;
  static ConvertFlags flags;
  verb->add_option("IN", in, "Document (.meso, .mesoz)")->required();
  verb->add_option("OUT", out, "Output file; replaced atomically")->required();
  verb->add_flag("--ascii", flags.ascii, "Text instead of binary STL");
  verb->add_option("--spacing", flags.spacing, "Implicit engine: distance of samples, e.g. 0.2mm");
  verb->add_option("--samples", flags.samples, "Implicit engine: number of samples, or three: 100^3, 50,60,200");
  verb->add_flag("--sharp", flags.sharp, "Implicit engine: edges and corners of the solid are those of the mesh");
  verb->add_option("--tolerance", flags.tolerance,
                   "Implicit engine: largest distance of the mesh from the surface, e.g. 0.05mm; picks the samples");
  verb->add_option("--simplify", flags.simplify,
                   "Implicit engine: as few triangles as stay so close to the surface, e.g. 0.05mm; beside the same "
                   "--tolerance, samples are close enough for it");
  verb->add_flag("--measure", flags.measure, "Implicit engine: volume, area, pieces and closed cavities of the mesh");
#ifdef MESO_CLI_IMPLICIT
  add_volume_flags(*verb, flags.volume);
#endif
  add_set_flag(*verb, run.flags);
  add_part_flag(*verb, run.flags);
  add_engine_flag(*verb, run.flags);
  add_mesh_flags(*verb, run.flags);
  add_limit_flags(*verb, run.flags);
  add_json_flag(*verb, run.flags);
  add_no_clobber_flag(*verb, run.flags);
  verb->callback([&run] { run.action = [&run] { return convert_verb(run, in, out, flags); }; });
}

}  // namespace meso::cli
