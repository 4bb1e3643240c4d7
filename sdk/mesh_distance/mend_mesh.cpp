// SPDX-License-Identifier: Apache-2.0
#include "mend_mesh.hpp"

#include <algorithm>
#include <numeric>
#include <span>
#include <tuple>

namespace meso::implicit {
namespace {

using Keys = std::array<std::uint64_t, 3>;

/// One side of a triangle: its ends, smaller key first, and whether the triangle runs along it that way.
struct Side {
  std::uint64_t low, high;
  std::uint32_t triangle;  // of the kept ones
  bool forward;
};

std::vector<Side> sorted_sides(const std::vector<Keys>& corners) {
  std::vector<Side> sides;
  sides.reserve(3 * corners.size());
  for (std::uint32_t t = 0; t < corners.size(); ++t) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint64_t a = corners[t][i], b = corners[t][(i + 1) % 3];
      if (a != b) sides.push_back({std::min(a, b), std::max(a, b), t, a < b});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.triangle, a.forward) < std::tie(b.low, b.high, b.triangle, b.forward);
  });
  return sides;
}

/// Calls back the sides of every edge.
template <class Visit>
void visit_edges(std::span<const Side> sides, Visit visit) {
  for (std::size_t first = 0; first < sides.size();) {
    std::size_t last = first + 1;
    while (last < sides.size() && sides[last].low == sides[first].low && sides[last].high == sides[first].high) ++last;
    visit(sides.subspan(first, last - first));
    first = last;
  }
}

/// Pieces that share edges of two triangles, and in each which triangles face one way (union-find with parity).
class Pieces {
 public:
  explicit Pieces(std::size_t triangles) : parent_(triangles), opposed_(triangles, false) {
    std::iota(parent_.begin(), parent_.end(), 0u);
  }
  struct Root {
    std::uint32_t piece;
    bool opposed;  ///< faces the other way than the piece's root
  };
  Root find(std::uint32_t t) {
    Root root{t, false};
    while (parent_[root.piece] != root.piece) {
      root.opposed = root.opposed != opposed_[root.piece];
      root.piece = parent_[root.piece];
    }
    for (bool opposed = root.opposed; parent_[t] != root.piece && t != root.piece;) {
      const std::uint32_t above = parent_[t];
      const bool next = opposed != opposed_[t];
      parent_[t] = root.piece;
      opposed_[t] = opposed;
      opposed = next;
      t = above;
    }
    return root;
  }
  /// False if they are known to be the other way round.
  bool join(std::uint32_t a, std::uint32_t b, bool opposed) {
    const Root x = find(a), y = find(b);
    if (x.piece == y.piece) return (x.opposed != y.opposed) == opposed;
    const auto [low, high] = std::minmax(x.piece, y.piece);
    parent_[high] = low;
    opposed_[high] = (x.opposed != y.opposed) != opposed;
    return true;
  }

 private:
  std::vector<std::uint32_t> parent_;
  std::vector<bool> opposed_;
};

std::int64_t imbalance(std::span<const Side> edge) {
  std::int64_t sum = 0;
  for (const Side& s : edge) sum += s.forward ? 1 : -1;
  return sum;
}

std::uint64_t unbalanced_edges(const std::vector<Keys>& corners) {
  std::uint64_t count = 0;
  visit_edges(sorted_sides(corners), [&](std::span<const Side> edge) { count += imbalance(edge) != 0 ? 1 : 0; });
  return count;
}

std::vector<Keys> corner_keys(const std::vector<Placed>& order, const TriangleMesh& mesh,
                              const std::vector<std::uint64_t>& keys) {
  std::vector<Keys> out;
  out.reserve(order.size());
  for (const Placed& p : order) {
    const auto& [a, b, c] = mesh.triangles[p.triangle()];
    out.push_back({keys[a], keys[b], keys[c]});
  }
  return out;
}

/// The triangles that are not a later copy of another one, smallest key first so that copies show.
std::vector<Placed> without_copies(const std::vector<Placed>& order, const std::vector<Keys>& corners) {
  std::vector<std::pair<Keys, std::uint32_t>> faces(order.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    faces[i] = {corners[i], i};
    Keys& k = faces[i].first;
    std::rotate(k.begin(), std::min_element(k.begin(), k.end()), k.end());
  }
  std::sort(faces.begin(), faces.end());
  std::vector<bool> copy(order.size(), false);
  for (std::size_t i = 1; i < faces.size(); ++i) copy[faces[i].second] = faces[i].first == faces[i - 1].first;
  std::vector<Placed> out;
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (!copy[i]) out.push_back(order[i]);
  }
  return out;
}

double area(const std::array<std::uint32_t, 3>& t, const TriangleMesh& mesh) {
  const Vec3 a = mesh.points[t[0]];
  return norm(cross(mesh.points[t[1]] - a, mesh.points[t[2]] - a));
}

std::vector<bool> minority(const std::vector<Placed>& order, const TriangleMesh& mesh, std::span<const Side> sides) {
  Pieces pieces(order.size());
  std::vector<bool> hopeless(order.size(), false);  // one-sided pieces: nothing to agree on
  visit_edges(sides, [&](std::span<const Side> edge) {
    if (edge.size() != 2) return;
    const bool agree = pieces.join(edge[0].triangle, edge[1].triangle, edge[0].forward == edge[1].forward);
    if (!agree) hopeless[edge[0].triangle] = true;
  });
  std::vector<double> balance(order.size(), 0);  // by piece: area like the root less area opposed
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    const Pieces::Root root = pieces.find(i);
    balance[root.piece] += (root.opposed ? -1 : 1) * area(mesh.triangles[order[i].triangle()], mesh);
    if (hopeless[i]) hopeless[root.piece] = true;
  }
  std::vector<bool> turned(order.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    const Pieces::Root root = pieces.find(i);
    turned[i] = !hopeless[root.piece] && root.opposed == (balance[root.piece] >= 0);
  }
  return turned;
}

}  // namespace

std::vector<bool> mend_mesh(std::vector<Placed>& order, const TriangleMesh& mesh,
                            const std::vector<std::uint64_t>& keys, MeshQuality& quality) {
  std::vector<Keys> corners = corner_keys(order, mesh, keys);
  if (std::vector<Placed> once = without_copies(order, corners); once.size() < order.size()) {
    std::vector<Keys> corners_once = corner_keys(once, mesh, keys);
    if (unbalanced_edges(corners_once) < unbalanced_edges(corners)) {
      quality.repeated = order.size() - once.size();
      order.swap(once);
      corners.swap(corners_once);
    }
  }
  std::vector<bool> turned = minority(order, mesh, sorted_sides(corners));
  quality.turned = static_cast<std::uint64_t>(std::count(turned.begin(), turned.end(), true));
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (turned[i]) std::swap(corners[i][1], corners[i][2]);
  }
  visit_edges(sorted_sides(corners), [&](std::span<const Side> edge) {
    if (imbalance(edge) == 0) return;
    ++(edge.size() == 1 ? quality.open_edges : edge.size() == 2 ? quality.flipped_edges : quality.multiple_edges);
  });
  return turned;
}

}  // namespace meso::implicit
