// SPDX-License-Identifier: Apache-2.0
#include "meso/eval/pattern_reach.hpp"

#include <algorithm>
#include <cmath>

#include "meso/base/number.hpp"
#include "scope.hpp"

namespace meso::eval {
namespace {

enum class Found { none, some, failed };

/// `visit` runs a visitor over cells; the first one that is `wanted` is enough. An empty `wanted` is any.
template <class Visit>
Found any(const Visit& visit, const MayReach& wanted, DiagnosticSink& sink) {
  const std::size_t errors = sink.error_count();
  bool found = false;
  (void)visit([&](const PlacedCell& cell) {
    found = !wanted || wanted(cell);
    return !found && sink.error_count() == errors;
  });
  if (sink.error_count() > errors) return Found::failed;
  return found ? Found::some : Found::none;
}

Found any_kept(const CellStream& cells, DiagnosticSink& sink) {
  return any([&](const auto& visitor) { return cells.visit(0, cells.size(), visitor, sink); }, {}, sink);
}

std::string text_of(Vec3 p) { return format_number(p.x) + ", " + format_number(p.y) + ", " + format_number(p.z); }

/// Where the first cell stands that is kept; empty without one.
std::string first_place(const CellStream& cells, DiagnosticSink& sink) {
  std::string first;
  (void)cells.visit(
      0, cells.size(),
      [&](const PlacedCell& cell) {
        first = text_of(cell.world_from_cell.translation);
        return false;
      },
      sink);
  return first;
}

void warn_of_miss(const Evaluation& evaluation, const CellStream& cells, const Part& part, const Box3& body_mm,
                  DiagnosticSink& sink) {
  const std::string first = first_place(cells, sink);
  Report{evaluation.checked().source(), sink}(
      Code::pattern_misses_part, {cells.pattern().id_in_source, {}},
      {cells.pattern().id.text, part.id.text, text_of(body_mm.min), text_of(body_mm.max), first});
}

/// A cut that takes nothing away. Of other operations the result tells.
void warn_of_no_cells(const Evaluation& evaluation, const CellStream& cells, DiagnosticSink& sink) {
  const Pattern& pattern = cells.pattern();
  const Place place =
      pattern.loops.empty() ? Place{pattern.id_in_source, {}} : Place{pattern.loops.front().id_in_source, "count"};
  Report{evaluation.checked().source(), sink}(Code::pattern_keeps_none, place, {pattern.id.text, "0"});
}

std::string rounded(double length_mm) { return format_number(std::round(1e6 * length_mm) / 1e6); }

/// An intersection of what is smaller than each of many cells is a scrap of one; most often, a unit is wrong. One cell
/// alone is an operand as any other.
void warn_of_scrap(const Evaluation& evaluation, const CellStream& cells, const Part& part, const Box3& body_mm,
                   DiagnosticSink& sink) {
  const Vec3 size = body_mm.max - body_mm.min;
  const double longest = std::max({size.x, size.y, size.z});
  double edge = HUGE_VAL;  // the shortest of all cells there
  DiagnosticSink untold;   // the cell is evaluated again, and its faults are told there
  (void)cells.visit_touching(
      body_mm,
      [&](const PlacedCell& cell) {
        const auto box = cell.mapping == CellMapping::rigid ? cells.cell_box(cell, untold) : std::nullopt;
        edge = box ? std::min({edge, box->size.x, box->size.y, box->size.z}) : 0;
        return edge > longest;
      },
      untold);
  if (!std::isfinite(edge) || !(longest < edge)) return;
  Report{evaluation.checked().source(), sink}(Code::body_within_cell, {cells.pattern().id_in_source, {}},
                                              {cells.pattern().id.text, part.id.text, rounded(longest), rounded(edge)});
}

bool has_when(const Pattern& pattern) {
  return std::ranges::any_of(pattern.instructions,
                             [](const Instruction& i) { return std::holds_alternative<WhenInstruction>(i); });
}

}  // namespace

bool check_keeps_any(const Evaluation& evaluation, const CellStream& cells, DiagnosticSink& sink) {
  const Pattern& pattern = cells.pattern();
  if (cells.size() == 0 || !has_when(pattern)) return true;
  const Found found = any_kept(cells, sink);
  if (found == Found::none)
    Report{evaluation.checked().source(), sink}(Code::pattern_keeps_none, {pattern.id_in_source, {}},
                                                {pattern.id.text, std::to_string(cells.size())});
  return found != Found::failed;
}

bool must_reach(const CellStream& cells, const Apply& apply) {
  return cells.pattern().scatter && apply.operation != ApplyOperation::union_ && cells.size() > 0;
}

void report_no_reach(const Evaluation& evaluation, const CellStream& cells, const Part& part, DiagnosticSink& sink) {
  const Scatter& scatter = *cells.pattern().scatter;
  Report{evaluation.checked().source(), sink}(Code::field_misses_part, {scatter.id_in_source, "field"},
                                              {std::to_string(cells.size()), scatter.field.text, part.id.text});
}

bool check_reach(const Evaluation& evaluation, const CellStream& cells, const Apply& apply, const Part& part,
                 const Box3& body_mm, const MayReach& may_reach, DiagnosticSink& sink) {
  if (cells.size() == 0 && apply.operation == ApplyOperation::difference && !body_mm.empty())
    warn_of_no_cells(evaluation, cells, sink);
  if (apply.operation == ApplyOperation::union_ || body_mm.empty() || cells.size() == 0)
    return check_keeps_any(evaluation, cells, sink);
  const Found touching =
      any([&](const auto& visitor) { return cells.visit_touching(body_mm, visitor, sink); }, may_reach, sink);
  if (touching == Found::some && apply.operation == ApplyOperation::intersection && cells.size() > 1)
    warn_of_scrap(evaluation, cells, part, body_mm, sink);
  if (touching != Found::none) return touching == Found::some;
  const Found kept = any_kept(cells, sink);
  if (kept == Found::none) return check_keeps_any(evaluation, cells, sink);
  if (kept == Found::failed) return false;
  if (must_reach(cells, apply)) return report_no_reach(evaluation, cells, part, sink), false;
  // What an intersection leaves is empty, and told as that.
  if (apply.operation == ApplyOperation::difference) warn_of_miss(evaluation, cells, part, body_mm, sink);
  return true;
}

Diagnostic empty_part(const Evaluation& evaluation, const Part& part) {
  const SourceMap& source = evaluation.checked().source();
  Diagnostic out{.code = Code::geometry_empty,
                 .where = source.span(part.id_in_source),
                 .path = source.path(part.id_in_source),
                 .args = {part.id.text}};
  for (const Apply& apply : part.steps) {
    const Pattern* pattern = apply.pattern ? evaluation.find_pattern(apply.pattern->text) : nullptr;
    DiagnosticSink untold;
    const auto cells = pattern != nullptr ? evaluation.cells(*pattern, untold) : std::nullopt;
    if (!cells) continue;
    const std::string first = first_place(*cells, untold), name = "pattern '" + pattern->id.text + "' ";
    const bool has_loops = cells->size() == 0 && !pattern->loops.empty();
    out.related.push_back(
        {has_loops ? source.span(pattern->loops.front().id_in_source, "count") : source.span(pattern->id_in_source),
         cells->size() == 0 ? name + "has no cells"
         : first.empty()    ? name + "keeps none of its cells"
                            : name + "has its first cell at (" + first + ") mm"});
  }
  return out;
}

}  // namespace meso::eval
