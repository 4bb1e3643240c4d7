// SPDX-License-Identifier: Apache-2.0
// The table of case studies, and the series over the number of cells with its plots.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <filesystem>

#include "make_options.hpp"
#include "meso/export_svg/write_plot_svg.hpp"
#include "meso/operations/compare.hpp"
#include "meso/package/referenced_files.hpp"
#include "run.hpp"

namespace meso::cli {
namespace {

namespace fs = std::filesystem;
using operations::ComparisonRow;

struct CompareArguments {
  std::vector<std::string> documents;
  std::string series;
  std::string out;
};

Json row_json(const ComparisonRow& r) {
  return {{"name", r.name},
          {"cells", r.cells},
          {"macroStep", r.macro_step},
          {"partStep", r.part_step},
          {"partStl", r.part_stl},
          {"framework", r.framework},
          {"packed", r.packed},
          {"vsStep", r.versus_step()},
          {"vsStl", r.versus_stl()},
          {"triangles", r.triangles},
          {"deflection", r.deflection_mm},
          {"angle", r.angle_rad},
          {"seconds", seconds_json(r.seconds)}};
}

/// A document that is made, by the script run.sh in its folder from a form `<document>.in`, and is not there.
struct NotMade {
  fs::path document;
  std::string command;
};
std::optional<NotMade> not_made(const fs::path& document) {
  const fs::path folder = document.has_parent_path() ? document.parent_path() : fs::path("."),
                 script = folder / "run.sh";
  std::error_code error;
  const bool is_made = fs::exists(document.string() + ".in", error) && fs::exists(script, error);
  if (!is_made || fs::exists(document, error)) return std::nullopt;
  return NotMade{document, script.string() + " " + folder.string()};
}
Json row_json(const NotMade& r) {
  return {{"name", r.document.stem().string()}, {"missing", r.document.filename().string()}, {"madeBy", r.command}};
}

void print_table(const std::vector<ComparisonRow>& rows) {
  fmt::print("{:<22} {:>7} {:>10} {:>12} {:>12} {:>10} {:>8} {:>8} {:>8} {:>10} {:>6} {:>6} {:>7}\n", "case", "cells",
             "macro STEP", "part STEP", "ASCII STL", "framework", "packed", "vsSTEP%", "vsSTL%", "triangles", "defl",
             "angle", "s");
  for (const ComparisonRow& r : rows) {
    fmt::print("{:<22} {:>7} {:>10} {:>12} {:>12} {:>10} {:>8} {:>8.3f} {:>8.3f} {:>10} {:>6.3g} {:>6.3g} {:>7.2f}\n",
               r.name, r.cells, r.macro_step, r.part_step, r.part_stl, r.framework, r.packed, r.versus_step(),
               r.versus_stl(), r.triangles, r.deflection_mm, r.angle_rad, r.seconds.total);
  }
}

struct Series {
  std::string id;
  std::vector<std::string> values;
};
std::optional<Series> parse_series(const std::string& text, Run& run) {
  Series out;
  const std::size_t equals = text.find('=');
  if (equals != std::string::npos && equals > 0) {
    out.id = text.substr(0, equals);
    for (std::size_t at = equals + 1; at <= text.size();) {
      const std::size_t comma = std::min(text.find(',', at), text.size());
      if (comma > at) out.values.push_back(text.substr(at, comma - at));
      at = comma + 1;
    }
  }
  if (!out.values.empty()) return out;
  run.usage_error("--series: '" + text + "' is not ID=VALUE,VALUE,..., e.g. pitch=10mm,5mm,2.5mm");
  return std::nullopt;
}

bool write_text(const fs::path& file, std::string_view text, Run& run) {
  auto out = OutputFile::create(file.string(), run.existing_file(), run.sink);
  if (out) (void)out->write(text);  // commit() reports what went wrong
  return out && out->commit(run.sink);
}

/// A value as part of a file name: "60mm/6" names no folder.
std::string in_file_name(std::string value) {
  for (std::size_t at = 0; (at = value.find('/', at)) != std::string::npos;) value.replace(at, 1, "%2F");
  return value;
}

/// Each variant becomes a document of its own beside the files it refers to, so that its size is that of a real
/// document.
std::optional<std::vector<fs::path>> write_variants(const fs::path& document, const Series& series,
                                                    const fs::path& folder, Run& run) {
  std::vector<fs::path> files;
  for (const std::string& value : series.values) {
    const auto text = operations::document_with_parameter(document, series.id, value, run.sink);
    if (!text) return std::nullopt;
    files.push_back(folder / fmt::format("{}-{}-{}.meso", document.stem().string(), series.id, in_file_name(value)));
    if (!write_text(files.back(), *text, run)) return std::nullopt;
  }
  return files;
}

bool copy_references(const fs::path& document, const fs::path& folder, Run& run) {
  const auto checked = run.open(document.string());
  if (!checked) return false;
  for (const ReferencedFile& file : referenced_files(*checked)) {
    const fs::path target = folder / fs::path(file.name);
    std::error_code error;
    fs::create_directories(target.parent_path(), error);
    if (fs::equivalent(file.resource.name(), target, error)) continue;
    std::string why;
    const auto bytes = ResourceBytes::open(file.resource, why);
    if (!bytes) {
      run.sink.report({.code = Code::import_unreadable, .args = {file.name, why}});
      return false;
    }
    if (!write_text(target, bytes->view(), run)) return false;
  }
  return true;
}

bool write_plots(const std::vector<ComparisonRow>& rows, const std::string& stem, const fs::path& folder, Run& run) {
  PlotSeries step{"part STEP", {}}, stl{"part ASCII STL", {}}, idea{"document and body", {}}, time{"read to STEP", {}};
  for (const ComparisonRow& r : rows) {
    const auto cells = static_cast<double>(r.cells);
    step.points.push_back({cells, static_cast<double>(r.part_step)});
    stl.points.push_back({cells, static_cast<double>(r.part_stl)});
    idea.points.push_back({cells, static_cast<double>(r.framework)});
    time.points.push_back({cells, r.seconds.total});
  }
  const PlotSpec bytes{.title = stem + ": file size against cells",
                       .x_label = "cells",
                       .y_label = "bytes",
                       .x_log = true,
                       .y_log = true,
                       .series = {stl, step, idea}};
  const PlotSpec seconds{.title = stem + ": time against cells",
                         .x_label = "cells",
                         .y_label = "seconds",
                         .x_log = true,
                         .y_log = true,
                         .series = {time}};
  return write_text(folder / (stem + "-bytes.svg"), write_plot_svg(bytes), run) &&
         write_text(folder / (stem + "-seconds.svg"), write_plot_svg(seconds), run);
}

int compare_verb(Run& run, const CompareArguments& arguments) {
  if (arguments.series.empty()) {
    run.refuse_without_effect({{"--out", !arguments.out.empty()}, {"--no-clobber", run.flags.no_clobber}},
                              "with --series");
  }
  const auto options = make_options(run);
  if (!options) return run.finish();
  const fs::path folder = arguments.out.empty() ? "." : arguments.out;
  std::vector<fs::path> files(arguments.documents.begin(), arguments.documents.end());
  std::string stem;
  if (!arguments.series.empty()) {
    const auto series = parse_series(arguments.series, run);
    if (series && files.size() != 1) run.usage_error("--series takes exactly one document");
    if (run.sink.has_errors()) return run.finish();
    stem = files[0].stem().string() + "-" + series->id;
    std::error_code error;
    fs::create_directories(folder, error);
    if (!copy_references(files[0], folder, run)) return run.finish();
    const auto variants = write_variants(files[0], *series, folder, run);
    if (!variants) return run.finish();
    files = *variants;
  }
  std::vector<ComparisonRow> rows;
  std::vector<NotMade> missing;
  for (const fs::path& file : files) {
    if (run.sink.has_errors()) break;
    if (auto row = not_made(file)) {
      run.sink.report({.code = Code::compare_not_made,
                       .where = {.file = file.string()},
                       .args = {file.string(), file.filename().string(), row->command}});
      missing.push_back(std::move(*row));
      continue;
    }
    if (auto row = operations::compare(file, *options, run.sink)) rows.push_back(std::move(*row));
  }
  if (!run.sink.has_errors() && !stem.empty()) (void)write_plots(rows, stem, folder, run);
  if (run.flags.json) {
    Json list = Json::array();
    for (const ComparisonRow& row : rows) list.push_back(row_json(row));
    for (const NotMade& row : missing) list.push_back(row_json(row));
    fmt::print("{}\n", list.dump(2));
  } else if (!rows.empty()) {
    print_table(rows);
  }
  if (!run.flags.json)
    for (const NotMade& row : missing)
      fmt::print("{:<22} not made; run {}\n", row.document.stem().string(), row.command);
  return run.finish();
}

}  // namespace

void add_compare(CLI::App& app, Run& run) {
  CLI::App* verb = app.add_subcommand("compare", "Bytes of documents against bytes of their STEP and STL");
  static CompareArguments arguments;
  verb->add_option("DOC", arguments.documents, "Documents (.meso, .mesoz)")->required();
  verb->add_option("--series", arguments.series,
                   "One row per value of a parameter; writes the variants and two plots (SVG)")
      ->type_name("ID=V,V,...");
  verb->add_option("--out", arguments.out, "Folder for the variants and plots of --series (.)")->type_name("DIR");
  add_mesh_flags(*verb, run.flags);
  add_limit_flags(*verb, run.flags);
  add_json_flag(*verb, run.flags);
  add_no_clobber_flag(*verb, run.flags);
  verb->callback([&run] { run.action = [&run] { return compare_verb(run, arguments); }; });
}

}  // namespace meso::cli
