// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <CLI/CLI.hpp>

#include "run.hpp"

namespace meso::cli {

void add_validate(CLI::App& app, Run& run) {
  CLI::App* verb = app.add_subcommand("validate", "Check a document against every rule of the format");
  static std::string file;
  verb->add_option("FILE", file, "Document (.meso, .mesoz)")->required();
  add_memory_flag(*verb, run.flags);
  add_json_flag(*verb, run.flags);
  verb->callback([&run] {
    run.action = [&run] {
      (void)run.options();
      const bool valid = !run.sink.has_errors() && run.open(file).has_value();
      if (valid) fmt::print(stderr, "{}: valid\n", file);
      Json report;
      report["file"] = file;
      report["verdict"] = valid ? "valid" : "invalid";
      report["truncated"] = run.sink.truncated();
      return run.finish(std::move(report));
    };
  });
}

}  // namespace meso::cli
