// SPDX-License-Identifier: Apache-2.0
#include "vertex_pass.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "bits.hpp"
#include "case_table.hpp"
#include "pad_vertices.hpp"

namespace meso::implicit {
namespace {

constexpr std::size_t chunk = 512;

// Where the linear interpolant is zero, from v0 (t = 0) to v1, kept off the ends: within a thousandth of a cell no
// accuracy is lost, and no triangle degenerates. Half way where an end has no value.
float crossing(float v0, float v1, bool& undefined) {
  constexpr float margin = 1e-3F;
  float t = v0 / (v0 - v1);
  undefined |= t != t;
  t = t < margin ? margin : t;
  t = t > 1 - margin ? 1 - margin : t;
  return t == t ? t : 0.5F;
}

double between(double a, double b, float t) { return a + static_cast<double>(t) * (b - a); }

unsigned corners_inside(const CellRows& rows, std::size_t b) {
  unsigned inside = 0, corner = 0;
  for (const SampleRow* row : {&rows.a, &rows.b, &rows.c, &rows.d})
    for (const std::ptrdiff_t i : {static_cast<std::ptrdiff_t>(b) - 1, static_cast<std::ptrdiff_t>(b)})
      inside |= static_cast<unsigned>(row->inside[i >> 6] >> (i & 63) & 1U) << corner++;
  return inside;
}

}  // namespace

VertexPass::VertexPass(const Layout& layout, const GridSource& source, const MeshSink& sink,
                       const ContourOptions& options, std::function<bool()> go_on)
    : layout_(layout),
      go_on_(std::move(go_on)),
      sampler_(source.sampler()),
      sink_(sink),
      signs_only_(source.signs_only()),
      polish_(options.polish || options.sharp),
      roots_(options.coordinate_step),
      rows_(layout),
      x_(layout.nx + 1),
      y_(layout.nx + 1),
      z_(layout.nx + 1),
      points_(chunk + 4 * (layout.nx + 1)) {
  if (options.sharp) sharp_.emplace(layout, source.grid());
  if (!signs_only_) return;
  auto edge_ends = std::make_unique<EdgeEndSampler>(source.grid(), std::move(sampler_), source.exact_within(), go_on_);
  edge_ends_ = edge_ends.get();
  sampler_ = std::move(edge_ends);
}

std::uint64_t VertexPass::grown_by() {
  std::uint64_t now = edge_ends_ == nullptr ? 0 : edge_ends_->grown_bytes();
  if (sharp_)
    now += sharp_->crossings.bytes() + sharp_->finder.bytes() +
           (points_.capacity() + sharp_->with_features.capacity()) * sizeof(Vec3);
  now = std::max(told_bytes_, now);
  return now - std::exchange(told_bytes_, now);
}

BrickRecord VertexPass::run(std::size_t first, std::size_t last, ByteBuffer& out,
                            const std::function<bool()>& after_row) {
  BrickRecord record;
  signs_.clear();
  row_starts_.clear();
  // This thread did the brick before, and has its last plane; but not the values for edges that leave it.
  const bool continues = first > 0 && sampled_ == first && !signs_only_ && !sharp_;
  const std::size_t from = continues || first == 0 ? first : first - 1;
  sampler_->begin_slab(static_cast<std::int32_t>(from), static_cast<std::int32_t>(std::min(last, layout_.nz)));
  if (!continues) joined_.begin_brick();
  if (sharp_) sharp_->crossings.begin(from);
  if (from < first) sample_plane_below(from);
  for (std::size_t k = first; k < last; ++k) {
    joined_.begin_plane();
    record.last_plane = signs_.size();
    const std::uint64_t before = record.vertices;
    for (std::size_t j = 0; j <= layout_.ny; ++j) {
      const auto cell_row = static_cast<std::uint32_t>((k - first) * (layout_.ny + 1) + j);
      row(j, k, cell_row, record);
      if (filled_ >= chunk && !sharp_) flush(out);
      if (!after_row()) return record;
    }
    record.last_plane_vertices = record.vertices - before;
    sampled_ = k + 1;
  }
  if (sharp_)
    add_features(first, last, record, out);
  else
    flush(out);
  record.signs.assign(signs_.begin(), signs_.end());
  return record;
}

void VertexPass::sample_plane_below(std::size_t k) {
  joined_.begin_plane();
  for (std::size_t j = 0; j < layout_.ny; ++j) {
    const SampleRow& d = rows_.fresh();
    sampler_->row(static_cast<std::int32_t>(j), static_cast<std::int32_t>(k), d.values, d.inside);
    // No edge from below is looked at: the row stands for the one below itself.
    const CellRows rows{rows_.outside(), d, rows_.at(static_cast<std::ptrdiff_t>(j) - 1), d};
    for (std::size_t w = 0; w < layout_.words; ++w) joined_.find_across_z(rows, static_cast<std::uint32_t>(j), w);
    if (sharp_) {
      find_crossings(rows, j, k, false);
      BrickRecord belongs_to_the_brick_below;
      add_vertices(rows, j, k, belongs_to_the_brick_below);
      keep_crossings(rows);
    }
    rows_.replace(j);
  }
  nx_ = ny_ = nz_ = 0;
  if (sharp_) keep_crossings({rows_.outside(), rows_.outside(), rows_.outside(), rows_.outside()});
}

void VertexPass::row(std::size_t j, std::size_t k, std::uint32_t cell_row, BrickRecord& record) {
  const auto sj = static_cast<std::ptrdiff_t>(j);
  const SampleRow& none = rows_.outside();
  CellRows rows{none, none, none, none};
  if (k == layout_.nz) {
    rows.a = rows_.at(sj - 1);
    rows.b = rows_.at(sj);
  } else {
    rows.c = rows_.at(sj - 1);
    if (k > 0 && j > 0) rows.a = rows_.replaced();
    if (k > 0) rows.b = rows_.at(sj);
    if (j < layout_.ny) {
      rows.d = rows_.fresh();
      sampler_->row(static_cast<std::int32_t>(j), static_cast<std::int32_t>(k), rows.d.values, rows.d.inside);
    }
  }
  for (std::size_t w = 0; w < layout_.words; ++w)
    record.inside += static_cast<std::uint64_t>(std::popcount(rows.d.inside[w]));
  joined_.begin_row();
  find_crossings(rows, j, k, true);
  const std::size_t old_cells = record.joined.size();
  joined_.collect(static_cast<std::uint32_t>(j), cell_row, record.joined);
  add_vertices(rows, j, k, record);
  prefetch_next_row(j);
  RowCounts counts{static_cast<std::uint16_t>(nx_), static_cast<std::uint16_t>(ny_), static_cast<std::uint16_t>(nz_),
                   0};
  if (record.joined.size() > old_cells)
    counts.centre = add_centres(rows, j, k, std::span(record.joined).subspan(old_cells));
  if (sharp_) {
    filled_ -= counts.centre;
    keep_crossings(rows);
    filled_ += counts.centre;
    row_starts_.push_back(signs_.size());
  }
  append_row(signs_, counts, x_.data(), rows.d.inside, layout_.words);
  record.vertices += counts.total();
  if (k < layout_.nz && j < layout_.ny) rows_.replace(j);
}

// A surface goes on: the next row crosses to the plane below near where this one does, and values of that plane are the
// only ones that have left the nearest cache.
void VertexPass::prefetch_next_row(std::size_t j) const {
  const float* const below = rows_.at(static_cast<std::ptrdiff_t>(j) + 1).values;
  for (std::size_t n = 0; n < nz_; ++n) __builtin_prefetch(below + z_[n]);
}

void VertexPass::find_crossings(const CellRows& rows, std::size_t j, std::size_t k, bool looks_at_faces) {
  std::uint16_t *x_end = x_.data(), *y_end = y_.data(), *z_end = z_.data();
  const PadVertices pads(layout_, j, k);
  for (std::size_t w = 0; w < layout_.words; ++w) {
    const std::uint64_t d = rows.d.inside[w];
    const std::uint64_t x = d ^ moved_up(rows.d.inside, w), y = d ^ rows.c.inside[w], z = d ^ rows.b.inside[w];
    if ((x | y | z) == 0) continue;
    x_end = append_bits(x, w, x_end);
    y_end = append_bits(y & pads.y_mask(w), w, y_end);
    z_end = append_bits(z & pads.z_mask(w), w, z_end);
    if (looks_at_faces && (x & y) != 0) joined_.find_across_z(rows, static_cast<std::uint32_t>(j), w);
    if (looks_at_faces && ((x & z) != 0 || (y & z) != 0)) joined_.find_across_x_and_y(rows, w);
  }
  nx_ = static_cast<std::size_t>(x_end - x_.data());
  ny_ = static_cast<std::size_t>(y_end - y_.data());
  nz_ = static_cast<std::size_t>(z_end - z_.data());
}

void VertexPass::add_vertices(const CellRows& rows, std::size_t j, std::size_t k, BrickRecord& record) {
  const auto sj = static_cast<std::ptrdiff_t>(j), sk = static_cast<std::ptrdiff_t>(k);
  const double y = layout_.y(sj), z = layout_.z(sk), y0 = layout_.y(sj - 1), z0 = layout_.z(sk - 1);
  const float *const b = rows.b.values, *const c = rows.c.values, *const d = rows.d.values;
  if (sharp_ && points_.size() < filled_ + 4 * (layout_.nx + 1)) points_.resize(2 * points_.size());
  Vec3* to = points_.data() + filled_;
  bool undefined = false;
  for (std::size_t n = 0; n < nx_; ++n) {
    const auto i = static_cast<std::ptrdiff_t>(x_[n]);
    *to++ = {between(layout_.x(i - 1), layout_.x(i), crossing(d[i - 1], d[i], undefined)), y, z};
  }
  for (std::size_t n = 0; n < ny_; ++n)
    *to++ = {layout_.x(y_[n]), between(y0, y, crossing(c[y_[n]], d[y_[n]], undefined)), z};
  for (std::size_t n = 0; n < nz_; ++n)
    *to++ = {layout_.x(z_[n]), y, between(z0, z, crossing(b[z_[n]], d[z_[n]], undefined))};
  if (undefined)
    visit_edges(rows, j, k, [&](Vec3, std::size_t, double, float v0, float v1) {
      if (v0 != v0 || v1 != v1) ++record.undefined;
    });
  if (polish_)
    visit_edges(rows, j, k, [&, n = filled_](Vec3 p, std::size_t axis, double step, float v0, float v1) mutable {
      if (step > 0) roots_.add(p, axis, step, v0, v1, n);
      ++n;
    });
  filled_ += nx_ + ny_ + nz_;
}

// In the order of the vertices: where the edge begins, its axis and length (0 in the added layer), and its values.
template <class Visit>
void VertexPass::visit_edges(const CellRows& rows, std::size_t j, std::size_t k, Visit visit) const {
  const auto sj = static_cast<std::ptrdiff_t>(j), sk = static_cast<std::ptrdiff_t>(k);
  const double y = layout_.y(sj), z = layout_.z(sk), y0 = layout_.y(sj - 1), z0 = layout_.z(sk - 1);
  const float *const b = rows.b.values, *const c = rows.c.values, *const d = rows.d.values;
  for (std::size_t n = 0; n < nx_; ++n) {
    const auto i = static_cast<std::ptrdiff_t>(x_[n]);
    visit(Vec3{layout_.x(i - 1), y, z}, 0, layout_.x(i) - layout_.x(i - 1), d[i - 1], d[i]);
  }
  for (std::size_t n = 0; n < ny_; ++n) visit(Vec3{layout_.x(y_[n]), y0, z}, 1, y - y0, c[y_[n]], d[y_[n]]);
  for (std::size_t n = 0; n < nz_; ++n) visit(Vec3{layout_.x(z_[n]), y, z0}, 2, z - z0, b[z_[n]], d[z_[n]]);
}

std::uint16_t VertexPass::add_centres(const CellRows& rows, std::size_t j, std::size_t k,
                                      std::span<const JoinedCell> cells) {
  std::uint16_t count = 0;
  for (const JoinedCell& cell : cells) {
    const unsigned edges = CaseTable::get().at(corners_inside(rows, cell.cell), cell.joined).centre_edges;
    if (edges == 0) continue;
    ++count;
    const auto corner = [&](unsigned c) {
      const auto i = static_cast<std::ptrdiff_t>(cell.cell) - 1 + (c & 1U);
      const SampleRow& row = c < 2 ? rows.a : c < 4 ? rows.b : c < 6 ? rows.c : rows.d;
      return std::pair{Vec3{layout_.x(i), layout_.y(static_cast<std::ptrdiff_t>(j) - 1 + (c >> 1 & 1U)),
                            layout_.z(static_cast<std::ptrdiff_t>(k) - 1 + (c >> 2))},
                       row.values[i]};
    };
    Vec3 sum;
    bool undefined = false;
    for (unsigned e = 0; e < 12; ++e) {
      if ((edges >> e & 1U) == 0) continue;
      const auto [p0, v0] = corner(edge_corners[e][0]);
      const auto [p1, v1] = corner(edge_corners[e][1]);
      sum += p0 + static_cast<double>(crossing(v0, v1, undefined)) * (p1 - p0);
    }
    points_[filled_++] = sum / std::popcount(edges);
  }
  return count;
}

// The row's points are the last ones but for those in the middle of cells.
void VertexPass::keep_crossings(const CellRows& rows) {
  sharp_->crossings.add_row(filled_ - nx_ - ny_ - nz_, {x_.data(), nx_}, {y_.data(), ny_}, {z_.data(), nz_},
                            rows.d.inside);
}

// Features are the last vertices of their rows.
void VertexPass::add_features(std::size_t first, std::size_t last, BrickRecord& record, ByteBuffer& out) {
  roots_.solve(*sampler_, points_);
  const std::span<const Vec3> points(points_.data(), filled_);
  const auto& found = sharp_->finder.find(sharp_->crossings, points, first, last, record.joined, *sampler_, go_on_);
  record.borders = sharp_->finder.borders();
  std::vector<Vec3>& all = sharp_->with_features;
  all.clear();
  auto next = found.begin();
  for (std::size_t row = 0; row < row_starts_.size(); ++row) {
    const std::size_t j = row % (layout_.ny + 1), k = first + row / (layout_.ny + 1);
    std::uint16_t* const counts = &signs_[row_starts_[row]];  // x, y, z, centre
    const std::size_t begin = sharp_->crossings.row(j, k).first_point;
    all.insert(all.end(), points.begin() + static_cast<std::ptrdiff_t>(begin),
               points.begin() + static_cast<std::ptrdiff_t>(begin + counts[0] + counts[1] + counts[2] + counts[3]));
    for (; next != found.end() && next->feature.row == row; ++next) {
      record.features.push_back(next->feature);
      record.features.back().vertex = static_cast<std::uint32_t>(all.size());
      all.push_back(next->position);
      ++counts[3];
      ++record.vertices;
      if (k + 1 == last) ++record.last_plane_vertices;
    }
  }
  sink_.encode_points(all, out);
  filled_ = 0;
}

void VertexPass::flush(ByteBuffer& out) {
  if (polish_) roots_.solve(*sampler_, points_);
  sink_.encode_points({points_.data(), filled_}, out);
  filled_ = 0;
}

}  // namespace meso::implicit
