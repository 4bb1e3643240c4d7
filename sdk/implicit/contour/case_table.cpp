// SPDX-License-Identifier: Apache-2.0
#include "case_table.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace meso::implicit {
namespace {

using Loop = std::vector<std::uint8_t>;

constexpr std::uint8_t edge_between(unsigned a, unsigned b) {
  for (std::uint8_t e = 0; e < 12; ++e)
    if ((edge_corners[e][0] == a && edge_corners[e][1] == b) || (edge_corners[e][0] == b && edge_corners[e][1] == a))
      return e;
  return 12;
}

bool in_face(std::uint8_t edge, unsigned face) {
  unsigned corners = 0;
  for (const unsigned c : face_corners[face]) corners += c == edge_corners[edge][0] || c == edge_corners[edge][1];
  return corners == 2;
}

bool share_face(std::uint8_t a, std::uint8_t b) {
  for (unsigned f = 0; f < 6; ++f)
    if (in_face(a, f) && in_face(b, f)) return true;
  return false;
}

// Twice the middle of an edge.
std::array<int, 3> middle(std::uint8_t edge) {
  std::array<int, 3> m{};
  for (const unsigned c : edge_corners[edge])
    for (unsigned axis = 0; axis < 3; ++axis) m[axis] += static_cast<int>(c >> axis & 1U);
  return m;
}

int squared_length(std::uint8_t a, std::uint8_t b) {
  const auto p = middle(a), q = middle(b);
  int sum = 0;
  for (unsigned axis = 0; axis < 3; ++axis) sum += (p[axis] - q[axis]) * (p[axis] - q[axis]);
  return sum;
}

std::uint8_t find_ambiguous(unsigned inside) {
  std::uint8_t faces = 0;
  for (unsigned f = 0; f < 6; ++f) {
    const auto& c = face_corners[f];
    const auto in = [&](unsigned i) { return (inside >> c[i] & 1U) != 0; };
    if (in(0) == in(2) && in(1) == in(3) && in(0) != in(1)) faces |= static_cast<std::uint8_t>(1U << f);
  }
  return faces;
}

// In a face, a line of the surface runs from the side where one enters the inside to the side where one leaves it, the
// face walked around counter-clockwise. The neighbour walks the other way around, so lines chain into oriented loops.
std::array<std::uint8_t, 12> successors(unsigned inside, unsigned joined) {
  std::array<std::uint8_t, 12> next;
  next.fill(12);
  for (unsigned f = 0; f < 6; ++f) {
    const auto& c = face_corners[f];
    const auto in = [&](unsigned i) { return (inside >> c[i % 4] & 1U) != 0; };
    const bool join = (joined >> f & 1U) != 0;
    for (unsigned i = 0; i < 4; ++i) {
      if (!in(i) || in(i + 1)) continue;
      // Out of the inside between corners i and i + 1: around the outside (joined), or back around the inside.
      unsigned k = i;
      if (join) {
        while (in(k + 1) || !in(k + 2)) ++k;
        ++k;
      } else {
        while (in(k + 4) && in(k + 3)) k += 3;
        k += 3;
      }
      next[edge_between(c[k % 4], c[(k + 1) % 4])] = edge_between(c[i], c[(i + 1) % 4]);
    }
  }
  return next;
}

std::vector<Loop> trace_loops(unsigned inside, unsigned joined) {
  auto next = successors(inside, joined);
  std::vector<Loop> loops;
  for (std::uint8_t start = 0; start < 12; ++start) {
    if (next[start] == 12) continue;
    Loop loop;
    for (std::uint8_t e = start; next[e] != 12;) {
      loop.push_back(e);
      e = std::exchange(next[e], std::uint8_t{12});
    }
    loops.push_back(loop);
  }
  return loops;
}

void add(CellTriangles& cell, std::uint8_t a, std::uint8_t b, std::uint8_t c) {
  cell.triangles[cell.count++] = {a, b, c};
}

// The triangulation of a polygon with the shortest diagonals (Klincsek's recurrence), none of them in a face.
class Triangulation {
 public:
  explicit Triangulation(const Loop& loop) : loop_(loop), n_(loop.size()) {
    for (std::size_t length = 2; length < n_; ++length)
      for (std::size_t i = 0; i + length < n_; ++i) solve(i, i + length);
  }
  [[nodiscard]] bool exists() const { return cost_[0][n_ - 1] < impossible; }
  void add_to(CellTriangles& cell) const { add_to(cell, 0, n_ - 1); }

 private:
  static constexpr int impossible = 1 << 20;

  [[nodiscard]] int diagonal(std::size_t i, std::size_t k) const {
    if (k == i + 1 || (i == 0 && k == n_ - 1)) return 0;
    return share_face(loop_[i], loop_[k]) ? impossible : squared_length(loop_[i], loop_[k]);
  }
  void solve(std::size_t i, std::size_t k) {
    int best = impossible;
    for (std::size_t m = i + 1; m < k; ++m) {
      const int cost = cost_[i][m] + cost_[m][k];
      if (cost < best) best = cost, apex_[i][k] = m;
    }
    cost_[i][k] = std::min(impossible, best + diagonal(i, k));
  }
  void add_to(CellTriangles& cell, std::size_t i, std::size_t k) const {
    if (k < i + 2) return;
    const std::size_t m = apex_[i][k];
    add_to(cell, i, m);
    add(cell, loop_[i], loop_[m], loop_[k]);
    add_to(cell, m, k);
  }

  const Loop& loop_;
  std::size_t n_;
  std::array<std::array<int, 12>, 12> cost_{};
  std::array<std::array<std::size_t, 12>, 12> apex_{};
};

void triangulate(const Loop& loop, CellTriangles& cell) {
  const Triangulation triangulation(loop);
  if (triangulation.exists()) return triangulation.add_to(cell);
  assert(cell.centre_edges == 0);  // at most one loop of a cell needs one
  for (std::size_t i = 0; i < loop.size(); ++i) {
    cell.centre_edges |= static_cast<std::uint16_t>(1U << loop[i]);
    add(cell, loop[i], loop[(i + 1) % loop.size()], centre_vertex);
  }
}

void make_cell(unsigned inside, unsigned joined, CellTriangles& cell, CellLoops& loops) {
  for (const Loop& loop : trace_loops(inside, joined)) {
    CellLoop& out = loops.loops[loops.count++];
    const unsigned centre_before = cell.centre_edges;
    out.size = static_cast<std::uint8_t>(loop.size());
    out.first_triangle = cell.count;
    std::copy(loop.begin(), loop.end(), out.edges.begin());
    triangulate(loop, cell);
    out.triangle_count = static_cast<std::uint8_t>(cell.count - out.first_triangle);
    out.has_centre = cell.centre_edges != centre_before;
  }
}

std::uint8_t find_common_face(std::uint8_t a, std::uint8_t b) {
  for (std::uint8_t f = 0; f < 6; ++f)
    if (in_face(a, f) && in_face(b, f)) return f;
  return 6;
}

}  // namespace

CaseTable::CaseTable() {
  for (unsigned inside = 0; inside < 256; ++inside) {
    const std::uint8_t ambiguous = ambiguous_[inside] = find_ambiguous(inside);
    for (unsigned joined = 0; joined < 64; ++joined) {
      if ((joined & ~unsigned{ambiguous}) != 0) continue;
      slot_[64 * inside + joined] = static_cast<std::uint16_t>(cells_.size());
      make_cell(inside, joined, cells_.emplace_back(), loops_.emplace_back());
    }
    const CellTriangles& cell = at(inside, 0);
    assert(cell.count <= 5 && cell.centre_edges == 0);
    std::copy_n(cell.triangles.begin(), 5, plain_[inside].triangles.begin());
    plain_[inside].count = cell.count;
  }
  for (std::uint8_t a = 0; a < 12; ++a) {
    for (std::uint8_t b = 0; b < 12; ++b) common_face_[a][b] = find_common_face(a, b);
    for (unsigned face = 0; face < 6; ++face)
      if (in_face(a, face)) edges_of_face_[face] |= static_cast<std::uint16_t>(1U << a);
    for (unsigned axis = 0; axis < 3; ++axis)
      mirrored_[a][axis] = edge_between(edge_corners[a][0] ^ 1U << axis, edge_corners[a][1] ^ 1U << axis);
  }
}

const CaseTable& CaseTable::get() {
  static const CaseTable table;
  return table;
}

}  // namespace meso::implicit
