// SPDX-License-Identifier: Apache-2.0
#include "face_pass.hpp"

#include <bit>
#include <cstring>

#include "bits.hpp"

namespace meso::implicit {
namespace {

constexpr std::size_t chunk = 1024;
constexpr std::size_t most_triangles = 12;  // of one cell

bool crossed(unsigned inside, unsigned edge) {
  return ((inside >> edge_corners[edge][0] ^ inside >> edge_corners[edge][1]) & 1U) != 0;
}

}  // namespace

FacePass::FacePass(const Layout& layout, const MeshSink& sink)
    : layout_(layout),
      sink_(sink),
      least_facing_(layout.least_facing()),
      advance_(256),
      planes_{SignPlane(layout), SignPlane(layout)},
      cells_(layout.nx + 1),
      y0_(layout.nx),
      y1_(layout.nx),
      z0_(layout.nx),
      z1_(layout.nx),
      triangles_(chunk + most_triangles * (layout.nx + 2)) {
  // Along x every row of nodes has its own count. Along y and z, the count at a cell's far edge is the number of that
  // edge, and the near edge was counted last: both move on when the far edge is crossed.
  constexpr std::array<std::uint8_t, 12> decides{0, 1, 2, 3, 5, 5, 7, 7, 9, 9, 11, 11};
  for (unsigned inside = 0; inside < 256; ++inside)
    for (unsigned e = 0; e < 4; ++e) {
      advance_[inside].x[e] = crossed(inside, decides[e]) ? 1 : 0;
      advance_[inside].y[e] = crossed(inside, decides[e + 4]) ? 1 : 0;
      advance_[inside].z[e] = crossed(inside, decides[e + 8]) ? 1 : 0;
    }
}

std::uint64_t FacePass::run(const BrickView& brick, ByteBuffer& out, const std::function<bool()>& after_row) {
  brick_ = &brick;
  if (brick.below.record == nullptr) {
    above_->clear();
  } else {
    const BrickRecord& below = *brick.below.record;
    const std::uint16_t* from = below.signs.data() + below.last_plane;
    auto next = brick.first_vertex - static_cast<std::uint32_t>(below.last_plane_vertices);
    above_->read(from, next);
  }
  std::uint64_t count = 0;
  const std::uint16_t* from = brick.record->signs.data();
  std::uint32_t next = brick.first_vertex;
  auto joined = std::span(brick.record->joined);
  auto features = std::span(brick.record->features);
  for (std::size_t k = brick.first; k < brick.last; ++k) {
    std::swap(below_, above_);
    above_->read(from, next);
    for (std::size_t j = 0; j <= layout_.ny; ++j) {
      const std::size_t row = (k - brick.first) * (layout_.ny + 1) + j;
      std::size_t cells = 0, sharp = 0;
      while (cells < joined.size() && joined[cells].row == row) ++cells;
      while (sharp < features.size() && features[sharp].row == row) ++sharp;
      const std::size_t before = filled_;
      const auto sj = static_cast<std::ptrdiff_t>(j);
      a_ = below_->at(sj - 1);
      b_ = below_->at(sj);
      c_ = above_->at(sj - 1);
      d_ = above_->at(sj);
      find_active_cells();
      const bool plain = cells == 0 && sharp == 0 && j > 0 && j < layout_.ny && k > 0 && k < layout_.nz;
      if (plain)
        plain_row(j);
      else if (active_ > 0)
        special_row(j, k, joined.first(cells), features.first(sharp));
      joined = joined.subspan(cells);
      features = features.subspan(sharp);
      count += filled_ - before;
      if (filled_ >= chunk) flush(out);
      if (!after_row()) return count;
    }
  }
  flush(out);
  return count;
}

void FacePass::find_active_cells() {
  std::uint16_t* to = cells_.data();
  std::uint64_t any_before = 0, all_before = 0;
  for (std::size_t w = 0; w < layout_.words; ++w) {
    const std::uint64_t any = a_[w] | b_[w] | c_[w] | d_[w], all = a_[w] & b_[w] & c_[w] & d_[w];
    const std::uint64_t active = (any | any << 1 | any_before >> 63) & ~(all & (all << 1 | all_before >> 63));
    any_before = any;
    all_before = all;
    to = append_bits(active, w, to);
  }
  active_ = static_cast<std::size_t>(to - cells_.data());
}

void FacePass::plain_row(std::size_t j) {
  const RowNumbers &a = below_->numbers(j - 1), &b = below_->numbers(j), &c = above_->numbers(j - 1),
                   &d = above_->numbers(j);
  Four x{a.x, b.x, c.x, d.x}, y{b.y - 1, b.y, d.y - 1, d.y}, z{c.z - 1, c.z, d.z - 1, d.z};
  alignas(Four) std::array<std::uint32_t, 12> ids;
  IndexTriangle* to = triangles_.data() + filled_;
  for (std::size_t n = 0; n < active_; ++n) {
    const std::size_t cell = cells_[n];
    const unsigned inside = corners_inside(cell);
    std::memcpy(&ids[0], &x, sizeof x);
    std::memcpy(&ids[4], &y, sizeof y);
    std::memcpy(&ids[8], &z, sizeof z);
    const PlainCell& plain = table_.plain(inside);
    const auto put = [&](std::size_t t) {
      const auto& edges = plain.triangles[t];
      to[t] = {ids[edges[0]], ids[edges[1]], ids[edges[2]]};
    };
    for (std::size_t t = 0; t < 4; ++t) put(t);
    if (plain.count > 4) put(4);
    to += plain.count;
    const Advance& advance = advance_[inside];
    x += advance.x;
    y += advance.y;
    z += advance.z;
  }
  filled_ = static_cast<std::size_t>(to - triangles_.data());
}

void FacePass::flush(ByteBuffer& out) {
  sink_.encode_triangles({triangles_.data(), filled_}, out);
  filled_ = 0;
}

}  // namespace meso::implicit
