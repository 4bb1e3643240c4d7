// SPDX-License-Identifier: Apache-2.0
#include "meso/operations/volume_outputs.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <system_error>

#include "mesh_warnings.hpp"
#include "meso/base/number.hpp"
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

struct SizedMesh {
  implicit::BccLattice lattice;
  TetMesh mesh;
};

/// Of a part that fills its box, the box's sides are where the field is zero, which is not inside. A little within,
/// they are cuts through the part.
Box3 a_little_within(const Box3& box) {
  constexpr double little = 1e-9;
  Box3 result = box;
  for (std::size_t a = 0; a < 3; ++a) {
    result.min[a] += little * (box.max[a] - box.min[a]);
    result.max[a] -= little * (box.max[a] - box.min[a]);
  }
  return result;
}

void move_sides(TetMesh& mesh, const Box3& from, const Box3& to) {
  for (Vec3& p : mesh.points)
    for (std::size_t a = 0; a < 3; ++a) {
      if (p[a] == from.min[a]) p[a] = to.min[a];
      if (p[a] == from.max[a]) p[a] = to.max[a];
    }
}

std::optional<SizedMesh> mesh_at(double spacing, const VolumeJob& job, const RunOptions& run) {
  const bool is_document = job.words == nullptr;
  const implicit::BccLattice lattice = implicit::bcc_lattice(is_document ? a_little_within(job.box) : job.box, spacing);
  const auto corners = job.source(job.field, lattice.corners), centres = job.source(job.field, lattice.centres);
  if (!corners || !centres) return std::nullopt;
  auto mesh = implicit::stuff(lattice, *corners, *centres, run, job.sink);
  if (!mesh) return std::nullopt;
  move_sides(*mesh, lattice.box, job.box);
  return SizedMesh{lattice, std::move(*mesh)};
}

/// Which spacing gives so many, if a mesh tells: twelve tetrahedra a cube, and a share of the surface.
double spacing_for(double elements, const SizedMesh& seen) {
  const double h = seen.lattice.spacing, volume = implicit::tet_quality(seen.mesh).volume;
  const double surface = std::max(0.0, static_cast<double>(seen.mesh.tets.size()) * h * h - 12 * volume / h);
  double low = h * 1e-3, high = h * 32;  // more elements at the low end
  for (int i = 0; i < 60; ++i) {
    const double s = std::sqrt(low * high);
    (12 * volume / (s * s * s) + surface / (s * s) > elements ? low : high) = s;
  }
  return low;
}

/// A mesh that is too coarse for walls does not tell how much they hold, and lattices of some spacings miss more of
/// them than coarser ones: the spacing is found by steps of at most a half, then between one that gives too few and one
/// that gives too many, until a mesh has about as many elements as are asked for.
std::optional<SizedMesh> mesh_of(double elements, const VolumeJob& job) {
  constexpr int most_steps = 12;
  constexpr double near = 1.25;  // of the number
  const Vec3 size = job.box.max - job.box.min;
  const double volume = size.x * size.y * size.z;
  RunOptions quiet = job.options.run;
  quiet.progress = nullptr;  // it would begin anew
  double spacing = std::cbrt(volume) / std::clamp(std::cbrt(elements / 12), 4.0, 32.0);
  double too_many = 0, too_few = HUGE_VAL;  // spacings
  std::optional<SizedMesh> closest;
  const auto off = [&](const SizedMesh& m) {
    return std::fabs(std::log((static_cast<double>(m.mesh.tets.size()) + 0.5) / elements));
  };
  for (int step = 0; step < most_steps; ++step) {
    auto seen = mesh_at(spacing, job, quiet);
    if (!seen) return std::nullopt;
    const auto count = static_cast<double>(seen->mesh.tets.size());
    double next = count == 0 ? 0 : spacing_for(elements, *seen);
    const double here = off(*seen);
    if (!closest || here < off(*closest)) closest = std::move(seen);
    if (here < std::log(near)) break;
    (count < elements ? too_few : too_many) = spacing;
    // Nothing is there at eight cubes for each element that is asked for: nothing is there, or it takes more elements.
    if (count == 0 && volume / (spacing * spacing * spacing) > 8 * elements) break;
    next = std::max(next, spacing / 2);
    if (too_many > 0 && too_few < HUGE_VAL && !(too_many < next && next < too_few))
      next = std::sqrt(too_many * too_few);
    if (implicit::bcc_lattice(job.box, next).cells == implicit::bcc_lattice(job.box, spacing).cells) break;
    spacing = next;
  }
  return closest;
}

/// Twice the volume over the area that is not in the box's faces, in which cuts count for nothing.
double thickness_of(const TetMesh& mesh, double volume) {
  double area = 0;
  for (const TetMesh::Face& face : mesh.boundary) {
    if (face.side != TetMesh::Side::surface) continue;
    const auto [a, b, c] = mesh.corners(face);
    area += norm(cross(mesh.points[b] - mesh.points[a], mesh.points[c] - mesh.points[a])) / 2;
  }
  return area > 0 ? 2 * volume / area : HUGE_VAL;
}

double spacing_of_samples(const VolumeJob& job) {
  const implicit::Grid grid{.box = job.box, .nodes = job.samples};
  return std::cbrt(grid.spacing(0) * grid.spacing(1) * grid.spacing(2));
}

}  // namespace

bool write_tetrahedra(VolumeJob& job) {
  const auto made = job.options.elements ? mesh_of(*job.options.elements, job)
                                         : mesh_at(spacing_of_samples(job), job, job.options.run);
  if (!made) return false;
  const auto& [lattice, mesh] = *made;
  const TetFormat format = job.options.ascii ? TetFormat::vtu_ascii : *tet_format_of(job.path);
  auto file = OutputFile::create(job.path, job.options.existing, job.sink);
  if (!file) return false;
  const std::size_t errors = job.sink.error_count();
  const bool written = write_tet_mesh(mesh, format, *file, job.options.run, job.sink);
  if (job.sink.error_count() > errors || !file->commit(job.sink) || !written) return false;
  const implicit::TetQuality quality = implicit::tet_quality(mesh);
  constexpr double degree = std::numbers::pi / 180;
  job.report.tetrahedra = {.elements = mesh.tets.size(),
                           .points = mesh.points.size(),
                           .spacing = lattice.spacing,
                           .volume = quality.volume,
                           .min_dihedral_degrees = quality.min_dihedral / degree,
                           .max_dihedral_degrees = quality.max_dihedral / degree};
  job.report.cells = lattice.cells;
  if (mesh.tets.empty()) {
    job.sink.report({.code = Code::sdf_empty, .args = {job.path}});
  } else if (job.words != nullptr && warn_of_period(*job.words, lattice.spacing, job.sink)) {
    // It is not that solid: nothing else counts.
  } else {
    const double elements = static_cast<double>(mesh.tets.size());
    warn_of_thinness(thickness_of(mesh, quality.volume), {elements, lattice.spacing, "elements"}, job.sink);
  }
  return true;
}

bool is_tetrahedra_output(const std::string& path) { return is_tetrahedra(lower_extension(path)); }

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
  std::array<std::int32_t, 3> samples{};
  if (program.samples.size() == 1) {
    samples = implicit::nodes_for_total(box->box, program.samples[0]);
  } else {
    for (std::size_t i = 0; i < 3; ++i) samples[i] = static_cast<std::int32_t>(program.samples[i]);
  }
  return write_volume(program.output, {*field, box->box, samples, &program}, options, sink);
}

std::optional<VolumeReport> write_volume(const std::string& path, const VolumeSource& from,
                                         const VolumeOptions& options, DiagnosticSink& sink) {
  const Stopwatch watch;
  const std::string extension = lower_extension(path);
  VolumeJob job{.path = path,
                .options = options,
                .field = from.field,
                .box = from.box,
                .samples = from.samples,
                .sink = sink,
                .words = from.words};
  const bool written = is_tetrahedra(extension) ? write_tetrahedra(job)
                       : is_voxels(extension)   ? write_voxels(job)
                                                : write_slices(job);
  if (!written) return std::nullopt;
  if (from.words != nullptr && !is_tetrahedra(extension)) warn_of_period(*from.words, spacing_of_samples(job), sink);
  std::error_code error;
  if (job.report.bytes == 0) job.report.bytes = std::filesystem::file_size(path, error);
  if (error) job.report.bytes = 0;
  job.report.seconds = watch.total();
  return job.report;
}

}  // namespace meso::operations
