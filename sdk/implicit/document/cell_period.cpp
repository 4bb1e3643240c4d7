// SPDX-License-Identifier: Apache-2.0
#include "cell_period.hpp"

#include <algorithm>
#include <cmath>

#include "affine_map.hpp"

namespace meso::implicit {
namespace {

constexpr std::int32_t side = strut_lanes;       // nodes of a part along an axis, at most
constexpr std::uint64_t most_samples = 1 << 20;  // 8 MB, in cache while a few of its planes are copied
constexpr std::uint64_t least_copies = 8;
constexpr std::int32_t longest = 1 << 16;  // nodes of a period, other than the whole grid

Vec3 vector_of(const std::array<std::int64_t, 3>& steps) {
  return {static_cast<double>(steps[0]), static_cast<double>(steps[1]), static_cast<double>(steps[2])};
}

/// Equal to the map's, but for rounding: grids are laid out from one end to the other.
Vec3 step_along(std::size_t axis, const Grid& grid, const Affine& map) {
  return grid.spacing(axis) * map.linear.column(axis);
}

}  // namespace

std::uint64_t CellPeriod::most_bytes(std::uint64_t nodes) {
  return std::min(nodes / least_copies, most_samples) * sizeof(double);
}

/// The least number of nodes after which the lattice comes again, and goes on coming again up to the grid's other end,
/// to within rounding. Else the whole grid.
CellPeriod::Axis CellPeriod::axis_of(std::size_t axis, const Grid& grid, const Affine& map,
                                     const Repetition& repetition) {
  constexpr double rounding = 1e-13;
  const Mat3 steps_from_field = inverse(repetition.steps);
  const Vec3 step = step_along(axis, grid, map);
  const std::int32_t last = grid.nodes[axis] - 1;
  const double size = std::max(norm(map * grid.box.min), norm(map * grid.box.max)) + last * norm(step);
  Axis result;
  result.nodes = grid.nodes[axis];
  for (std::int32_t n = 1; n <= std::min(last / 2, longest); ++n) {
    const Vec3 way = static_cast<double>(n) * step, in_steps = steps_from_field * way;
    Steps whole{};
    for (std::size_t a = 0; a < 3; ++a)
      whole[a] = repetition.count[a] == 1 ? 0 : static_cast<std::int64_t>(std::llround(in_steps[a]));
    if (whole == Steps{}) continue;
    if (norm(way - repetition.steps * vector_of(whole)) * last / n > rounding * size) continue;
    result.nodes = n;
    result.steps = whole;
    break;
  }
  return result;
}

void CellPeriod::Axis::divide() {
  const std::int32_t parts = (nodes + side - 1) / side;
  for (std::int32_t p = 0; p <= parts; ++p) begin.push_back(static_cast<std::int32_t>(std::int64_t{nodes} * p / parts));
  for (std::int32_t p = 0; p < parts; ++p)
    part.resize(static_cast<std::size_t>(begin[static_cast<std::size_t>(p) + 1]), p);
}

std::unique_ptr<const CellPeriod> CellPeriod::find(const PlacedCells& cells, const Grid& grid,
                                                   const Affine& field_from_grid, const Nearness& nearness,
                                                   const RunOptions& run) {
  const auto& repetition = cells.index().repetition();
  if (!repetition) return nullptr;
  std::unique_ptr<CellPeriod> result(new CellPeriod);
  std::uint64_t samples = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    result->axes_[a] = axis_of(a, grid, field_from_grid, *repetition);
    samples *= static_cast<std::uint64_t>(result->axes_[a].nodes);
  }
  if (samples * sizeof(double) > most_bytes(grid.node_count())) return nullptr;
  for (Axis& axis : result->axes_) axis.divide();
  result->count_ = repetition->count;
  result->row_nodes_ = grid.nodes[0];
  result->samples_.resize(samples);
  const auto& [x, y, z] = result->axes_;
  for (std::size_t pz = 0; pz < z.parts(); ++pz)
    for (std::size_t py = 0; py < y.parts(); ++py) {
      if (run.should_stop()) return nullptr;
      for (std::size_t px = 0; px < x.parts(); ++px)
        result->sample_part(cells, grid, field_from_grid, nearness, {px, py, pz});
    }
  return result;
}

void CellPeriod::sample_part(const PlacedCells& cells, const Grid& grid, const Affine& map, const Nearness& nearness,
                             std::array<std::size_t, 3> part) {
  std::array<std::int32_t, 3> first{}, last{};
  BrickBox box;
  Vec3 middle;
  for (std::size_t a = 0; a < 3; ++a) {
    first[a] = axes_[a].begin[part[a]];
    last[a] = axes_[a].begin[part[a] + 1] - 1;
    const Vec3 half = (last[a] - first[a]) / 2.0 * step_along(a, grid, map);
    box.half += Vec3{std::abs(half.x), std::abs(half.y), std::abs(half.z)};
    middle[a] = (grid.coordinate(a, first[a]) + grid.coordinate(a, last[a])) / 2;
  }
  box.middle = map * middle;
  box.half = (1 + 1e-9) * box.half;
  box.radius = norm(box.half);

  BrickContents contents;
  std::vector<Steps> copies;
  const Brick brick = contents.add(box, nearness, [&](const Box3& around, auto f) {
    cells.index().visit_endless(around, [&](const Primitive& primitive, const Steps& copy) {
      copies.push_back(copy);
      f(primitive, cells.index().repetition()->steps * vector_of(copy));
    });
  });
  Part& kept = parts_.emplace_back();
  kept.need = static_cast<std::uint32_t>(needs_.size());
  for (const BrickContents::Source& source : contents.sources()) needs_.push_back({source.thing, copies[source.call]});
  kept.needs = static_cast<std::uint32_t>(needs_.size()) - kept.need;
  const auto begin = needs_.begin() + kept.need;
  std::stable_sort(begin, needs_.end(), [](const auto& a, const auto& b) { return a.thing < b.thing; });
  for (std::size_t a = 0; a < 3 && kept.needs > 0; ++a) {
    const auto [least, most] = std::minmax_element(
        begin, needs_.end(), [a](const auto& one, const auto& other) { return one.copy[a] < other.copy[a]; });
    kept.least[a] = least->copy[a];
    kept.most[a] = most->copy[a];
  }

  BrickSampler sampler(nearness);
  std::array<double, strut_lanes> xs{};
  for (std::int32_t i = 0; i < side; ++i)
    xs[static_cast<std::size_t>(i)] = grid.coordinate(0, std::min(first[0] + i, last[0]));
  std::vector<Line> lines;
  std::vector<double> values;
  for (std::int32_t k = first[2]; k <= last[2]; ++k) {
    lines.clear();
    for (std::int32_t j = first[1]; j <= last[1]; ++j)
      lines.push_back({map * Vec3{0, grid.coordinate(1, j), grid.coordinate(2, k)}, map.linear.column(0)});
    values.assign(lines.size() * strut_lanes, brick.state == Brick::State::inside ? -nearness.far : nearness.far);
    if (brick.state == Brick::State::mixed) sampler.sample(contents, brick, lines, xs.data(), values.data());
    for (std::size_t l = 0; l < lines.size(); ++l)
      std::copy_n(values.data() + l * strut_lanes, last[0] - first[0] + 1,
                  samples_.data() + (row(first[1] + static_cast<std::int32_t>(l), k) - samples_.data()) + first[0]);
  }
}

/// Whether all that the part comes from is there: of each thing at least one of the copies that place it.
bool CellPeriod::is_whole(const Part& part, const Steps& from) const {
  const auto is_there = [&](const Steps& copy) {
    for (std::size_t a = 0; a < 3; ++a)
      if (copy[a] + from[a] < 0 || copy[a] + from[a] >= count_[a]) return false;
    return true;
  };
  if (part.needs == 0 || (is_there(part.least) && is_there(part.most))) return true;
  const Part::Need* const end = needs_.data() + part.need + part.needs;
  for (const Part::Need* need = needs_.data() + part.need; need != end;) {
    bool found = false;
    for (const std::uint32_t thing = need->thing; need != end && need->thing == thing; ++need)
      found = found || is_there(need->copy);
    if (!found) return false;
  }
  return true;
}

CellPeriod::Steps CellPeriod::steps_at(std::int32_t i, std::int32_t j, std::int32_t k) const {
  Steps result;
  for (std::size_t a = 0; a < 3; ++a)
    result[a] = i / axes_[0].nodes * axes_[0].steps[a] + j / axes_[1].nodes * axes_[1].steps[a] +
                k / axes_[2].nodes * axes_[2].steps[a];
  return result;
}

const CellPeriod::Part& CellPeriod::part_at(std::int32_t i, std::int32_t j, std::int32_t k) const {
  const auto part = [](const Axis& axis, std::int32_t node) {
    return static_cast<std::size_t>(axis.part[static_cast<std::size_t>(node % axis.nodes)]);
  };
  const auto& [x, y, z] = axes_;
  return parts_[(part(z, k) * y.parts() + part(y, j)) * x.parts() + part(x, i)];
}

const double* CellPeriod::row(std::int32_t j, std::int32_t k) const {
  const auto& [x, y, z] = axes_;
  return samples_.data() + (std::ptrdiff_t{k % z.nodes} * y.nodes + j % y.nodes) * x.nodes;
}

std::int32_t CellPeriod::band(std::size_t axis, std::int32_t node) const {
  const Axis& a = axes_[axis];
  return node / a.nodes * static_cast<std::int32_t>(a.parts()) + a.part[static_cast<std::size_t>(node % a.nodes)];
}

void CellPeriod::find_runs(std::int32_t j, std::int32_t k, std::vector<Run>& runs) const {
  const Axis& x = axes_[0];
  runs.clear();
  for (std::int32_t i = 0; i < row_nodes_;) {
    const std::int32_t in_period = i % x.nodes;
    const auto part = static_cast<std::size_t>(x.part[static_cast<std::size_t>(in_period)]);
    const std::int32_t end = std::min(row_nodes_, i - in_period + x.begin[part + 1]);
    const bool copied = is_whole(part_at(i, j, k), steps_at(i, j, k));
    if (!runs.empty() && runs.back().copied == copied)
      runs.back().last = end;
    else
      runs.push_back({i, end, copied});
    i = end;
  }
}

void CellPeriod::copy(std::int32_t j, std::int32_t k, std::int32_t first, std::int32_t last, double* out) const {
  const double* const samples = row(j, k);
  const std::int32_t nodes = axes_[0].nodes;
  for (std::int32_t i = first, from = first % nodes; i < last; from = 0) {
    const std::int32_t count = std::min(nodes - from, last - i);
    out = std::copy_n(samples + from, count, out);
    i += count;
  }
}

std::optional<double> CellPeriod::at(std::int32_t i, std::int32_t j, std::int32_t k) const {
  if (!is_whole(part_at(i, j, k), steps_at(i, j, k))) return std::nullopt;
  return row(j, k)[i % axes_[0].nodes];
}

}  // namespace meso::implicit
