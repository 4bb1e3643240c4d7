// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <CLI/CLI.hpp>

#include "run.hpp"

namespace meso::cli {
namespace {

struct Format {
  const char* extension;
  const char* name;
  bool reads, writes;
  const char* note;
};

constexpr Format formats[] = {
    {".meso", "Meso document", true, true, "convert's input; canonical writes it"},
#ifdef MESO_CLI_PACKAGES
    {".mesoz", "package of a document", true, true, "read wherever a document is; written by pack"},
#endif
#ifdef MESO_CLI_BREP
    {".step", "STEP AP214 (also .stp)", true, true, "exact; imported by documents, written by convert"},
    {".brep", "OpenCASCADE B-rep, text", true, true, "exact; imported by documents, written by convert"},
    {".iges", "IGES 5.3 (also .igs)", true, false, "exact; imported by documents"},
    {".stl", "STL, binary or --ascii", true, true, "triangles; imported by documents as a faceted solid"},
#elif defined(MESO_CLI_IMPLICIT)
    {".stl", "STL, binary or --ascii", true, true, "triangles, read and written by sdf"},
#endif
#ifdef MESO_CLI_IMPLICIT
#ifdef MESO_CLI_PACKAGES
    {".3mf", "3MF, one mesh in millimetres", false, true, "triangles, written by convert and sdf"},
#endif
    {".ply", "PLY, binary", true, true, "triangles, read and written by sdf"},
    {".obj", "Wavefront OBJ", true, true, "triangles, read and written by sdf"},
    {".off", "Object File Format", true, true, "triangles, read and written by sdf"},
    {".vtk", "legacy VTK polygons", false, true, "triangles, written by sdf"},
    {".vtu", "VTK unstructured grid", false, true, "tetrahedra, written by sdf and convert"},
    {".inp", "CalculiX, Abaqus", false, true, "tetrahedra, written by sdf and convert"},
    {".nrrd", "voxels (also .vti, .h5)", false, true, "written by sdf and convert"},
    {".svg", "slices, drawn (pictures: .png)", false, true, "written by sdf and convert"},
#endif
#ifdef MESO_CLI_EVAL
    {".csv", "table", true, true, "a field, read by documents and field; placed cells, written by eval"},
    {".frd", "CalculiX results", true, false, "a field, read by documents and field"},
    {".msh", "Gmsh", true, true, "node data as a field, read; tetrahedra, written by sdf and convert"},
    {".json", "placed cells", false, true, "written by eval"},
#endif
#ifdef MESO_CLI_RENDER
    {".png", "picture", false, true, "written by render"},
#endif
};

}  // namespace

void add_formats(CLI::App& app, Run& run) {
  CLI::App* verb = app.add_subcommand("formats", "List the file formats this build reads and writes");
  add_json_flag(*verb, run.flags);
  verb->callback([&run] {
    run.action = [&run] {
      Json report, list = Json::array();
      for (const Format& f : formats) {
        list.push_back(
            {{"extension", f.extension}, {"name", f.name}, {"reads", f.reads}, {"writes", f.writes}, {"note", f.note}});
        if (!run.flags.json) {
          fmt::print("{:<7} {:<28} {:<5} {:<6} {}\n", f.extension, f.name, f.reads ? "read" : "",
                     f.writes ? "write" : "", f.note);
        }
      }
      report["formats"] = list;
      return run.finish(std::move(report));
    };
  });
}

}  // namespace meso::cli
