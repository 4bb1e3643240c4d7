// SPDX-License-Identifier: Apache-2.0
// What is in a document; with --estimate what it would become, without building it.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <limits>

#include "run.hpp"
#ifdef MESO_CLI_EVAL
#include "meso/eval/evaluation.hpp"
#include "overrides.hpp"
#endif
#ifdef MESO_CLI_BREP
#include "make_options.hpp"
#include "meso/operations/estimate.hpp"
#include "meso/operations/macrostructure_distance.hpp"
#endif

namespace meso::cli {
namespace {

struct InfoArguments {
  std::string file;
  bool estimate = false;
};

template <class Items>
Json ids(const Items& items) {
  Json out = Json::array();
  for (const auto& item : items) out.push_back(item.id.text);
  return out;
}

Json contents(const Document& d) {
  Json out;
  for (const Metadata& m : d.metadata) out["metadata"][m.name] = m.text;
  for (const Parameter& p : d.parameters) out["parameters"][p.id.text] = {{"expression", p.value.text}};
  out["coordinateSystems"] = ids(d.coordinate_systems);
  out["macrostructures"] = ids(d.macrostructures);
  out["unitCells"] = ids(d.unit_cells);
  out["vectorFields"] = ids(d.vector_fields);
  out["patterns"] = ids(d.patterns);
  out["parts"] = ids(d.parts);
  return out;
}

#ifdef MESO_CLI_EVAL
/// Parameter values and cell counts.
bool add_values(Json& report, const CheckedDocument& checked, const RunOptions& options, Run& run) {
  eval::EvaluateOptions evaluate{.run = options};
  if (!parse_overrides(run, evaluate.overrides)) return false;
#ifdef MESO_CLI_BREP
  evaluate.distance = operations::macrostructure_distance(evaluate.overrides, options);
#endif
  const auto evaluation = eval::Evaluation::make(checked, evaluate, run.sink);
  if (!evaluation) return false;
  for (const Parameter& p : checked.document().parameters)
    report["parameters"][p.id.text]["value"] = evaluation->parameter(p.id.text).value_or(0);
  for (const Pattern& p : checked.document().patterns) {
    const auto cells = evaluation->cells(p, run.sink);
    if (!cells) return false;
    report["cells"][p.id.text] = cells->size();
  }
  return true;
}
#endif

#ifdef MESO_CLI_BREP
bool add_estimate(Json& report, const std::string& file, const operations::MakeOptions& options, Run& run) {
  const auto estimate = operations::estimate(file, options, run.sink);
  if (!estimate) return false;
  report["estimate"] = {
      {"placed", estimate->placed},
      {"kept", estimate->kept},
      {"faces", estimate->faces},
      {"triangles", estimate->triangles},
      {"bytes",
       {{"step", estimate->step_bytes}, {"stl", estimate->stl_bytes}, {"asciiStl", estimate->ascii_stl_bytes}}}};
  return true;
}
#endif

void print_json_as_text(const Json& value, int indent) {
  for (const auto& [key, item] : value.items()) {
    if (item.is_object()) {
      fmt::print("{:{}}{}:\n", "", indent, key);
      print_json_as_text(item, indent + 2);
    } else if (!(item.is_array() && item.empty())) {
      fmt::print("{:{}}{}: {}\n", "", indent, key, item.is_string() ? item.get<std::string>() : item.dump());
    }
  }
}

int info_verb(Run& run, const InfoArguments& arguments) {
#ifdef MESO_CLI_BREP
  if (!arguments.estimate) {
    run.refuse_without_effect({{"--part", !run.flags.part.empty()},
                               {"--deflection", !run.flags.deflection.empty()},
                               {"--angle", !run.flags.angle.empty()}},
                              "with --estimate");
  }
  const auto make = make_options(run);
  if (!make) return run.finish();
#endif
  const auto checked = run.open(arguments.file);
  if (!checked) return run.finish();
  Json report = contents(checked->document());
#ifdef MESO_CLI_BREP
  if (arguments.estimate && !add_estimate(report, arguments.file, *make, run)) return run.finish();
  RunOptions options = make->run;
  if (arguments.estimate) options.max_cells = std::numeric_limits<std::uint64_t>::max();  // nothing is built
#elif defined(MESO_CLI_EVAL)
  const RunOptions options = run.options();
#endif
#ifdef MESO_CLI_EVAL
  if (!add_values(report, *checked, options, run)) return run.finish();
#endif
  if (!run.flags.json) print_json_as_text(report, 0);
  return run.finish(std::move(report));
}

}  // namespace

void add_info(CLI::App& app, Run& run) {
  CLI::App* verb = app.add_subcommand("info", "What a document contains; --estimate: what it would become");
  static InfoArguments arguments;
  verb->add_option("FILE", arguments.file, "Document (.meso, .mesoz)")->required();
  add_json_flag(*verb, run.flags);
#ifdef MESO_CLI_EVAL
  add_set_flag(*verb, run.flags);
  add_limit_flags(*verb, run.flags);
#endif
#ifdef MESO_CLI_BREP
  verb->add_flag("--estimate", arguments.estimate, "Cells, faces and bytes per format, without building");
  add_part_flag(*verb, run.flags);
  add_mesh_flags(*verb, run.flags);
#endif
  verb->callback([&run] { run.action = [&run] { return info_verb(run, arguments); }; });
}

}  // namespace meso::cli
