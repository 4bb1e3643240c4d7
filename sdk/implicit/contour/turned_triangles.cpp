// SPDX-License-Identifier: Apache-2.0
// A vertex on a sharp edge may leave its cell, since the sheets may meet outside of it. Where samples are too far apart
// to tell what meets what, it would turn triangles inside out. There, marching cubes' own triangles stay.

#include <algorithm>
#include <cmath>
#include <compare>
#include <utility>

#include "feature_finder.hpp"

namespace meso::implicit {

/// Of a loop, where its sharp edge goes on into the next cell; there, that cell's loop has the same side backwards.
struct FeatureFinder::Side {
  std::uint32_t from, to;  ///< points
  std::uint32_t candidate, number;
  friend auto operator<=>(const Side&, const Side&) = default;
};

bool FeatureFinder::leads_out(const Candidate& c, std::size_t side, std::size_t first, std::size_t last) const {
  const std::size_t k = first + c.feature.row / (layout_.ny + 1);
  return (c.side_faces[side] == 4 && k == first) || (c.side_faces[side] == 5 && k + 1 == last);
}

// Both bricks ask with the same numbers in the same order, so they agree.
bool joins_well(const BorderSide& lower, const BorderSide& upper, double least) {
  const auto faces = [&](Vec3 a, Vec3 b, Vec3 c, Vec3 normal) { return dot(cross(b - a, c - a), normal) > least; };
  int turned_joined = 0, turned_apart = 0;
  for (const auto& [own, other] : {std::pair(&lower, &upper), std::pair(&upper, &lower)}) {
    turned_joined += faces(own->from, other->vertex, own->vertex, own->normal) ? 0 : 1;
    turned_apart += faces(own->from, other->from, own->vertex, own->normal + other->normal) ? 0 : 1;
  }
  return turned_joined <= turned_apart;
}

bool FeatureFinder::has_whole_face(const Candidate& c, std::size_t side) const {
  const unsigned edges = table_.edges_of_face(c.side_faces[side]);
  return (c.feature.edges & edges) == edges;
}

// The triangles are those of FacePass::sharp_cell. Sides that lead into another brick are looked at there: what is
// beyond is not known yet.
bool FeatureFinder::turns_a_triangle(std::size_t candidate, std::span<const Vec3> points, std::span<const Side> sides,
                                     std::size_t first, std::size_t last) const {
  const Candidate& c = candidates_[candidate];
  const double least = layout_.least_facing();
  for (std::size_t n = 0; n < c.size; ++n) {
    const std::uint32_t from = c.points[n], to = c.points[(n + 1) % c.size];
    Vec3 third = points[to], normal = planes_[from].normal + planes_[to].normal;
    if (goes_on_through(c, n)) {
      if (leads_out(c, n, first, last)) continue;
      const auto other = std::lower_bound(sides.begin(), sides.end(), Side{to, from, 0, 0});
      const bool is_there =
          other != sides.end() && other->from == to && other->to == from && candidates_[other->candidate].sharp;
      if (is_there && !(has_whole_face(c, n) && has_whole_face(candidates_[other->candidate], other->number)))
        third = candidates_[other->candidate].position, normal = planes_[from].normal;
    }
    const Vec3 facing = cross(third - points[from], c.position - points[from]);
    if (!(dot(facing, normal) > least)) return true;
  }
  return false;
}

// What is rejected changes the triangles of those beside it, so those that went farthest go first. Nothing comes back.
void FeatureFinder::reject_turning(std::span<const Vec3> points, std::size_t first, std::size_t last) {
  std::vector<Side> sides;
  for (std::uint32_t i = 0; i < candidates_.size(); ++i) {
    const Candidate& c = candidates_[i];
    for (std::uint32_t n = 0; n < c.size; ++n)
      if (goes_on_through(c, n)) sides.push_back({c.points[n], c.points[(n + 1) % c.size], i, n});
  }
  std::sort(sides.begin(), sides.end());
  const auto turns = [&](std::size_t i) {
    return candidates_[i].sharp && turns_a_triangle(i, points, sides, first, last);
  };
  const auto way = [&](std::size_t i) { return norm(candidates_[i].position - candidates_[i].middle); };
  for (std::vector<std::size_t> turning;;) {
    turning.clear();
    for (std::size_t i = 0; i < candidates_.size(); ++i)
      if (turns(i)) turning.push_back(i);
    if (turning.empty()) break;
    std::stable_sort(turning.begin(), turning.end(), [&](std::size_t i, std::size_t j) { return way(i) > way(j); });
    for (const std::size_t i : turning)
      if (turns(i)) candidates_[i].sharp = false;
  }
  std::erase_if(candidates_, [](const Candidate& c) { return !c.sharp; });
}

void FeatureFinder::keep_borders(std::span<const Vec3> points, std::size_t first, std::size_t last) {
  borders_.clear();
  for (const Candidate& c : candidates_)
    for (std::size_t n = 0; n < c.size; ++n) {
      if (!goes_on_through(c, n) || !leads_out(c, n, first, last)) continue;
      borders_.push_back({.row = c.feature.row,
                          .cell = c.feature.cell,
                          .edge = c.edges[n],
                          .next = c.edges[(n + 1) % c.size],
                          .vertex = c.position,
                          .from = points[c.points[n]],
                          .normal = planes_[c.points[n]].normal});
    }
  std::sort(borders_.begin(), borders_.end(),
            [](const BorderSide& a, const BorderSide& b) { return a.place() < b.place(); });
}

}  // namespace meso::implicit
