// SPDX-License-Identifier: Apache-2.0
#pragma once
// A program of the command language (docs/sdf.md) carried out as a volume: tetrahedra, voxels or slices, by the
// output's extension.
//
//   run_volume(*sdf::parse_program(words, ...), {.elements = 1e6}, sink);   // -o part.vtu
//
//   .vtu .msh .inp     tetrahedra      (VolumeOptions::elements, else the spacing of the program's samples)
//   .nrrd .vti .h5     voxels          (as many as samples; VolumeOptions::voxels, subsamples)
//   .svg .png          slices          (VolumeOptions::slices; several are part_0001.png, part_0002.png, ...)
//
// Each file appears whole or not at all. An empty solid is a file without content, and SDF_EMPTY. Options that do not
// belong to the output are USAGE. Thread rule: as run_sdf().

#include <array>
#include <optional>
#include <string>

#include "meso/base/output_file.hpp"
#include "meso/base/run_options.hpp"
#include "meso/implicit/field.hpp"
#include "meso/sdf/program.hpp"

namespace meso::operations {

[[nodiscard]] bool is_volume_output(const std::string& path);
[[nodiscard]] bool is_tetrahedra_output(const std::string& path);

struct VolumeOptions {
  std::optional<double> elements{};     ///< about so many tetrahedra
  std::optional<std::string> slices{};  ///< "axis=z,step=0.1", "axis=x,at=2.5", "count=100"
  std::optional<std::string> voxels{};  ///< "occupancy" (as if absent), "density", "distance"
  std::optional<int> subsamples{};      ///< along each axis of a voxel or pixel; 4 for density and pictures, else 1
  bool strict_math = false;             ///< formulas as written
  bool ascii = false;                   ///< of .vtu
  ExistingFile existing = ExistingFile::replace;
  RunOptions run{};
};

/// Whether all options that are given have an effect on that output. Also for outputs that are no volume.
[[nodiscard]] bool check_volume_options(const std::string& path, const VolumeOptions& options, DiagnosticSink& sink);

struct VolumeReport {
  struct Tetrahedra {
    std::uint64_t elements = 0, points = 0;
    double spacing = 0, volume = 0;  ///< mm, mm^3
    double min_dihedral_degrees = 0, max_dihedral_degrees = 0;
  };
  std::optional<Tetrahedra> tetrahedra{};
  std::array<std::int32_t, 3> cells{};  ///< voxels; of slices, pixels or samples, and slices
  std::uint64_t files = 1, bytes = 0;
  double seconds = 0;
};

/// What is sampled: a field, in a box, by so many samples along its axes.
struct VolumeSource {
  implicit::Field field;
  Box3 box;
  std::array<std::int32_t, 3> samples{};
  const sdf::Program* words = nullptr;  ///< that the field was made from, if it was: for warnings
};
/// `options` were checked.
[[nodiscard]] std::optional<VolumeReport> write_volume(const std::string& path, const VolumeSource& from,
                                                       const VolumeOptions& options, DiagnosticSink& sink);

[[nodiscard]] std::optional<VolumeReport> run_volume(const sdf::Program& program, const VolumeOptions& options,
                                                     DiagnosticSink& sink);

}  // namespace meso::operations
