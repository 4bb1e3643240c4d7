// SPDX-License-Identifier: Apache-2.0
#include "sdf_volumes.hpp"

#include <fmt/core.h>

namespace meso::cli {
namespace {

Json report_json(const operations::VolumeReport& r, const std::string& out) {
  Json j;
  j["output"] = out;
  if (const auto& t = r.tetrahedra) {
    j["elements"] = t->elements;
    j["points"] = t->points;
    j["spacing"] = t->spacing;
    j["volume"] = t->volume;
    j["dihedralDegrees"] = {t->min_dihedral_degrees, t->max_dihedral_degrees};
  } else {
    j["cells"] = r.cells;
    j["files"] = r.files;
  }
  j["bytes"] = r.bytes;
  j["seconds"] = r.seconds;
  j["peakBytes"] = peak_memory_bytes();
  return j;
}

void print_summary(const operations::VolumeReport& r, const std::string& out) {
  if (const auto& t = r.tetrahedra) {
    fmt::print(stderr, "{}: {} tetrahedra, {} points, dihedral angles {:.2f} to {:.2f} degrees, volume {:.6g} mm^3\n",
               out, t->elements, t->points, t->min_dihedral_degrees, t->max_dihedral_degrees, t->volume);
  } else {
    fmt::print(stderr, "{}: {} x {} x {}, {} file{}\n", out, r.cells[0], r.cells[1], r.cells[2], r.files,
               r.files == 1 ? "" : "s");
  }
  fmt::print(stderr, "{} bytes, {:.3f} s\n", r.bytes, r.seconds);
}

}  // namespace

void add_volume_flags(CLI::App& flags, operations::VolumeOptions& options) {
  const auto last = [](CLI::Option* option) { option->multi_option_policy(CLI::MultiOptionPolicy::TakeLast); };
  last(flags.add_option("--elements", options.elements, "About so many tetrahedra (.vtu .msh .inp)"));
  last(flags.add_option("--slices", options.slices, "axis=z and one of step=LENGTH, at=LENGTH, count=N (.svg .png)"));
  last(flags.add_option("--voxels", options.voxels, "occupancy, density or distance (.nrrd .vti .h5)"));
  last(flags.add_option("--subsamples", options.subsamples, "Samples along each axis of a voxel or pixel"));
}

int finish_volume(Run& run, const std::optional<operations::VolumeReport>& report, const std::string& out) {
  if (!report) return run.finish(Json{{"output", out}});
  if (run.flags.json) return run.finish(report_json(*report, out));
  const int code = run.finish();
  print_summary(*report, out);
  return code;
}

int sdf_volume(Run& run, const sdf::Program& program, const operations::VolumeOptions& options) {
  return finish_volume(run, operations::run_volume(program, options, run.sink), program.output);
}

}  // namespace meso::cli
