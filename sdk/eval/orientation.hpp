// SPDX-License-Identifier: Apache-2.0
#pragma once
// Rotations that point a cell's axes along given vectors.

#include "meso/base/vec.hpp"
#include "meso/model/pattern.hpp"

namespace meso::eval {

/// v or -v: the one whose last non-zero component is positive.
[[nodiscard]] Vec3 without_sign(Vec3 v);
/// True if b is zero or along +-a, to within 1e-9 of a right angle's sine. REQUIRES: a is not zero.
[[nodiscard]] bool is_parallel(Vec3 a, Vec3 b);
/// x with m x = v. REQUIRES: m is not singular.
[[nodiscard]] Vec3 solve(const Mat3& m, Vec3 v);
[[nodiscard]] Mat3 inverse(const Mat3& m);

/// The rotation by the smallest angle that takes the axis along `v`; half a turn about the next axis (x y z x) if v
/// points the opposite way.
[[nodiscard]] Mat3 smallest_turn(CellAxis axis, Vec3 v);
/// The rotation that takes `first` along a and `second` as near to b as that allows.
/// REQUIRES: different axes; a and b not parallel.
[[nodiscard]] Mat3 two_axis_turn(CellAxis first, Vec3 a, CellAxis second, Vec3 b);

}  // namespace meso::eval
