// SPDX-License-Identifier: Apache-2.0
#pragma once
// What every field must pass, whatever it is made of. Part of tests, never installed.
//
//   check_field({.name = "my field", .field = f, .reference = [](Vec3 p) { return norm(p) - 1; }});

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <ostream>
#include <random>
#include <string>
#include <vector>

#include "meso/implicit/field.hpp"

namespace meso::implicit {

struct FieldUnderTest {
  std::string name;
  Field field;
  /// The same function, written another way; empty if there is no other way.
  std::function<double(Vec3)> reference{};
  double reach = 3;  ///< points are taken from the cube of this half size
  double reference_tolerance = 1e-12;
};

/// Random points, boxes and pairs: the same ones in every run.
class FieldSuite {
 public:
  explicit FieldSuite(const FieldUnderTest& subject) : subject_(subject), field_(subject.field) {}

  void run() {
    SCOPED_TRACE(subject_.name);
    values_agree();
    intervals_hold_samples();
    slopes_are_bounded();
    bounds_hold_the_body();
    gradients_agree_with_differences();
    complement_of_complement_is_itself();
  }

 private:
  double uniform(double lo, double hi) { return std::uniform_real_distribution(lo, hi)(engine_); }
  Vec3 point(double reach) { return {uniform(-reach, reach), uniform(-reach, reach), uniform(-reach, reach)}; }
  Vec3 point() { return point(subject_.reach); }
  std::vector<Vec3> points(int count) {
    std::vector<Vec3> result;
    for (int i = 0; i < count; ++i) result.push_back(point());
    return result;
  }
  static bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

  void values_agree() {
    const Term term = field_.term();
    const std::vector<Vec3> at = points(200);
    std::vector<double> values(at.size());
    field_.values(at, values);
    for (std::size_t i = 0; i < at.size(); ++i) {
      const double v = field_.value(at[i]);
      EXPECT_TRUE(same(v, values[i]) && same(v, term.value(at[i])));
      if (!subject_.reference) continue;
      const double r = subject_.reference(at[i]);
      EXPECT_TRUE(same(v, r) || std::abs(v - r) <= subject_.reference_tolerance * (1 + std::abs(r)))
          << v << " and " << r;
    }
  }

  void intervals_hold_samples() {
    const Interval all = field_.interval({{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, {HUGE_VAL, HUGE_VAL, HUGE_VAL}});
    for (const double size : {4.0, 1.0, 0.1, 1e-3, 0.0}) {
      for (int round = 0; round < 12; ++round) {
        Box3 box;
        const Vec3 a = point();
        box.extend(a);
        box.extend(a + size * point(1));
        const Interval range = field_.interval(box);
        EXPECT_LE(range.lo, range.hi);
        for (int sample = 0; sample < 12; ++sample) {
          Vec3 p;
          for (std::size_t axis = 0; axis < 3; ++axis)
            p[axis] = std::clamp(uniform(box.min[axis], std::nextafter(box.max[axis], HUGE_VAL)), box.min[axis],
                                 box.max[axis]);
          if (sample == 0) p = box.min;
          if (sample == 1) p = box.max;
          const double v = field_.value(p);
          EXPECT_TRUE(range.contains(v)) << v << " is not in " << range.lo << " ... " << range.hi;
          EXPECT_TRUE(all.contains(v)) << v;
        }
      }
    }
  }

  void slopes_are_bounded() {
    const double slope = field_.lipschitz();
    ASSERT_GE(slope, 0);
    if (std::isinf(slope)) return;
    for (const double distance : {3.0, 0.3, 1e-2, 1e-4}) {
      for (int i = 0; i < 60; ++i) {
        const Vec3 p = point(), q = p + distance * point(1);
        const double difference = std::abs(field_.value(p) - field_.value(q));
        EXPECT_LE(difference, slope * norm(p - q) * (1 + 1e-9) + 1e-12);
      }
    }
  }

  static bool holds(const Box3& box, Vec3 p) {
    const double slack = 1e-9;
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (!(box.min[axis] - slack <= p[axis] && p[axis] <= box.max[axis] + slack)) return false;
    return true;
  }

  void bounds_hold_the_body() {
    for (const double level : {-0.4, 0.0, 0.7}) {
      const Box3 inside = field_.bounds(level), outside = field_.complement_bounds(level);
      for (const Vec3 p : points(250)) {
        const double v = field_.value(p);
        if (v <= level) {
          EXPECT_TRUE(holds(inside, p)) << level << ": " << p.x << " " << p.y << " " << p.z;
        }
        if (-v <= level) {
          EXPECT_TRUE(holds(outside, p)) << level << ": " << p.x << " " << p.y << " " << p.z;
        }
      }
    }
  }

  void gradients_agree_with_differences() {
    const double h = 1e-6;
    int agree = 0;
    const std::vector<Vec3> at = points(100);
    for (const Vec3 p : at) {
      const Vec3 gradient = field_.gradient(p);
      Vec3 differences;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        Vec3 a = p, b = p;
        a[axis] -= h;
        b[axis] += h;
        differences[axis] = (field_.value(b) - field_.value(a)) / (b[axis] - a[axis]);
      }
      agree += norm(gradient - differences) <= 1e-5 * (1 + norm(gradient)) || std::isnan(differences.x) ? 1 : 0;
      EXPECT_FALSE(norm(gradient) > field_.lipschitz() * (1 + 1e-6));
    }
    EXPECT_GE(agree, 98);  // a kink is met rarely, and there the gradient is that of one side
  }

  void complement_of_complement_is_itself() {
    const Field twice = field_.complement().complement();
    for (const Vec3 p : points(50)) {
      EXPECT_TRUE(same(twice.value(p), field_.value(p)));
      EXPECT_TRUE(same(-field_.complement().value(p), field_.value(p)));
    }
    EXPECT_EQ(twice.bounds(0.3), field_.bounds(0.3));
    EXPECT_EQ(field_.complement().bounds(0.3), field_.complement_bounds(0.3));
  }

  const FieldUnderTest& subject_;
  const Field& field_;
  std::mt19937_64 engine_{12345};
};

/// For GoogleTest's messages.
inline void PrintTo(const FieldUnderTest& subject, std::ostream* out) { *out << subject.name; }

inline void check_field(const FieldUnderTest& subject) { FieldSuite(subject).run(); }

}  // namespace meso::implicit
