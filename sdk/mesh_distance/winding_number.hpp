// SPDX-License-Identifier: Apache-2.0
#pragma once
// How much of all directions a surface covers, seen from a point: 1 inside a closed surface, 0 outside, between them
// where there are holes. Far parts of the tree are taken as one dipole and its second-order term (Barill, Dickson,
// Schmidt, Levin, Jacobson: Fast winding numbers for soups and clouds, 2018, eq. 15), near triangles exactly.

#include "triangle_tree.hpp"

namespace meso::implicit {

class WindingNumber {
 public:
  WindingNumber() = default;
  explicit WindingNumber(const TriangleTree& tree);

  /// `tree` is the one it was made from.
  [[nodiscard]] double at(const TriangleTree& tree, Vec3 p) const;
  [[nodiscard]] std::uint64_t bytes() const { return moments_.capacity() * sizeof(Moments); }

 private:
  struct Moments {
    Vec3 middle;        ///< mean of the triangles by area
    double radius = 0;  ///< of a ball about it that holds them
    double area = 0;
    Vec3 normal;                               ///< sum of area times normal
    Mat3 spread{{0, 0, 0, 0, 0, 0, 0, 0, 0}};  ///< sum of (centroid - middle) normal^T area
  };
  [[nodiscard]] static Moments moments_of(const Triangle& t);
  void gather(const TriangleTree& tree, std::size_t number);

  std::vector<Moments> moments_;  // of each node
};

/// The solid angle of one triangle over 4 pi (van Oosterom, Strackee 1983); positive if p is behind it.
[[nodiscard]] double winding_of_triangle(const Triangle& t, Vec3 p);

}  // namespace meso::implicit
