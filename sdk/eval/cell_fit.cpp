// SPDX-License-Identifier: Apache-2.0
#include "meso/eval/cell_fit.hpp"

#include <algorithm>
#include <set>

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

bool is_in_strut(const Strut& strut, const std::vector<StrutNode>& nodes, Vec3 p) {
  const Vec3 from = nodes[strut.from].position, axis = nodes[strut.to].position - from;
  const double t = dot(p - from, axis) / dot(axis, axis);
  const double radius = (1 - t) * strut.radius_from + t * strut.radius_to;
  if (t >= 0 && t <= 1) return norm(p - from - t * axis) <= radius;
  const bool before = t < 0;
  if ((before ? strut.cap_from : strut.cap_to) == BeamCap::butt) return false;
  return norm(p - (before ? from : from + axis)) <= (before ? strut.radius_from : strut.radius_to);
}

double largest_radius(const BeamsShape& beams) {
  double radius = 0;
  for (const Strut& strut : beams.struts) radius = std::max({radius, strut.radius_from, strut.radius_to});
  return radius;
}

/// Balls that their struts need, where those leave a node at a small angle, are larger than what is stated.
double largest_ball(const BeamsShape& beams) {
  double radius = 0;
  for (const StrutNode& node : beams.nodes) radius = std::max(radius, node.ball_radius);
  return radius;
}

/// Of the edges along which cells follow each other.
double shortest_repeated_edge(const Steps& steps) {
  double edge = HUGE_VAL;
  for (std::size_t k = 0; k < 3; ++k)
    if (const std::size_t axis = axis_of(steps.by_loop[k]); steps.count[k] > 1 && axis < 3)
      edge = std::min(edge, steps.edges[axis]);
  return edge;
}

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
    if (are_beams) tell_of_thickness(*cells, *steps);
  }

 private:
  /// Once for each unit cell. Beams that differ may be thick in some cells.
  void tell_of_thickness(const CellStream& cells, const Steps& steps) {
    if (!cells.lattice() || cells.shape_varies() || !told_.insert(cells.unit_cell().id.text).second) return;
    DiagnosticSink ignored;
    std::optional<Shape> shape;
    std::optional<BoxShape> box;
    const auto take = [&](const PlacedCell& cell) {
      shape = cells.shape(cell, ignored);
      box = cells.cell_box(cell, ignored);
      return false;
    };
    (void)cells.visit(0, 1, take, ignored);
    const auto* beams = shape ? std::get_if<BeamsShape>(&shape->value) : nullptr;
    if (beams == nullptr || !box) return;
    const double radius = largest_radius(*beams);
    const bool is_thick = 2 * radius >= (1 - tolerance) * shortest_repeated_edge(steps), is_full = fill(*beams, *box);
    if (!is_thick && !is_full) return;
    const SourceMap& source = evaluation_.checked().source();
    const ElementId body = std::get<BeamsBody>(cells.unit_cell().body).id_in_source;
    const Place place = source.knows(body) ? Place{body, "radius"} : Place{cells.pattern().id_in_source, "unitCell"};
    std::string what = is_full ? "nothing of it stays open, the cells are blocks" : "struts are as thick as it";
    if (const double ball = largest_ball(*beams); is_full && ball > radius)
      what = "with balls of radius " + text_of(ball) + " mm " + what;
    Report{source, sink_}(Code::beams_fill_cell, place,
                          {cells.unit_cell().id.text, text_of(radius), text_of(box->size), std::move(what)});
  }

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
  std::set<std::string> told_;  ///< unit cells
};

}  // namespace

bool fill(const BeamsShape& beams, const BoxShape& box) {
  constexpr int steps =
      24;  // of an edge; the middles of faces and edges, which stay open longest, are among the points
  std::vector<Strut> struts = beams.struts;
  std::erase_if(struts, [&](const Strut& s) { return beams.nodes[s.from].position == beams.nodes[s.to].position; });
  const auto is_in = [&](Vec3 p) {
    return std::ranges::any_of(struts, [&](const Strut& s) { return is_in_strut(s, beams.nodes, p); }) ||
           std::ranges::any_of(beams.nodes, [&](const StrutNode& n) { return norm(p - n.position) <= n.ball_radius; });
  };
  for (int x = 0; x <= steps; ++x)
    for (int y = 0; y <= steps; ++y)
      for (int z = 0; z <= steps; ++z)
        if (!is_in(box.corner + Vec3{box.size.x * x, box.size.y * y, box.size.z * z} / steps)) return false;
  return true;
}

void warn_of_misfits(const Evaluation& evaluation, DiagnosticSink& sink) {
  Misfits misfits(evaluation, sink);
  for (const Pattern& pattern : evaluation.document().patterns) misfits.tell(pattern);
}

}  // namespace meso::eval
