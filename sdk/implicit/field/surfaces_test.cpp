// SPDX-License-Identifier: Apache-2.0
// The table of surfaces against what is known of them: volumes, ranges, slopes, periods and symmetries.

#include "meso/implicit/surfaces.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <set>

#include "csv_rows.hpp"
#include "meso/implicit/field.hpp"
#include "quasi_monte_carlo.hpp"

namespace meso::implicit {
namespace {

const std::string folder = MESO_SOURCE_DIR "/sdk/implicit/field/";
constexpr double pi = std::numbers::pi;
const Box3 unit_cell{{0, 0, 0}, {1, 1, 1}};

Field named(std::string_view name) {
  DiagnosticSink sink;
  return *Field::surface(name, sink);
}

/// The largest difference between the tabulated shares of volume and those of `count` points.
double worst_share(std::size_t count) {
  const std::vector<Row> truths = csv_rows(folder + "surface_truth.csv");
  double worst = 0;
  std::size_t compared = 0;
  for (const Surface& surface : surfaces()) {
    std::vector<double> values;
    for (const Row& row : truths) {
      if (row.at("name") != surface.name || row.at("kind") == "area") continue;
      if (values.empty())
        QuasiMonteCarlo(unit_cell).sample(named(surface.name), count, [&](std::span<const double> some) {
          values.insert(values.end(), some.begin(), some.end());
        });
      const double level = std::stod(row.at("level"));
      std::size_t inside = 0;
      for (const double v : values)
        inside += (row.at("kind") == "endo" ? v <= level : std::abs(v) <= level / 2) ? 1 : 0;
      const double share = static_cast<double>(inside) / static_cast<double>(count);
      worst = std::max(worst, std::abs(share - std::stod(row.at("value"))));
      ++compared;
    }
  }
  EXPECT_EQ(compared, 18U * 21U);
  return worst;
}

TEST(Surfaces, EncloseTheSharesOfVolumeThatAreKnown) { EXPECT_LT(worst_share(200000), 1e-3); }
/// Minutes: run with the label `slow`.
TEST(Surfaces, DISABLED_EncloseTheSharesOfVolumeThatAreKnownExactly) { EXPECT_LT(worst_share(4000000), 2e-4); }

TEST(Surfaces, StayInTheirRangesAndBelowTheirSlopes) {
  for (const Surface& surface : surfaces()) {
    const Field f = named(surface.name);
    double least = HUGE_VAL, most = -HUGE_VAL, steepest = 0;
    QuasiMonteCarlo(unit_cell).sample(f, 20000, [&](std::span<const double> values) {
      for (const double v : values) {
        least = std::min(least, v);
        most = std::max(most, v);
      }
    });
    std::mt19937_64 engine(4);
    std::uniform_real_distribution<double> u(0, 2);
    for (int i = 0; i < 2000; ++i) steepest = std::max(steepest, norm(f.gradient({u(engine), u(engine), u(engine)})));
    EXPECT_GE(least, surface.min - 1e-9) << surface.name;
    EXPECT_LE(most, surface.max + 1e-9) << surface.name;
    EXPECT_LE(steepest, surface.lipschitz) << surface.name;
    // ... and come near to them.
    EXPECT_LE(least, surface.min + 0.06 * (surface.max - surface.min)) << surface.name;
    EXPECT_GE(most, surface.max - 0.06 * (surface.max - surface.min)) << surface.name;
    EXPECT_GE(steepest, 0.9 * surface.lipschitz) << surface.name;
  }
}

/// Whether f(map(p)) is f(p) (+1), -f(p) (-1) or neither (0).
template <class Map>
int parity(const Field& f, Map map) {
  std::mt19937_64 engine(3);
  std::uniform_real_distribution<double> u(-2, 2);
  bool even = true, odd = true;
  for (int i = 0; i < 40; ++i) {
    const Vec3 p{u(engine), u(engine), u(engine)};
    const double a = f.value(p), b = f.value(map(p));
    even = even && std::abs(a - b) < 1e-10;
    odd = odd && std::abs(a + b) < 1e-10;
  }
  return even ? 1 : odd ? -1 : 0;
}

TEST(Surfaces, HaveThePeriodsAndSymmetriesOfTheTable) {
  for (const Row& row : csv_rows(folder + "surfaces.csv")) {
    const std::string& name = row.at("name");
    const Field f = named(name);
    const Vec3 period{1, name == "q-star-hex" ? std::sqrt(3.0) : 1, 1};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Vec3 step;
      step[axis] = period[axis];
      EXPECT_EQ(parity(f, [&](Vec3 p) { return p + step; }), 1) << name;
    }
    for (int half = 1; half < 8; ++half) {
      const Vec3 step{0.5 * period.x * (half >> 2), 0.5 * period.y * (half >> 1 & 1), 0.5 * period.z * (half & 1)};
      const std::string key{char('0' + (half >> 2)), char('0' + (half >> 1 & 1)), char('0' + (half & 1))};
      const bool even = row.at("translations").find(key) != std::string::npos;
      const bool odd = row.at("odd_translations").find(key) != std::string::npos;
      EXPECT_EQ(parity(f, [&](Vec3 p) { return p + step; }), int(even) - int(odd)) << name << " " << key;
    }
    const int inversion = row.at("inversion") == "even" ? 1 : row.at("inversion") == "odd" ? -1 : 0;
    EXPECT_EQ(parity(f, [](Vec3 p) { return -p; }), inversion) << name;
  }
}

// The lattices that the literature gives, apart from the table.
TEST(Surfaces, BelongToTheirLattices) {
  const auto half = [](double x, double y, double z) { return [=](Vec3 p) { return p + 0.5 * Vec3{x, y, z}; }; };
  for (const char* bcc : {"gyroid", "iwp", "lidinoid", "s", "split-p", "g-prime", "g-prime-2", "c-s", "c-i2-y", "c-g"})
    EXPECT_EQ(parity(named(bcc), half(1, 1, 1)), 1) << bcc;
  for (const char* fcc : {"d", "frd", "frd-4", "f", "c-d", "d-prime"})
    EXPECT_EQ(parity(named(fcc), half(1, 1, 0)), 1) << fcc;
  for (const char* odd : {"p", "neovius", "c-y", "y", "pm-y", "c-pm-y", "w"})
    EXPECT_EQ(parity(named(odd), half(1, 1, 1)), -1) << odd;
  for (const char* odd : {"d", "f", "c-d", "q-star"}) EXPECT_EQ(parity(named(odd), half(0, 0, 1)), -1) << odd;
  for (const char* odd : {"gyroid", "s", "c-g"}) EXPECT_EQ(parity(named(odd), [](Vec3 p) { return -p; }), -1) << odd;
  // Cyclic exchange of the axes: all but C(D), as it is printed, and Q*.
  for (const Surface& s : surfaces())
    if (s.name != "c-d" && !s.name.starts_with("q-star")) {
      EXPECT_EQ(parity(named(s.name), [](Vec3 p) { return Vec3{p.y, p.z, p.x}; }), 1) << s.name;
    }
}

TEST(Surfaces, HexagonalStarHasASixfoldScrew) {
  const Field f = named("q-star-hex");
  const auto in_axes = [](double u, double v, double w) { return Vec3{u - v / 2, std::sqrt(3.0) / 2 * v, w}; };
  const auto fractions = [](Vec3 p) { return Vec3{p.x + p.y / std::sqrt(3.0), 2 * p.y / std::sqrt(3.0), p.z}; };
  EXPECT_EQ(parity(f,
                   [&](Vec3 p) {
                     const Vec3 u = fractions(p);
                     return in_axes(u.x - u.y, u.x, u.z + 1.0 / 3);
                   }),
            1);
  // The orthogonal one is the same function read with other axes.
  const Field orthogonal = named("q-star");
  const Vec3 u{0.13, 0.37, 0.71};
  EXPECT_NEAR(f.value(in_axes(u.x, u.y, u.z)), orthogonal.value(u), 1e-12);
}

// Values and zero sets that are known exactly.
TEST(Surfaces, HaveKnownValues) {
  EXPECT_NEAR(named("p+c-p").value({0, 0, 0}), 1.75, 1e-15);
  EXPECT_NEAR(named("neovius").value({0, 0, 0}), 13, 1e-14);
  EXPECT_NEAR(named("lidinoid").value({0, 0, 0}), -2.7, 1e-15);
  std::mt19937_64 engine(3);
  std::uniform_real_distribution<double> u(-2, 2);
  for (int i = 0; i < 50; ++i) {
    const Vec3 p{u(engine), u(engine), u(engine)};
    const double a = std::cos(2 * pi * p.x), b = std::cos(2 * pi * p.y), c = std::cos(2 * pi * p.z);
    EXPECT_NEAR(named("w").value(p), 2 * (a - b) * (b - c) * (a - c), 1e-12);  // zero on the planes x = +-y, ...
    EXPECT_NEAR(named("f").value(p), a * b * c, 1e-14);
    // The gyroid of the table is the usual one moved by a quarter, with the sign changed.
    const Vec3 q = p + Vec3{0.25, 0.25, 0.25};
    EXPECT_NEAR(named("gyroid").value(p),
                -(std::sin(2 * pi * q.x) * std::cos(2 * pi * q.y) + std::sin(2 * pi * q.y) * std::cos(2 * pi * q.z) +
                  std::sin(2 * pi * q.z) * std::cos(2 * pi * q.x)),
                1e-12);
  }
}

TEST(Surfaces, NamesAreDistinctAndFoundFromNear) {
  std::set<std::string_view> names;
  for (const Surface& s : surfaces()) {
    EXPECT_TRUE(names.insert(s.name).second);
    EXPECT_EQ(find_surface(s.name), &s);
  }
  EXPECT_EQ(names.size(), 29U);  // 27, the other FRD, and Q* on its own axes
  EXPECT_EQ(find_surface("tpms.schwarz-d")->name, "d");
  EXPECT_EQ(find_surface("tpms.diamond")->title, "D");
  EXPECT_EQ(find_surface("Gyroid"), nullptr);
  EXPECT_EQ(find_surface(""), nullptr);
  EXPECT_EQ(nearest_surface("tpms.neovus"), "neovius");
  EXPECT_EQ(nearest_surface("icosahedron"), "");
}

}  // namespace
}  // namespace meso::implicit
