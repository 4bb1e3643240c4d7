// SPDX-License-Identifier: Apache-2.0
#pragma once
// Halves edges of a mesh where it is too far from the surface of its field, until it is not.
//
// The distance is measured in edges and triangles, at more places where there may be creases between. An edge that is
// too far gets a vertex on the surface; both of its triangles are cut there, so the mesh stays closed and a manifold
// whatever happens. The distance of an edge goes with the square of its length, so triangles multiply about as distance
// over tolerance.
//
// Of a smooth surface, the normals at an edge's ends tell its distance: by an eighth of what they turn along it. Asked
// is only where that is near the tolerance; and, in the end, at a few of the others.

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "meso/base/triangle_mesh.hpp"
#include "surface_feet.hpp"

namespace meso::implicit {

/// What is asked of a point takes more memory than a triangle: so many points at a time.
inline constexpr std::size_t asked_at_once = 1 << 14;

/// How many triangles one becomes that is so many times as far as it may be: halves are a quarter as far, or a
/// sixteenth, so most are nearer than is asked in the end.
[[nodiscard]] inline double parts_for(double times) { return times > 1 ? 1.8 * times : 1; }

/// Points that no triangle has.
void drop_unused_points(TriangleMesh& mesh);

/// Triangles of a mesh with what is known of them.
class RefinableMesh {
 public:
  /// `smooth`: the surface has no edges, and the mesh is about as fine as its curves. Where points are `marked`, the
  /// field is asked at those alone and at their neighbours: see take_as_known.
  RefinableMesh(TriangleMesh mesh, const Box3& box, SurfaceFeet& feet, bool smooth, std::span<const char> marked = {});

  /// Only what is between marked points is measured.
  void take_as_known(std::span<const char> marked);
  /// Edges between marked points count as too far.
  void take_as_far(std::span<const char> marked, double tolerance);
  /// Moves vertices that are farther than a tenth of `tolerance` onto the surface.
  void move_vertices(double tolerance);
  /// Measures how far vertices are that are not on the surface.
  void measure_points(double tolerance);
  /// Measures what is not known yet; distances that are not near `tolerance` are told roughly.
  void measure(double tolerance);
  /// Measures how far creases are from the mesh, where the mesh is within `tolerance`; call measure() before.
  void measure_creases(double tolerance);
  /// Halves the edges whose distance is more; returns how many. Call measure() before.
  std::size_t refine(double tolerance);
  /// Edges whose distance is more get the other diagonal of their two triangles in their place, where that is near.
  void flip(double tolerance);
  /// Collapses edges of which nothing is left: of vertices that went to the same corner, one stays. Call measure()
  /// after.
  void merge(double tolerance);
  /// Asks at some of the places whose distance was told by normals; true: no more of them was told wrongly than
  /// `tolerance` allows. Else all of them are forgotten, and from now on everything is measured.
  [[nodiscard]] bool normals_were_right(double tolerance);

  /// Marks which of `points` are within `reach` of what is farther than `tolerance`.
  void mark_around_far(double tolerance, double reach, std::span<const Vec3> points, std::span<char> marks) const;

  /// What is farther.
  struct Far {
    std::size_t triangles = 0;
    Vec3 place;  ///< a corner of the farthest
  };
  [[nodiscard]] Far what_is_far(double tolerance) const;
  /// The largest distance that was measured or told.
  [[nodiscard]] double distance() const;
  /// About how many triangles refining to `tolerance` takes.
  [[nodiscard]] double triangles_for(double tolerance) const;
  /// About how many would do if none were finer than it asks for.
  [[nodiscard]] double triangles_for_curves(double tolerance) const;

  /// Whether the last refine() came as far as to creases that the mesh cut off.
  [[nodiscard]] bool found_creases() const { return !missed_.empty(); }

  [[nodiscard]] const TriangleMesh& mesh() const { return mesh_; }
  /// Without points that no triangle has. Ends the use of this.
  [[nodiscard]] TriangleMesh take();

  static constexpr std::uint64_t bytes_per_triangle = 160;

 private:
  void look_around(std::span<const char> marked);
  static constexpr float unknown = std::numeric_limits<float>::infinity();
  /// Distances are negative where the middle is inside.
  struct Known {
    std::array<float, 3> edge{unknown, unknown, unknown};  ///< of the edge after each corner
    float middle = unknown;
    std::array<std::uint8_t, 3> farthest_at{4, 4, 4};  ///< eighths of each edge, from its lower end
  };
  /// A curve over its chord: its height over the middle, and what an S adds over the quarters.
  struct Bend {
    double middle = 0, quarters = 0;
    [[nodiscard]] double farthest() const {
      return std::copysign(std::max(std::fabs(middle), 0.75 * std::fabs(middle) + quarters), middle);
    }
  };
  struct Edge {
    std::uint32_t a, b;  ///< a < b
    std::uint32_t triangle;
    std::uint8_t side;
    friend auto operator<=>(const Edge&, const Edge&) = default;  // NOLINT(modernize-use-nullptr): there is no pointer
  };

  using Ends = std::array<std::uint32_t, 2>;
  struct Cut {
    Edge edge;
    float distance;
    double share = 0.5;                       ///< of b, where it is farthest
    std::array<std::uint32_t, 2> opposite{};  ///< corners of the edge's triangles
    bool operator<(const Cut& c) const { return edge < c.edge; }
    bool operator==(const Cut& c) const { return edge == c.edge; }
  };

  /// A crease that is too far from the mesh, and the edge beside it: it was looked for between
  /// two points.
  struct Missed {
    Edge edge, other;  ///< of one triangle and the other
    std::array<std::uint32_t, 2> sheets{};
    std::array<std::uint32_t, 4> around{};
    Vec3 place{};
  };

  /// Of the tolerance: a point that is no farther is used.
  static constexpr double near_surface = 0.3;

  [[nodiscard]] static float farthest(const Known& known);
  /// Its corners included.
  [[nodiscard]] double distance_of(std::uint32_t triangle) const;
  [[nodiscard]] Edge edge_of(std::uint32_t triangle, std::size_t side) const;
  static void sort_cuts(std::vector<Cut>& cuts);
  void collect(double tolerance, std::vector<Cut>& cuts, std::vector<std::uint32_t>& bridges) const;
  void move_onto_surface(std::span<const std::size_t> which, double tolerance);
  void measure_edges(double tolerance);
  void measure_along(std::span<const Edge> edges, std::span<const std::uint32_t> pairs, double tolerance);
  void measure_middles(double tolerance);
  void measure_within(std::span<const std::uint32_t> triangles, double tolerance);
  [[nodiscard]] double tangents_leave(std::uint32_t a, std::uint32_t b) const;
  void ask(std::span<const PointNearSurface> points, double tolerance, std::vector<double>& distances);
  // merge_points.cpp
  [[nodiscard]] std::vector<Ends> coincident(std::size_t first, double distance) const;
  // place_points.cpp
  struct Flip;
  [[nodiscard]] bool was_halved_at(std::uint32_t point, Ends ends) const;
  [[nodiscard]] std::vector<Flip> possible_flips(double tolerance) const;
  template <class Points>
  void keep_near(std::vector<Flip>& flips, double tolerance, Points points_of);
  void turn(const Flip& flip);
  [[nodiscard]] bool is_bridge(std::uint32_t triangle) const;
  void divide(std::span<const std::uint32_t> triangles, double tolerance);
  void take_gradients(std::span<const Foot> feet, std::vector<Vec3>& gradients);
  void mend_feet(std::span<const PointNearSurface> from, std::span<Foot> feet, double tolerance);
  void add_points(std::span<const PointNearSurface> from, std::span<Foot> feet, double tolerance);
  void measure_new_points(std::size_t first, std::span<const Vec3> ways, double tolerance);
  [[nodiscard]] bool is_beside_end(const Cut& cut, Vec3 place) const;
  [[nodiscard]] bool goes_through(const Edge& edge) const;
  [[nodiscard]] bool is_taken(const Cut& cut, Vec3 place) const;
  [[nodiscard]] bool is_poor(const Cut& cut, const Foot& foot) const;
  void look_ahead(std::span<const Cut> cuts, std::span<const PointNearSurface> middles, double tolerance,
                  std::span<Foot> feet);
  void look_for_creases(std::span<const Cut> cuts, std::span<const PointNearSurface> middles, double tolerance,
                        std::span<const char> poor, std::span<Foot> feet);
  // missed_creases.cpp
  [[nodiscard]] std::vector<Missed> possibly_missed(double tolerance) const;
  void use_missed_creases(std::span<const Cut> cuts, std::span<const PointNearSurface> middles,
                          std::span<Foot> feet) const;

  void place(std::span<const Cut> cuts, std::span<const PointNearSurface> middles, double tolerance);

  [[nodiscard]] Vec3 normal_of(std::uint32_t triangle) const;
  [[nodiscard]] bool turns_evenly(std::uint32_t a, std::uint32_t b) const;
  [[nodiscard]] Bend bend_along(std::uint32_t a, std::uint32_t b) const;
  [[nodiscard]] unsigned plane_of_triangle(std::uint32_t triangle) const;
  [[nodiscard]] PointNearSurface middle_of(std::uint32_t a, std::uint32_t b) const { return between(a, b, 0.5); }
  [[nodiscard]] PointNearSurface middle_of(std::uint32_t triangle) const {
    return between(triangle, Vec3{1, 1, 1} / 3);
  }
  [[nodiscard]] PointNearSurface between(std::uint32_t a, std::uint32_t b, double share_of_b) const;
  [[nodiscard]] PointNearSurface between(std::uint32_t triangle, Vec3 shares) const;
  void split(std::uint32_t triangle, const std::array<std::uint32_t, 3>& middles);

  TriangleMesh mesh_;
  Box3 box_;
  SurfaceFeet& feet_;
  bool smooth_;
  std::vector<Known> known_;
  std::vector<unsigned> planes_;  // of points
  std::vector<Vec3> gradients_;   // at points
  std::vector<double> values_;    // at the points of the mesh that was given
  std::vector<Missed> missed_;    // by edge
  std::size_t points_before_;     // of the mesh that was given
  std::vector<Ends> halved_;      // the edges that points were put on; of the later points
  std::vector<float> distances_;  // of points, in the planes of the box that they are on
};

}  // namespace meso::implicit
