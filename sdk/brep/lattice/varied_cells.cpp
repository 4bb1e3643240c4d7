// SPDX-License-Identifier: Apache-2.0
#include "lattice/varied_cells.hpp"

#include <algorithm>
#include <numeric>

#include "lattice/primitive_field.hpp"
#include "meso/brep/instance_map.hpp"

namespace meso::brep {

std::uint32_t PrimitiveTable::number_of(const CellPrimitive& primitive) {
  const auto rounded = [&](double value) { return std::llround(value / quantum_); };
  std::array<std::int64_t, 8> key{};
  if (const auto* ball = std::get_if<Ball>(&primitive)) {
    key = {
        rounded(ball->centre.x), rounded(ball->centre.y), rounded(ball->centre.z), rounded(ball->radius), 0, 0, 0, -1};
  } else {
    const auto& strut = std::get<Frustum>(primitive);
    key = {rounded(strut.start.x), rounded(strut.start.y), rounded(strut.start.z), rounded(strut.start_radius),
           rounded(strut.end.x),   rounded(strut.end.y),   rounded(strut.end.z),   rounded(strut.end_radius)};
  }
  const auto [it, fresh] = numbers_.try_emplace(key, static_cast<std::uint32_t>(all_.size()));
  if (fresh) all_.push_back(primitive);
  return it->second;
}

VariedBoxes::VariedBoxes(const CellShape& cell)
    : cell_(cell), placed_(std::max({cell.size().x, cell.size().y, cell.size().z})) {
  Box3 all;
  for (const CellPrimitive& primitive : cell.primitives) {
    bounds_.push_back(bounds(primitive));
    all.extend(bounds_.back().min);
    all.extend(bounds_.back().max);
  }
  if (cell.cut_to_box) return;
  Index3 low{}, high{};
  for (std::size_t i = 0; i < 3; ++i) {
    low[i] = static_cast<std::int32_t>(std::ceil((cell.box.min[i] - all.max[i] + cell.tolerance()) / cell.size()[i]));
    high[i] = static_cast<std::int32_t>(std::floor((cell.box.max[i] - all.min[i] - cell.tolerance()) / cell.size()[i]));
  }
  for (Index3 shift = low; shift[0] <= high[0]; ++shift[0])
    for (shift[1] = low[1]; shift[1] <= high[1]; ++shift[1])
      for (shift[2] = low[2]; shift[2] <= high[2]; ++shift[2])
        if (shift != Index3{}) reach_.rim.push_back({.shift = shift, .parts = {}});
  reach_.neighbours = reach_.rim;
}

bool VariedBoxes::reaches(std::uint32_t solid, const Index3& shift) const {
  for (std::size_t i = 0; i < 3; ++i) {
    const double by = shift[i] * cell_.size()[i];
    if (bounds_[solid].min[i] + by >= cell_.box.max[i] - cell_.tolerance() ||
        bounds_[solid].max[i] + by <= cell_.box.min[i] + cell_.tolerance())
      return false;
  }
  return true;
}

std::vector<std::uint32_t> VariedBoxes::parts_of(const Index3& box, const std::function<bool(Index3)>& in_pattern) {
  std::vector<std::uint32_t> parts;
  std::vector<CellPrimitive> placed, own;
  const auto add_from = [&](const Index3& shift) {
    const Index3 from = box + shift;
    if (!in_pattern(from)) return;
    const Vec3 by{shift[0] * cell_.size().x, shift[1] * cell_.size().y, shift[2] * cell_.size().z};
    // What a neighbour adds to the cell's own; its struts add nothing to the balls that they end in, which may be
    // larger than the cell's own about the same centres.
    std::vector<CellPrimitive> known = own;
    if (shift != Index3{})
      for (const std::uint32_t solid : cell_.varied->of(from))
        if (std::holds_alternative<Ball>(cell_.primitives[solid]))
          known.push_back(translated(cell_.primitives[solid], by));
    for (const std::uint32_t solid : cell_.varied->of(from)) {
      if (!reaches(solid, shift)) continue;
      const CellPrimitive primitive = translated(cell_.primitives[solid], by);
      const bool is_ball = std::holds_alternative<Ball>(primitive);
      if (shift != Index3{} && !(is_ball && own.empty()) && covered(primitive, is_ball ? own : known, cell_.box))
        continue;
      if (std::ranges::any_of(placed, [&](const CellPrimitive& p) { return same(p, primitive, cell_.tolerance()); }))
        continue;
      placed.push_back(primitive);
      // Whichever neighbour sends it: boxes that hold the same are one kind.
      const std::uint32_t number = placed_.number_of(primitive);
      if (number == reach_.parts.size()) reach_.parts.push_back({solid, shift});
      parts.push_back(number);
    }
  };
  add_from({});
  own = placed;
  for (const Reach::Neighbour& neighbour : reach_.neighbours) add_from(neighbour.shift);
  std::ranges::sort(parts);
  return parts;
}

std::optional<CellShape> as_varied(const CellShape& cell) {
  if (cell.varied || cell.primitives.empty()) return {};
  std::vector<std::uint32_t> all(cell.primitives.size());
  std::iota(all.begin(), all.end(), 0u);
  CellShape out = cell;
  out.varied = std::make_shared<const VariedCells>(std::move(all));
  VariedBoxes boxes(out);
  const auto parts = boxes.parts_of({}, [](const Index3&) { return true; });
  if (!is_put_together(out, boxes.reach(), parts)) return {};
  return out;
}

}  // namespace meso::brep
