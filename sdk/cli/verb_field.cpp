// SPDX-License-Identifier: Apache-2.0
// Foreign field files: what is in them, and as a document or HDF5.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <cmath>

#include "meso/operations/field_import.hpp"
#include "run.hpp"

namespace meso::cli {
namespace {

struct FieldArguments {
  std::string in, out;
  operations::FieldOptions options;
};

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

int finish(Run& run, const operations::FieldReport& report) {
  Json json{{"records", report.records}, {"tetra", report.tetra}, {"hexa", report.hexa}};
  if (!report.box.empty()) {
    json["box"] = {{"min", {report.box.min.x, report.box.min.y, report.box.min.z}},
                   {"max", {report.box.max.x, report.box.max.y, report.box.max.z}}};
  }
  json["columns"] = Json::array();
  if (!run.flags.json) {
    fmt::print("{} records{}{}\n", report.records, report.tetra > 0 ? fmt::format(", {} tetrahedra", report.tetra) : "",
               report.hexa > 0 ? fmt::format(", {} hexahedra", report.hexa) : "");
    if (const Box3& box = report.box; !box.empty())
      fmt::print("box ({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g})\n", box.min.x, box.min.y, box.min.z,
                 box.max.x, box.max.y, box.max.z);
  }
  for (const auto& c : report.columns) {
    json["columns"].push_back({{"name", c.name},
                               {"unit", c.unit},
                               {"min", number(c.statistics.min)},
                               {"max", number(c.statistics.max)},
                               {"nan", c.statistics.nan},
                               {"infinite", c.statistics.infinite}});
    if (run.flags.json) continue;
    fmt::print("{:<16} {:>14.6g} to {:<14.6g} {}", c.name, c.statistics.min, c.statistics.max, c.unit);
    if (c.statistics.nan + c.statistics.infinite > 0)
      fmt::print("  {} NaN, {} infinite, first in record {}", c.statistics.nan, c.statistics.infinite,
                 c.statistics.first_not_finite);
    fmt::print("\n");
  }
  return run.finish(std::move(json));
}

void add_common(CLI::App& verb, Run& run, FieldArguments& arguments) {
  verb.add_option("IN", arguments.in, "Field file (.csv .h5 .vtk .vtu .frd .msh)")->required();
  verb.add_option("--data-set", arguments.options.data_set, "One data set, view or array of the file")
      ->type_name("NAME");
  add_json_flag(verb, run.flags);
  add_work_flags(verb, run.flags);
}

}  // namespace

void add_field(CLI::App& app, Run& run) {
  static FieldArguments arguments;
  CLI::App* field = app.add_subcommand("field", "Field files: what is in them; as a document or HDF5");
  field->require_subcommand(1);
  CLI::App* info = field->add_subcommand("info", "Columns, ranges, NaN and bounding box of a field file");
  add_common(*info, run, arguments);
  info->callback([&run] {
    run.action = [&run] {
      arguments.options.run = run.options();
      const auto report = operations::field_info(arguments.in, arguments.options, run.sink);
      return report ? finish(run, *report) : run.finish();
    };
  });
  CLI::App* import = field->add_subcommand("import", "A field file as a document (.meso) or as HDF5 (.h5)");
  add_common(*import, run, arguments);
  import->add_option("OUT", arguments.out, "Output file (.meso or .h5)")->required();
  import->add_option("--unit", arguments.options.unit, "Unit of the positions: um mm cm m in ft")
      ->check(CLI::IsMember({"um", "mm", "cm", "m", "in", "ft"}))
      ->type_name("UNIT");
  add_no_clobber_flag(*import, run.flags);
  import->callback([&run] {
    run.action = [&run] {
      arguments.options.run = run.options();
  arguments.options.existing = run.existing_file();
  const auto report = operations::import_field(arguments.in, arguments.out, arguments.options, run.sink);
  return report ? finish(run, *report) : run.finish();
};
}  // namespace meso::cli
);
}

}  // namespace meso::cli
