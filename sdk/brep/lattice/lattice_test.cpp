// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <numbers>

#include "meso/brep/audit.hpp"
#include "meso/brep/lattice_body.hpp"
#include "meso/brep/measure.hpp"

namespace meso::brep {
namespace {

constexpr double pi = std::numbers::pi;

LatticeCell bcc(Vec3 size, double strut, double ball) {
  LatticeCell cell{.box = {{0, 0, 0}, size}, .primitives = {}};
  const Vec3 centre = 0.5 * size;
  cell.primitives.push_back(Ball{centre, ball});
  for (int i = 0; i < 8; ++i) {
    const Vec3 corner{i & 1 ? size.x : 0, i & 2 ? size.y : 0, i & 4 ? size.z : 0};
    cell.primitives.push_back(Ball{corner, ball});
    cell.primitives.push_back(Frustum{corner, centre, strut, strut});
  }
  return cell;
}

/// Two whole balls, eight struts between their circles, minus the caps that the struts cut from the balls.
double bcc_volume(Vec3 size, double strut, double ball) {
  const double height = std::sqrt(ball * ball - strut * strut), sagitta = ball - height;
  const double cap = pi * sagitta * sagitta * (3 * ball - sagitta) / 3;
  const double length = 0.5 * norm(size) - 2 * height;
  return 2 * 4 * pi / 3 * ball * ball * ball + 8 * (pi * strut * strut * length - 2 * cap);
}

LatticeSet block(int x, int y, int z) {
  return {.min = {0, 0, 0}, .max = {x - 1, y - 1, z - 1}, .inside = [](Index3) { return true; }};
}

TEST(Lattice, BodyCentredBlock) {
  DiagnosticSink sink;
  const auto body = lattice_body(bcc({5, 5, 5}, 0.5, 0.9), block(2, 2, 2), {}, sink);
  for (const Diagnostic& d : sink.diagnostics()) std::cerr << render(d) << '\n';
  ASSERT_TRUE(body);
  const Audit a = audit(*body);
  EXPECT_TRUE(a.clean()) << a.free_edges << ' ' << a.multiple_edges << ' ' << a.conflicts << ' ' << a.open_loops << ' '
                         << a.components << ' ' << a.shells;
  const Measures m = measure(*body);
  EXPECT_NEAR(m.volume / (8 * bcc_volume({5, 5, 5}, 0.5, 0.9)), 1, 1e-6);
  std::cerr << m.volume << ' ' << a.faces << '\n';
}

}  // namespace
}  // namespace meso::brep
