// SPDX-License-Identifier: Apache-2.0
#pragma once
// Where the solid has sharp edges and corners: extended marching cubes (Kobbelt, Botsch, Schwanecke, Seidel 2001).
//
// Where the normals at a loop's crossed edges spread, the loop's sheets of surface meet: the vertex goes where their
// tangent planes do. Tangent planes of curved sheets are only good near where they touch; so they are taken anew ever
// closer to the vertex, which converges with the square of that distance. Only where the sheets still meet at an angle
// in the end is there an edge: on a round strut of a few samples across they do not, and marching cubes' triangles
// stay.

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "brick_crossings.hpp"
#include "brick_record.hpp"
#include "case_table.hpp"
#include "meso/implicit/grid_source.hpp"
#include "plane_fit.hpp"

namespace meso::implicit {

/// One per thread.
class FeatureFinder {
 public:
  FeatureFinder(const Layout& layout, const Grid& grid) : layout_(layout), grid_(grid) {}

  struct Found {
    Feature feature;
    Vec3 position;
  };
  /// Of the cells whose upper planes are [first, last); `points` are the crossings, `joined` those cells of the brick.
  /// `go_on` is asked within long work: false ends it.
  [[nodiscard]] const std::vector<Found>& find(BrickCrossings& crossings, std::span<const Vec3> points,
                                               std::size_t first, std::size_t last, std::span<const JoinedCell> joined,
                                               GridSampler& sampler, const std::function<bool()>& go_on);

  /// Of those that were found last.
  [[nodiscard]] const std::vector<BorderSide>& borders() const { return borders_; }

  [[nodiscard]] std::uint64_t bytes() const {
    return planes_.capacity() * sizeof planes_[0] + found_.capacity() * sizeof found_[0];
  }

 private:
  struct Candidate {
    Feature feature;
    std::uint8_t size = 0;
    std::array<std::uint32_t, 12> points{};
    std::array<std::uint8_t, 12> edges{}, side_faces{};  ///< of each point; through which the side after it runs
    Vec3 middle, position;
    double moved = 0, off = 0;  ///< in the last round, and the largest distance from a plane after it
    bool sharp = true;
  };

  void take_planes(std::span<const Vec3> at, double step, GridSampler& sampler, const std::function<bool()>& go_on,
                   std::vector<Plane>& planes);
  void look_at_row(BrickCrossings& crossings, std::span<const Vec3> points, std::size_t j, std::size_t k,
                   std::uint32_t row, std::span<const JoinedCell> joined);
  void look_at_loop(const CellLoop& loop, const BrickCrossings& crossings, std::span<const Vec3> points,
                    std::uint32_t row, std::size_t cell);
  void approach(std::span<const Vec3> points, double share, GridSampler& sampler, const std::function<bool()>& go_on);
  [[nodiscard]] bool within_reach(const Candidate& c) const;
  // turned_triangles.cpp
  struct Side;
  [[nodiscard]] bool goes_on_through(const Candidate& c, std::size_t side) const {
    return (c.feature.faces >> c.side_faces[side] & 1U) != 0;
  }
  [[nodiscard]] bool leads_out(const Candidate& c, std::size_t side, std::size_t first, std::size_t last) const;
  void keep_borders(std::span<const Vec3> points, std::size_t first, std::size_t last);
  [[nodiscard]] bool has_whole_face(const Candidate& c, std::size_t side) const;
  [[nodiscard]] bool turns_a_triangle(std::size_t candidate, std::span<const Vec3> points, std::span<const Side> sides,
                                      std::size_t first, std::size_t last) const;
  void reject_turning(std::span<const Vec3> points, std::size_t first, std::size_t last);

  const Layout& layout_;
  const Grid& grid_;
  const CaseTable& table_ = CaseTable::get();
  std::vector<Plane> planes_, near_planes_;  // at the crossings; beside candidates
  std::vector<Vec3> asked_, near_;
  std::vector<double> values_;
  std::vector<std::uint16_t> cells_;
  std::vector<Candidate> candidates_;
  std::vector<Found> found_;
  std::vector<BorderSide> borders_;
};

}  // namespace meso::implicit
