// SPDX-License-Identifier: Apache-2.0
#include "coordinate_inverse.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "affine_map.hpp"

namespace meso::implicit {
namespace {

using expr::Op;
using std::numbers::pi;

constexpr double tiny = 1e-12;

struct NamedAxis {
  std::size_t position;  ///< in the result
  eval::CoordinateAxis axis;
};
using Result = std::optional<std::array<Coordinate, 3>>;

class Inverse {
 public:
  Inverse(const eval::CoordinateFrame& system, const std::array<std::size_t, 3>& axes,
          const std::array<double, 3>& around)
      : around_(around) {
    const Affine local_from_world = inverse(system.world_from_system());
    for (std::size_t i = 0; i < 3; ++i) local_[i] = Term::coordinate(i).at(local_from_world);
    std::array<std::size_t, 3> order{0, 1, 2};
    std::ranges::sort(order, {}, [&](std::size_t i) { return axes[i]; });
    for (const std::size_t i : order) {
      const eval::CoordinateAxis& axis = system.axes()[axes[i]];
      has_scalar_ = has_scalar_ || axis.kind == AxisKind::scalar;
      (axis.kind == AxisKind::circular ? turns_ : lengths_).push_back({i, axis});
    }
  }

  Result find() {
    if (has_scalar_) return {};
    switch (turns_.size()) {
      case 0:
        return straight();
      case 1:
        return turned_once();
      case 2:
        return turned_twice();
      default:
        return {};
    }
  }

 private:
  [[nodiscard]] Term along(Vec3 d) const {
    Term sum = Term::constant(0);
    for (std::size_t i = 3; i-- > 0;) {
      if (std::abs(d[i]) < 1e-16) continue;
      const Term part = d[i] == 1 ? local_[i] : d[i] * local_[i];
      sum = sum.is_constant() && sum.node().number == 0 ? part : part + sum;
    }
    return sum;
  }
  static Term length(const Term& a, const Term& b) { return sqrt(a * a + b * b); }
  void set(const NamedAxis& axis, const Term& q, const Term& millimeters, bool is_angle = false) {
    result_[axis.position] = {q, millimeters, is_angle};
  }
  /// The angle of (x, y), within half a turn of `middle`.
  static Term angle(const Term& x, const Term& y, double middle) {
    const double c = std::cos(middle), s = std::sin(middle);
    const Term turned = Term::apply(Op::atan2, {c * y - s * x, c * x + s * y});
    return turned - -middle;
  }

  Result straight() {
    const Mat3 columns =
        Mat3::from_columns(lengths_[0].axis.direction, lengths_[1].axis.direction, lengths_[2].axis.direction);
    if (std::abs(determinant(columns)) < tiny) return {};
    const Mat3 rows = inverse(columns);
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 row{rows(i, 0), rows(i, 1), rows(i, 2)};
      set(lengths_[i], along(row), Term::constant(1 / norm(row)));
    }
    return result_;
  }

  Result turned_once() {
    const Vec3 n = turns_[0].axis.direction;
    const auto across = [&](const NamedAxis& a) { return a.axis.direction - dot(a.axis.direction, n) * n; };
    const bool both_turn = lengths_[0].axis.kind == AxisKind::distance && lengths_[1].axis.kind == AxisKind::distance;
    if (!both_turn && lengths_[0].axis.kind == lengths_[1].axis.kind) return {};
    // The first is the distance that leads away from the axis of the turn.
    const NamedAxis *first = lengths_.data(), *second = first + 1;
    const bool swap =
        both_turn ? norm(across(*second)) > norm(across(*first)) : second->axis.kind == AxisKind::distance;
    if (swap) std::swap(first, second);
    if (norm(across(*first)) < tiny) return {};
    const Vec3 e1 = across(*first) / norm(across(*first)), e2 = cross(n, e1);
    const Term x = along(e1), y = along(e2), z = along(n), rho = length(x, y);
    // In the half-plane (rho, z) the two are straight coordinates.
    const double c1 = dot(first->axis.direction, e1), z1 = dot(first->axis.direction, n);
    const double c2 = dot(second->axis.direction, e1), z2 = dot(second->axis.direction, n);
    if (std::abs(dot(second->axis.direction, e2)) > tiny || c2 < -tiny) return {};
    if (!both_turn && std::abs(c2) > tiny) return {};
    const double det = c1 * z2 - c2 * z1;
    if (std::abs(det) < tiny) return {};
    const auto solved = [&](double of_rho, double of_z) {
      const Term a = (of_rho / det) * rho, b = (of_z / det) * z;
      return of_rho == 0 ? b : of_z == 0 ? a : a + b;
    };
    set(*first, solved(z2, -c2), Term::constant(std::abs(det) / std::hypot(z2, c2)));
    set(*second, solved(-z1, c1), Term::constant(std::abs(det) / std::hypot(z1, c1)));
    set(turns_[0], angle(x, y, around_[turns_[0].position]), rho, true);
    return result_;
  }

  // R_A(t) R_B(f) d with A and B at right angles and d in the plane that A turns: with C = A x B, B turns C towards A
  // and A turns C towards -B.
  Result turned_twice() {
    const Vec3 a = turns_[0].axis.direction, b = turns_[1].axis.direction, d = lengths_[0].axis.direction;
    if (lengths_[0].axis.kind != AxisKind::distance || std::abs(dot(a, b)) > tiny || std::abs(dot(d, b)) > tiny)
      return {};
    const Vec3 c = cross(a, b);
    const double offset = std::atan2(dot(d, a), dot(d, c));
    const Term x = along(c), y = along(-b), z = along(a), rho = length(x, y), r = length(rho, z);
    const double f = around_[turns_[1].position], t = around_[turns_[0].position];
    // Beyond a pole the latitude falls again, on the other side.
    const bool beyond = std::cos(f + offset) < 0;
    set(lengths_[0], r, Term::constant(1));
    set(turns_[1], angle(beyond ? -rho : rho, z, f + offset) - offset, r, true);
    set(turns_[0], beyond ? angle(-x, -y, t) : angle(x, y, t), rho, true);
    return result_;
  }

  std::array<double, 3> around_;
  std::array<Term, 3> local_;
  std::vector<NamedAxis> lengths_, turns_;
  bool has_scalar_ = false;
  std::array<Coordinate, 3> result_;
};

}  // namespace

std::optional<std::array<Coordinate, 3>> coordinates_of(const eval::CoordinateFrame& system,
                                                        const std::array<std::size_t, 3>& axes,
                                                        const std::array<double, 3>& around) {
  return Inverse(system, axes, around).find();
}

}  // namespace meso::implicit
