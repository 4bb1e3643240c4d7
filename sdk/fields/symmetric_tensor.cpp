// SPDX-License-Identifier: Apache-2.0
// Cyclic Jacobi: Golub and Van Loan, Matrix Computations, 8.5.
#include "meso/fields/symmetric_tensor.hpp"

#include <algorithm>
#include <cmath>

namespace meso::fields {
namespace {

constexpr int most_sweeps = 32;  // converges quadratically: five are the rule

/// One rotation in the plane of axes p and q that makes a(p, q) zero.
void rotate(Mat3& a, Mat3& v, std::size_t p, std::size_t q) {
  const double off = a(p, q);
  if (off == 0) return;
  const double theta = (a(q, q) - a(p, p)) / (2 * off);
  const double t = (theta >= 0 ? 1 : -1) / (std::abs(theta) + std::hypot(theta, 1));
  const double c = 1 / std::hypot(t, 1), s = t * c;
  const std::size_t r = 3 - p - q;
  const double rp = a(r, p), rq = a(r, q);
  a(p, p) -= t * off;
  a(q, q) += t * off;
  a(p, q) = a(q, p) = 0;
  a(r, p) = a(p, r) = c * rp - s * rq;
  a(r, q) = a(q, r) = s * rp + c * rq;
  for (std::size_t i = 0; i < 3; ++i) {
    const double ip = v(i, p), iq = v(i, q);
    v(i, p) = c * ip - s * iq;
    v(i, q) = s * ip + c * iq;
  }
}

Vec3 without_sign(Vec3 v) {
  for (std::size_t i = 3; i-- > 0;) {
    if (v[i] != 0) return v[i] > 0 ? v : -v;
  }
  return v;
}

}  // namespace

Principal principal(const SymmetricTensor& t) {
  // Entries near the end of the number range would overflow in squares.
  const double size =
      std::max({std::abs(t.xx), std::abs(t.yy), std::abs(t.zz), std::abs(t.xy), std::abs(t.yz), std::abs(t.zx)});
  const double scale = size > 0 ? size : 1;
  Mat3 a{{t.xx / scale, t.xy / scale, t.zx / scale,  //
          t.xy / scale, t.yy / scale, t.yz / scale,  //
          t.zx / scale, t.yz / scale, t.zz / scale}};
  Mat3 v;
  for (int sweep = 0; sweep < most_sweeps && (a(0, 1) != 0 || a(1, 2) != 0 || a(0, 2) != 0); ++sweep) {
    rotate(a, v, 0, 1);
    rotate(a, v, 1, 2);
    rotate(a, v, 0, 2);
    // What is below rounding of the diagonal turns nothing any more.
    for (const auto& [p, q] : {std::pair<std::size_t, std::size_t>{0, 1}, {1, 2}, {0, 2}}) {
      if (std::abs(a(p, q)) < 1e-300) a(p, q) = a(q, p) = 0;
    }
  }
  std::array<std::size_t, 3> order{0, 1, 2};
  std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return a(i, i) > a(j, j); });
  Principal result;
  for (std::size_t i = 0; i < 3; ++i) {
    result.value[i] = scale * a(order[i], order[i]);
    const Vec3 direction = v.column(order[i]);
    result.direction[i] = without_sign(direction / norm(direction));
  }
  return result;
}

double von_mises(const SymmetricTensor& t) {
  const double xy = t.xx - t.yy, yz = t.yy - t.zz, zx = t.zz - t.xx;
  return std::sqrt((xy * xy + yz * yz + zx * zx) / 2 + 3 * (t.xy * t.xy + t.yz * t.yz + t.zx * t.zx));
}

}  // namespace meso::fields
