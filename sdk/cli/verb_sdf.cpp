// SPDX-License-Identifier: Apache-2.0
// The words behind `meso sdf` are a language of their own (docs/sdf.md) and reach it unparsed.

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "accuracy_json.hpp"
#include "meso/base/number.hpp"
#include "meso/implicit/surfaces.hpp"
#include "meso/operations/sdf.hpp"
#ifdef MESO_CLI_EVAL
#include "meso/operations/words.hpp"
#endif
#include "meso/sdf/vocabulary.hpp"
#include "run.hpp"
#include "sdf_volumes.hpp"
#include "stop.hpp"

namespace meso::cli {
namespace {

constexpr const char* description =
    "A solid in the command language of docs/sdf.md as a mesh: .ply .stl .3mf .obj .off .vtk";

/// The flags that are ours; everything else is a word.
struct Lengths {
  std::string tolerance, simplify;
};

void add_flags(CLI::App& flags, Run& run, operations::SdfOptions& options, Lengths& lengths) {
  flags.add_flag("--polish", options.polish, "Vertices on the surface itself, to 1e-6 of a grid spacing");
  flags.add_flag("--sharp", options.sharp, "Edges and corners of the solid become edges and corners of the mesh");
  flags.add_option("--tolerance", lengths.tolerance,
                   "Largest distance of the mesh from the surface, e.g. 0.01 or 10um; picks the samples");
  flags.add_option("--simplify", lengths.simplify,
                   "As few triangles as stay so close to the surface; beside the same --tolerance, samples are close "
                   "enough for it");
  flags.add_flag("--no-slivers", options.no_slivers, "Collapse very narrow triangles");
  flags.add_flag("--strict-math", options.strict_math, "Formulas as written, none regrouped");
  flags.add_flag("--double", options.double_coordinates, "Coordinates in double precision (not .stl)");
  flags.add_flag("--ascii", options.ascii, "Text instead of binary (.stl)");
  add_work_flags(flags, run.flags);
  add_json_flag(flags, run.flags);
  add_no_clobber_flag(flags, run.flags);
  for (CLI::Option* option : flags.get_options()) option->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
}

std::vector<sdf::CallerFlag> caller_flags(const CLI::App& flags) {
  std::vector<sdf::CallerFlag> out;
  for (const CLI::Option* option : flags.get_options()) {
    for (const std::string& name : option->get_lnames())
      if (name != "help") out.push_back({.name = "--" + name, .takes_value = option->get_items_expected_max() > 0});
  }
  return out;
}

void print_help(const CLI::App& flags) {
  fmt::print("{}\nUsage: meso sdf WORDS...\n\nWords, carried out from left to right on a stack of solids:\n",
             description);
  const auto line = [](std::string_view word, std::string_view argument, std::string_view meaning) {
    fmt::print("  {:<36}{}\n", argument.empty() ? word : fmt::format("{} {}", word, argument), meaning);
  };
  line("tpms.NAME", "", "all points where a periodic surface's expression is negative: tpms.gyroid");
  line("strut.NAME", "r", "the library's cells of struts, edge 1, radius r: strut.bcc strut.octet strut.kelvin ...");
  for (const sdf::Vocable& v : sdf::vocabulary()) line(v.word, v.argument, v.meaning);
  fmt::print("\nSurfaces (docs/specification/surfaces.md):\n");
  std::string names;
  for (const implicit::Surface& surface : implicit::surfaces()) {
    const std::string name = fmt::format(" tpms.{}", surface.name);
    if (names.size() + name.size() > 79) {
      fmt::print(" {}\n", names);
      names.clear();
    }
    names += name;
  }
  fmt::print(" {}\n\nOptions, anywhere; the last of equals counts:\n", names);
  line("-b", "x0,y0,z0,x1,y1,z1", "the box (the solid's own, unbounded sides at -1 and 1)");
  line("-s", "n | nx,ny,nz", "samples in all, or along the axes (100^3)");
  line("-o", "PATH", "the mesh: .ply .stl .3mf .obj .off .vtk (out.ply); .vtu .msh .inp .nrrd .vti .h5 .svg .png");
  line("", "", "or the same design as a document: .meso");
  line("--print DOCUMENT", "", "the words that make the same mesh, instead of a mesh");
  line("@PATH", "", "the words of that file");
  line("-h --help", "", "this");
  line("--version", "", "the version");
  fmt::print("\n{}", CLI::Formatter().make_groups(&flags, CLI::AppFormatMode::Normal));
}

Json report_json(const operations::SdfReport& r, const std::string& out) {
  const operations::MeshMeasures& m = *r.measures;
  const Vec3 size = r.grid.box.max - r.grid.box.min;
  const double room = size.x * size.y * size.z;
  const auto point = [](Vec3 p) { return Json{p.x, p.y, p.z}; };
  Json j;
  j["output"] = out;
  j["volume"] = m.volume;
  j["area"] = m.area;
  j["solidFraction"] = m.volume / room;
  if (const auto& limit = r.extrapolated) {
    j["extrapolated"] = {{"volume", limit->volume}, {"area", limit->area}, {"solidFraction", limit->volume / room}};
  } else {
    j["extrapolated"] = nullptr;
  }
  if (r.accuracy) j["accuracy"] = accuracy_json(*r.accuracy);
  j["triangles"] = r.triangles;
  j["vertices"] = r.points;
  j["components"] = m.components;
  j["cavities"] = m.cavities;
  j["crumbs"] = m.crumbs;
  j["closed"] = m.closed;
  j["euler"] = m.euler;
  j["bbox"] = m.box.empty() ? Json() : Json{point(m.box.min), point(m.box.max)};
  j["box"] = {point(r.grid.box.min), point(r.grid.box.max)};
  j["samples"] = r.grid.nodes;
  j["bytes"] = r.bytes;
  j["seconds"] = {{"read", r.seconds.read},
                  {"contour", r.seconds.contour},
                  {"extrapolate", r.seconds.extrapolate},
                  {"total", r.seconds.total}};
  j["peakBytes"] = peak_memory_bytes();
  return j;
}

void print_summary(const operations::SdfReport& r, const std::string& out) {
  fmt::print(stderr, "{}: {} triangles, {} vertices, Euler number {}, {} bytes\n", out, r.triangles, r.points, r.euler,
             r.bytes);
  fmt::print(stderr, "{} x {} x {} samples: {:.3f} s reading, {:.3f} s contouring and writing\n", r.grid.nodes[0],
             r.grid.nodes[1], r.grid.nodes[2], r.seconds.read, r.seconds.contour);
  if (r.accuracy)
    fmt::print(stderr, "within {:g} of the surface; {} samples of the field beside the grid's\n", r.accuracy->distance,
               r.accuracy->surface_samples);
}

/// The values of our flags, checked as on any other verb.
bool take_flags(CLI::App& flags, const std::vector<sdf::GivenFlag>& given, Run& run) {
  std::vector<std::string> backwards;
  backwards.reserve(given.size());
  for (const sdf::GivenFlag& flag : given)
    backwards.push_back(flag.value.empty() ? flag.name : flag.name + "=" + flag.value);
  std::reverse(backwards.begin(), backwards.end());
  try {
    flags.parse(backwards);
  } catch (const CLI::ParseError& e) {
    run.usage_error(e.what());
    return false;
  }
  return true;
}

/// What must hold while words are read, some of them perhaps from a pipe that stays silent. An argument that looks like
/// these flags does no harm.
void heed_flags_before_reading(Run& run, const std::vector<std::string>& words) {
  run.flags.json = std::find(words.begin(), words.end(), "--json") != words.end();
  if (run.flags.json) answer_stop_in_json();
  for (std::size_t i = 0; i < words.size(); ++i) {
    constexpr std::string_view with_value = "--timeout=";
    std::string_view value;
    if (words[i].starts_with(with_value)) value = std::string_view(words[i]).substr(with_value.size());
    if (words[i] == "--timeout" && i + 1 < words.size()) value = words[i + 1];
    if (const auto seconds = parse_number(value); seconds && *seconds > 0 && *seconds <= 1e9) end_after(*seconds);
  }
}

#ifdef MESO_CLI_EVAL
bool is_document(const std::string& path) { return path.ends_with(".meso"); }

/// A design as a document; what only meshes have is refused.
int write_document(Run& run, const sdf::Program& program, const operations::SdfOptions& options) {
  const bool has_flags_of_meshes = options.polish || options.no_slivers || options.double_coordinates ||
                                   options.sharp || options.tolerance > 0 || options.simplify > 0 ||
                                   options.strict_math || options.ascii;
  if (has_flags_of_meshes)
    return run.usage_error("a document states the design; --sharp, --tolerance and the like are flags of convert"),
           run.finish(Json{{"output", program.output}});
  const auto written = operations::write_words(program, options.existing, options.run, run.sink);
  if (!written) return run.finish(Json::object());
  const int code = run.finish(Json{{"output", program.output},
                                   {"parts", written->parts},
                                   {"unitCells", written->unit_cells},
                                   {"bytes", written->bytes}});
  if (!run.flags.json)
    fmt::print(stderr, "{}: {} part{}, {} unit cell{}, {} bytes\n", program.output, written->parts,
               written->parts == 1 ? "" : "s", written->unit_cells, written->unit_cells == 1 ? "" : "s",
               written->bytes);
  return code;
}

int print_document(Run& run, const std::string& path) {
  const auto line = operations::print_words(path, run.options(), run.sink);
  if (!line) return run.finish(Json::object());
  if (run.flags.json) return run.finish(Json{{"words", *line}});
  const int code = run.finish();
  fmt::print("{}\n", *line);
  return code;
}
#endif

}  // namespace

void add_sdf(CLI::App& app) { app.add_subcommand("sdf", description)->prefix_command(); }

int sdf_verb(Run& run, const std::vector<std::string>& words) {
  heed_flags_before_reading(run, words);
#ifdef MESO_CLI_EVAL
  if (words.size() > 1 && words[0] == "--print") {
    if (words.size() == 2 || (words.size() == 3 && words[2] == "--json")) return print_document(run, words[1]);
    return run.usage_error("--print takes a document, and no words"), run.finish(Json::object());
  }
#endif
  CLI::App flags;
  flags.set_help_flag();  // -h is a word
  operations::SdfOptions options;
  Lengths lengths;
  add_flags(flags, run, options, lengths);
  operations::VolumeOptions volume;
  add_volume_flags(flags, volume);
  const std::vector<sdf::CallerFlag> ours = caller_flags(flags);
  const auto program = sdf::parse_program(sdf::words_of_arguments(words),
                                          {.caller_flags = ours, .read_text = operations::read_text}, run.sink);
  if (!program) return run.finish(Json::object());
  // From now on what the words say.
  run.flags.json = std::any_of(program->caller_flags.begin(), program->caller_flags.end(),
                               [](const sdf::GivenFlag& flag) { return flag.name == "--json"; });
  if (!take_flags(flags, program->caller_flags, run)) return run.finish(Json::object());
  if (program->asks == sdf::Program::Asks::help) return print_help(flags), 0;
  if (program->asks == sdf::Program::Asks::version) return fmt::print("{}\n", MESO_VERSION), 0;
  const auto length = [&](const std::string& text, const char* flag) {
    return text.empty() ? 0 : run.length_mm(text, LengthUnit::millimeter, flag).value_or(0);
  };
  options.tolerance = length(lengths.tolerance, "--tolerance");
  options.simplify = length(lengths.simplify, "--simplify");
  options.run = run.options();
  options.existing = run.existing_file();
  options.measure = run.flags.json;
  if (run.sink.has_errors()) return run.finish(Json::object());
#ifdef MESO_CLI_EVAL
  if (is_document(program->output)) return write_document(run, *program, options);
#endif
  if (!operations::check_volume_options(program->output, volume, run.sink)) return run.finish(Json::object());
  if (operations::is_volume_output(program->output)) {
    if (options.polish || options.no_slivers || options.double_coordinates || options.sharp || options.tolerance > 0 ||
        options.simplify > 0)
      return run.usage_error(
                 "--polish, --sharp, --tolerance, --simplify, --no-slivers and --double have an effect on surfaces "
                 "only"),
             run.finish(Json::object());
    volume.strict_math = options.strict_math;
    volume.ascii = options.ascii;
    volume.existing = options.existing;
    volume.run = options.run;
    return sdf_volume(run, *program, volume);
  }
  const auto report = operations::run_sdf(*program, options, run.sink);
  if (!report) return run.finish(Json{{"output", program->output}});
  if (run.flags.json) return run.finish(report_json(*report, program->output));
  const int code = run.finish();
  print_summary(*report, program->output);
  return code;
}

}  // namespace meso::cli
