// SPDX-License-Identifier: Apache-2.0
#pragma once
// A mesh's distance that is not asked where it is certainly too far to matter: lattices that fill a body have nearly
// all of their surface away from the body's own. Private.

#include <memory>

#include "meso/implicit/external_field.hpp"

namespace meso::implicit {

/// The same field. REQUIRES: |f(p) - f(q)| <= |p - q|, as the distance to a closed mesh keeps it.
class FarFromMesh final : public ExternalField {
 public:
  explicit FarFromMesh(std::shared_ptr<const ExternalField> mesh) : mesh_(std::move(mesh)) {}

  [[nodiscard]] double value(Vec3 p) const override { return mesh_->value(p); }
  [[nodiscard]] Interval interval(const Box3& box) const override { return mesh_->interval(box); }
  [[nodiscard]] double lipschitz() const override { return mesh_->lipschitz(); }
  [[nodiscard]] Box3 bounds(double level) const override { return mesh_->bounds(level); }
  [[nodiscard]] std::unique_ptr<Prepared> prepare(const Grid& grid, const Affine& field_from_grid, double band,
                                                  const RunOptions& run) const override;
  [[nodiscard]] std::uint64_t bytes() const override { return mesh_->bytes(); }
  [[nodiscard]] std::uint64_t prepared_bytes(const Grid& grid) const override { return mesh_->prepared_bytes(grid); }

 private:
  std::shared_ptr<const ExternalField> mesh_;
};

}  // namespace meso::implicit
