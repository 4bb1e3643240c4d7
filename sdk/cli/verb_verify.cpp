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

struct DeepFlags {
  bool deep = false;
  std::size_t points = 0;  ///< 0: not given
};

int verify_verb(Run& run, const std::string& file, const DeepFlags& flags) {
  if (!operations::is_document(file)) {
    run.refuse_without_effect(
        {{"--set", !run.flags.set.empty()}, {"--part", !run.flags.part.empty()}, {"--deep", flags.deep}},
        "on documents");
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
    json["volume"] = report->measures.volume;
    json["area"] = report->measures.area;
    json["closed"] = report->closed;
  }
  const int code = run.finish(std::move(json));
  if (report && !run.flags.json) {
    for (const operations::Check& c : report->checks) {
      fmt::print("{} {:<24} expected {:<22} found {}\n", c.passed ? "ok  " : "FAIL", c.what, c.expected, c.found);
    }
    fmt::print("{}: {}\n", file, report->passed() ? "passed" : "failed");
  }
  return code;
}

}  // namespace

void add_verify(CLI::App& app, Run& run) {
  CLI::App* verb = app.add_subcommand(
      "verify", "Recompute a document's validation values, or audit a .step, .stp, .stl, .ply, .obj or .off");
  static std::string file;
  static DeepFlags deep;
  verb->add_option("FILE", file, "Document or geometry")->required();
  verb->add_flag("--deep", deep.deep, "Judge the part by face integrals and by random points, too");
  verb->add_option("--points", deep.points, "Random points of --deep (2000000)")
      ->check(CLI::Range(1000, 1'000'000'000));
  add_set_flag(*verb, run.flags);
  add_part_flag(*verb, run.flags);
  add_limit_flags(*verb, run.flags);
  add_json_flag(*verb, run.flags);
  verb->callback([&run] { run.action = [&run] { return verify_verb(run, file, deep); }; });
}

}  // namespace meso::cli
