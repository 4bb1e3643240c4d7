// SPDX-License-Identifier: Apache-2.0
// docs/specification/fields.md: every row of its tables of primitives and operations, against the code.

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "meso/implicit/field.hpp"

namespace meso::implicit {
namespace {

/// First and third cell of the rows of the page's table that begins with `head`.
std::map<std::string, std::string> rows_below(const std::string& head, std::size_t cell) {
  std::ifstream in(MESO_SOURCE_DIR "/docs/specification/fields.md");
  std::map<std::string, std::string> rows;
  bool within = false;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with(head)) {
      within = true;
      std::getline(in, line);  // the line of dashes
      continue;
    }
    if (!within) continue;
    if (!line.starts_with("| ")) break;
    std::vector<std::string> cells{""};
    for (std::size_t i = 2; i < line.size(); ++i) {
      if (line[i] == '|' && line[i - 1] != '\\')
        cells.emplace_back();
      else
        cells.back() += line[i];
    }
    for (std::string& c : cells) c = c.substr(c[0] == ' ' ? 1 : 0, c.find_last_not_of(' ') + (c[0] == ' ' ? 0 : 1));
    rows[cells[0]] = cells.at(cell);
  }
  return rows;
}

std::vector<Vec3> points() {
  std::mt19937_64 engine(11);
  std::uniform_real_distribution<double> u(-2, 2);
  std::vector<Vec3> out(200);
  for (Vec3& p : out) p = {u(engine), u(engine), u(engine)};
  return out;
}

struct Operation {
  std::function<Field(const Field&, const Field&)> carry_out;
  std::function<double(const Field&, const Field&, Vec3)> formula;  ///< the page's second column
};

// The page's formulas, transcribed.
const std::map<std::string, Operation>& operations() {
  static const double s = std::sqrt(0.5);
  static const std::map<std::string, Operation> all{
      {"translate δ",
       {[](const Field& f, const Field&) {
          return f.translated({1, 2, 3});
        },
        [](const Field& f, const Field&, Vec3 p) {
          return f.value(p - Vec3{1, 2, 3});
        }}},
      {"scale κ, one number",
       {[](const Field& f, const Field&) { return f.scaled(-2); },
        [](const Field& f, const Field&, Vec3 p) { return 2 * f.value(p / -2.0); }}},
      {"scale κ, three numbers",
       {[](const Field& f, const Field&) {
          return f.scaled(Vec3{2, -0.5, 3});
        },
        [](const Field& f, const Field&, Vec3 p) {
          return 0.5 * f.value({p.x / 2, p.y / -0.5, p.z / 3});
        }}},
      {"rotate v, θ",
       {[](const Field& f, const Field&) {
          return f.rotated({0, 0, 2}, std::acos(s));
        },
        [](const Field& f, const Field&, Vec3 p) {
          return f.value({s * (p.x + p.y), s * (p.y - p.x), p.z});
        }}},
      {"orient v",
       {[](const Field& f, const Field&) {
          return f.oriented({1, 0, 1});
        },
        [](const Field& f, const Field&, Vec3 p) {
          return f.value({s * (p.x - p.z), p.y, s * (p.x + p.z)});
        }}},
      {"mirror n",
       {[](const Field& f, const Field&) {
          return f.mirrored({3, 0, 0});
        },
        [](const Field& f, const Field&, Vec3 p) {
          return f.value({-p.x, p.y, p.z});
        }}},
      {"offset ξ",
       {[](const Field& f, const Field&) { return f.offset(0.3); },
        [](const Field& f, const Field&, Vec3 p) { return f.value(p) - 0.3; }}},
      {"shell Ξ",
       {[](const Field& f, const Field&) { return f.shell(0.3); },
        [](const Field& f, const Field&, Vec3 p) { return std::abs(f.value(p)) - 0.15; }}},
      {"complement",
       {[](const Field& f, const Field&) { return f.complement(); },
        [](const Field& f, const Field&, Vec3 p) { return -f.value(p); }}},
      {"union",
       {[](const Field& f, const Field& g) { return union_of(f, g); },
        [](const Field& f, const Field& g, Vec3 p) { return std::min(f.value(p), g.value(p)); }}},
      {"intersection",
       {[](const Field& f, const Field& g) { return intersection_of(f, g); },
        [](const Field& f, const Field& g, Vec3 p) { return std::max(f.value(p), g.value(p)); }}},
      {"difference",
       {[](const Field& f, const Field& g) { return difference_of(f, g); },
        [](const Field& f, const Field& g, Vec3 p) { return std::max(f.value(p), -g.value(p)); }}},
  };
  return all;
}

TEST(FieldsPage, OperationsAreAsItSays) {
  const Field f = Field::box({1, 0.75, 0.5}).translated({0.125, 0.25, 0}), g = Field::ball(0.875);
  const auto rows = rows_below("| operation |", 2);
  ASSERT_EQ(rows.size(), operations().size());
  for (const auto& [name, operation] : operations()) {
    ASSERT_TRUE(rows.contains(name)) << name;
    const Field made = operation.carry_out(f, g);
    for (const Vec3 p : points()) EXPECT_NEAR(made.value(p), operation.formula(f, g, p), 1e-13) << name;
    // Distances stay distances, or become bounds of them; the slope tells: nowhere more than 1.
    EXPECT_LE(made.lipschitz(), 1 + 1e-12) << name;
    if (rows.at(name) != "kept") continue;
    for (const Vec3 p : points()) EXPECT_NEAR(norm(made.gradient(p)), 1, 1e-9) << name;
  }
}

bool holds(const Box3& box, Vec3 p) {
  for (std::size_t i = 0; i < 3; ++i)
    if (p[i] < box.min[i] || p[i] > box.max[i]) return false;
  return true;
}

TEST(FieldsPage, BoxesHoldTheBodies) {
  const Field f = Field::box({1, 0.75, 0.5}).translated({0.125, 0.25, 0}), g = Field::ball(0.875);
  for (const auto& [name, operation] : operations()) {
    const Field made = operation.carry_out(f, g);
    for (const double level : {-0.25, 0.0, 0.5}) {
      const Box3 body = made.bounds(level), rest = made.complement_bounds(level);
      for (const Vec3 p : points()) {
        if (made.value(p) <= level) {
          EXPECT_TRUE(holds(body, p)) << name << " " << level;
        }
        if (-made.value(p) <= level) {
          EXPECT_TRUE(holds(rest, p)) << name << " " << level;
        }
      }
    }
  }
}

TEST(FieldsPage, PrimitivesThatAreDistancesHaveUnitSlope) {
  DiagnosticSink sink;
  const std::map<std::string, Field> made{{"ball *r*", Field::ball(1.25)},
                                          {"box *h* (half sizes)", Field::box({1, 0.5, 0.75})},
                                          {"cylinder *r*", Field::cylinder(0.5)},
                                          {"cone *r*₀, *r*₁, *h*", Field::cone(1, 0.5, 1.5)},
                                          {"torus *R*, *r*", Field::torus(1, 0.25)},
                                          {"capsule *a*, *b*, *r*", Field::capsule({-1, 0, 0}, {1, 1, 0.5}, 0.25)},
                                          {"half-space *n*, *d*", Field::half_space({1, 2, 2}, 0.5)},
                                          {"surface", *Field::surface("gyroid", sink)},
                                          {"expression", *Field::expression("x*y - z", sink)}};
  const auto rows = rows_below("| primitive |", 2);
  ASSERT_EQ(rows.size(), made.size() + 1);
  EXPECT_EQ(rows.at("mesh"), "distance");  // its own room tests that
  for (const auto& [name, field] : made) {
    ASSERT_TRUE(rows.contains(name)) << name;
    bool unit = true;
    for (const Vec3 p : points()) unit = unit && std::abs(norm(field.gradient(p)) - 1) < 1e-9;
    EXPECT_EQ(unit, rows.at(name) == "distance") << name;
  }
}

}  // namespace
}  // namespace meso::implicit
