// SPDX-License-Identifier: Apache-2.0
#pragma once
// The second pass over a brick of planes: from the recorded signs to triangles whose vertices have their final numbers.

#include <functional>
#include <optional>
#include <vector>

#include "bits.hpp"
#include "brick_record.hpp"
#include "case_table.hpp"
#include "meso/base/mesh_sink.hpp"
#include "sign_plane.hpp"

namespace meso::implicit {

/// A brick as the second pass sees it, and the ones beside it.
struct BrickView {
  struct Neighbour {
    const BrickRecord* record = nullptr;  ///< null: there is none
    std::size_t first = 0;                ///< plane
    std::uint32_t first_vertex = 0;
  };
  std::size_t first = 0, last = 0;  ///< planes
  const BrickRecord* record = nullptr;
  std::uint32_t first_vertex = 0;
  Neighbour below, above;
};

/// One per thread.
class FacePass {
 public:
  FacePass(const Layout& layout, const MeshSink& sink);

  /// Returns the number of triangles. Calls `after_row` now and then: false stops the work.
  [[nodiscard]] std::uint64_t run(const BrickView& brick, ByteBuffer& out, const std::function<bool()>& after_row);

 private:
  void find_active_cells();
  [[nodiscard]] unsigned corners_inside(std::size_t cell) const {
    return two_signs(a_, cell) | two_signs(b_, cell) << 2 | two_signs(c_, cell) << 4 | two_signs(d_, cell) << 6;
  }
  void plain_row(std::size_t j);
  void special_row(std::size_t j, std::size_t k, std::span<const JoinedCell> joined, std::span<const Feature> features);
  void add_triangle(const IndexTriangle& triangle);
  void sharp_cell(std::size_t j, std::size_t k, unsigned inside, unsigned joined, std::span<const Feature> features,
                  const std::array<std::uint32_t, 13>& ids);
  [[nodiscard]] std::optional<std::uint32_t> feature_across(unsigned face, std::uint8_t edge, const Feature& feature,
                                                            std::size_t j, std::size_t k) const;
  [[nodiscard]] bool joins_well_across(unsigned face, std::uint8_t edge, const Feature& feature, const Feature& other,
                                       const BrickRecord& beyond) const;
  void number_y(SignPlane& plane, std::size_t j, std::vector<std::uint32_t>& to);
  void number_z(std::size_t j, std::size_t k, std::vector<std::uint32_t>& to);
  void number_row_on_box(const std::uint64_t* p, const std::uint64_t* q, const RowNumbers& row, std::uint32_t next,
                         std::vector<std::uint32_t>& to);
  void flush(ByteBuffer& out);

  /// One number for each edge along an axis.
  using Four __attribute__((vector_size(16))) = std::uint32_t;
  /// How far the numbers of the edges along x, y, z move on from one cell to the next.
  struct Advance {
    Four x, y, z;
  };

  const Layout& layout_;
  const MeshSink& sink_;
  double least_facing_;
  const CaseTable& table_ = CaseTable::get();
  std::vector<Advance> advance_;
  SignPlane planes_[2];
  SignPlane *below_ = &planes_[0], *above_ = &planes_[1];
  const std::uint64_t *a_ = nullptr, *b_ = nullptr, *c_ = nullptr, *d_ = nullptr;  // rows of nodes around the cells
  std::vector<std::uint16_t> cells_;                                               // with corners inside and outside
  std::size_t active_ = 0;
  std::vector<std::uint32_t> y0_, y1_, z0_, z1_;  // numbers of vertices by node, for special rows
  const BrickView* brick_ = nullptr;
  std::vector<IndexTriangle> triangles_;
  std::size_t filled_ = 0;
};

}  // namespace meso::implicit
