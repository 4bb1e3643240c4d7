// SPDX-License-Identifier: Apache-2.0
#include "prepared_mesh.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <optional>

#include "clean_mesh.hpp"
#include "near_blocks.hpp"
#include "open_signs.hpp"
#include "row_signs.hpp"

namespace meso::implicit {
namespace {

/// Triangles and nodes in one space where rows run along x. A map that only scales and shifts leaves the triangles
/// where they are and moves the nodes, which keeps signs those of the points that are asked elsewhere; any other map
/// moves the triangles to the grid.
class Alignment {
 public:
  Alignment(const Grid& grid, const Affine& field_from_grid) : field_from_grid_(field_from_grid) {
    assert(determinant(field_from_grid.linear) != 0);
    const auto& m = field_from_grid.linear.m;
    in_field_ = m[1] == 0 && m[2] == 0 && m[3] == 0 && m[5] == 0 && m[6] == 0 && m[7] == 0;
    for (std::size_t a = 0; a < 3; ++a) reversed_[a] = in_field_ && m[4 * a] < 0;
    size_ = grid.nodes;
    ticks_.emplace(GridTicks{ticks(grid, 0), ticks(grid, 1), ticks(grid, 2)});
  }

  [[nodiscard]] const GridTicks& ticks() const { return *ticks_; }
  [[nodiscard]] bool in_field() const { return in_field_; }
  [[nodiscard]] bool reversed(std::size_t axis) const { return reversed_[axis]; }
  /// Node from tick, and the other way round.
  [[nodiscard]] std::int32_t flipped(std::size_t axis, std::int32_t i) const {
    return reversed_[axis] ? size_[axis] - 1 - i : i;
  }
  [[nodiscard]] std::vector<Triangle> moved_to_grid(std::span<const Triangle> triangles) const {
    const Mat3 grid_from_field = inverse(field_from_grid_.linear);
    std::vector<Triangle> out(triangles.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, out.size(), 1 << 14), [&](const auto& range) {
      for (std::size_t i = range.begin(); i != range.end(); ++i) {
        for (std::size_t c = 0; c < 3; ++c)
          out[i][c] = without_specks(grid_from_field * (triangles[i][c] - field_from_grid_.translation));
      }
    });
    return out;
  }

 private:
  [[nodiscard]] Ticks ticks(const Grid& grid, std::size_t axis) const {
    std::vector<double> values(static_cast<std::size_t>(size_[axis]));
    for (std::int32_t t = 0; t < size_[axis]; ++t) {
      Vec3 p;
      p[axis] = grid.coordinate(axis, flipped(axis, t));
      values[static_cast<std::size_t>(t)] = without_specks(in_field_ ? field_from_grid_ * p : p)[axis];
    }
    return Ticks(std::move(values));
  }
  static Mat3 inverse(const Mat3& m) {
    const Vec3 a = m.column(0), b = m.column(1), c = m.column(2);
    const double scale = 1 / determinant(m);
    return transposed(Mat3::from_columns(scale * cross(b, c), scale * cross(c, a), scale * cross(a, b)));
  }

  Affine field_from_grid_;
  bool in_field_ = false;
  std::array<bool, 3> reversed_{};
  std::array<std::int32_t, 3> size_{};
  std::optional<GridTicks> ticks_;
};

/// What all threads share.
struct Shared {
  /// Cut short by `stop`, it must not be asked.
  Shared(std::shared_ptr<const SignedMesh> signed_mesh, const Grid& nodes, const Affine& map, double largest,
         StopPoll& stop)
      : mesh(std::move(signed_mesh)), grid(nodes), field_from_grid(map), band(largest), alignment(nodes, map) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (std::int32_t i = 0; i < grid.nodes[axis]; ++i) coordinates[axis].push_back(grid.coordinate(axis, i));
    std::vector<Triangle> moved;
    if (!alignment.in_field()) moved = alignment.moved_to_grid(mesh->tree().triangles());
    const std::span<const Triangle> triangles = alignment.in_field() ? mesh->tree().triangles() : moved;
    signs.emplace(triangles, alignment.ticks(), stop);
    if (stop()) return;
    if (mesh->quality().closed) {
      if (alignment.in_field()) drop_buried_touches(stop);
    } else {
      const auto is_inside = [this](auto i, auto j, auto k) {
        return mesh->is_inside_open(point(alignment.flipped(0, i), alignment.flipped(1, j), alignment.flipped(2, k)));
      };
      decide_by_winding_number(*signs, triangles, alignment.ticks(), is_inside, stop);
    }
    if (band > 0 && band < HUGE_VAL) near.emplace(*mesh, grid, field_from_grid, band, stop);
  }
  /// Nodes on a wall that is buried have the row's number on both sides of it.
  void drop_buried_touches(StopPoll& stop) {
    const std::span<const RowSigns::Touch> touches = signs->touches();
    std::vector<char> keep(touches.size(), 1);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, touches.size(), 1024), [&](const auto& range) {
      if (stop()) return;
      for (std::size_t t = range.begin(); t != range.end(); ++t) {
        const auto row_length = static_cast<std::uint64_t>(grid.nodes[1]);
        const auto j = static_cast<std::int32_t>(touches[t].row % row_length);
        const auto k = static_cast<std::int32_t>(touches[t].row / row_length);
        const Vec3 p = point(alignment.flipped(0, touches[t].node), alignment.flipped(1, j), alignment.flipped(2, k));
        keep[t] = mesh->is_buried(p) ? 0 : 1;
      }
    });
    signs->keep_touches(keep);
  }
  [[nodiscard]] Vec3 point(std::int32_t i, std::int32_t j, std::int32_t k) const {
    return without_specks(field_from_grid * grid.node(i, j, k));
  }
  /// -1 inside, 0 on the surface, 1 outside; nothing if p is no node.
  [[nodiscard]] std::optional<int> sign_of_node(Vec3 p) const {
    std::array<std::int32_t, 3> tick{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double at = std::round((p[axis] - grid.box.min[axis]) / grid.spacing(axis));
      if (!(at >= 0 && at < grid.nodes[axis])) return {};
      const auto i = static_cast<std::int32_t>(at);
      if (coordinates[axis][static_cast<std::size_t>(i)] != p[axis]) return {};
      tick[axis] = alignment.flipped(axis, i);
    }
    return signs->sign(alignment.ticks().row(tick[1], tick[2]), tick[0]);
  }

  std::shared_ptr<const SignedMesh> mesh;
  Grid grid;
  Affine field_from_grid;
  double band;
  Alignment alignment;
  std::array<std::vector<double>, 3> coordinates;
  std::optional<RowSigns> signs;
  std::optional<NearBlocks> near;
};

class Rows final : public ExternalRows {
 public:
  explicit Rows(std::shared_ptr<const Shared> shared) : shared_(std::move(shared)) {}

  void row(std::int32_t j, std::int32_t k, std::int32_t first, std::int32_t last, double* out) override {
    const Alignment& alignment = shared_->alignment;
    const std::size_t row = alignment.ticks().row(alignment.flipped(1, j), alignment.flipped(2, k));
    write_signs(row, first, last, out);
    if (shared_->band > 0) write_distances(j, k, first, last, out);
    for (const RowSigns::Touch& t : shared_->signs->touches(row)) {
      const std::int32_t i = alignment.flipped(0, t.node);
      if (first <= i && i < last) out[i - first] = 0;
    }
  }

  void values_at(std::span<const Vec3> points, std::span<const double> within, double* out) override {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3 p = without_specks(shared_->field_from_grid * points[i]);
      const int sign = this->sign(points[i], p);
      out[i] = within[i] > 0 && sign != 0 ? value_within(p, within[i], sign) : sign;
    }
  }

 private:
  double value_within(Vec3 p, double within, int sign) {
    const double beyond = 2 * sign * within;
    if (ball_.holds(p, within)) return beyond;
    const SignedMesh::Value at = shared_->mesh->distance(p, hint_, within);
    hint_ = at.triangle;
    ball_ = {p, std::min(at.distance, within), sign};
    return at.distance <= within ? SignedMesh::with_sign(at.distance, sign) : beyond;
  }

  /// Inside or outside, beyond every band.
  void write_signs(std::size_t row, std::int32_t first, std::int32_t last, double* out) const {
    const double far = shared_->band < HUGE_VAL && shared_->band > 0 ? 2 * shared_->band : 1;
    std::fill(out, out + (last - first), far);
    const std::span<const RowSigns::Change> changes = shared_->signs->changes(row);
    for (std::size_t c = 0; c < changes.size(); ++c) {
      if (changes[c].winding == 0) continue;
      // Ticks [begin, end) are inside; as nodes, their order may be the other way round.
      std::int32_t begin = changes[c].node;
      std::int32_t end = c + 1 < changes.size() ? changes[c + 1].node : shared_->grid.nodes[0];
      if (shared_->alignment.reversed(0))
        std::tie(begin, end) = std::pair(shared_->grid.nodes[0] - end, shared_->grid.nodes[0] - begin);
      for (std::int32_t i = std::max(begin, first); i < std::min(end, last); ++i) out[i - first] = -far;
    }
  }

  void write_distances(std::int32_t j, std::int32_t k, std::int32_t first, std::int32_t last, double* out) {
    for (std::int32_t i = first; i < last; ++i) {
      if (shared_->near && !shared_->near->contains(i, j, k)) {
        i |= NearBlocks::edge - 1;
        continue;
      }
      const SignedMesh::Value at = shared_->mesh->distance(shared_->point(i, j, k), hint_, shared_->band);
      hint_ = at.triangle;
      if (!(at.distance <= shared_->band)) continue;
      out[i - first] = SignedMesh::with_sign(at.distance, out[i - first] < 0 ? -1 : 1);
    }
  }

  [[nodiscard]] int sign(Vec3 grid_point, Vec3 p) const {
    if (const auto of_node = shared_->sign_of_node(grid_point)) return *of_node;
    // Nothing to cross on the way to the last point: no other sign. A surface with holes has no such rule.
    if (ball_.sign != 0 && shared_->mesh->quality().closed && ball_.holds(p, 0)) return ball_.sign;
    return shared_->mesh->sign(p);
  }

  /// The surface does not come into this ball.
  struct EmptyBall {
    Vec3 middle;
    double radius = 0;
    int sign = 0;  ///< of its points
    [[nodiscard]] bool holds(Vec3 p, double around) const { return norm(p - middle) + around < (1 - 1e-9) * radius; }
  };

  std::shared_ptr<const Shared> shared_;
  std::uint32_t hint_ = TriangleTree::no_triangle;
  EmptyBall ball_;  ///< about the last point
};

class PreparedMesh final : public ExternalField::Prepared {
 public:
  explicit PreparedMesh(std::shared_ptr<const Shared> shared) : shared_(std::move(shared)) {}
  [[nodiscard]] std::unique_ptr<ExternalRows> make_rows() const override { return std::make_unique<Rows>(shared_); }

 private:
  std::shared_ptr<const Shared> shared_;
};

}  // namespace

std::unique_ptr<ExternalField::Prepared> prepare_mesh(std::shared_ptr<const SignedMesh> mesh, const Grid& grid,
                                                      const Affine& field_from_grid, double band,
                                                      const RunOptions& options) {
  StopPoll stop(options);
  std::shared_ptr<const Shared> shared;
  with_jobs(options,
            [&] { shared = std::make_shared<const Shared>(std::move(mesh), grid, field_from_grid, band, stop); });
  if (stop.stopped()) return nullptr;
  return std::make_unique<PreparedMesh>(std::move(shared));
}

}  // namespace meso::implicit
