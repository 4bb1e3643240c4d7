// SPDX-License-Identifier: Apache-2.0
#include "implicit_pattern.hpp"

#include <algorithm>
#include <array>
#include <numbers>

#include "affine_map.hpp"
#include "cell_primitives.hpp"
#include "coordinate_inverse.hpp"
#include "meso/base/number.hpp"
#include "point_terms.hpp"
#include "volume_element.hpp"

namespace meso::implicit {
namespace {

constexpr double tolerance = 1e-9;
/// Where weights, densities and fields are looked at before a body is made, along each axis.
constexpr std::int32_t points_in_block = 33, points_in_cell = 5;
using Steps = std::array<std::int64_t, 3>;

/// A cell that outlives the visit.
struct KeptCell {
  std::uint64_t ordinal;
  std::vector<std::int64_t> index;
  CellMapping mapping;
  Affine frame;
  Vec3 global;
  std::vector<double> parameters, q;
  std::array<double, 3> step;

  explicit KeptCell(const eval::PlacedCell& c)
      : ordinal(c.ordinal),
        index(c.index.begin(), c.index.end()),
        mapping(c.mapping),
        frame(c.world_from_cell),
        global(c.global),
        parameters(c.parameters.begin(), c.parameters.end()),
        q(c.q.begin(), c.q.end()),
        step(c.step) {}
  [[nodiscard]] eval::PlacedCell placed() const {
    return {.ordinal = ordinal,
            .index = index,
            .mapping = mapping,
            .world_from_cell = frame,
            .global = global,
            .parameters = parameters,
            .q = q,
            .step = step};
  }
};

/// Nothing if it is not one.
std::optional<std::int64_t> whole(double x) {
  const double n = std::round(x);
  return std::abs(x - n) <= tolerance * std::max(1.0, std::abs(n)) ? std::optional(static_cast<std::int64_t>(n))
                                                                   : std::nullopt;
}

bool near(const Mat3& a, const Mat3& b) {
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < 9; ++i) {
    difference = std::max(difference, std::abs(a.m[i] - b.m[i]));
    size = std::max(size, std::abs(a.m[i]));
  }
  return difference <= tolerance * size;
}

class Maker {
 public:
  Maker(const eval::Evaluation& evaluation, const eval::CellStream& cells, const Reporter& report)
      : evaluation_(evaluation), cells_(cells), report_(report), bodies_(evaluation, cells, report) {}

  std::optional<PatternField> make(const KeepCell& keep, const RunOptions& run);
  std::optional<Field> one(const eval::PlacedCell& cell);
  std::optional<Field> alone(const eval::PlacedCell& cell) {
    kept_.emplace_back(cell);
    return make_phases() ? one(cell) : std::nullopt;
  }

 private:
  struct Block {
    Steps first{}, last{};
    bool is_full = false;
  };

  std::optional<eval::BoxShape> box_of(const eval::PlacedCell& cell) { return cells_.cell_box(cell, report_.sink()); }
  std::optional<Field> lattice_at_once(const eval::CellStream::Lattice& lattice);
  bool collect(const KeepCell& keep, const RunOptions& run);
  std::optional<std::vector<Steps>> steps_from_first(const eval::BoxShape& box);
  bool repeats(const eval::PlacedCell& cell, const eval::BoxShape& box, const Block& block);
  std::optional<Field> repeated(const eval::BoxShape& box, const std::vector<Steps>& steps);
  std::optional<Field> cell_by_cell();
  std::optional<eval::VolumeElementShape> element_of_block(const Block& block);
  std::optional<Field> scattered_boxes(const eval::BoxShape& box, const std::vector<Steps>& steps);
  bool make_phases();

  /// The body in the world, not cut; the coordinates continue those of this cell over all of space.
  std::optional<Term> rigid_body(const eval::PlacedCell& cell, const eval::BoxShape& box, const Field& region,
                                 std::int32_t points_along);
  std::optional<Term> conformal_body(const eval::PlacedCell& cell, const eval::BoxShape& box,
                                     const eval::VolumeElementShape& around, const Field& region,
                                     std::int32_t points_along);
  static Field rigid_box(const eval::BoxShape& box, const Steps& first, const Steps& last, const Affine& frame) {
    Vec3 size, corner = box.corner;
    for (std::size_t a = 0; a < 3; ++a) {
      size[a] = static_cast<double>(last[a] - first[a] + 1) * box.size[a];
      corner[a] += static_cast<double>(first[a]) * box.size[a];
    }
    return moved(Field::box(0.5 * size).translated(corner + 0.5 * size), frame);
  }
  std::optional<eval::VolumeElementShape> element_of(const eval::PlacedCell& cell) {
    const auto region = cells_.cell_region(cell, report_.sink());
    return region ? std::optional(std::get<eval::VolumeElementShape>(region->value)) : std::nullopt;
  }
  std::nullopt_t not_inverted() {
    report_(Code::conformal_not_inverted, cells_.pattern().id_in_source, {});
    return std::nullopt;
  }
  Block block_of(const std::vector<Steps>& steps) const;
  /// Of the cell in the world.
  double shortest_edge(const eval::PlacedCell& cell, const eval::BoxShape& box) {
    if (cell.mapping == CellMapping::conformal) {
      const auto element = element_of(cell);
      return element ? shortest_edge_of(*element) : HUGE_VAL;
    }
    double shortest = HUGE_VAL;
    for (std::size_t a = 0; a < 3; ++a)
      shortest = std::min(shortest, box.size[a] * norm(cell.world_from_cell.linear.column(a)));
    return shortest;
  }

  const eval::Evaluation& evaluation_;
  const eval::CellStream& cells_;
  const Reporter& report_;
  ImplicitCells bodies_;
  std::vector<KeptCell> kept_;
  std::array<std::shared_ptr<const AxisPhase>, 3> phases_;  ///< of axes whose cells have a size from point to point
};

std::optional<Term> Maker::rigid_body(const eval::PlacedCell& cell, const eval::BoxShape& box, const Field& region,
                                      std::int32_t points_along) {
  const Affine local_from_world = inverse(cell.world_from_cell);
  CellPoint point;
  for (std::size_t i = 0; i < 3; ++i) {
    point.global[i] = Term::coordinate(i);
    point.local[i] = Term::coordinate(i).at(local_from_world);
  }
  return bodies_.body(cell, box, point, {region, shortest_edge(cell, box), points_along});
}

std::optional<Term> Maker::conformal_body(const eval::PlacedCell& cell, const eval::BoxShape& box,
                                          const eval::VolumeElementShape& around, const Field& region,
                                          std::int32_t points_along) {
  std::array<double, 3> middle{};
  for (std::size_t i = 0; i < 3; ++i) middle[i] = (around.from[i] + around.to[i]) / 2;
  const auto q = coordinates_of(*around.system, around.axes, middle);
  if (!q) return not_inverted();
  CellPoint point;
  for (std::size_t i = 0; i < 3; ++i) {
    point.global[i] = Term::coordinate(i);
    if (phases_[i]) {
      const Term phase = phase_term(phases_[i], (*q)[i].q) - std::round(phases_[i]->at(cell.q[i]));
      point.local[i] = box.size[i] * phase - -box.corner[i];
      continue;
    }
    const double edge = box.size[i] / cell.step[i];
    point.local[i] = edge * (*q)[i].q - (edge * cell.q[i] - box.corner[i]);
  }
  return bodies_.body(cell, box, point, {region, shortest_edge(cell, box), points_along});
}

/// Over what the kept cells take up.
bool Maker::make_phases() {
  const eval::PlacedCell cell = kept_.front().placed();
  if (cell.mapping == CellMapping::rigid) return true;
  const auto element = element_of(cell);
  if (!element) return false;
  for (std::size_t a = 0; a < 3; ++a) {
    const eval::CoordinateAxis& axis = element->system->axes()[a];
    const auto loop = std::ranges::find_if(
        cells_.pattern().loops, [&](const Loop& l) { return l.size && l.axis && l.axis->text == axis.name; });
    if (loop == cells_.pattern().loops.end()) continue;
    double from = HUGE_VAL, to = -HUGE_VAL;
    for (const KeptCell& kept : kept_) {
      from = std::min(from, kept.q[a]);
      to = std::max(to, kept.q[a] + kept.step[a]);
    }
    phases_[a] = bodies_.phase(*loop, axis.kind == AxisKind::circular, from, to);
    if (!phases_[a]) return false;
  }
  return true;
}

std::optional<Field> Maker::one(const eval::PlacedCell& cell) {
  const auto box = box_of(cell);
  if (!box) return std::nullopt;
  if (cell.mapping == CellMapping::rigid) {
    const Field region = rigid_box(*box, {}, {}, cell.world_from_cell);
    const auto body = rigid_body(cell, *box, region, points_in_cell);
    return body ? std::optional(intersection_of(Field::from_term(*body), region)) : std::nullopt;
  }
  const auto element = element_of(cell);
  if (!element) return std::nullopt;
  const auto region = volume_element(*element);
  if (!region) return not_inverted();
  const auto body = conformal_body(cell, *box, *element, *region, points_in_cell);
  return body ? std::optional(intersection_of(Field::from_term(*body), *region)) : std::nullopt;
}

/// A lattice whose steps are edges of the box need not be visited, whatever the number of its cells.
std::optional<Field> Maker::lattice_at_once(const eval::CellStream::Lattice& lattice) {
  if (!collect({}, {.max_cells = 1})) return std::nullopt;
  const eval::PlacedCell cell = kept_.front().placed();
  const auto box = box_of(cell);
  if (!box) return std::nullopt;
  const Mat3 cell_from_world = inverse(cell.world_from_cell.linear);
  Block block;
  std::array<bool, 3> taken{};
  for (std::size_t column = 0; column < 3; ++column) {
    if (lattice.count[column] == 1) continue;
    const Vec3 step = cell_from_world * lattice.lattice.column(column);
    bool fits = false;
    for (std::size_t axis = 0; axis < 3 && !fits; ++axis) {
      Vec3 edge;
      edge[axis] = box->size[axis];
      for (const double sign : {1.0, -1.0}) {
        if (taken[axis] || norm(step - sign * edge) > tolerance * box->size[axis]) continue;
        (sign > 0 ? block.last : block.first)[axis] = static_cast<std::int64_t>(sign) * (lattice.count[column] - 1);
        taken[axis] = fits = true;
        break;
      }
    }
    if (!fits) return std::nullopt;
  }
  if (!repeats(cell, *box, block)) return std::nullopt;
  const Field region = rigid_box(*box, block.first, block.last, cell.world_from_cell);
  const auto body = rigid_body(cell, *box, region, points_in_block);
  return body ? std::optional(intersection_of(Field::from_term(*body), region)) : std::nullopt;
}

bool Maker::repeats(const eval::PlacedCell& cell, const eval::BoxShape& box, const Block& block) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (block.first[axis] != block.last[axis] && !bodies_.repeats(cell, box, axis)) return false;
  return true;
}

bool Maker::collect(const KeepCell& keep, const RunOptions& run) {
  kept_.clear();
  bool good = true;
  const std::uint64_t last = std::min(cells_.size(), run.max_cells);
  const bool visited = cells_.visit(
      0, last,
      [&](const eval::PlacedCell& cell) {
        const auto kept = keep ? keep(cell) : true;
        good = kept.has_value();
        if (good && *kept) kept_.emplace_back(cell);
        return good;
      },
      report_.sink());
  return visited && good;
}

/// How many edges of the box each cell stands from the first, if that is a whole number along each axis.
std::optional<std::vector<Steps>> Maker::steps_from_first(const eval::BoxShape& box) {
  const KeptCell& first = kept_.front();
  const Affine back = first.mapping == CellMapping::rigid ? inverse(first.frame) : Affine{};
  std::vector<Steps> result;
  for (const KeptCell& cell : kept_) {
    if (cell.parameters != first.parameters) return std::nullopt;
    Vec3 away;
    if (cell.mapping == CellMapping::rigid) {
      if (!near(cell.frame.linear, first.frame.linear)) return std::nullopt;
      const Vec3 d = back * cell.frame.translation;
      for (std::size_t a = 0; a < 3; ++a) away[a] = d[a] / box.size[a];
    } else {
      for (std::size_t a = 0; a < 3; ++a) {
        if (phases_[a]) {
          away[a] = std::round(phases_[a]->at(cell.q[a])) - std::round(phases_[a]->at(first.q[a]));
          continue;
        }
        if (std::abs(cell.step[a] - first.step[a]) > tolerance * std::abs(first.step[a])) return std::nullopt;
        away[a] = (cell.q[a] - first.q[a]) / first.step[a];
      }
    }
    Steps steps{};
    for (std::size_t a = 0; a < 3; ++a) {
      const auto n = whole(away[a]);
      if (!n) return std::nullopt;
      steps[a] = *n;
    }
    result.push_back(steps);
  }
  return result;
}

Maker::Block Maker::block_of(const std::vector<Steps>& steps) const {
  Block block{steps.front(), steps.front()};
  for (const Steps& s : steps) {
    for (std::size_t a = 0; a < 3; ++a) {
      block.first[a] = std::min(block.first[a], s[a]);
      block.last[a] = std::max(block.last[a], s[a]);
    }
  }
  std::vector<Steps> distinct = steps;
  std::ranges::sort(distinct);
  const auto ends = std::ranges::unique(distinct);
  double cells = 1;
  for (std::size_t a = 0; a < 3; ++a) cells *= static_cast<double>(block.last[a] - block.first[a] + 1);
  block.is_full = cells == static_cast<double>(distinct.size() - ends.size());
  return block;
}

/// The coordinates that the whole block takes up.
std::optional<eval::VolumeElementShape> Maker::element_of_block(const Block& block) {
  const eval::PlacedCell cell = kept_.front().placed();
  auto element = element_of(cell);
  if (!element) return std::nullopt;
  for (std::size_t a = 0; a < 3; ++a) {
    if (phases_[a]) {
      for (const KeptCell& kept : kept_) {
        element->from[a] = std::min(element->from[a], kept.q[a]);
        element->to[a] = std::max(element->to[a], kept.q[a] + kept.step[a]);
      }
    } else {
      element->to[a] = element->from[a] + static_cast<double>(block.last[a] + 1) * cell.step[a];
      element->from[a] += static_cast<double>(block.first[a]) * cell.step[a];
    }
    const double turn = 2 * std::numbers::pi;
    if (element->system->axes()[a].kind != AxisKind::circular || element->to[a] - element->from[a] <= turn * (1 + 1e-9))
      continue;
    report_(
        Code::conformal_overlap, cells_.pattern().id_in_source,
        {element->system->axes()[a].name, format_number((element->to[a] - element->from[a]) * 180 / std::numbers::pi)});
    return std::nullopt;
  }
  return element;
}

/// Boxes here and there: what lies in any of them.
std::optional<Field> Maker::scattered_boxes(const eval::BoxShape& box, const std::vector<Steps>& steps) {
  const eval::PlacedCell cell = kept_.front().placed();
  std::vector<Primitive> boxes;
  for (std::size_t i = 0; i < kept_.size(); ++i) {
    if (cell.mapping == CellMapping::rigid) {
      add_field(rigid_box(box, steps[i], steps[i], cell.world_from_cell), boxes);
    } else {
      const auto element = element_of(kept_[i].placed());
      const auto region = element ? volume_element(*element) : std::nullopt;
      if (!region) return not_inverted();
      add_field(*region, boxes);
    }
  }
  const double reach = std::min({box.size.x, box.size.y, box.size.z}) / 2;
  return Field::external(std::make_shared<const PlacedCells>(PrimitiveIndex(std::move(boxes), {}), reach));
}

std::optional<Field> Maker::repeated(const eval::BoxShape& box, const std::vector<Steps>& steps) {
  const Block block = block_of(steps);
  const eval::PlacedCell cell = kept_.front().placed();
  if (!repeats(cell, box, block)) return std::nullopt;
  const bool is_rigid = cell.mapping == CellMapping::rigid;
  const auto element = is_rigid ? std::nullopt : element_of_block(block);
  if (!is_rigid && !element) return std::nullopt;
  const auto region = !block.is_full ? scattered_boxes(box, steps)
                      : is_rigid     ? rigid_box(box, block.first, block.last, cell.world_from_cell)
                                     : volume_element(*element);
  if (!region) return is_rigid ? std::nullopt : std::optional<Field>(not_inverted());
  const auto body = is_rigid ? rigid_body(cell, box, *region, points_in_block)
                             : conformal_body(cell, box, *element, *region, points_in_block);
  return body ? std::optional(intersection_of(Field::from_term(*body), *region)) : std::nullopt;
}

std::optional<Field> Maker::cell_by_cell() {
  std::vector<Primitive> primitives;
  double reach = 0;
  for (const KeptCell& kept : kept_) {
    const auto field = one(kept.placed());
    if (!field) return std::nullopt;
    add_field(*field, primitives);
    const Box3 box = field->bounds();
    if (!box.empty()) reach = std::max(reach, norm(box.max - box.min) / 4);
  }
  return Field::external(std::make_shared<const PlacedCells>(PrimitiveIndex(std::move(primitives), {}), reach));
}

std::optional<PatternField> Maker::make(const KeepCell& keep, const RunOptions& run) {
  PatternField result{nothing()};
  result.placed = result.kept = cells_.size();
  if (cells_.size() == 0) return result;
  const std::size_t errors = report_.sink().error_count();
  std::optional<Field> field;
  if (const auto lattice = keep ? std::nullopt : cells_.lattice()) field = lattice_at_once(*lattice);
  if (report_.sink().error_count() > errors) return std::nullopt;
  if (!field) {
    if (!collect(keep, run)) return std::nullopt;
    result.kept = kept_.size();
    if (kept_.empty()) return result;
    if (!make_phases()) return std::nullopt;
  }
  const auto box = box_of(kept_.front().placed());
  if (!box) return std::nullopt;
  result.smallest_feature_mm = shortest_edge(kept_.front().placed(), *box) / 4;
  if (!field) {
    if (const auto steps = steps_from_first(*box)) field = repeated(*box, *steps);
    if (report_.sink().error_count() > errors) return std::nullopt;
    if (!field) field = cell_by_cell();
  }
  if (!field) return std::nullopt;
  result.smallest_feature_mm = std::min(result.smallest_feature_mm, bodies_.thinnest_wall_mm());
  result.density_spacing_mm = bodies_.density_spacing_mm();
  result.field = *field;
  return result;
}

}  // namespace

std::optional<PatternField> implicit_pattern(const eval::Evaluation& evaluation, const eval::CellStream& cells,
                                             const KeepCell& keep, const RunOptions& run, const Reporter& report) {
  return Maker(evaluation, cells, report).make(keep, run);
}

std::optional<Field> implicit_cell(const eval::Evaluation& evaluation, const eval::CellStream& cells,
                                   const eval::PlacedCell& cell, const Reporter& report) {
  return Maker(evaluation, cells, report).alone(cell);
}

}  // namespace meso::implicit
