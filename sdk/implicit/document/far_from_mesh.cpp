// SPDX-License-Identifier: Apache-2.0
#include "far_from_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace meso::implicit {
namespace {

constexpr std::int32_t side = 8;  ///< nodes of a block

struct Blocks {
  Blocks(std::shared_ptr<const ExternalField> field, const Grid& nodes, const Affine& map)
      : mesh(std::move(field)), grid(nodes), field_from_grid(map) {
    Vec3 half;
    for (std::size_t a = 0; a < 3; ++a) {
      counts[a] = (grid.nodes[a] + side - 1) / side;
      inverse_spacing[a] = 1 / grid.spacing(a);
      half[a] = grid.spacing(a) * side / 2;  // points between nodes belong to the nearest
    }
    Vec3 reach;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t a = 0; a < 3; ++a) reach[i] += std::abs(map.linear(i, a)) * half[a];
    radius = norm(reach) * (1 + 1e-9);
  }
  [[nodiscard]] std::int32_t block_of(double p, std::size_t axis) const {
    const double node = (p - grid.box.min[axis]) * inverse_spacing[axis] + 0.5;
    return std::clamp(static_cast<std::int32_t>(node), 0, grid.nodes[axis] - 1) / side;
  }
  /// A value of the field, drawn towards zero by as much as it may change within the block; 0 near the surface.
  [[nodiscard]] float at_least(std::int32_t x, std::int32_t y, std::int32_t z) const {
    const std::array<std::int32_t, 3> at{x, y, z};
    Vec3 middle;
    for (std::size_t a = 0; a < 3; ++a)
      middle[a] = grid.box.min[a] + grid.spacing(a) * (at[a] * side + (side - 1) / 2.0);
    const double value = mesh->value(field_from_grid * middle), size = std::abs(value) - radius;
    if (!(size > 0)) return 0;
    const auto lower = static_cast<float>(size * (1 - 1e-6));
    return value < 0 ? -lower : lower;
  }

  std::shared_ptr<const ExternalField> mesh;
  Grid grid;
  Affine field_from_grid;
  std::array<std::int32_t, 3> counts{};
  Vec3 inverse_spacing;
  double radius = 0;
};

class Rows final : public ExternalRows {
 public:
  Rows(std::shared_ptr<const Blocks> blocks, std::unique_ptr<ExternalRows> rows)
      : blocks_(std::move(blocks)), rows_(std::move(rows)) {}

  void row(std::int32_t j, std::int32_t k, std::int32_t first, std::int32_t last, double* out) override {
    rows_->row(j, k, first, last, out);
  }

  void values_at(std::span<const Vec3> points, std::span<const double> within, double* out) override {
    near_.clear();
    near_points_.clear();
    near_within_.clear();
    for (std::size_t n = 0; n < points.size(); ++n) {
      const double far = lower_bound(points[n]);
      out[n] = far;
      if (std::abs(far) > within[n]) continue;
      near_.push_back(n);
      near_points_.push_back(points[n]);
      near_within_.push_back(within[n]);
    }
    values_.resize(near_.size());
    rows_->values_at(near_points_, near_within_, values_.data());
    for (std::size_t n = 0; n < near_.size(); ++n) out[near_[n]] = values_[n];
  }

 private:
  struct Layer {
    std::int32_t z = -1;
    std::vector<float> blocks;
  };

  double lower_bound(Vec3 p) {
    const std::int32_t x = blocks_->block_of(p.x, 0), y = blocks_->block_of(p.y, 1), z = blocks_->block_of(p.z, 2);
    Layer& layer = layers_[static_cast<std::size_t>(z) % layers_.size()];
    if (layer.z != z) {
      layer.z = z;
      layer.blocks.assign(std::size_t(blocks_->counts[0]) * std::size_t(blocks_->counts[1]), NAN);
    }
    float& block = layer.blocks[std::size_t(y) * std::size_t(blocks_->counts[0]) + std::size_t(x)];
    if (std::isnan(block)) block = blocks_->at_least(x, y, z);
    return block;
  }

  std::shared_ptr<const Blocks> blocks_;
  std::unique_ptr<ExternalRows> rows_;
  std::array<Layer, 4> layers_;  ///< a slab's planes lie in three
  std::vector<std::size_t> near_;
  std::vector<Vec3> near_points_;
  std::vector<double> near_within_, values_;
};

class PreparedFar final : public ExternalField::Prepared {
 public:
  PreparedFar(std::shared_ptr<const Blocks> blocks, std::unique_ptr<ExternalField::Prepared> prepared)
      : blocks_(std::move(blocks)), prepared_(std::move(prepared)) {}
  [[nodiscard]] std::unique_ptr<ExternalRows> make_rows() const override {
    return std::make_unique<Rows>(blocks_, prepared_->make_rows());
  }

 private:
  std::shared_ptr<const Blocks> blocks_;
  std::unique_ptr<ExternalField::Prepared> prepared_;
};

}  // namespace

std::unique_ptr<ExternalField::Prepared> FarFromMesh::prepare(const Grid& grid, const Affine& field_from_grid,
                                                              double band, const RunOptions& run) const {
  auto prepared = mesh_->prepare(grid, field_from_grid, band, run);
  if (!prepared) return nullptr;
  return std::make_unique<PreparedFar>(std::make_shared<const Blocks>(mesh_, grid, field_from_grid),
                                       std::move(prepared));
}

}  // namespace meso::implicit
