// SPDX-License-Identifier: Apache-2.0
// Placed cells as CSV or JSON, streamed: memory does not grow with the pattern.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <cstdio>

#include "meso/base/number.hpp"
#include "meso/base/output_file.hpp"
#include "meso/eval/evaluation.hpp"
#include "meso/eval/pattern_reach.hpp"
#ifdef MESO_CLI_BREP
#include "meso/operations/macrostructure_distance.hpp"
#endif
#include "overrides.hpp"
#include "run.hpp"
#include "stop.hpp"

namespace meso::cli {
namespace {

using eval::CellStream;
using eval::PlacedCell;

std::array<double, 12> rows(const Affine& a) {
  const auto& m = a.linear.m;
  const Vec3 t = a.translation;
  return {m[0], m[1], m[2], t.x, m[3], m[4], m[5], t.y, m[6], m[7], m[8], t.z};
}

/// Where the text goes: standard output, or a file that appears whole.
class TextOutput {
 public:
  static std::optional<TextOutput> open(const std::string& path, Run& run) {
    TextOutput out;
    if (!path.empty()) {
      auto file = OutputFile::create(path, run.existing_file(), run.sink);
      if (!file) return std::nullopt;
      out.file_.emplace(std::move(*file));
    }
    return out;
  }
  void write(std::string_view text) {
    if (file_) {
      (void)file_->write(text);  // commit() reports what went wrong
    } else {
      std::fwrite(text.data(), 1, text.size(), stdout);
    }
  }
  bool commit(DiagnosticSink& sink) { return !file_ || file_->commit(sink); }

 private:
  std::optional<OutputFile> file_;
};

std::string csv_header(const CellStream& cells) {
  std::string out = "ordinal";
  const Pattern& p = cells.pattern();
  for (const Loop& l : p.loops) out += "," + l.index.text;
  if (p.fill) {
    for (const FillRange& r : p.fill->ranges) out += "," + (r.index ? r.index->text : "n_" + r.axis.text);
  }
  if (p.list) out += "," + (p.list->index ? p.list->index->text : std::string("n"));
  if (p.scatter) out += "," + (p.scatter->index ? p.scatter->index->text : std::string("n"));
  for (int r = 1; r <= 3; ++r) {
    for (int c = 1; c <= 4; ++c) out += fmt::format(",m{}{}", r, c);
  }
  if (p.mapping == CellMapping::conformal) out += ",q1,q2,q3,step1,step2,step3";
  for (const CellParameter& cell : cells.unit_cell().parameters) out += "," + cell.name.text;
  return out + "\n";
}

void append_numbers(std::string& line, std::span<const double> values) {
  for (const double v : values) (line += ',') += format_number(v);
}

std::string csv_line(const PlacedCell& c) {
  std::string line = std::to_string(c.ordinal);
  for (const std::int64_t i : c.index) (line += ',') += std::to_string(i);
  append_numbers(line, rows(c.world_from_cell));
  if (c.mapping == CellMapping::conformal) {
    append_numbers(line, c.q.first(3));
    append_numbers(line, c.step);
  }
  append_numbers(line, c.parameters);
  return line + "\n";
}

std::string json_cell(const PlacedCell& c, const CellStream& cells) {
  Json out;
  out["index"] = std::vector<std::int64_t>(c.index.begin(), c.index.end());
  out["ordinal"] = c.ordinal;
  out["matrix"] = rows(c.world_from_cell);
  Json parameters = Json::object();
  const auto& names = cells.unit_cell().parameters;
  for (std::size_t i = 0; i < c.parameters.size(); ++i) parameters[names[i].name.text] = c.parameters[i];
  out["parameters"] = std::move(parameters);
  if (c.mapping == CellMapping::conformal) {
    out["q"] = std::vector<double>(c.q.begin(), c.q.end());
    out["step"] = c.step;
  }
  return out.dump();
}

bool write_csv(const CellStream& cells, TextOutput& out, DiagnosticSink& sink) {
  out.write(csv_header(cells));
  return cells.visit(
      0, cells.size(),
      [&](const PlacedCell& c) {
        out.write(csv_line(c));
        return true;
      },
      sink);
}

bool write_json(const CellStream& cells, TextOutput& out, DiagnosticSink& sink) {
  out.write(fmt::format("{{\"pattern\":{},\"unitCell\":{},\"cells\":[", Json(cells.pattern().id.text).dump(),
                        Json(cells.unit_cell().id.text).dump()));
  bool first = true;
  const bool done = cells.visit(
      0, cells.size(),
      [&](const PlacedCell& c) {
        out.write((first ? "\n" : ",\n") + json_cell(c, cells));
        first = false;
        return true;
      },
      sink);
  out.write(fmt::format("\n],\"diagnostics\":{}}}\n", diagnostics_json(sink).dump()));
  return done;
}

/// The pattern called `id`, or the only one.
const Pattern* choose_pattern(const eval::Evaluation& evaluation, const std::string& id, Run& run) {
  const auto& all = evaluation.document().patterns.items;
  if (id.empty() && all.size() == 1) return all.data();
  if (const Pattern* found = id.empty() ? nullptr : evaluation.find_pattern(id)) return found;
  std::string ids;
  for (const Pattern& p : all) ids += (ids.empty() ? "" : ", ") + p.id.text;
  run.usage_error(id.empty() ? "--pattern is needed: the document's patterns are " + ids
                             : "there is no pattern '" + id + "'; the document's patterns are " + ids);
  return nullptr;
}

int eval_verb(Run& run, const std::string& in, const std::string& out_path, const std::string& pattern_id) {
  if (out_path.empty()) run.refuse_without_effect({{"--no-clobber", run.flags.no_clobber}}, "with an output file");
  if (out_path.ends_with(".csv")) run.refuse_without_effect({{"--json", run.flags.json}}, "without a .csv file");
  if (!out_path.empty() && !out_path.ends_with(".csv") && !out_path.ends_with(".json"))
    run.usage_error("'" + out_path + "': eval writes .csv and .json");
  const RunOptions options = run.options();
  if (run.sink.has_errors()) return run.finish();
  const auto checked = run.open(in);
  if (!checked) return run.finish();
  eval::EvaluateOptions evaluate{.run = options};
  if (!parse_overrides(run, evaluate.overrides)) return run.finish();
#ifdef MESO_CLI_BREP
  evaluate.distance = operations::macrostructure_distance(evaluate.overrides, options);
#endif
  const auto evaluation = eval::Evaluation::make(*checked, evaluate, run.sink);
  if (!evaluation) return run.finish();
  const Pattern* pattern = choose_pattern(*evaluation, pattern_id, run);
  if (pattern == nullptr) return run.finish();
  const auto cells = evaluation->cells(*pattern, run.sink);
  if (!cells) return run.finish();
  const bool json = run.flags.json || out_path.ends_with(".json");
  // A look at every cell first: a fault in the last one must not leave half a table behind.
  if (!eval::check_keeps_any(*evaluation, *cells, run.sink) ||
      !cells->visit(
          0, cells->size(), [](const PlacedCell&) { return true; }, run.sink)) {
    return run.finish({{"pattern", pattern->id.text}, {"unitCell", pattern->unit_cell.text}, {"cells", Json::array()}});
  }
  if (out_path.empty()) (void)claim_answer();  // no second object after half of this one
  auto out = TextOutput::open(out_path, run);
  if (out && (json ? write_json(*cells, *out, run.sink) : write_csv(*cells, *out, run.sink)))
    (void)out->commit(run.sink);
  return run.finish();
}

}  // namespace

void add_eval(CLI::App& app, Run& run) {
  CLI::App* verb = app.add_subcommand("eval", "Write the placed cells of a pattern (CSV, JSON)");
  static std::string in, out, pattern;
  verb->add_option("IN", in, "Document (.meso, .mesoz)")->required();
  verb->add_option("OUT", out, "Output file (.csv or .json); standard output if absent");
  verb->add_option("--pattern", pattern, "The pattern, if the document has several")->type_name("ID");
  add_set_flag(*verb, run.flags);
  add_json_flag(*verb, run.flags);
  add_no_clobber_flag(*verb, run.flags);
  add_limit_flags(*verb, run.flags);
  verb->callback([&run] { run.action = [&run] { return eval_verb(run, in, out, pattern); }; });
}

}  // namespace meso::cli
