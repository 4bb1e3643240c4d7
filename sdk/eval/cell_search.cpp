// SPDX-License-Identifier: Apache-2.0
// Which cells can touch a box: by inverting the lattice where there is one, else cell by cell.
#include <algorithm>
#include <cmath>

#include "cell_stream_impl.hpp"
#include "meso/eval/bounds.hpp"
#include "orientation.hpp"
#include "walker.hpp"

namespace meso::eval {
namespace {

/// Rounding in placements and bounds is far below this, touching cells are found.
Box3 widened(const Box3& box) {
  constexpr double tolerance = 1e-9;
  double size = 1;
  for (std::size_t i = 0; i < 3; ++i) size = std::max({size, std::abs(box.min[i]), std::abs(box.max[i])});
  const double pad = tolerance * size;
  return {box.min - Vec3{pad, pad, pad}, box.max + Vec3{pad, pad, pad}};
}

void extend(Box3& box, const Box3& other) {
  if (other.empty()) return;
  box.extend(other.min);
  box.extend(other.max);
}

/// A box around everything a cell may fill. Remembers the last one: most cells of a pattern have equal parameters.
class CellReach {
 public:
  CellReach(const CellStream& stream, DiagnosticSink& sink) : stream_(stream), sink_(sink) {}

  /// False: something was reported. `reach` is empty where nobody can say: the cell may be anywhere.
  bool find(const PlacedCell& cell, std::optional<Box3>& reach) {
    if (!stream_.shape_varies() && known_ && std::ranges::equal(parameters_, cell.parameters)) {
      reach = local_ ? std::optional(transformed(cell.world_from_cell, *local_)) : std::nullopt;
      return true;
    }
    known_ = true;
    parameters_.assign(cell.parameters.begin(), cell.parameters.end());
    if (!compute(cell, local_)) return false;
    reach = local_ && cell.mapping == CellMapping::rigid ? std::optional(transformed(cell.world_from_cell, *local_))
                                                         : local_;
    return true;
  }

 private:
  bool compute(const PlacedCell& cell, std::optional<Box3>& box) {
    const UnitCell& unit_cell = stream_.unit_cell();
    const bool has_box = unit_cell.box.has_value();
    const bool cut =
        has_box && (unit_cell.clip_to_box.value_or(false) || std::holds_alternative<ImplicitBody>(unit_cell.body));
    box = Box3{};
    if (has_box) {
      const std::size_t errors = sink_.error_count();
      const auto own = stream_.cell_region(cell, sink_);
      if (!own) return sink_.error_count() == errors && (box = std::nullopt, true);
      extend(*box, bounds(*own).value());
    }
    if (cut) return true;
    const bool known =
        std::holds_alternative<CsgBody>(unit_cell.body) || std::holds_alternative<BeamsBody>(unit_cell.body);
    if (!known) {
      box.reset();
      return true;
    }
    const auto shape = stream_.shape(cell, sink_);
    if (!shape) return false;
    const auto body = bounds(*shape);
    if (body)
      extend(*box, *body);
    else
      box.reset();
    return true;
  }

  const CellStream& stream_;
  DiagnosticSink& sink_;
  bool known_ = false;
  std::vector<double> parameters_;
  std::optional<Box3> local_;
};

struct IndexBox {
  std::array<std::int64_t, 3> first{}, last{};
};

/// Indices n with lattice * n in `box`; nothing if the lattice is flat or the box is not finite.
std::optional<IndexBox> indices_in(const CellStream::Lattice& lattice, const Box3& box) {
  Vec3 columns[3] = {lattice.lattice.column(0), lattice.lattice.column(1), lattice.lattice.column(2)};
  double longest = 0;
  for (const Vec3& c : columns) longest = std::max(longest, norm(c));
  // An index that takes one value only needs no direction of its own: any independent one will do.
  for (std::size_t k = 0; k < 3; ++k) {
    if (lattice.count[k] > 1) continue;
    const Vec3 a = columns[(k + 1) % 3], b = columns[(k + 2) % 3];
    Vec3 free = cross(a, b);
    if (norm(free) == 0) {
      const Vec3 along = norm(a) > 0 ? a : b;
      free = cross(along, std::abs(along.x) <= std::abs(along.y) ? Vec3{1, 0, 0} : Vec3{0, 1, 0});
    }
    columns[k] = norm(free) > 0 ? (longest / norm(free)) * free : Vec3{};
  }
  const Mat3 basis = Mat3::from_columns(columns[0], columns[1], columns[2]);
  const double volume = norm(columns[0]) * norm(columns[1]) * norm(columns[2]);
  if (!(std::abs(determinant(basis)) > 1e-9 * volume)) return std::nullopt;
  const Box3 range = transformed({inverse(basis), {}}, box);
  IndexBox result;
  for (std::size_t k = 0; k < 3; ++k) {
    if (!std::isfinite(range.min[k]) || !std::isfinite(range.max[k])) return std::nullopt;
    if (lattice.count[k] == 1) continue;
    const double top = static_cast<double>(lattice.count[k] - 1);
    const double slack = 1e-9 * (1 + std::max(std::abs(range.min[k]), std::abs(range.max[k])));
    result.first[k] = static_cast<std::int64_t>(std::clamp(std::ceil(range.min[k] - slack), 0.0, top + 1));
    result.last[k] = static_cast<std::int64_t>(std::clamp(std::floor(range.max[k] + slack), -1.0, top));
  }
  return result;
}

}  // namespace

bool CellStream::visit_touching(const Box3& region, const Visitor& visitor, DiagnosticSink& sink) const {
  if (region.empty() || size() == 0) return true;
  const Box3 wide = widened(region);
  CellReach reach(*this, sink);
  bool good = true;
  const Visitor test = [&](const PlacedCell& cell) {
    std::optional<Box3> box;
    good = reach.find(cell, box);
    if (!good) return false;
    return box && !box->intersects(wide) ? true : visitor(cell);
  };
  Walker walker(*impl_->program, sink);

  const auto grid = lattice();
  std::optional<IndexBox> indices;
  if (grid) {
    std::optional<Box3> first;
    if (!visit(
            0, 1, [&](const PlacedCell& cell) { return good = reach.find(cell, first); }, sink) ||
        !good)
      return false;
    if (first) indices = indices_in(*grid, {wide.min - first->max, wide.max - first->min});
  }
  if (!indices) return walker.visit(0, size(), test) && good;

  const auto& count = grid->count;
  for (std::int64_t i = indices->first[0]; i <= indices->last[0]; ++i) {
    for (std::int64_t j = indices->first[1]; j <= indices->last[1]; ++j) {
      const auto row = static_cast<std::uint64_t>((i * count[1] + j) * count[2]);
      const auto from = row + static_cast<std::uint64_t>(indices->first[2]);
      const auto to = row + static_cast<std::uint64_t>(indices->last[2] + 1);
      if (!walker.visit(from, to, test) || !good) return false;
      if (walker.ended()) return true;
    }
  }
  return true;
}

}  // namespace meso::eval
