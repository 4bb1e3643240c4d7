// SPDX-License-Identifier: Apache-2.0
// Rows of cells at the box, where vertices are shared, rows with joined faces, and rows with sharp edges.
#include <algorithm>
#include <tuple>

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

// Along the box's edges, shared vertices fold triangles up.
void FacePass::add_triangle(const IndexTriangle& triangle) {
  if (triangle[0] != triangle[1] && triangle[1] != triangle[2] && triangle[2] != triangle[0])
    triangles_[filled_++] = triangle;
}

/// The number of the feature on the other side of a face, in the loop that crosses `edge` of that face; it must say
/// that its sharp edge goes on through the face, too.
std::optional<std::uint32_t> FacePass::feature_across(unsigned face, std::uint8_t edge, const Feature& feature,
                                                      std::size_t j, std::size_t k) const {
  const unsigned axis = face / 2;
  std::array<std::size_t, 3> cell{feature.cell, j, k};
  if (face % 2 == 0)
    --cell[axis];  // a feature's cell lies between nodes of the grid: none of the three is 0
  else
    ++cell[axis];
  BrickView::Neighbour brick{brick_->record, brick_->first, brick_->first_vertex};
  if (cell[2] < brick_->first) brick = brick_->below;
  if (cell[2] >= brick_->last) brick = brick_->above;
  if (brick.record == nullptr) return std::nullopt;
  const std::size_t row = (cell[2] - brick.first) * (layout_.ny + 1) + cell[1];
  const auto place = [](const Feature& f) { return std::tuple<std::size_t, std::size_t>(f.row, f.cell); };
  const auto wanted = std::tuple(row, cell[0]);
  const auto& list = brick.record->features;
  auto found =
      std::lower_bound(list.begin(), list.end(), wanted, [&](const Feature& f, auto w) { return place(f) < w; });
  const unsigned across = 1U << (face ^ 1U), same_edge = 1U << table_.mirrored(edge, axis);
  while (found != list.end() && place(*found) == wanted && (found->edges & same_edge) == 0) ++found;
  if (found == list.end() || place(*found) != wanted || (found->faces & across) == 0) return std::nullopt;
  // Through an ambiguous face, two lines may join the same two loops: their vertices would get two edges.
  const auto has_whole = [&](const Feature& f, unsigned side) {
    const unsigned edges = table_.edges_of_face(side);
    return (f.edges & edges) == edges;
  };
  if (has_whole(feature, face) && has_whole(*found, face ^ 1U)) return std::nullopt;
  if (brick.record != brick_->record && !joins_well_across(face, edge, feature, *found, *brick.record))
    return std::nullopt;
  return brick.first_vertex + found->vertex;
}

bool FacePass::joins_well_across(unsigned face, std::uint8_t edge, const Feature& feature, const Feature& other,
                                 const BrickRecord& beyond) const {
  const auto side_at = [](const BrickRecord& record, const Feature& f, std::uint8_t e) {
    const auto wanted = std::tuple(f.row, f.cell, e);
    const auto found = std::lower_bound(record.borders.begin(), record.borders.end(), wanted,
                                        [](const BorderSide& b, const auto& w) { return b.place() < w; });
    return found != record.borders.end() && found->place() == wanted ? &*found : nullptr;
  };
  const BorderSide* const own = side_at(*brick_->record, feature, edge);
  const BorderSide* const its = own ? side_at(beyond, other, table_.mirrored(own->next, face / 2)) : nullptr;
  if (its == nullptr) return true;
  return face % 2 == 1 ? joins_well(*own, *its, least_facing_) : joins_well(*its, *own, least_facing_);
}

// Each loop with a feature is a fan around it. Where a sharp edge goes on into the next cell, the side of the two fans
// that crosses it is replaced by the line from feature to feature: each of the two cells adds one of the two triangles.
void FacePass::sharp_cell(std::size_t j, std::size_t k, unsigned inside, unsigned joined,
                          std::span<const Feature> features, const std::array<std::uint32_t, 13>& ids) {
  const CellTriangles& triangles = table_.at(inside, joined);
  const CellLoops& loops = table_.loops(inside, joined);
  for (std::size_t l = 0; l < loops.count; ++l) {
    const CellLoop& loop = loops.loops[l];
    const auto feature = std::find_if(features.begin(), features.end(),
                                      [&](const Feature& f) { return (f.edges >> loop.edges[0] & 1U) != 0; });
    if (feature == features.end()) {
      for (std::size_t t = loop.first_triangle; t < std::size_t{loop.first_triangle} + loop.triangle_count; ++t) {
        const auto& e = triangles.triangles[t];
        add_triangle({ids[e[0]], ids[e[1]], ids[e[2]]});
      }
      continue;
    }
    const std::uint32_t own = brick_->first_vertex + feature->vertex;
    for (std::size_t n = 0; n < loop.size; ++n) {
      const std::uint8_t edge = loop.edges[n], next = loop.edges[(n + 1) % loop.size];
      const std::uint8_t face = table_.common_face(edge, next);
      const auto other = (feature->faces >> face & 1U) != 0 ? feature_across(face, edge, *feature, j, k) : std::nullopt;
      add_triangle({ids[edge], other ? *other : ids[next], own});
    }
  }
}

void FacePass::special_row(std::size_t j, std::size_t k, std::span<const JoinedCell> joined,
                           std::span<const Feature> features) {
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
    std::size_t sharp = 0;
    while (sharp < features.size() && features[sharp].cell == cell) ++sharp;
    if (sharp > 0) {
      sharp_cell(j, k, inside, faces, features.first(sharp), ids);
      features = features.subspan(sharp);
    } else {
      for (std::size_t t = 0; t < triangles.count; ++t) {
        const auto& e = triangles.triangles[t];
        add_triangle({ids[e[0]], ids[e[1]], ids[e[2]]});
      }
    }
    for (std::size_t e = 0; e < 4; ++e) ids[e] += advance_[inside].x[e];
    if (triangles.centre_edges != 0) ++ids[centre_vertex];
  }
}

}  // namespace meso::implicit
