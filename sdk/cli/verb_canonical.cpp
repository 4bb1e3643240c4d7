// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <cstdio>

#include "meso/base/output_file.hpp"
#include "meso/package/open_document.hpp"
#include "meso/xml/write.hpp"
#include "run.hpp"

namespace meso::cli {
namespace {

int canonical(Run& run, const std::string& in, const std::string& out) {
  if (out.empty()) run.refuse_without_effect({{"--no-clobber", run.flags.no_clobber}}, "with an output file");
  const RunOptions options = run.options();
  if (run.sink.has_errors()) return run.finish();
  const auto read = open_document(in, options, run.sink);
  if (!read) return run.finish();
  const std::string bytes = canonical_document(read->document);
  if (out.empty()) {
    std::fwrite(bytes.data(), 1, bytes.size(), stdout);
  } else {
    auto file = OutputFile::create(out, run.existing_file(), run.sink);
    if (file) {
      (void)file->write(bytes);  // commit() reports what went wrong
      (void)file->commit(run.sink);
    }
  }
  return run.finish();
}

}  // namespace

void add_canonical(CLI::App& app, Run& run) {
  CLI::App* verb = app.add_subcommand("canonical", "Write the one canonical byte form of a document");
  static std::string in, out;
  verb->add_option("IN", in, "Document (.meso, .mesoz)")->required();
  verb->add_option("OUT", out, "Output file; standard output if absent");
  add_memory_flag(*verb, run.flags);
  add_no_clobber_flag(*verb, run.flags);
  verb->callback([&run] { run.action = [&run] { return canonical(run, in, out); }; });
}

}  // namespace meso::cli
