// SPDX-License-Identifier: Apache-2.0
#include "fill.hpp"

#include <algorithm>

namespace meso::implicit::stuffing {
namespace {

/// The four lattice tetrahedra around the long edge between two centres, which passes through a square of corners.
class Square {
 public:
  Square(const Points& points, std::vector<RawTet>& out) : points_(points), out_(out) {}

  void fill(const Index3& lower, std::size_t axis) {
    const std::size_t b = (axis + 1) % 3, c = (axis + 2) % 3;
    centre_index_ = {lower, lower};
    ++centre_index_[1][axis];
    Index3 corner = centre_index_[1];
    corner_index_.fill(corner);
    ++corner_index_[1][b], ++corner_index_[2][b], ++corner_index_[2][c], ++corner_index_[3][c];
    bool any_inside = false;
    for (std::size_t i = 0; i < 2; ++i) {
      centre_[i] = points_.centre(centre_index_[i]);
      any_inside |= points_.sign(centre_[i]) == Sign::inside;
    }
    for (std::size_t i = 0; i < 4; ++i) {
      corner_[i] = points_.corner(corner_index_[i]);
      any_inside |= points_.sign(corner_[i]) == Sign::inside;
    }
    if (!any_inside) return;
    // Of the corners seen along the axis from the lower centre, the second and the fourth have two greater coordinates.
    for (std::size_t i = 0; i < 4; ++i) tetrahedron(i, (i + 1) % 4, i % 2 == 1);
  }

 private:
  void tetrahedron(std::size_t i, std::size_t j, bool even) {
    const std::array<std::uint32_t, 4> id{corner_[i], corner_[j], centre_[0], centre_[1]};
    const std::array<Sign, 4> signs{points_.sign(id[0]), points_.sign(id[1]), points_.sign(id[2]), points_.sign(id[3])};
    const Stencil& s = stencil(signs, even);
    if (s.count == 0) return;
    std::array<std::uint32_t, 10> node{id[0], id[1], id[2], id[3]};
    for (std::size_t p = 0; p < 4; ++p)
      for (std::size_t q = p + 1; q < 4; ++q)
        if (signs[p] != Sign::zero && signs[q] != Sign::zero && signs[p] != signs[q])
          node[edge_node(p, q)] = points_.count() + cut_between(p, q, id, i, j);
    for (std::size_t t = 0; t < s.count; ++t) {
      const LocalTet& local = s.tets[t];
      out_.push_back({node[local[0]], node[local[1]], node[local[2]], node[local[3]]});
    }
  }

  [[nodiscard]] std::uint32_t cut_between(std::size_t p, std::size_t q, const std::array<std::uint32_t, 4>& id,
                                          std::size_t i, std::size_t j) const {
    if (p / 2 == q / 2) {
      const std::uint32_t owner = std::min(id[p], id[q]);
      unsigned axis = 0;
      while (points_.stride(owner, axis) != std::max(id[p], id[q]) - owner) ++axis;
      return points_.cut(owner, axis);
    }
    const Index3 &corner = corner_index_[p == 0 ? i : j], &centre = centre_index_[q - 2];
    unsigned edge = 0;
    for (std::size_t a = 0; a < 3; ++a) edge |= static_cast<unsigned>(corner[a] - centre[a]) << a;
    return points_.cut(id[q], long_edges + edge);
  }

  const Points& points_;
  std::vector<RawTet>& out_;
  std::array<Index3, 2> centre_index_{};
  std::array<Index3, 4> corner_index_{};
  std::array<std::uint32_t, 2> centre_{};
  std::array<std::uint32_t, 4> corner_{};
};

}  // namespace

std::optional<std::vector<RawTet>> fill(const Points& points, Threads& threads) {
  const Index3 n = points.lattice().cells;
  // A layer is what stands on a layer of centres, the one below the box included.
  std::vector<std::vector<RawTet>> layers(static_cast<std::size_t>(n[2]) + 1);
  const bool whole = threads.ranges("tetrahedra", layers.size(), 1, [&](std::size_t layer, std::size_t) {
    const auto k = static_cast<std::int32_t>(layer) - 1;
    Square square(points, layers[layer]);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (axis != 2 && k < 0) continue;
      for (std::int32_t j = axis == 1 ? -1 : 0; j < n[1]; ++j)
        for (std::int32_t i = axis == 0 ? -1 : 0; i < n[0]; ++i) square.fill({i, j, k}, axis);
    }
  });
  if (!whole) return std::nullopt;
  std::size_t count = 0;
  for (const auto& layer : layers) count += layer.size();
  std::vector<RawTet> tets;
  tets.reserve(count);
  for (auto& layer : layers) {
    tets.insert(tets.end(), layer.begin(), layer.end());
    std::vector<RawTet>().swap(layer);
  }
  return tets;
}

Numbered number_points(std::vector<RawTet> tets, const Points& points, const std::vector<Cut>& cuts,
                       const std::vector<Moved>& moved) {
  std::vector<std::uint32_t> number(std::size_t{points.count()} + cuts.size(), 0);
  for (const RawTet& t : tets)
    for (const std::uint32_t id : t) number[id] = 1;
  const auto used = static_cast<std::size_t>(std::count(number.begin(), number.end(), 1U));
  Numbered out;
  out.mesh.points.reserve(used);
  out.inside.reserve(used);
  auto next_moved = moved.begin();
  for (std::uint32_t id = 0; id < number.size(); ++id) {
    const bool is_moved = next_moved != moved.end() && next_moved->point == id;
    if (number[id] != 0) {
      number[id] = static_cast<std::uint32_t>(out.mesh.points.size());
      out.inside.push_back(id < points.count() && points.sign(id) == Sign::inside);
      out.mesh.points.push_back(id >= points.count() ? cuts[id - points.count()].at
                                : is_moved           ? next_moved->to
                                                     : points.position(id));
    }
    if (is_moved) ++next_moved;
  }
  for (RawTet& t : tets)
    for (std::uint32_t& id : t) id = number[id];
  out.mesh.tets = std::move(tets);
  return out;
}

}  // namespace meso::implicit::stuffing
