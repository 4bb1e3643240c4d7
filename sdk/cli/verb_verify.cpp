// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <CLI/CLI.hpp>

#include "make_options.hpp"
#include "meso/operations/verify.hpp"
#include "run.hpp"

namespace meso::cli {
namespace {

Json check_json(const operations::Check& c) {
  return {{"what", c.what}, {"expected", c.expected}, {"found", c.found}, {"passed", c.passed}};
}

Json deep_json(const operations::DeepFigures& d) {
  return {{"part", d.part},
          {"volume", {{"shells", d.shells_volume}, {"pieces", d.pieces_volume > 0 ? Json(d.pieces_volume) : Json()}}},
          {"monteCarlo",
           {{"points", d.points},
            {"seed", d.seed},
            {"volume", d.points_volume},
            {"volumeWithUnknown", d.points_volume_high},
            {"sigma", d.sigma},
            {"difference", d.difference}}},
          {"triangles",
           {{"volume", d.triangles_volume},
            {"upToTheFaces", d.triangles_gap_volume},
            {"largestGap", d.triangle_gap},
            {"deflection", d.deflection},
            {"unmatchedHalfEdges", d.unmatched_half_edges}}},
          {"largestGap", {{"edge", d.edge_gap}, {"vertex", d.vertex_gap}}},
          {"solids", d.solids},
          {"fragments", d.fragments},
          {"shellVolumes", d.shell_volumes},
          {"readBackVolumes", d.read_back_volumes.empty() ? Json() : Json(d.read_back_volumes)}};
}

struct DeepFlags {
  bool deep = false;
  std::size_t points = 0;  ///< 0: not given
};

int verify_verb(Run& run, const std::string& file, const DeepFlags& flags) {
  if (!operations::is_document(file)) {
    run.refuse_without_effect(
        {{"--set", !run.flags.set.empty()}, {"--part", !run.flags.part.empty()}, {"--points", flags.points > 0}},
        "on documents");
    if (!operations::is_step_file(file))
      run.refuse_without_effect({{"--deep", flags.deep}}, "on documents and STEP files");
  }
  if (!flags.deep) run.refuse_without_effect({{"--points", flags.points > 0}}, "with --deep");
  const auto options = make_options(run);
  if (!options) return run.finish();
  std::optional<operations::DeepCheck> deep;
  if (flags.deep) deep.emplace();
  if (deep && flags.points > 0) deep->points = flags.points;
  const auto report = operations::verify(file, *options, deep, run.sink);
  Json json{{"file", file}};
  if (report) {
    json["verdict"] = report->passed() ? "passed" : "failed";
    json["checks"] = Json::array();
    for (const operations::Check& c : report->checks) json["checks"].push_back(check_json(c));
    json["solids"] = report->measures.solids;
    json["faces"] = report->measures.faces;
    json["triangles"] = report->triangles;
    json["volume"] = report->measured ? Json(report->measures.volume) : Json();
    json["area"] = report->measured ? Json(report->measures.area) : Json();
    json["closed"] = report->closed;
    if (!report->shell_volumes.empty()) json["shellVolumes"] = report->shell_volumes;
    for (const operations::DeepFigures& d : report->deep) json["deep"].push_back(deep_json(d));
    json["notes"] = report->notes;
  }
  const int code = run.finish(std::move(json));
  if (report && !run.flags.json) {
    for (const operations::Check& c : report->checks) {
      fmt::print("{} {:<24} expected {:<22} found {}\n", c.passed ? "ok  " : "FAIL", c.what, c.expected, c.found);
    }
    for (const std::string& note : report->notes) fmt::print("note {}\n", note);
    fmt::print("{}: {}\n", file, report->passed() ? "passed" : "failed");
  }
  return code;
}

}  // namespace

void add_verify(CLI::App& app, Run& run) {
  CLI::App* verb = app.add_subcommand(
      "verify",
      "Recompute a document's validation values, or audit a .step, .stp, .brep, .iges, .igs, .stl, .ply, .obj or .off");
  static std::string file;
  static DeepFlags deep;
  verb->add_option("FILE", file, "Document or geometry")->required();
  verb->add_flag("--deep", deep.deep, "Judge the part by everything that knows better; of STEP, also what is large");
  verb->add_option("--points", deep.points, "Random points of --deep (as many as a thousandth of the volume takes)")
      ->check(CLI::Range(1000, 1'000'000'000));
  add_set_flag(*verb, run.flags);
  add_part_flag(*verb, run.flags);
  add_limit_flags(*verb, run.flags);
  add_json_flag(*verb, run.flags);
  verb->callback([&run] { run.action = [&run] { return verify_verb(run, file, deep); }; });
}

}  // namespace meso::cli
