// SPDX-License-Identifier: Apache-2.0
// A document and all its files as one file, and back.
#include <fmt/core.h>

#include <CLI/CLI.hpp>

#include "meso/package/open_document.hpp"
#include "meso/package/package.hpp"
#include "run.hpp"
#if defined(MESO_CLI_BREP) && defined(MESO_CLI_RENDER)
#include "meso/operations/load_mesh.hpp"
#include "meso/render/picture.hpp"
#endif

namespace meso::cli {
namespace {

int finish(Run& run, const std::string& in, const std::string& out, const std::optional<PackReport>& report) {
  Json json{{"input", in}, {"output", out}};
  if (report) {
    json["files"] = report->files;
    json["unpackedBytes"] = report->unpacked;
    json["bytes"] = report->bytes;
    fmt::print(stderr, "{}: {} file{}, {} bytes, {} packed\n", out, report->files, report->files == 1 ? "" : "s",
               report->unpacked, report->bytes);
  }
  return run.finish(std::move(json));
}

#if defined(MESO_CLI_BREP) && defined(MESO_CLI_RENDER)
/// What the part looks like, small. Nothing, reported, if it cannot be made.
std::optional<std::string> thumbnail_of(const std::string& document, const RunOptions& options, Run& run) {
  const auto mesh = operations::load_mesh(document, {.run = options}, run.sink);
  const auto image =
      mesh ? picture::draw(*mesh, {.width = 256, .height = 256, .samples = 4}, options, run.sink) : std::nullopt;
  return image ? std::optional(picture::png(*image)) : std::nullopt;
}
#endif

int pack_verb(Run& run, const std::string& in, const std::string& out, [[maybe_unused]] bool with_thumbnail) {
  if (!is_package(out)) run.usage_error("'" + out + "': pack writes .mesoz");
  PackOptions options{.existing = run.existing_file(), .run = run.options()};
  if (run.sink.has_errors()) return run.finish();
#if defined(MESO_CLI_BREP) && defined(MESO_CLI_RENDER)
  if (with_thumbnail) {
    auto thumbnail = thumbnail_of(in, options.run, run);
    if (!thumbnail) return run.finish();
    options.thumbnail = std::move(*thumbnail);
  }
#endif
  return finish(run, in, out, pack(in, out, options, run.sink));
}

int unpack_verb(Run& run, const std::string& in, std::string out) {
  while (out.size() > 1 && out.ends_with('/')) out.pop_back();
  const RunOptions options = run.options();
  if (run.sink.has_errors()) return run.finish();
  return finish(run, in, out, unpack(in, out, run.existing_file(), options, run.sink));
}

}  // namespace

void add_package(CLI::App& app, Run& run) {
  static std::string in, out;
  static bool with_thumbnail = false;
  CLI::App* pack = app.add_subcommand("pack", "A document and all files it needs as one package (.mesoz)");
  pack->add_option("IN", in, "Document (.meso)")->required();
  pack->add_option("OUT", out, "Package (.mesoz); replaced atomically")->required();
#if defined(MESO_CLI_BREP) && defined(MESO_CLI_RENDER)
  pack->add_flag("--thumbnail", with_thumbnail, "Add a small picture of the part");
#endif
  CLI::App* unpack = app.add_subcommand("unpack", "The files of a package (.mesoz) in a folder of their own");
  unpack->add_option("IN", in, "Package (.mesoz)")->required();
  unpack->add_option("FOLDER", out, "New or empty folder; appears whole or not at all")->required();
  for (CLI::App* verb : {pack, unpack}) {
    add_work_flags(*verb, run.flags);
    add_json_flag(*verb, run.flags);
    add_no_clobber_flag(*verb, run.flags);
  }
  pack->callback([&run] { run.action = [&run] { return pack_verb(run, in, out, with_thumbnail); }; });
  unpack->callback([&run] { run.action = [&run] { return unpack_verb(run, in, out); }; });
}

}  // namespace meso::cli
