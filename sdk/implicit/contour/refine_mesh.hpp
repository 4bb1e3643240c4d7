// SPDX-License-Identifier: Apache-2.0
#pragma once
// Halves edges of a mesh where it is too far from the surface of its field, until it is not.
//
// The distance is measured in the middles of edges and triangles. An edge that is too far gets a vertex on the surface;
// both of its triangles are cut there, so the mesh stays closed and a manifold whatever happens. The distance of an
// edge goes with the square of its length, so triangles multiply about as distance over tolerance.

#include <functional>

#include "meso/base/triangle_mesh.hpp"
#include "surface_feet.hpp"

namespace meso::implicit {

/// Triangles of a mesh with what is known of them.
class RefinableMesh {
 public:
  RefinableMesh(TriangleMesh mesh, const Box3& box, SurfaceFeet& feet);

  /// Moves vertices that are farther than a tenth of `tolerance` onto the surface.
  void move_vertices(double tolerance);
  /// Measures what is not known yet; distances below `tolerance` are told roughly. False: stopped.
  void measure(double tolerance);
  /// Halves the edges whose distance is more; returns how many. Call measure() before.
  std::size_t refine(double tolerance);

  /// The largest distance that was measured.
  [[nodiscard]] double distance() const;
  /// About how many triangles refining to `tolerance` takes.
  [[nodiscard]] double triangles_for(double tolerance) const;
  /// The share of edges that are further than `distance` from the surface.
  [[nodiscard]] double share_beyond(double distance) const;

  [[nodiscard]] const TriangleMesh& mesh() const { return mesh_; }
  [[nodiscard]] TriangleMesh take() { return std::move(mesh_); }

  static constexpr std::uint64_t bytes_per_triangle = 160;

 private:
  struct Known {
    std::array<float, 3> edge{-1, -1, -1};  ///< distance of the edge after each corner; -1: not measured
    float middle = -1;
  };
  struct Edge {
    std::uint32_t a, b;  ///< a < b
    std::uint32_t triangle;
    std::uint8_t side;
    friend auto operator<=>(const Edge&, const Edge&) = default;
  };

  void measure_edges(double tolerance);
  void measure_middles(double tolerance);
  [[nodiscard]] unsigned plane_of_triangle(std::uint32_t triangle) const;
  [[nodiscard]] PointNearSurface middle_of(std::uint32_t a, std::uint32_t b) const;
  void split(std::uint32_t triangle, const std::array<std::uint32_t, 3>& middles);

  TriangleMesh mesh_;
  Box3 box_;
  SurfaceFeet& feet_;
  std::vector<Known> known_;
  std::vector<unsigned> planes_;  // of points
  std::vector<double> slopes_;    // of points
  std::vector<float> distances_;  // of points; 0 on the box's planes
};

}  // namespace meso::implicit
