// SPDX-License-Identifier: Apache-2.0
#include "meso/implicit/voxels.hpp"

#include <cassert>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "meso/implicit/sampled_row.hpp"
#include "meso/implicit/threads.hpp"

namespace meso::implicit {
namespace {

constexpr std::int32_t planes_at_a_time = 16;

constexpr std::string_view name_of(VoxelValue value) {
  constexpr std::array<std::string_view, 4> names{"occupancy", "density", "grey", "distance"};
  return names[static_cast<std::size_t>(value)];
}

VoxelArray array_of(const VoxelGrid& voxels, VoxelValue value) {
  VoxelArray array{
      .origin = voxels.box.min,
      .type = value == VoxelValue::density || value == VoxelValue::distance ? VoxelType::float32 : VoxelType::uint8,
      .name = name_of(value)};
  for (std::size_t a = 0; a < 3; ++a) {
    array.cells[a] = static_cast<std::uint32_t>(voxels.cells[a]);
    array.spacing[a] = (voxels.box.max[a] - voxels.box.min[a]) / voxels.cells[a];
  }
  return array;
}

/// One plane of voxels at a time, for one thread.
class Plane {
 public:
  Plane(const GridSource& source, const VoxelGrid& voxels, VoxelValue value)
      : grid_(source.grid()), voxels_(voxels), value_(value), sampler_(source.sampler()), row_(grid_.nodes[0]) {}

  void make(std::int32_t plane, char* out) {
    if (value_ == VoxelValue::distance) return distances(plane, out);
    const auto [nx, ny, nz] = voxels_.cells;
    const auto [mx, my, mz] = voxels_.subsamples;
    counts_.assign(static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny), 0);
    sampler_->begin_slab(plane * mz, (plane + 1) * mz);
    for (std::int32_t k = plane * mz; k < (plane + 1) * mz; ++k)
      for (std::int32_t j = 0; j < ny * my; ++j) {
        row_.sample(*sampler_, j, k);
        std::int32_t* count = counts_.data() + static_cast<std::size_t>(j / my) * static_cast<std::size_t>(nx);
        for (std::int32_t i = 0; i < nx; ++i) count[i] += row_.count_inside(i * mx, mx);
      }
    encode(mx * my * mz, out);
  }

 private:
  void encode(std::int32_t whole, char* out) const {
    for (const std::int32_t count : counts_) {
      if (value_ == VoxelValue::density) {
        const float share = static_cast<float>(count) / static_cast<float>(whole);
        std::memcpy(out, &share, sizeof share);
        out += sizeof share;
      } else {
        *out++ = static_cast<char>(value_ == VoxelValue::occupancy ? (2 * count > whole ? 1 : 0)
                                                                   : (510 * count + whole) / (2 * whole));
      }
    }
  }

  void distances(std::int32_t k, char* out) {
    const auto nx = static_cast<std::size_t>(voxels_.cells[0]);
    points_.resize(nx);
    values_.resize(nx);
    sampler_->begin_slab(k, k + 1);
    for (std::int32_t j = 0; j < voxels_.cells[1]; ++j) {
      for (std::size_t i = 0; i < nx; ++i) points_[i] = grid_.node(static_cast<std::int32_t>(i), j, k);
      sampler_->values_at(points_, values_.data());
      for (const double v : values_) {
        const auto rounded = static_cast<float>(v);
        std::memcpy(out, &rounded, sizeof rounded);
        out += sizeof rounded;
      }
    }
  }

  const Grid& grid_;
  const VoxelGrid& voxels_;
  VoxelValue value_;
  std::unique_ptr<GridSampler> sampler_;
  SampledRow row_;
  std::vector<std::int32_t> counts_;
  std::vector<Vec3> points_;
  std::vector<double> values_;
};

}  // namespace

Grid VoxelGrid::samples() const {
  Grid grid{.box = box};
  for (std::size_t a = 0; a < 3; ++a) {
    const std::int32_t n = cells[a] * subsamples[a];
    const double half = (box.max[a] - box.min[a]) / n / 2;
    grid.nodes[a] = std::max(n, 2);
    grid.box.min[a] = box.min[a] + half;
    if (n > 1) grid.box.max[a] = box.max[a] - half;
  }
  return grid;
}

bool sample_voxels(const GridSource& source, const VoxelGrid& voxels, VoxelValue value, VoxelSink& sink,
                   const RunOptions& run, DiagnosticSink& diagnostics) {
  assert(value != VoxelValue::distance || voxels.subsamples == (std::array<std::int32_t, 3>{1, 1, 1}));
  const VoxelArray array = array_of(voxels, value);
  const std::uint64_t per_plane = array.plane_bytes() + 8 * std::uint64_t{array.cells[0]} * array.cells[1];
  if (!fits_memory(source.grid(), per_plane * planes_at_a_time, "planes of voxels", run, diagnostics)) return false;
  if (!sink.begin(array)) return false;
  Threads threads(run);
  std::vector<char> bytes(array.plane_bytes() * planes_at_a_time);
  for (std::int32_t first = 0; first < voxels.cells[2]; first += planes_at_a_time) {
    const auto count = static_cast<std::size_t>(std::min(planes_at_a_time, voxels.cells[2] - first));
    const bool whole = threads.ranges("voxels", count, 1, [&](std::size_t p, std::size_t) {
      Plane(source, voxels, value).make(first + static_cast<std::int32_t>(p), bytes.data() + p * array.plane_bytes());
    });
    if (!whole || !threads.go_on()) {
      threads.report_stop(diagnostics);
      return false;
    }
    for (std::size_t p = 0; p < count; ++p)
      if (!sink.write_plane({bytes.data() + p * array.plane_bytes(), array.plane_bytes()})) return false;
  }
  return sink.finish();
}

}  // namespace meso::implicit
