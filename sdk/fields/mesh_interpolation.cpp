// SPDX-License-Identifier: Apache-2.0
#include "meso/fields/mesh_interpolation.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace meso::fields {
namespace {

constexpr double inside_tolerance = 1e-9;  // of the element: no gap between neighbours
constexpr double corner_tolerance = 1e-12;
constexpr std::size_t leaf_elements = 4;
constexpr std::size_t poll_elements = 1 << 15;  // sorting fewer takes a few milliseconds
constexpr int most_newton_steps = 30;

/// Corners of VTK's hexahedron in the unit cube.
constexpr double cube[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};

struct Node {
  Box3 box;
  std::uint32_t first = 0, count = 0;  ///< of a leaf: elements; else count 0, children at `first` and `first + 1`
};

double snapped(double w) { return std::abs(w) < corner_tolerance ? 0 : std::abs(w - 1) < corner_tolerance ? 1 : w; }

}  // namespace

struct MeshInterpolation::Tree {
  std::shared_ptr<const std::vector<Vec3>> points;
  std::size_t corners;
  std::vector<std::int64_t> connectivity;
  std::vector<std::uint32_t> order;
  std::vector<Node> nodes;

  [[nodiscard]] Vec3 corner(std::size_t element, std::size_t c) const {
    return (*points)[static_cast<std::size_t>(connectivity[corners * element + c])];
  }
  [[nodiscard]] Box3 box_of(std::size_t element) const {
    Box3 box;
    for (std::size_t c = 0; c < corners; ++c) box.extend(corner(element, c));
    const double margin = inside_tolerance * norm(box.max - box.min);
    box.extend(box.min - Vec3{margin, margin, margin});
    box.extend(box.max + Vec3{margin, margin, margin});
    return box;
  }

  /// False: asked to stop.
  bool build(const std::vector<Box3>& boxes, std::size_t node, std::uint32_t first, std::uint32_t count,
             const RunOptions& run) {
    if (count >= poll_elements && run.should_stop()) return false;
    Box3 all, centers;
    for (std::uint32_t i = first; i < first + count; ++i) {
      const Box3& b = boxes[order[i]];
      all.extend(b.min);
      all.extend(b.max);
      centers.extend(b.min + b.max);
    }
    nodes[node] = {all, first, count};
    if (count <= leaf_elements) return true;
    const Vec3 extent = centers.max - centers.min;
    const std::size_t axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
    const std::uint32_t half = count / 2;
    std::nth_element(order.begin() + first, order.begin() + first + half, order.begin() + first + count,
                     [&](std::uint32_t a, std::uint32_t b) {
                       const double ca = boxes[a].min[axis] + boxes[a].max[axis],
                                    cb = boxes[b].min[axis] + boxes[b].max[axis];
                       return ca < cb || (ca == cb && a < b);
                     });
    const std::size_t children = nodes.size();
    nodes[node] = {all, static_cast<std::uint32_t>(children), 0};
    nodes.resize(children + 2);
    return build(boxes, children, first, half, run) && build(boxes, children + 1, first + half, count - half, run);
  }

  [[nodiscard]] std::optional<std::array<double, 8>> tetra_weights(std::size_t e, Vec3 p) const {
    const Vec3 o = corner(e, 0), a = corner(e, 1) - o, b = corner(e, 2) - o, c = corner(e, 3) - o, d = p - o;
    const double volume = dot(a, cross(b, c));
    if (volume == 0) return std::nullopt;
    const double wa = dot(d, cross(b, c)) / volume, wb = dot(a, cross(d, c)) / volume,
                 wc = dot(a, cross(b, d)) / volume, wo = 1 - wa - wb - wc;
    if (!(std::min({wo, wa, wb, wc}) >= -inside_tolerance)) return std::nullopt;
    return std::array<double, 8>{wo, wa, wb, wc};
  }

  /// Newton's method for the place in the unit cube whose trilinear image is p.
  [[nodiscard]] std::optional<std::array<double, 8>> hexa_weights(std::size_t e, Vec3 p) const {
    Vec3 u{0.5, 0.5, 0.5};
    std::array<double, 8> weights{};
    for (int step = 0; step < most_newton_steps; ++step) {
      Vec3 image;
      Vec3 columns[3];
      for (std::size_t c = 0; c < 8; ++c) {
        double factor[3], slope[3];
        for (std::size_t a = 0; a < 3; ++a) {
          factor[a] = cube[c][a] == 0 ? 1 - u[a] : u[a];
          slope[a] = cube[c][a] == 0 ? -1 : 1;
        }
        const Vec3 x = corner(e, c);
        weights[c] = factor[0] * factor[1] * factor[2];
        image += weights[c] * x;
        columns[0] += slope[0] * factor[1] * factor[2] * x;
        columns[1] += factor[0] * slope[1] * factor[2] * x;
        columns[2] += factor[0] * factor[1] * slope[2] * x;
      }
      const double volume = dot(columns[0], cross(columns[1], columns[2]));
      if (volume == 0) return std::nullopt;
      const Vec3 d = p - image;
      const Vec3 move{dot(d, cross(columns[1], columns[2])) / volume, dot(columns[0], cross(d, columns[2])) / volume,
                      dot(columns[0], cross(columns[1], d)) / volume};
      u += move;
      if (!(norm(u) < 100)) return std::nullopt;  // far outside
      if (norm(move) > 1e-15) continue;
      break;
    }
    for (std::size_t a = 0; a < 3; ++a) {
      if (!(u[a] >= -inside_tolerance && u[a] <= 1 + inside_tolerance)) return std::nullopt;
      u[a] = snapped(u[a]);
    }
    for (std::size_t c = 0; c < 8; ++c) {
      weights[c] = 1;
      for (std::size_t a = 0; a < 3; ++a) weights[c] *= cube[c][a] == 0 ? 1 - u[a] : u[a];
    }
    return weights;
  }

  /// The lowest-numbered element that holds p, so that the tree decides nothing.
  void find(std::size_t node, Vec3 p, std::size_t& best, std::array<double, 8>& weights) const {
    const Node& n = nodes[node];
    if (!(p.x >= n.box.min.x && p.x <= n.box.max.x && p.y >= n.box.min.y && p.y <= n.box.max.y && p.z >= n.box.min.z &&
          p.z <= n.box.max.z))
      return;
    if (n.count == 0) {
      find(n.first, p, best, weights);
      find(n.first + 1, p, best, weights);
      return;
    }
    for (std::uint32_t i = n.first; i < n.first + n.count; ++i) {
      const std::size_t e = order[i];
      if (e >= best) continue;
      if (const auto found = corners == 4 ? tetra_weights(e, p) : hexa_weights(e, p)) {
        best = e;
        weights = *found;
      }
    }
  }
};

std::optional<MeshInterpolation> MeshInterpolation::make(std::shared_ptr<const std::vector<Vec3>> points,
                                                         std::size_t corners, std::vector<std::int64_t> connectivity,
                                                         const RunOptions& run) {
  assert((corners == 4 || corners == 8) && connectivity.size() % corners == 0);
  auto tree = std::make_unique<Tree>();
  tree->points = std::move(points);
  tree->corners = corners;
  tree->connectivity = std::move(connectivity);
  const std::size_t elements = tree->connectivity.size() / corners;
  std::vector<Box3> boxes(elements);
  tree->order.resize(elements);
  for (std::size_t e = 0; e < elements; ++e) {
    boxes[e] = tree->box_of(e);
    tree->order[e] = static_cast<std::uint32_t>(e);
  }
  tree->nodes.resize(1);
  if (elements > 0 && !tree->build(boxes, 0, 0, static_cast<std::uint32_t>(elements), run)) return std::nullopt;
  return MeshInterpolation(std::move(tree));
}
MeshInterpolation::MeshInterpolation(std::unique_ptr<const Tree> tree) : tree_(std::move(tree)) {}
MeshInterpolation::MeshInterpolation(MeshInterpolation&&) noexcept = default;
MeshInterpolation& MeshInterpolation::operator=(MeshInterpolation&&) noexcept = default;
MeshInterpolation::~MeshInterpolation() = default;

std::optional<Stencil> MeshInterpolation::at(Vec3 p) const {
  const std::size_t none = std::numeric_limits<std::size_t>::max();
  std::size_t element = none;
  std::array<double, 8> weights{};
  tree_->find(0, p, element, weights);
  if (element == none) return std::nullopt;
  Stencil stencil;
  for (std::size_t c = 0; c < tree_->corners; ++c)
    stencil.add(tree_->connectivity[tree_->corners * element + c], snapped(weights[c]));
  return stencil;
}

}  // namespace meso::fields
