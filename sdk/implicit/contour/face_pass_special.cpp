// SPDX-License-Identifier: Apache-2.0
// Rows of cells at the box, where vertices are shared, and rows with joined faces.
#include "bits.hpp"
#include "face_pass.hpp"

namespace meso::implicit {
namespace {

template <class Number>
void number_crossings(const std::uint64_t* p, const std::uint64_t* q, std::size_t words, std::vector<std::uint32_t>& to,
                      Number number) {
  for (std::size_t w = 0; w < words; ++w) for_each_bit(p[w] ^ q[w], w, [&](std::size_t i) { to[i] = number(i); });
}

}  // namespace

// The first and last node of a row on the box share the vertex of their edge along x (see PadVertices).
void FacePass::number_row_on_box(const std::uint64_t* p, const std::uint64_t* q, const RowNumbers& row,
                                 std::uint32_t next, std::vector<std::uint32_t>& to) {
  number_crossings(p, q, layout_.words, to, [&](std::size_t i) {
    return i == 0 ? row.x : i + 1 == layout_.nx ? row.x_last : next++;
  });
}

void FacePass::number_y(SignPlane& plane, std::size_t j, std::vector<std::uint32_t>& to) {
  const auto sj = static_cast<std::ptrdiff_t>(j);
  std::uint32_t next = plane.numbers(j).y;
  if (j == 0 || j == layout_.ny)
    number_row_on_box(plane.at(sj - 1), plane.at(sj), plane.numbers(j == 0 ? 0 : j - 1), next, to);
  else
    number_crossings(plane.at(sj - 1), plane.at(sj), layout_.words, to, [&](std::size_t) { return next++; });
}

void FacePass::number_z(std::size_t j, std::size_t k, std::vector<std::uint32_t>& to) {
  const auto sj = static_cast<std::ptrdiff_t>(j);
  const std::uint64_t *p = below_->at(sj), *q = above_->at(sj);
  std::uint32_t next = above_->numbers(j).z;
  SignPlane& real = k == 0 ? *above_ : *below_;
  if (k > 0 && k < layout_.nz)
    number_crossings(p, q, layout_.words, to, [&](std::size_t) { return next++; });
  else if (j == 0)
    number_y(real, 0, to);
  else if (j + 1 == layout_.ny)
    number_y(real, layout_.ny, to);
  else
    number_row_on_box(p, q, real.numbers(j), next, to);
}

void FacePass::special_row(std::size_t j, std::size_t k, std::span<const JoinedCell> joined) {
  number_y(*below_, j, y0_);
  number_y(*above_, j, y1_);
  if (j > 0) number_z(j - 1, k, z0_);
  if (j < layout_.ny) number_z(j, k, z1_);
  std::array<std::uint32_t, 13> ids{};
  if (j > 0) {
    ids[0] = below_->numbers(j - 1).x;
    ids[2] = above_->numbers(j - 1).x;
  }
  ids[1] = below_->numbers(j).x;
  ids[3] = above_->numbers(j).x;
  ids[centre_vertex] = above_->numbers(j).centre;
  for (std::size_t n = 0; n < active_; ++n) {
    const std::size_t cell = cells_[n];
    const unsigned inside = corners_inside(cell);
    unsigned faces = 0;
    if (!joined.empty() && joined.front().cell == cell) {
      faces = joined.front().joined;
      joined = joined.subspan(1);
    }
    const std::size_t near = cell > 0 ? cell - 1 : 0, far = cell < layout_.nx ? cell : 0;  // no crossing where clamped
    ids[4] = y0_[near], ids[5] = y0_[far], ids[6] = y1_[near], ids[7] = y1_[far];
    ids[8] = z0_[near], ids[9] = z0_[far], ids[10] = z1_[near], ids[11] = z1_[far];
    const CellTriangles& triangles = table_.at(inside, faces);
    for (std::size_t t = 0; t < triangles.count; ++t) {
      const auto& e = triangles.triangles[t];
      const IndexTriangle triangle{ids[e[0]], ids[e[1]], ids[e[2]]};
      // Along the box's edges, shared vertices fold triangles up.
      if (triangle[0] != triangle[1] && triangle[1] != triangle[2] && triangle[2] != triangle[0])
        triangles_[filled_++] = triangle;
    }
    for (std::size_t e = 0; e < 4; ++e) ids[e] += advance_[inside].x[e];
    if (triangles.centre_edges != 0) ++ids[centre_vertex];
  }
}

}  // namespace meso::implicit
