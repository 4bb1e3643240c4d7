// SPDX-License-Identifier: Apache-2.0
#pragma once
// Triangles in boxes in boxes: which triangle is nearest to a point, which does a ray meet?
//
// Boxes are floats, relative to the middle of the mesh and rounded outward; everything that decides is in double. What
// is found does not depend on where the search begins.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "exact_sign.hpp"
#include "stop_poll.hpp"

namespace meso::implicit {

/// What a closed surface does around a point, decided exactly.
struct Winding {
  int number = 0;           ///< how many times the surface encloses the point
  bool on_surface = false;  ///< then the number means nothing
};

class TriangleTree {
 public:
  static constexpr std::uint32_t no_triangle = ~std::uint32_t{0};

  struct Nearest {
    double squared_distance = HUGE_VAL;
    Vec3 offset;  ///< from the point to the nearest point
    std::uint32_t triangle = no_triangle;
  };

  /// Four children, so that one visit decides on all of them. A child is a node's number, or `leaf` with a number of
  /// triangles less one and the first of them. The triangles of a leaf also lie between two planes: where a surface is
  /// finer than its distance, boxes alone do not tell which of many leaves is the nearest.
  struct alignas(64) Node {
    static constexpr std::uint32_t leaf = 1u << 31, count_shift = 29, first_mask = (1u << count_shift) - 1;
    std::array<std::array<float, 4>, 3> low, high;  ///< an empty slot has low > high
    std::array<std::array<float, 4>, 3> normal;     ///< of the planes, not longer than 1
    std::array<float, 4> behind, before;            ///< behind <= dot(normal, x) <= before
    std::array<std::uint32_t, 4> child;
  };

  /// `triangles` in an order that keeps neighbours together (spatial_order.hpp), at least one, at most 2^29. Cut short
  /// by `stop`, the tree must not be asked.
  TriangleTree(std::vector<Triangle> triangles, const Box3& box, StopPoll& stop);

  /// `hint`: a triangle that may be near, to begin with. Triangles farther than `within` may be overlooked.
  [[nodiscard]] Nearest nearest(Vec3 p, std::uint32_t hint = no_triangle, double within = HUGE_VAL) const;
  [[nodiscard]] Winding winding(Vec3 p) const;
  /// Unit normals of the triangles that p is on, exactly; without repetition, some eight at most.
  [[nodiscard]] std::vector<Vec3> normals_at(Vec3 p) const;

  [[nodiscard]] std::span<const Triangle> triangles() const { return triangles_; }
  [[nodiscard]] std::span<const Node> nodes() const { return nodes_; }
  [[nodiscard]] const Box3& box() const { return box_; }
  [[nodiscard]] std::uint64_t bytes() const {
    return triangles_.capacity() * sizeof(Triangle) + nodes_.capacity() * sizeof(Node);
  }

 private:
  class Best;
  template <class Query>
  void search(const Query& q, Best& best) const;
  [[nodiscard]] Vec3 to_unit(Vec3 p) const { return unit_ * (p - middle_); }

  std::vector<Triangle> triangles_;
  std::vector<Node> nodes_;  // nodes_[0] is the root
  Box3 box_;
  Vec3 middle_;
  double unit_ = 1;  // a power of two that brings the mesh into [-1, 1]^3
};

}  // namespace meso::implicit
