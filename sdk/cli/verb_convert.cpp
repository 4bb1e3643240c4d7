// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <CLI/CLI.hpp>

#include "make_options.hpp"
#include "meso/operations/convert.hpp"
#include "run.hpp"
#include "stop.hpp"

namespace meso::cli {
namespace {

void print_summary(const operations::ConvertReport& r, const std::string& out) {
  fmt::print(stderr, "{}: {} bytes, {} solid{}, {} faces", out, r.bytes, r.measures.solids,
             r.measures.solids == 1 ? "" : "s", r.measures.faces);
  if (r.triangles > 0)
    fmt::print(stderr, ", {} triangles (deflection {:g} mm, angle {:g} rad)", r.triangles, r.deflection_mm,
               r.angle_rad);
  fmt::print(stderr, "\n");
  if (r.cells.placed > 0) {
    fmt::print(stderr, "cells: {} placed, {} kept, {} crossing the boundary", r.cells.placed, r.cells.kept,
               r.cells.crossing);
    if (r.fragments > 0) fmt::print(stderr, "; {} loose fragments", r.fragments);
    fmt::print(stderr, "\n");
  }
  fmt::print(stderr, "volume {:.6f} mm3, area {:.6f} mm2, {}; engine {} ({}), {:.2f} s\n", r.measures.volume,
             r.measures.area, r.closed ? "closed" : "NOT CLOSED", r.engine, r.way, r.seconds.total);
}

Json report_json(const operations::ConvertReport& r, const std::string& in, const std::string& out) {
  Json j;
  j["input"] = in;
  j["output"] = out;
  j["engine"] = r.engine;
  j["way"] = r.way;
  j["cells"] = {{"placed", r.cells.placed}, {"kept", r.cells.kept}, {"crossing", r.cells.crossing}};
  j["solids"] = r.measures.solids;
  j["faces"] = r.measures.faces;
  j["triangles"] = r.triangles;
  j["volume"] = r.measures.volume;
  j["area"] = r.measures.area;
  j["closed"] = r.closed;
  j["fragments"] = r.fragments;
  j["bytes"] = r.bytes;
  j["seconds"] = seconds_json(r.seconds);
  j["peakBytes"] = peak_memory_bytes();
  return j;
}

int convert_verb(Run& run, const std::string& in, const std::string& out, bool ascii) {
  if (operations::output_needs_mesh(out) == false) {
    run.refuse_without_effect({{"--deflection", !run.flags.deflection.empty()}, {"--angle", !run.flags.angle.empty()}},
                              "for .stl");
  }
  const auto options = make_options(run);
  if (!options) return run.finish();
  clean_on_stop(out);
  const auto report = operations::convert(
      in, out, *options, {.ascii = ascii, .no_clobber = run.flags.no_clobber, .run = options->run}, run.sink);
  if (!report) return run.finish(Json{{"input", in}, {"output", out}});
  const int code = run.finish(report_json(*report, in, out));
  if (!run.flags.json) print_summary(*report, out);
  return code;
}

}  // namespace

void add_convert(CLI::App& app, Run& run) {
  CLI::App* verb = app.add_subcommand("convert", "Realise a document: .step .stp .brep .stl by the output's extension");
  static std::string in, out;
  static bool ascii = false;
  verb->add_option("IN", in, "Document (.meso)")->required();
  verb->add_option("OUT", out, "Output file; replaced atomically")->required();
  verb->add_flag("--ascii", ascii, "Text instead of binary STL");
  add_set_flag(*verb, run.flags);
  add_part_flag(*verb, run.flags);
  add_engine_flag(*verb, run.flags);
  add_mesh_flags(*verb, run.flags);
  add_limit_flags(*verb, run.flags);
  add_json_flag(*verb, run.flags);
  add_no_clobber_flag(*verb, run.flags);
  verb->callback([&run] { run.action = [&run] { return convert_verb(run, in, out, ascii); }; });
}

}  // namespace meso::cli
