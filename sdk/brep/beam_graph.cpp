// SPDX-License-Identifier: Apache-2.0
#include "beam_graph.hpp"

#include <algorithm>
#include <cmath>

#include "meso/base/number.hpp"
#include "meso/brep/instance_map.hpp"
#include "solid_beams.hpp"
#include "solid_primitive.hpp"

namespace meso::brep {
namespace {

constexpr double same_point = 1e-6;

/// Finds again the points it has been given, by the small box they are in.
class Points {
 public:
  /// Its number; numbers count from 0 as new points come.
  std::uint32_t operator()(Vec3 p) {
    const std::array<std::int64_t, 3> low = box_of(p - Vec3{same_point, same_point, same_point}),
                                      high = box_of(p + Vec3{same_point, same_point, same_point});
    for (std::int64_t x = low[0]; x <= high[0]; ++x)
      for (std::int64_t y = low[1]; y <= high[1]; ++y)
        for (std::int64_t z = low[2]; z <= high[2]; ++z)
          if (const std::uint32_t* first = boxes_.find(key_of({x, y, z})))
            for (std::uint32_t i = *first; i != none; i = next_[i])
              if (norm(points_[i] - p) <= same_point) return i;
    const auto number = static_cast<std::uint32_t>(points_.size());
    points_.push_back(p);
    const auto [first, fresh] = boxes_.find_or_add(key_of(box_of(p)));
    next_.push_back(fresh ? none : first);
    first = number;
    return number;
  }

 private:
  static constexpr std::uint32_t none = ~std::uint32_t{0};
  static constexpr double box = 1e-3;

  static std::array<std::int64_t, 3> box_of(Vec3 p) {
    return {std::llround(p.x / box), std::llround(p.y / box), std::llround(p.z / box)};
  }
  /// Boxes that share a key share a list.
  static std::uint64_t key_of(const std::array<std::int64_t, 3>& b) {
    std::uint64_t h = 0;
    for (const std::int64_t c : b) h = (h ^ static_cast<std::uint64_t>(c)) * 0x9e3779b97f4a7c15u + (h >> 29);
    return h >> 1;
  }

  FlatMap<std::uint32_t> boxes_;
  std::vector<std::uint32_t> next_;
  std::vector<Vec3> points_;
};

class Collector {
 public:
  Collector(SnappedRadii& snapped, std::string& why, const SolidContext& context)
      : snapped_(snapped), why_(why), context_(context) {}

  /// False: not such a body (see why), or something was reported.
  bool add(const eval::BeamsShape& beams, const Affine& world_from_cell, ElementId where) {
    if (!is_similarity(world_from_cell)) return refuse("a cell is stretched");
    const double scale = std::cbrt(determinant(world_from_cell.linear));
    node_.clear();
    for (const eval::StrutNode& node : beams.nodes) {
      const Vec3 p = world_from_cell * node.position;
      if (!(norm(p) < largest_size)) return size("the distance of a node from the origin", norm(p), where);
      if (node.ball_radius != 0 && !(scale * node.ball_radius > smallest_size))
        return size("the radius of a node", scale * node.ball_radius, where);
      node_.push_back(points_(p));
      if (node_.back() == graph_.nodes.size()) graph_.nodes.push_back({p, 0});
      raise(node_.back(), scale * node.ball_radius);
    }
    for (const eval::Strut& strut : beams.struts)
      if (!add(strut, scale, where)) return false;
    return true;
  }

  /// What ends flat must end within a ball.
  std::optional<BeamGraph> finish() {
    for (BeamGraph::Strut& strut : graph_.struts)  // a cone that is none but for rounding
      if (std::fabs(strut.radius[0] - strut.radius[1]) <= 1e-9 * strut.radius[0])
        strut.radius.fill(std::max(strut.radius[0], strut.radius[1]));
    for (const BeamGraph::Strut& strut : graph_.struts)
      for (std::size_t end = 0; end < 2; ++end) {
        const double ball = graph_.nodes[strut.node[end]].radius;
        if (ball >= strut.radius[end] * (1 - equal_radii)) continue;
        why_ = "a strut of radius " + format_number(strut.radius[end]) + " mm ends at a node whose ball has " +
               format_number(ball) + " mm";
        return {};
      }
    return std::move(graph_);
  }

 private:
  bool refuse(std::string why) {
    why_ = std::move(why);
    return false;
  }
  bool size(std::string what, double value, ElementId where) {
    context_.report(Code::geometry_size, where, {std::move(what), format_number(value)});
    return false;
  }
  void raise(std::uint32_t node, double radius) {
    graph_.nodes[node].radius = std::max(graph_.nodes[node].radius, radius);
  }

  bool add(const eval::Strut& strut, double scale, ElementId where) {
    BeamGraph::Strut added{{node_[strut.from], node_[strut.to]}, {scale * strut.radius_from, scale * strut.radius_to}};
    const Vec3 from = graph_.nodes[added.node[0]].position;
    if (added.node[0] == added.node[1]) return size(size_of_beam_at("length", from), 0, where);
    for (const double radius : added.radius)
      if (!(radius > smallest_size && radius < largest_size))
        return size(size_of_beam_at("radius", from), radius, where);
    const std::array caps{strut.cap_from, strut.cap_to};
    for (std::size_t end = 0; end < 2; ++end) {
      // Half a ball at the end of a cone is less than a ball: it counts only where a ball covers it, see finish().
      const bool is_ball =
          caps[end] == BeamCap::sphere || (caps[end] == BeamCap::hemisphere && added.radius[0] == added.radius[1]);
      if (is_ball) raise(added.node[end], added.radius[end]);
    }
    if (added.node[0] > added.node[1]) {
      std::swap(added.node[0], added.node[1]);
      std::swap(added.radius[0], added.radius[1]);
    }
    const auto [known, fresh] = struts_.find_or_add(std::uint64_t{added.node[0]} << 32 | added.node[1]);
    if (!fresh) return merge(graph_.struts[known], added);
    known = static_cast<std::uint32_t>(graph_.struts.size());
    graph_.struts.push_back(added);
    return true;
  }

  /// Two cones about one axis: the larger one, if one is larger at both ends.
  bool merge(BeamGraph::Strut& known, const BeamGraph::Strut& added) {
    int larger = 0;
    for (std::size_t end = 0; end < 2; ++end) {
      const double difference = added.radius[end] - known.radius[end];
      const double least = equal_radii * known.radius[end];
      if (difference != 0 && std::fabs(difference) <= least && std::fabs(difference) > 1e-12 * known.radius[end])
        snapped_.tell(std::fabs(difference));
      if (std::fabs(difference) > least) larger |= difference > 0 ? 1 : 2;
    }
    if (larger == 3) return refuse("two struts between the same nodes are thicker than each other at one end each");
    for (std::size_t end = 0; end < 2; ++end) known.radius[end] = std::max(known.radius[end], added.radius[end]);
    return true;
  }

  SnappedRadii& snapped_;
  std::string& why_;
  const SolidContext& context_;
  BeamGraph graph_;
  Points points_;
  FlatMap<std::uint32_t> struts_;
  std::vector<std::uint32_t> node_;  ///< of the cell's nodes
};

}  // namespace

std::optional<BeamGraph> beam_graph(const eval::CellStream& cells, SnappedRadii& snapped, std::string& why,
                                    const SolidContext& context) {
  const RunOptions& run = context.run;
  Collector collector(snapped, why, context);
  std::uint64_t kept = 0;
  bool is_graph = true;
  const eval::BeamsShape* of_part = context.parts != nullptr ? context.parts->beams_in(cells) : nullptr;
  const auto take = [&](const eval::PlacedCell& cell) {
    if (++kept % 256 == 0 && run.should_stop()) return is_graph = false;
    const auto shape = of_part == nullptr ? cells.shape(cell, context.sink) : std::nullopt;
    const auto* beams = shape ? std::get_if<eval::BeamsShape>(&shape->value) : of_part;
    const bool is_mapped = cell.mapping == CellMapping::conformal;
    const ElementId where = shape ? shape->source : cells.unit_cell().id_in_source;
    return is_graph = beams != nullptr && collector.add(*beams, is_mapped ? Affine{} : cell.world_from_cell, where);
  };
  if (!cells.visit(0, cells.size(), take, context.sink) || !is_graph || kept == 0) return {};
  auto graph = collector.finish();
  if (graph) graph->cells = kept;
  return graph;
}

std::optional<BeamGraph> beam_graph(const eval::BeamsShape& beams, ElementId where, SnappedRadii& snapped,
                                    std::string& why, const SolidContext& context) {
  Collector collector(snapped, why, context);
  if (!collector.add(beams, {}, where)) return {};
  auto graph = collector.finish();
  if (graph) graph->cells = 1;
  return graph;
}

}  // namespace meso::brep
