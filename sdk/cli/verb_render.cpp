// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <CLI/CLI.hpp>

#include "make_options.hpp"
#include "meso/operations/convert.hpp"
#include "meso/operations/load_mesh.hpp"
#include "meso/render/picture.hpp"
#include "run.hpp"

namespace meso::cli {
namespace {

/// "z=5mm" as a cut; empty: a usage error was reported.
std::optional<picture::Cut> parse_cut(const std::string& text, Run& run) {
  const std::size_t axis = text.empty() ? std::string::npos : std::string_view("xyz").find(text[0]);
  if (axis != std::string::npos && text.size() > 2 && text[1] == '=') {
    if (const auto position = run.value_mm(text.substr(2))) return picture::Cut{.axis = axis, .position = *position};
  }
  run.usage_error("--cut: '" + text + "' is not a plane such as z=5mm");
  return std::nullopt;
}

bool is_cut(const TriangleMesh& mesh, const picture::Cut& cut) {
  Box3 box;
  for (const Vec3 p : mesh.points) box.extend(p);
  return box.min[cut.axis] < cut.position && cut.position < box.max[cut.axis];
}

int render_verb(Run& run, const std::string& in, const std::string& out, const std::string& cut,
                picture::RenderOptions look) {
  if (!out.ends_with(".png")) run.usage_error("'" + out + "': render writes .png");
  if (!operations::is_document(in)) {
    run.refuse_without_effect({{"--set", !run.flags.set.empty()}, {"--part", !run.flags.part.empty()}}, "on documents");
  }
  if (!cut.empty()) look.cut = parse_cut(cut, run);
  const auto options = run.sink.has_errors() ? std::nullopt : make_options(run);
  if (!options) return run.finish();
  const auto mesh = operations::load_mesh(in, *options, run.sink);
  if (!mesh) return run.finish();
  if (look.cut && !is_cut(*mesh, *look.cut)) {
    run.usage_error("--cut: the plane " + cut + " does not meet the part");
    return run.finish();
  }
  const auto image = picture::draw(*mesh, look, options->run, run.sink);
  if (!image) return run.finish();
  auto file = OutputFile::create(out, run.existing_file(), run.sink);
  if (file) {
    (void)file->write(picture::png(*image));  // commit() reports what went wrong
    (void)file->commit(run.sink);
  }
  const int code = run.finish();
  if (code == 0)
    fmt::print(stderr, "{}: {} x {}, {} triangles\n", out, image->width, image->height, mesh->triangles.size());
  return code;
}

}  // namespace

void add_render(CLI::App& app, Run& run) {
  CLI::App* verb = app.add_subcommand(
      "render",
      "Draw a document, .step, .stp, .brep, .iges, .igs, .stl, .ply, .obj or .off as one well-lit picture (.png)");
  static std::string in, out, cut;
  static picture::RenderOptions look;
  verb->add_option("IN", in, "Document or geometry")->required();
  verb->add_option("OUT", out, "Picture (.png)")->required();
  verb->add_option("--width", look.width, "Pixels (1200)")->check(CLI::Range(16, 16384));
  verb->add_option("--height", look.height, "Pixels (900)")->check(CLI::Range(16, 16384));
  verb->add_option("--cut", cut, "Show the section in a plane, e.g. z=5mm; the half towards the viewer is left out")
      ->type_name("AXIS=LEN");
  add_set_flag(*verb, run.flags);
  add_part_flag(*verb, run.flags);
  add_mesh_flags(*verb, run.flags);
  add_limit_flags(*verb, run.flags);
  add_no_clobber_flag(*verb, run.flags);
  verb->callback([&run] { run.action = [&run] { return render_verb(run, in, out, cut, look); }; });
}

}  // namespace meso::cli
