// SPDX-License-Identifier: Apache-2.0
#pragma once
// The lattice's points and edges by number, and what is known at each. Private.
//
// Corners are numbered x first; then centres, with one layer of them beyond the box on each side, which is outside.
// Each edge belongs to one of its ends: long ones to the lower, short ones to the centre.

#include <bit>
#include <vector>

#include "meso/implicit/stuffing.hpp"
#include "stencil.hpp"

namespace meso::implicit::stuffing {

using Index3 = std::array<std::int32_t, 3>;

// Distances within which a cut moves the lattice's point, as parts of the edge: close to Labelle and Shewchuk's optimum
// for the smallest angle.
inline constexpr double close_on_long = 0.2851, close_on_short = 0.3989;

inline constexpr unsigned long_edges = 3, short_edges = 8, owned_edges = long_edges + short_edges;

/// Where the surface crosses an edge.
struct Cut {
  Vec3 at;
  std::uint32_t owner = 0;
  std::uint8_t edge = 0;  ///< 0-2: long, along x, y, z; 3-10: short
  bool gone = false;      ///< one end of the edge has moved onto the surface
};

class Points {
 public:
  explicit Points(const BccLattice& lattice);

  [[nodiscard]] const BccLattice& lattice() const { return lattice_; }
  [[nodiscard]] std::uint32_t corner_count() const { return corner_count_; }
  [[nodiscard]] std::uint32_t count() const { return static_cast<std::uint32_t>(signs_.size()); }
  [[nodiscard]] bool is_centre(std::uint32_t id) const { return id >= corner_count_; }

  [[nodiscard]] std::uint32_t corner(const Index3& i) const {
    return static_cast<std::uint32_t>(i[0] + (n_[0] + 1) * (i[1] + (n_[1] + 1) * i[2]));
  }
  /// -1 ... n along each axis.
  [[nodiscard]] std::uint32_t centre(const Index3& i) const {
    return corner_count_ + static_cast<std::uint32_t>(i[0] + 1 + (n_[0] + 2) * (i[1] + 1 + (n_[1] + 2) * (i[2] + 1)));
  }
  [[nodiscard]] Index3 index(std::uint32_t id) const;
  [[nodiscard]] Vec3 position(std::uint32_t id) const;
  /// By which the id grows along an axis.
  [[nodiscard]] std::uint32_t stride(std::uint32_t id, std::size_t axis) const {
    return is_centre(id) ? centre_stride_[axis] : corner_stride_[axis];
  }
  /// The corner at the other end of a centre's short edge (0-7). REQUIRES: a centre within the box.
  [[nodiscard]] std::uint32_t short_end(const Index3& centre_index, unsigned edge) const {
    return corner({centre_index[0] + static_cast<std::int32_t>(edge & 1),
                   centre_index[1] + static_cast<std::int32_t>(edge >> 1 & 1),
                   centre_index[2] + static_cast<std::int32_t>(edge >> 2 & 1)});
  }
  [[nodiscard]] bool in_box(const Index3& centre_index) const {
    for (std::size_t a = 0; a < 3; ++a)
      if (centre_index[a] < 0 || centre_index[a] >= n_[a]) return false;
    return true;
  }

  [[nodiscard]] Sign sign(std::uint32_t id) const { return signs_[id]; }
  void set_sign(std::uint32_t id, Sign s) { signs_[id] = s; }

  /// Numbers of cuts, once mark_crossings() and count_crossings() have been called.
  [[nodiscard]] std::uint32_t cut(std::uint32_t owner, unsigned edge) const {
    const unsigned below = crossed_[owner] & ((1U << edge) - 1);
    return first_cut_[owner] + static_cast<std::uint32_t>(std::popcount(below));
  }
  [[nodiscard]] bool crossed(std::uint32_t owner, unsigned edge) const { return crossed_[owner] >> edge & 1; }
  [[nodiscard]] std::uint32_t crossings(std::uint32_t owner) const { return crossed_[owner]; }
  void mark_crossings(std::uint32_t owner);
  [[nodiscard]] std::uint64_t count_crossings();

  static constexpr std::uint64_t bytes_per_point = sizeof(Sign) + sizeof(std::uint16_t) + 2 * sizeof(std::uint32_t);

 private:
  [[nodiscard]] bool differ(std::uint32_t a, std::uint32_t b) const {
    return static_cast<int>(signs_[a]) + static_cast<int>(signs_[b]) == 2 && signs_[a] != Sign::zero;
  }

  const BccLattice& lattice_;
  Index3 n_;
  std::uint32_t corner_count_;
  std::array<std::uint32_t, 3> corner_stride_, centre_stride_;
  std::vector<Sign> signs_;
  std::vector<std::uint16_t> crossed_;  // a bit for each edge that belongs to the point
  std::vector<std::uint32_t> first_cut_;
};

/// How many points Points would hold.
[[nodiscard]] std::uint64_t point_count(const BccLattice& lattice);

}  // namespace meso::implicit::stuffing
