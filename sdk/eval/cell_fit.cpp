// SPDX-License-Identifier: Apache-2.0
#include "meso/eval/cell_fit.hpp"

#include <algorithm>

#include "meso/base/number.hpp"
#include "orientation.hpp"
#include "scope.hpp"

namespace meso::eval {
namespace {

constexpr double tolerance = 1e-6;  ///< of an edge

/// What stands regularly, seen from its first cell; millimetres.
struct Steps {
  std::array<Vec3, 3> by_loop;
  std::array<std::int64_t, 3> count;
  Vec3 edges;  ///< of the box
};

std::optional<Steps> steps_of(const CellStream& cells) {
  const auto lattice = cells.lattice_of_places();
  if (!lattice || cells.size() < 2) return {};
  DiagnosticSink ignored;
  std::optional<BoxShape> box;
  const auto take = [&](const PlacedCell& cell) {
    box = cells.cell_box(cell, ignored);
    return false;
  };
  (void)cells.visit(0, 1, take, ignored);
  if (!box) return {};
  Steps out{.by_loop = {}, .count = lattice->count, .edges = box->size};
  const Mat3 in_cell = inverse(lattice->world_from_first.linear) * lattice->lattice;
  for (std::size_t k = 0; k < 3; ++k) out.by_loop[k] = in_cell.column(k);
  return out;
}

/// The one axis that a step runs along; 3 if there is none.
std::size_t axis_of(Vec3 step) {
  std::size_t axis = 0;
  while (axis < 3 && std::fabs(step[axis]) < (1 - tolerance) * norm(step)) ++axis;
  return axis;
}

/// Each loop has an axis of its own: a gap along one is not filled by cells of another.
bool is_straight(const Steps& steps) {
  std::array<bool, 4> used{};
  for (std::size_t k = 0; k < 3; ++k) {
    if (steps.count[k] == 1) continue;
    const std::size_t axis = axis_of(steps.by_loop[k]);
    if (axis == 3 || used[axis]) return false;
    used[axis] = true;
  }
  return true;
}

bool overlaps(Vec3 step, Vec3 edges) {
  for (std::size_t a = 0; a < 3; ++a)
    if (std::fabs(step[a]) > (1 - tolerance) * edges[a]) return false;
  return true;
}

/// Without the last digits of a conversion.
std::string text_of(double length) { return format_number(std::round(length * 1e9) / 1e9); }
std::string text_of(Vec3 size) { return text_of(size.x) + " x " + text_of(size.y) + " x " + text_of(size.z); }

/// Whether a part is made of the pattern's cells and of no other pattern's.
bool fills_alone(const Document& document, const Pattern& pattern) {
  const auto applies = [&](const Apply& apply) {
    return apply.pattern && apply.pattern->text == pattern.id.text && apply.operation != ApplyOperation::difference;
  };
  return document.patterns.size() == 1 && std::ranges::any_of(document.parts, [&](const Part& part) {
           return std::ranges::any_of(part.steps, applies);
         });
}

class Misfits {
 public:
  Misfits(const Evaluation& evaluation, DiagnosticSink& sink) : evaluation_(evaluation), sink_(sink) {}

  void tell(const Pattern& pattern) {
    DiagnosticSink ignored;
    const auto cells = evaluation_.cells(pattern, ignored);
    const auto steps = cells ? steps_of(*cells) : std::nullopt;
    if (!steps) return;
    const bool are_beams = std::holds_alternative<BeamsBody>(cells->unit_cell().body);
    const bool may_gape = are_beams && is_straight(*steps) && fills_alone(evaluation_.document(), pattern);
    for (std::size_t k = 0; k < 3; ++k) {
      if (steps->count[k] == 1) continue;
      const Vec3 step = steps->by_loop[k];
      if (step == Vec3{}) return report(Code::cells_coincide, pattern, k, {std::to_string(steps->count[k])});
      const std::size_t axis = axis_of(step);
      if (are_beams && overlaps(step, steps->edges))
        return report(Code::cells_overlap, pattern, k, {text_of(steps->edges), text_of(norm(step))});
      if (may_gape && norm(step) > (1 + tolerance) * steps->edges[axis])
        return report(Code::cells_apart, pattern, k, {text_of(steps->edges), text_of(norm(step))});
    }
  }

 private:
  /// `k`: the loop; the arguments follow the pattern's name and the loop's index.
  void report(Code code, const Pattern& pattern, std::size_t k, std::vector<std::string> arguments) {
    const bool has_loop = k < pattern.loops.size();
    arguments.insert(arguments.begin(), {pattern.id.text, has_loop ? pattern.loops[k].index.text : std::to_string(k)});
    const bool has_spacing = has_loop && pattern.loops[k].spacing;
    const Place place{has_loop ? pattern.loops[k].id_in_source : pattern.id_in_source, has_spacing ? "spacing" : ""};
    Report{evaluation_.checked().source(), sink_}(code, place, std::move(arguments));
  }

  const Evaluation& evaluation_;
  DiagnosticSink& sink_;
};

}  // namespace

void warn_of_misfits(const Evaluation& evaluation, DiagnosticSink& sink) {
  Misfits misfits(evaluation, sink);
  for (const Pattern& pattern : evaluation.document().patterns) misfits.tell(pattern);
}

}  // namespace meso::eval
