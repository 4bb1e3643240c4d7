// SPDX-License-Identifier: Apache-2.0
// The gyroid over [-1,1]^3 by OpenVDB alone: dense samples from tables written by hand, a narrow-band level set of
// them, its triangles and quadrilaterals, and these as binary PLY.
//
//   meso_bench_peer_openvdb 400 1 gyroid.ply     samples along each axis, threads, output
//   prints {"triangles": ..., "fillSeconds": ..., "gridSeconds": ..., "contourSeconds": ..., "writeSeconds": ...}
//
// A quadrilateral counts as two triangles. One layer of outside samples around the box closes the surface there.
#include <openvdb/openvdb.h>
#include <openvdb/tools/Dense.h>
#include <openvdb/tools/Prune.h>
#include <openvdb/tools/SignedFloodFill.h>
#include <openvdb/tools/VolumeToMesh.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <numbers>
#include <string>
#include <vector>

namespace {

constexpr double band_voxels = 3;

struct Tables {
  explicit Tables(int n) : sin(static_cast<std::size_t>(n)), cos(static_cast<std::size_t>(n)) {
    for (int i = 0; i < n; ++i) {
      const double phase = 2 * std::numbers::pi * (-1 + 2.0 * i / (n - 1));
      sin[static_cast<std::size_t>(i)] = std::sin(phase);
      cos[static_cast<std::size_t>(i)] = std::cos(phase);
    }
  }
  std::vector<double> sin, cos;
};

/// f / |grad f|, a distance to first order, within the band. A level set wants distances.
float distance(const Tables& t, std::size_t i, std::size_t j, std::size_t k, double band) {
  const double cx = t.cos[i], cy = t.cos[j], cz = t.cos[k], sx = t.sin[i], sy = t.sin[j], sz = t.sin[k];
  const double f = cx * sy + cy * sz + cz * sx;
  const double gx = cz * cx - sx * sy, gy = cx * cy - sy * sz, gz = cy * cz - sz * sx;
  const double slope = 2 * std::numbers::pi * std::sqrt(gx * gx + gy * gy + gz * gz);
  const double d = slope * band > std::abs(f) ? f / slope : std::copysign(band, f);
  return static_cast<float>(d);
}

bool write_ply(const char* path, const std::vector<openvdb::Vec3s>& points,
               const std::vector<openvdb::Vec3I>& triangles, const std::vector<openvdb::Vec4I>& quads) {
  std::FILE* file = std::fopen(path, "wb");
  if (file == nullptr) return false;
  std::fprintf(file,
               "ply\nformat binary_little_endian 1.0\nelement vertex %zu\nproperty float x\nproperty float y\n"
               "property float z\nelement face %zu\nproperty list uchar int vertex_indices\nend_header\n",
               points.size(), triangles.size() + quads.size());
  std::fwrite(points.data(), sizeof(openvdb::Vec3s), points.size(), file);
  std::string faces;
  const auto add = [&](const auto& list, unsigned char corners) {
    for (const auto& face : list) {
      faces += static_cast<char>(corners);
      faces.append(reinterpret_cast<const char*>(face.asPointer()), 4u * corners);
      if (faces.size() < (1u << 18)) continue;
      std::fwrite(faces.data(), 1, faces.size(), file);
      faces.clear();
    }
  };
  add(triangles, 3);
  add(quads, 4);
  std::fwrite(faces.data(), 1, faces.size(), file);
  return std::fclose(file) == 0;
}

double seconds_since(std::chrono::steady_clock::time_point& begin) {
  const auto now = std::chrono::steady_clock::now();
  const double seconds = std::chrono::duration<double>(now - begin).count();
  begin = now;
  return seconds;
}

}  // namespace

int main(int argc, char** argv) {
  const int n = argc > 1 ? std::atoi(argv[1]) : 100;
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(argc > 2 ? std::atoi(argv[2]) : 1));
  openvdb::initialize();
  auto clock = std::chrono::steady_clock::now();
  const double h = 2.0 / (n - 1), band = band_voxels * h;
  const Tables tables(n);
  openvdb::tools::Dense<float, openvdb::tools::LayoutXYZ> dense(
      openvdb::CoordBBox(openvdb::Coord(-1), openvdb::Coord(n)), static_cast<float>(band));
  tbb::parallel_for(0, n, [&](int k) {
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        dense.setValue(openvdb::Coord(i, j, k),
                       distance(tables, static_cast<std::size_t>(i), static_cast<std::size_t>(j),
                                static_cast<std::size_t>(k), band));
  });
  const double fill_seconds = seconds_since(clock);

  const auto grid = openvdb::createLevelSet<openvdb::FloatGrid>(h, band_voxels);
  openvdb::tools::copyFromDense(dense, *grid, 0.0f);
  openvdb::tools::pruneLevelSet(grid->tree());
  openvdb::tools::signedFloodFill(grid->tree());
  const double grid_seconds = seconds_since(clock);

  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(*grid, points, triangles, quads);
  for (auto& point : points) point -= openvdb::Vec3s(1, 1, 1);
  const double contour_seconds = seconds_since(clock);

  const bool written = write_ply(argc > 3 ? argv[3] : "/dev/null", points, triangles, quads);
  std::printf(
      "{\"triangles\": %zu, \"fillSeconds\": %.3f, \"gridSeconds\": %.3f, \"contourSeconds\": %.3f, "
      "\"writeSeconds\": %.3f}\n",
      triangles.size() + 2 * quads.size(), fill_seconds, grid_seconds, contour_seconds, seconds_since(clock));
  return written ? 0 : 1;
}
