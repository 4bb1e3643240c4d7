// SPDX-License-Identifier: Apache-2.0
#pragma once
// Where the surface crosses the lattice's edges, and which points of the lattice move there. Private.

#include "lattice.hpp"
#include "meso/implicit/threads.hpp"

namespace meso::implicit::stuffing {

/// One for each crossed edge, in the order of Points::cut(). False: stopped.
[[nodiscard]] bool find_cuts(const Points& points, const GridSource& source, std::vector<Cut>& cuts, Threads& threads);

/// A point of the lattice that is now where a cut was.
struct Moved {
  std::uint32_t point = 0;
  Vec3 to;
};

/// Moves each point that has a cut close by to the closest one. Points are taken in order, each sees what those before
/// it have done: an edge with one end on the surface is cut no more.
[[nodiscard]] std::vector<Moved> warp(Points& points, std::vector<Cut>& cuts);

}  // namespace meso::implicit::stuffing
