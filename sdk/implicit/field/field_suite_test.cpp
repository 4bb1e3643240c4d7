// SPDX-License-Identifier: Apache-2.0
// The suite that every field must pass, over primitives, surfaces, expressions, operations and random compositions,
// each beside the same function written another way.

#include "field_suite.hpp"

#include <cctype>
#include <cmath>
#include <memory>
#include <numbers>

#include "meso/expr/expression.hpp"
#include "meso/implicit/surfaces.hpp"

namespace meso::implicit {
namespace {

using Function = std::function<double(Vec3)>;
using Subject = FieldUnderTest;
constexpr double pi = std::numbers::pi;

double distance_to_segment(Vec3 p, Vec3 a, Vec3 b) {
  const Vec3 d = b - a;
  const double t = dot(d, d) == 0 ? 0 : std::clamp(dot(p - a, d) / dot(d, d), 0.0, 1.0);
  return norm(p - (a + t * d));
}

/// Distance to a convex polygon of the plane (corners counter-clockwise), by its sides one by one.
double polygon_distance(const std::vector<Vec3>& corners, Vec3 p) {
  double distance = HUGE_VAL;
  bool inside = true;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3 a = corners[i], b = corners[(i + 1) % corners.size()];
    distance = std::min(distance, distance_to_segment(p, a, b));
    inside = inside && cross(b - a, p - a).z > 0;
  }
  return inside ? -distance : distance;
}

Subject cone(double bottom, double top, double height) {
  return {"cone", Field::cone(bottom, top, height), [=](Vec3 p) {
            // The whole profile, both sides of the axis.
            std::vector<Vec3> profile{{-bottom, 0, 0}, {bottom, 0, 0}, {top, height, 0}, {-top, height, 0}};
            if (top == 0) profile.pop_back();
            if (bottom == 0) profile.erase(profile.begin());
            return polygon_distance(profile, {std::hypot(p.x, p.y), p.z, 0});
          }};
}

/// Distance to a ball as an external field would answer it.
class ExternalBall final : public ExternalField {
 public:
  double value(Vec3 p) const override { return norm(p) - 1; }
  Interval interval(const Box3& box) const override {
    double near = 0, far = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const double a = std::abs(box.min[i]), b = std::abs(box.max[i]);
      const double nearest = box.min[i] <= 0 && box.max[i] >= 0 ? 0 : std::min(a, b);
      near += nearest * nearest;
      far += std::max(a, b) * std::max(a, b);
    }
    return {std::sqrt(near) - 1 - 1e-9, std::sqrt(far) - 1 + 1e-9};
  }
  double lipschitz() const override { return 1; }
  Box3 bounds(double level) const override {
    const double r = 1 + level;
    return r < 0 ? Box3{} : Box3{{-r, -r, -r}, {r, r, r}};
  }
  std::unique_ptr<Prepared> prepare(const Grid&, const Affine&, double, const RunOptions&) const override {
    return nullptr;
  }
};

std::vector<Subject> primitives() {
  const Vec3 h{1, 0.5, 2}, a{-1, 0.3, 0.2}, b{0.7, 1.5, -1}, n{1, -2, 0.5};
  return {
      {"ball", Field::ball(1.3), [](Vec3 p) { return norm(p) - 1.3; }},
      {"box", Field::box(h),
       [=](Vec3 p) {
         const Vec3 nearest{std::clamp(p.x, -h.x, h.x), std::clamp(p.y, -h.y, h.y), std::clamp(p.z, -h.z, h.z)};
         if (nearest != p) return norm(p - nearest);
         return -std::min({h.x - std::abs(p.x), h.y - std::abs(p.y), h.z - std::abs(p.z)});
       }},
      {"cylinder", Field::cylinder(0.8), [](Vec3 p) { return std::hypot(p.x, p.y) - 0.8; }},
      cone(1.2, 0, 1.5),
      cone(0.4, 1.1, 2),
      cone(0, 1, 0.5),
      cone(1, 1, 2),
      {"torus", Field::torus(1.5, 0.4),
       [](Vec3 p) {
         const double angle = std::atan2(p.y, p.x);
         return norm(p - 1.5 * Vec3{std::cos(angle), std::sin(angle), 0}) - 0.4;
       }},
      {"capsule", Field::capsule(a, b, 0.6), [=](Vec3 p) { return distance_to_segment(p, a, b) - 0.6; }},
      {"capsule of no length", Field::capsule(a, a, 0.6), [=](Vec3 p) { return norm(p - a) - 0.6; }},
      {"half-space", Field::half_space(n, 0.3), [=](Vec3 p) { return dot(n, p) / norm(n) - 0.3; }},
      {"external ball", Field::external(std::make_shared<ExternalBall>()), [](Vec3 p) { return norm(p) - 1; }},
  };
}

std::vector<Subject> named_surfaces() {
  std::vector<Subject> result;
  DiagnosticSink sink;
  for (const Surface& s : surfaces()) {
    const auto parsed =
        std::make_shared<expr::Expression>(*expr::parse_expression(s.expression, LengthUnit::millimeter).expression);
    result.push_back({"surface " + std::string(s.name), *Field::surface(s.name, sink), [parsed](Vec3 p) {
                        std::vector<double> slots;
                        for (const expr::Name& name : parsed->names())
                          slots.push_back(p[static_cast<std::size_t>(name.text[0] - 'x')]);
                        return expr::evaluate(*parsed, slots).value;
                      }});
  }
  return result;
}

Subject expression(const char* text, Function reference) {
  DiagnosticSink sink;
  const Parameter parameters[] = {{"k", 2.5}};
  // No value is outside, far from every level.
  const auto value = [f = std::move(reference)](Vec3 p) { return std::isnan(f(p)) ? 1e30 : f(p); };
  return {text, *Field::expression(text, sink, parameters), value};
}

std::vector<Subject> expressions() {
  return {
      expression("x + y + z - 1", [](Vec3 p) { return p.x + p.y + p.z - 1; }),
      expression("x*y*z - k", [](Vec3 p) { return p.x * p.y * p.z - 2.5; }),
      expression("sin(k*x)*exp(-y^2) + hypot(y, z)/3",
                 [](Vec3 p) { return std::sin(2.5 * p.x) * std::exp(-p.y * p.y) + std::hypot(p.y, p.z) / 3; }),
      expression("sqrt(x) - y", [](Vec3 p) { return std::sqrt(p.x) - p.y; }),  // no value in half of space
      expression("log(x^2 - 1) + z", [](Vec3 p) { return std::log(p.x * p.x - 1) + p.z; }),
      expression("abs(x) < 1 ? y : z", [](Vec3 p) { return std::abs(p.x) < 1 ? p.y : p.z; }),
      expression("100*sin(30*x) + y", [](Vec3 p) { return 100 * std::sin(30 * p.x) + p.y; }),
      expression("-1", [](Vec3) { return -1.0; }),
  };
}

/// v turned about the unit vector n, vector by vector.
Vec3 turned(Vec3 v, Vec3 n, double angle) {
  return std::cos(angle) * v + std::sin(angle) * cross(n, v) + (1 - std::cos(angle)) * dot(n, v) * n;
}

// Operations, as the table of the specification writes them, applied to the reference.
Subject translated(const Subject& s, Vec3 d) {
  return {s.name + " translated", s.field.translated(d), [f = s.reference, d](Vec3 p) { return f(p - d); }};
}
Subject scaled(const Subject& s, double k) {
  return {s.name + " scaled", s.field.scaled(k), [f = s.reference, k](Vec3 p) { return std::abs(k) * f(p / k); }};
}
Subject stretched(const Subject& s, Vec3 k) {
  const double least = std::min({std::abs(k.x), std::abs(k.y), std::abs(k.z)});
  return {s.name + " stretched", s.field.scaled(k), [=, f = s.reference](Vec3 p) {
            return least * f({p.x / k.x, p.y / k.y, p.z / k.z});
          }};
}
Subject rotated(const Subject& s, Vec3 axis, double angle) {
  const Vec3 n = axis / norm(axis);
  return {s.name + " rotated", s.field.rotated(axis, angle),
          [=, f = s.reference](Vec3 p) { return f(turned(p, n, -angle)); }};
}
Subject oriented(const Subject& s, Vec3 direction) {
  const Vec3 d = direction / norm(direction), z{0, 0, 1};
  const Vec3 axis = cross(z, d);
  const Vec3 n = norm(axis) == 0 ? Vec3{1, 0, 0} : axis / norm(axis);
  const double angle = std::atan2(norm(axis), d.z);
  return {s.name + " oriented", s.field.oriented(direction),
          [=, f = s.reference](Vec3 p) { return f(turned(p, n, -angle)); }};
}
Subject mirrored(const Subject& s, Vec3 normal) {
  return {s.name + " mirrored", s.field.mirrored(normal),
          [=, f = s.reference](Vec3 p) { return f(p - (2 * dot(p, normal) / dot(normal, normal)) * normal); }};
}
Subject offset(const Subject& s, double d) {
  return {s.name + " offset", s.field.offset(d), [f = s.reference, d](Vec3 p) { return f(p) - d; }};
}
Subject shell(const Subject& s, double t) {
  return {s.name + " shell", s.field.shell(t), [f = s.reference, t](Vec3 p) { return std::abs(f(p)) - t / 2; }};
}
Subject eccentric(const Subject& s, double lower, double upper) {
  return {s.name + " eccentric", s.field.eccentric_shell(lower, upper),
          [=, f = s.reference](Vec3 p) { return std::max(lower - f(p), f(p) - upper); }};
}
Subject complement(const Subject& s) {
  return {s.name + " complement", s.field.complement(), [f = s.reference](Vec3 p) { return -f(p); }};
}
Subject united(const Subject& a, const Subject& b) {
  return {"(" + a.name + ", " + b.name + ") union", union_of(a.field, b.field),
          [f = a.reference, g = b.reference](Vec3 p) { return std::min(f(p), g(p)); }};
}
Subject intersected(const Subject& a, const Subject& b) {
  return {"(" + a.name + ", " + b.name + ") intersection", intersection_of(a.field, b.field),
          [f = a.reference, g = b.reference](Vec3 p) { return std::max(f(p), g(p)); }};
}
Subject subtracted(const Subject& a, const Subject& b) {
  return {"(" + a.name + ", " + b.name + ") difference", difference_of(a.field, b.field),
          [f = a.reference, g = b.reference](Vec3 p) { return std::max(f(p), -g(p)); }};
}

std::vector<Subject> operations() {
  const std::vector<Subject> p = primitives();
  const Subject &ball = p[0], &box = p[1], &cylinder = p[2], &torus = p[7];
  DiagnosticSink sink;
  const std::vector<Subject> s = named_surfaces();
  return {
      translated(box, {0.3, -1, 2}),
      scaled(box, 0.7),
      scaled(torus, -1.5),
      stretched(box, {1, -2, 0.5}),
      offset(stretched(ball, {1, 2, 3}), 0.4),
      rotated(box, {1, 2, 3}, 0.8),
      rotated(cylinder, {1, 0, 0}, pi / 2),
      rotated(torus, {-1, 0, 1e-3}, -4),
      oriented(cylinder, {1, 1, 1}),
      oriented(p[3], {0.3, 0, -1}),
      oriented(p[4], {0, 0, -1}),
      oriented(p[4], {1e-9, 0, -1}),
      mirrored(translated(box, {1, 0.5, 0}), {1, 2, 0}),
      offset(box, 0.25),
      offset(box, -0.25),
      shell(torus, 0.3),
      shell(complement(ball), 0.2),
      shell(box, 0),
      eccentric(s[0], -0.2, 0.6),
      complement(cylinder),
      complement(shell(ball, 0.5)),
      complement(united(ball, translated(box, {1, 1, 1}))),
      united(ball, cylinder),
      intersected(ball, s[0]),
      intersected(cylinder, oriented(cylinder, {1, 0, 0})),
      subtracted(box, ball),
      intersected(rotated(p[10], {0, 0, 1}, 0.3), box),
      rotated(p[10], {1, 1, 0}, pi / 2),
      stretched(rotated(p[11], {1, 1, 0}, 0.4), {2, 1, 1}),
  };
}

std::vector<Subject> random_compositions() {
  std::mt19937_64 engine(99);
  const auto u = [&](double lo, double hi) { return std::uniform_real_distribution(lo, hi)(engine); };
  const auto vector = [&] { return Vec3{u(-1, 1), u(-1, 1), u(-1, 1)}; };
  const auto pick = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(engine); };
  std::vector<Subject> pool = primitives();
  const std::vector<Subject> some = named_surfaces();
  pool.insert(pool.end(), some.begin(), some.end());
  std::vector<Subject> result;
  for (int round = 0; round < 60; ++round) {
    Subject s = pool[pick(pool.size())];
    for (std::size_t step = 0, steps = 3 + pick(5); step < steps; ++step) {
      switch (pick(12)) {
        case 0:
          s = translated(s, vector());
          break;
        case 1:
          s = scaled(s, u(0.5, 2) * (pick(2) == 0 ? 1 : -1));
          break;
        case 2:
          s = stretched(s, {u(0.5, 2), -u(0.5, 2), u(0.5, 2)});
          break;
        case 3:
          s = rotated(s, vector(), u(-7, 7));
          break;
        case 4:
          s = oriented(s, vector());
          break;
        case 5:
          s = mirrored(s, vector());
          break;
        case 6:
          s = offset(s, u(-0.3, 0.3));
          break;
        case 7:
          s = shell(s, u(0, 0.5));
          break;
        case 8:
          s = complement(s);
          break;
        case 9:
          s = united(s, pool[pick(pool.size())]);
          break;
        case 10:
          s = intersected(s, pool[pick(pool.size())]);
          break;
        default:
          s = subtracted(s, pool[pick(pool.size())]);
      }
    }
    s.reference_tolerance = 1e-10;
    result.push_back(s);
  }
  return result;
}

class EveryField : public testing::TestWithParam<Subject> {};
TEST_P(EveryField, PassesTheSuite) { check_field(GetParam()); }

std::string numbered(const testing::TestParamInfo<Subject>& info) {
  std::string name = std::to_string(info.index) + "_";
  for (const char c : info.param.name.substr(0, 60)) name += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  return name;
}

INSTANTIATE_TEST_SUITE_P(Primitives, EveryField, testing::ValuesIn(primitives()), numbered);
INSTANTIATE_TEST_SUITE_P(Surfaces, EveryField, testing::ValuesIn(named_surfaces()), numbered);
INSTANTIATE_TEST_SUITE_P(Expressions, EveryField, testing::ValuesIn(expressions()), numbered);
INSTANTIATE_TEST_SUITE_P(Operations, EveryField, testing::ValuesIn(operations()), numbered);
INSTANTIATE_TEST_SUITE_P(Random, EveryField, testing::ValuesIn(random_compositions()), numbered);

}  // namespace
}  // namespace meso::implicit
