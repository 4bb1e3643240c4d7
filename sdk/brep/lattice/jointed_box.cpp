// SPDX-License-Identifier: Apache-2.0
#include "lattice/jointed_box.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace meso::brep {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double in_plane = 1e-9;  ///< radians between an axis and a side that it runs in

class BoxReader {
 public:
  BoxReader(const Box3& box, double tolerance, std::string& why) : why_(why) {
    out_.box = box;
    out_.tolerance = tolerance;
  }

  std::optional<JointedBox> read(const std::vector<CellPrimitive>& primitives) {
    if (!read_graph(primitives)) return {};
    SnappedRadii snapped;
    auto joints = joints_of(std::move(graph_), snapped, why_);
    if (!joints) return {};
    out_.joints = std::move(*joints);
    if (std::ranges::find(out_.joints.is_straight, true) != out_.joints.is_straight.end())
      return refuse("two struts in a row hide their ball"), std::nullopt;
    for (const BeamGraph::Node& node : out_.joints.graph.nodes) {
      bool is_near = true;
      for (Side side = 0; side < 6; ++side) is_near = is_near && out_.depth(node.position, side) > -node.radius;
      out_.has_ball.push_back(is_near);
    }
    const std::size_t struts = out_.joints.graph.struts.size();
    out_.places.assign(struts, JointedBox::Place::inside);
    out_.in_sides.resize(struts);
    for (std::uint32_t s = 0; s < struts; ++s)
      if (!place(s)) return {};
    return std::move(out_);
  }

 private:
  bool refuse(const char* why) {
    why_ = why;
    return false;
  }

  bool read_graph(const std::vector<CellPrimitive>& primitives) {
    for (const CellPrimitive& primitive : primitives)
      if (const Ball* ball = std::get_if<Ball>(&primitive)) {
        const std::uint32_t known = node_at(ball->centre);
        if (known == graph_.nodes.size()) graph_.nodes.push_back({ball->centre, 0});
        graph_.nodes[known].radius = std::max(graph_.nodes[known].radius, ball->radius);
      }
    for (const CellPrimitive& primitive : primitives)
      if (const Frustum* strut = std::get_if<Frustum>(&primitive); strut != nullptr && !add(*strut)) return false;
    return true;
  }
  [[nodiscard]] std::uint32_t node_at(Vec3 p) const {
    const auto found = std::ranges::find_if(
        graph_.nodes, [&](const BeamGraph::Node& node) { return norm(node.position - p) <= out_.tolerance; });
    return static_cast<std::uint32_t>(found - graph_.nodes.begin());
  }
  bool add(const Frustum& strut) {
    const std::uint32_t from = node_at(strut.start), to = node_at(strut.end);
    for (const auto& [node, radius] : {std::pair{from, strut.start_radius}, {to, strut.end_radius}})
      if (node == graph_.nodes.size() || graph_.nodes[node].radius < radius * (1 - equal_radii))
        return refuse("a strut ends in no ball");
    if (from == to) return refuse("a strut has no length");
    BeamGraph::Strut value{{from, to}, {strut.start_radius, strut.end_radius}};
    if (from > to) value = {{to, from}, {strut.end_radius, strut.start_radius}};
    for (BeamGraph::Strut& known : graph_.struts) {
      if (known.node != value.node) continue;
      const bool is_thicker = known.radius[0] >= value.radius[0] && known.radius[1] >= value.radius[1];
      const bool is_thinner = known.radius[0] <= value.radius[0] && known.radius[1] <= value.radius[1];
      if (!is_thicker && !is_thinner) return refuse("two struts with one axis cross");
      if (is_thinner) known = value;
      return true;
    }
    graph_.struts.push_back(value);
    return true;
  }

  enum class End : std::uint8_t { inside, touching, in_side, beyond, across };
  /// Where the strut's circle on its ball is, seen from one side.
  [[nodiscard]] End end(Leaving l, Side side) const {
    const BeamGraph::Node& node = out_.joints.graph.nodes[out_.joints.node(l)];
    const double depth = out_.depth(node.position, side), circle = out_.joints.end(l).angle;
    const double away = angle_between(out_.joints.direction(l), outward(side));
    if (depth == 0 && std::fabs(away - pi / 2) <= in_plane) return End::in_side;
    if (depth >= node.radius) return End::inside;
    if (depth <= -node.radius) return End::beyond;
    const double cut = std::acos(depth / node.radius);
    if (away - circle >= cut - touching_gap) return away - circle <= cut + touching_gap ? End::touching : End::inside;
    if (away + circle <= cut + touching_gap) return End::beyond;
    return End::across;
  }
  bool place(std::uint32_t s) {
    bool crosses = false;
    for (Side side = 0; side < 6; ++side) {
      const End first = end(2 * s, side), second = end(2 * s + 1, side);
      if (first == End::beyond && second == End::beyond) {
        out_.places[s] = JointedBox::Place::beyond;
        return true;
      }
      if (first == End::in_side && second == End::in_side) {
        out_.in_sides[s].push_back(side);
        out_.places[s] = JointedBox::Place::in_sides;
      } else {
        const auto is_inside = [](End e) { return e == End::inside || e == End::touching; };
        // A strut that touches a side all along it bounds no room there.
        crosses = crosses || !is_inside(first) || !is_inside(second) || (first == second && first == End::touching);
      }
    }
    return !crosses || refuse("a side of the box divides a strut");
  }

  std::string& why_;
  JointedBox out_;
  BeamGraph graph_;
};

}  // namespace

Vec3 outward(Side side) {
  Vec3 normal;
  normal[side / 2] = side % 2 == 0 ? -1 : 1;
  return normal;
}

double JointedBox::depth(Vec3 p, Side side) const {
  const double at = side % 2 == 0 ? p[side / 2] - box.min[side / 2] : box.max[side / 2] - p[side / 2];
  return std::fabs(at) <= tolerance ? 0 : at;
}

std::optional<JointedBox> jointed_box(const std::vector<CellPrimitive>& primitives, const Box3& box, double tolerance,
                                      std::string& why) {
  return BoxReader(box, tolerance, why).read(primitives);
}

}  // namespace meso::brep
