// SPDX-License-Identifier: Apache-2.0
#include "open_signs.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>

namespace meso::implicit {
namespace {

struct Node {
  std::int32_t i, j, k;
};

class Front {
 public:
  Front(const GridTicks& ticks, const IsInside& is_inside, StopPoll& stop)
      : ticks_(ticks),
        is_inside_(is_inside),
        stop_(stop),
        known_(ticks.rows() * row_length()),
        inside_(known_.size()) {}

  void want(Node n) {
    if (n.i < 0 || n.j < 0 || n.k < 0 || n.i >= ticks_.x.size() || n.j >= ticks_.y.size() || n.k >= ticks_.z.size())
      return;
    if (known_[number(n)]) return;
    known_[number(n)] = true;
    wanted_.push_back(n);
  }

  /// Evaluates what is wanted and follows the places where neighbours differ.
  void advance() {
    while (!wanted_.empty()) {
      const std::vector<Node> nodes = std::exchange(wanted_, {});
      std::vector<char> found(nodes.size());
      tbb::parallel_for(tbb::blocked_range<std::size_t>(0, nodes.size(), 1024), [&](const auto& range) {
        if (stop_()) return;
        for (std::size_t n = range.begin(); n != range.end(); ++n)
          found[n] = is_inside_(nodes[n].i, nodes[n].j, nodes[n].k) ? 1 : 0;
      });
      if (stop_.stopped()) return;
      for (std::size_t n = 0; n < nodes.size(); ++n) inside_[number(nodes[n])] = found[n] != 0;
      for (const Node& n : nodes) follow(n);
    }
  }

  /// Every other node is like the one before it in its row; the first one like that of the row before.
  [[nodiscard]] bool inside(Node n, bool before) const { return known_[number(n)] ? inside_[number(n)] : before; }

 private:
  [[nodiscard]] std::size_t row_length() const { return std::size_t(ticks_.x.size()); }
  [[nodiscard]] std::size_t number(Node n) const { return ticks_.row(n.j, n.k) * row_length() + std::size_t(n.i); }

  void follow(Node n) {
    const auto differs = [&](std::int32_t di, std::int32_t dj, std::int32_t dk) {
      const Node m{n.i + di, n.j + dj, n.k + dk};
      if (m.i < 0 || m.j < 0 || m.k < 0 || m.i >= ticks_.x.size() || m.j >= ticks_.y.size() || m.k >= ticks_.z.size())
        return;
      if (!known_[number(m)] || inside_[number(m)] == inside_[number(n)]) return;
      want_around(n);
      want_around(m);
    };
    for (const std::int32_t d : {-1, 1}) {
      differs(d, 0, 0);
      differs(0, d, 0);
      differs(0, 0, d);
    }
  }
  void want_around(Node n) {
    for (std::int32_t k = -1; k <= 1; ++k) {
      for (std::int32_t j = -1; j <= 1; ++j) {
        for (std::int32_t i = -1; i <= 1; ++i) want({n.i + i, n.j + j, n.k + k});
      }
    }
  }

  const GridTicks& ticks_;
  const IsInside& is_inside_;
  StopPoll& stop_;
  std::vector<bool> known_, inside_;
  std::vector<Node> wanted_;
};

Vec3 rotated(Vec3 p) { return {p.y, p.z, p.x}; }

/// Both ends of every edge along a row that is crossed. `turns` axes were rotated to make that row run along x.
void want_crossed(Front& front, const RowSigns& rows, const GridTicks& ticks, int turns) {
  for (std::int32_t k = 0; k < ticks.z.size(); ++k) {
    for (std::int32_t j = 0; j < ticks.y.size(); ++j) {
      for (const RowSigns::Change& c : rows.changes(ticks.row(j, k))) {
        for (const std::int32_t i : {c.node - 1, c.node})
          front.want(turns == 0 ? Node{i, j, k} : turns == 1 ? Node{k, i, j} : Node{j, k, i});
      }
    }
  }
}

}  // namespace

void decide_by_winding_number(RowSigns& rows, std::span<const Triangle> triangles, const GridTicks& ticks,
                              const IsInside& is_inside, StopPoll& stop) {
  Front front(ticks, is_inside, stop);
  front.want({0, 0, 0});
  want_crossed(front, rows, ticks, 0);
  std::vector<Triangle> turned(triangles.begin(), triangles.end());
  GridTicks turned_ticks = ticks;
  for (int turns = 1; turns < 3; ++turns) {
    tbb::parallel_for(std::size_t{0}, turned.size(), [&](std::size_t t) {
      for (Vec3& p : turned[t]) p = rotated(p);
    });
    turned_ticks = {turned_ticks.y, turned_ticks.z, turned_ticks.x};
    const RowSigns turned_rows(turned, turned_ticks, stop);
    if (stop()) return;
    want_crossed(front, turned_rows, turned_ticks, turns);
  }
  front.advance();
  if (stop()) return;

  std::vector<std::size_t> start{0};
  std::vector<RowSigns::Change> changes;
  bool first_of_plane = false;
  for (std::int32_t k = 0; k < ticks.z.size(); ++k) {
    bool first_of_row = first_of_plane;
    for (std::int32_t j = 0; j < ticks.y.size(); ++j) {
      first_of_row = front.inside({0, j, k}, first_of_row);
      if (j == 0) first_of_plane = first_of_row;
      bool before = false;
      for (std::int32_t i = 0; i < ticks.x.size(); ++i) {
        const bool now = front.inside({i, j, k}, i == 0 ? first_of_row : before);
        if (now != before) changes.push_back({i, now ? 1 : 0});
        before = now;
      }
      start.push_back(changes.size());
    }
  }
  rows.replace_changes(std::move(start), std::move(changes));
}

}  // namespace meso::implicit
