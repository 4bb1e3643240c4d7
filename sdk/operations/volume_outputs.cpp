// SPDX-License-Identifier: Apache-2.0
#include "meso/operations/volume_outputs.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <system_error>

#include "meso/export_tetra_mesh/write_tet_mesh.hpp"
#include "meso/implicit/stuffing.hpp"
#include "meso/import_surface_mesh/read_surface_mesh.hpp"
#include "meso/mesh_distance/mesh_field.hpp"
#include "meso/sdf/build_field.hpp"
#include "stopwatch.hpp"
#include "volume_job.hpp"

namespace meso::operations {
namespace {

bool is_one_of(const std::string& extension, std::initializer_list<const char*> some) {
  return std::find(some.begin(), some.end(), extension) != some.end();
}
bool is_tetrahedra(const std::string& e) { return is_one_of(e, {".vtu", ".msh", ".inp"}); }
bool is_voxels(const std::string& e) { return is_one_of(e, {".nrrd", ".vti", ".h5", ".hdf5"}); }
bool is_slices(const std::string& e) { return is_one_of(e, {".svg", ".png"}); }

/// Twelve tetrahedra a cube, and a share of the surface that a coarse mesh shows.
std::optional<double> spacing_for(double elements, const VolumeJob& job) {
  const Vec3 size = job.box.max - job.box.min;
  const implicit::BccLattice lattice = implicit::bcc_lattice(job.box, std::cbrt(size.x * size.y * size.z) / 32);
  const auto corners = job.source(job.field, lattice.corners), centres = job.source(job.field, lattice.centres);
  if (!corners || !centres) return std::nullopt;
  RunOptions run = job.options.run;
  run.progress = nullptr;  // it would begin anew
  const auto mesh = implicit::stuff(lattice, *corners, *centres, run, job.sink);
  if (!mesh) return std::nullopt;
  const double h = lattice.spacing, volume = implicit::tet_quality(*mesh).volume;
  if (mesh->tets.empty()) return h;
  const double surface = static_cast<double>(mesh->tets.size()) * h * h - 12 * volume / h;
  double low = h * 1e-3, high = h * 32;  // more elements at the low end
  for (int i = 0; i < 60; ++i) {
    const double s = std::sqrt(low * high);
    (12 * volume / (s * s * s) + surface / (s * s) > elements ? low : high) = s;
  }
  return low;
}

double spacing_of_samples(const VolumeJob& job) {
  const implicit::Grid grid{.box = job.box, .nodes = job.samples};
  return std::cbrt(grid.spacing(0) * grid.spacing(1) * grid.spacing(2));
}

}  // namespace

bool write_tetrahedra(VolumeJob& job) {
  const auto spacing = job.options.elements ? spacing_for(*job.options.elements, job) : spacing_of_samples(job);
  if (!spacing) return false;
  const implicit::BccLattice lattice = implicit::bcc_lattice(job.box, *spacing);
  const auto corners = job.source(job.field, lattice.corners), centres = job.source(job.field, lattice.centres);
  if (!corners || !centres) return false;
  const auto mesh = implicit::stuff(lattice, *corners, *centres, job.options.run, job.sink);
  if (!mesh) return false;
  const TetFormat format = job.options.ascii ? TetFormat::vtu_ascii : *tet_format_of(job.path);
  auto file = OutputFile::create(job.path, job.options.existing, job.sink);
  if (!file) return false;
  const std::size_t errors = job.sink.error_count();
  const bool written = write_tet_mesh(*mesh, format, *file, job.options.run, job.sink);
  if (job.sink.error_count() > errors || !file->commit(job.sink) || !written) return false;
  const implicit::TetQuality quality = implicit::tet_quality(*mesh);
  constexpr double degree = std::numbers::pi / 180;
  job.report.tetrahedra = {.elements = mesh->tets.size(),
                           .points = mesh->points.size(),
                           .spacing = lattice.spacing,
                           .volume = quality.volume,
                           .min_dihedral_degrees = quality.min_dihedral / degree,
                           .max_dihedral_degrees = quality.max_dihedral / degree};
  job.report.cells = lattice.cells;
  if (mesh->tets.empty()) job.sink.report({.code = Code::sdf_empty, .args = {job.path}});
  return true;
}

bool is_volume_output(const std::string& path) {
  const std::string extension = lower_extension(path);
  return is_tetrahedra(extension) || is_voxels(extension) || is_slices(extension);
}

bool check_volume_options(const std::string& path, const VolumeOptions& o, DiagnosticSink& sink) {
  const std::string extension = lower_extension(path);
  const auto refuse = [&](const char* why) {
    sink.report({.code = Code::usage, .args = {why}});
    return false;
  };
  if (o.elements && !is_tetrahedra(extension)) return refuse("--elements has an effect for .vtu, .msh and .inp only");
  if (o.elements && !(*o.elements >= 1 && *o.elements <= 1e9)) return refuse("--elements takes a number from 1 to 1e9");
  if (o.slices && !is_slices(extension)) return refuse("--slices has an effect for .svg and .png only");
  if (o.voxels && !is_voxels(extension)) return refuse("--voxels has an effect for .nrrd, .vti and .h5 only");
  if (o.voxels && !is_one_of(*o.voxels, {"occupancy", "density", "distance"}))
    return refuse("--voxels takes occupancy, density or distance");
  if (o.subsamples && !is_voxels(extension) && extension != ".png")
    return refuse("--subsamples has an effect for .nrrd, .vti, .h5 and .png only");
  if (o.subsamples && (*o.subsamples < 1 || *o.subsamples > 64))
    return refuse("--subsamples takes a number from 1 to 64");
  if (o.subsamples && o.voxels == "distance") return refuse("--subsamples has no effect on --voxels distance");
  if (o.ascii && extension != ".vtu") return refuse("--ascii has an effect for .stl and .vtu only");
  return true;
}

std::optional<VolumeReport> run_volume(const sdf::Program& program, const VolumeOptions& options,
                                       DiagnosticSink& sink) {
  Stopwatch watch;
  const std::string extension = lower_extension(program.output);
  if (!check_volume_options(program.output, options, sink)) return std::nullopt;
  const auto load = [&](const std::string& path,
                        DiagnosticSink& told) -> std::shared_ptr<const implicit::ExternalField> {
    const auto mesh = read_surface_mesh_file(path, told, options.run);
    return mesh ? implicit::MeshField::make(*mesh, path, options.run, told) : nullptr;
  };
  const auto field = sdf::build_field(program, load, sink);
  if (!field) return std::nullopt;
  const auto box = sdf::box_of(program, *field, sink);
  if (!box) return std::nullopt;
  VolumeJob job{.path = program.output, .options = options, .field = *field, .box = box->box, .sink = sink};
  if (program.samples.size() == 1) {
    job.samples = implicit::nodes_for_total(job.box, program.samples[0]);
  } else {
    for (std::size_t i = 0; i < 3; ++i) job.samples[i] = static_cast<std::int32_t>(program.samples[i]);
  }
  const bool written = is_tetrahedra(extension) ? write_tetrahedra(job)
                       : is_voxels(extension)   ? write_voxels(job)
                                                : write_slices(job);
  if (!written) return std::nullopt;
  std::error_code error;
  if (job.report.bytes == 0) job.report.bytes = std::filesystem::file_size(program.output, error);
  if (error) job.report.bytes = 0;
  job.report.seconds = watch.total();
  return job.report;
}

}  // namespace meso::operations
