// SPDX-License-Identifier: Apache-2.0
#pragma once
// Principal values and directions of a symmetric 3x3 tensor.
//
//   const Principal p = principal({.xx = 3, .yy = 1, .zz = 2});
//   p.value;       // {3, 2, 1}, descending
//   p.direction;   // {(1,0,0), (0,0,1), (0,1,0)}: unit vectors whose last non-zero component is positive
//
// By Jacobi's rotations, backward stable: residual below 1e-14 of the largest entry. Directions of equal values are one
// of many possible right answers, the same one every time. Stateless.

#include <array>

#include "meso/base/vec.hpp"

namespace meso::fields {

struct SymmetricTensor {
  double xx = 0, yy = 0, zz = 0, xy = 0, yz = 0, zx = 0;
};
struct Principal {
  std::array<double, 3> value{};
  std::array<Vec3, 3> direction{};
};

[[nodiscard]] Principal principal(const SymmetricTensor& tensor);
/// The stress of uniaxial tension that yields as this one does, by von Mises.
[[nodiscard]] double von_mises(const SymmetricTensor& tensor);

}  // namespace meso::fields
