// SPDX-License-Identifier: Apache-2.0
#include "beam_graph_joints.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "box_pairs.hpp"
#include "meso/base/number.hpp"

namespace meso::brep {
namespace {

constexpr double least_gap = 1e-9;  // millimetres between surfaces that keep apart

/// To tenths of a micrometre: for people.
std::string rounded(double mm) { return format_number(std::nearbyint(mm * 1e4) / 1e4); }

std::string place(Vec3 p) { return "(" + rounded(p.x) + " " + rounded(p.y) + " " + rounded(p.z) + ")"; }

double length_of(const BeamGraph& graph, const BeamGraph::Strut& s) {
  return norm(graph.nodes[s.node[1]].position - graph.nodes[s.node[0]].position);
}

double distance_to_segment(Vec3 p, Vec3 a, Vec3 b) {
  const Vec3 way = b - a;
  const double t = std::clamp(dot(p - a, way) / dot(way, way), 0.0, 1.0);
  return norm(p - (a + t * way));
}

double distance_of_segments(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  const Vec3 u = b - a, v = d - c, w = a - c;
  const double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), uw = dot(u, w), vw = dot(v, w);
  const double det = uu * vv - uv * uv;
  if (det > 1e-12 * uu * vv) {
    const double s = (uv * vw - vv * uw) / det, t = (uu * vw - uv * uw) / det;
    if (s > 0 && s < 1 && t > 0 && t < 1) return norm((a + s * u) - (c + t * v));
  }
  return std::min({distance_to_segment(a, c, d), distance_to_segment(b, c, d), distance_to_segment(c, a, b),
                   distance_to_segment(d, a, b)});
}

class JointFinder {
 public:
  JointFinder(BeamGraph graph, SnappedRadii& snapped, std::string& why, Meeting meeting)
      : snapped_(snapped), why_(why), meeting_(meeting) {
    joints_.graph = std::move(graph);
  }

  std::optional<Joints> find() {
    if (meeting_ == Meeting::in_balls) join_balls_that_meet();
    const BeamGraph& graph = joints_.graph;
    joints_.ends.resize(graph.struts.size());
    joints_.is_swallowed.assign(graph.struts.size(), false);
    joints_.leaving.resize(graph.nodes.size());
    joints_.is_straight.assign(graph.nodes.size(), false);
    for (std::uint32_t s = 0; s < graph.struts.size(); ++s)
      for (const std::uint32_t end : {0u, 1u}) {
        joints_.leaving[graph.struts[s].node[end]].push_back(2 * s + end);
        double& ball = joints_.graph.nodes[graph.struts[s].node[end]].radius;
        if (ball >= graph.struts[s].radius[end]) continue;  // smaller ones are nearly as large, see beam_graph()
        snapped_.tell(graph.struts[s].radius[end] - ball);
        ball = graph.struts[s].radius[end];
      }
    if (meeting_ == Meeting::beyond_balls) return keep_apart() ? std::optional(std::move(joints_)) : std::nullopt;
    bool changed = false;
    if (!measure_ends() || !settle_balls(changed)) return {};
    if (changed && (!measure_ends() || !settle_balls(changed))) return {};
    if (!note_touching() || !keep_apart()) return {};
    return std::move(joints_);
  }

 private:
  bool refuse(std::string why) {
    why_ = std::move(why);
    return false;
  }
  [[nodiscard]] Vec3 at(std::uint32_t node) const { return joints_.graph.nodes[node].position; }

  /// The end of a strut at a ball of that radius.
  [[nodiscard]] StrutEnd end_at(Leaving l, double ball) const {
    const BeamGraph::Strut& s = joints_.graph.struts[l / 2];
    const double growth = (s.radius[1] - s.radius[0]) / length_of(joints_.graph, s);
    return leave_ball(ball, s.radius[l % 2], l % 2 == 0 ? growth : -growth);
  }

  /// Two balls meet in a circle, as those of a strut do that they swallow: between others a strut is put that they
  /// swallow, too.
  void join_balls_that_meet() {
    BeamGraph& graph = joints_.graph;
    std::set<std::array<std::uint32_t, 2>> have_strut;
    for (const BeamGraph::Strut& s : graph.struts) have_strut.insert(s.node);
    std::vector<Box3> boxes(graph.nodes.size());
    for (std::uint32_t n = 0; n < graph.nodes.size(); ++n)
      if (graph.nodes[n].radius > 0) grow(boxes[n], at(n), graph.nodes[n].radius);
    std::set<std::array<std::uint32_t, 2>> meeting;
    visit_meeting_pairs(boxes, [&](std::size_t i, std::size_t k) {
      const auto a = static_cast<std::uint32_t>(std::min(i, k)), b = static_cast<std::uint32_t>(std::max(i, k));
      const double both = graph.nodes[a].radius + graph.nodes[b].radius;
      if (norm(at(a) - at(b)) < both - 1e-6 && !have_strut.contains({a, b})) meeting.insert({a, b});
    });
    for (const auto& nodes : meeting) {
      const double thin = std::min(graph.nodes[nodes[0]].radius, graph.nodes[nodes[1]].radius) / 1000;
      graph.struts.push_back({nodes, {thin, thin}});
    }
  }

  bool measure_ends() {
    const BeamGraph& graph = joints_.graph;
    for (std::uint32_t s = 0; s < graph.struts.size(); ++s) {
      const BeamGraph::Strut& strut = graph.struts[s];
      const double length = length_of(graph, strut);
      const double first = graph.nodes[strut.node[0]].radius, second = graph.nodes[strut.node[1]].radius;
      auto& ends = joints_.ends[s];
      ends = {end_at(2 * s, first), end_at(2 * s + 1, second)};
      joints_.is_swallowed[s] = ends[0].along + ends[1].along >= length - 1e-7;
      if (!joints_.is_swallowed[s]) continue;
      if (length <= std::fabs(first - second) + least_gap)
        return refuse("the ball at " + place(at(strut.node[first < second ? 0 : 1])) + " lies in a ball beside it");
      const double along = (length * length + first * first - second * second) / (2 * length);
      const double radius = std::sqrt(std::max(0.0, first * first - along * along));
      if (radius < 1e-6) return refuse("two balls touch at " + place(at(strut.node[0])));
      ends = {StrutEnd{along, radius, std::atan2(radius, along)},
              StrutEnd{length - along, radius, std::atan2(radius, length - along)}};
    }
    return true;
  }

  /// The least angle between two circles of a node with a ball of that radius; of swallowed struts as they are.
  [[nodiscard]] double gap_at(std::uint32_t node, double ball) const {
    const auto& leaving = joints_.leaving[node];
    double least = std::numbers::pi;
    for (std::size_t i = 0; i < leaving.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        const auto angle = [&](Leaving l) {
          return joints_.is_swallowed[l / 2] ? joints_.end(l).angle : end_at(l, ball).angle;
        };
        const double between = angle_between(joints_.direction(leaving[i]), joints_.direction(leaving[j]));
        least = std::min(least, between - angle(leaving[i]) - angle(leaving[j]));
      }
    return least;
  }

  /// What radius would part the struts of a node, if any does: two digits, rounded up.
  [[nodiscard]] std::string larger_ball(std::uint32_t node) const {
    const double ball = joints_.graph.nodes[node].radius;
    // Where balls meet, too, a larger one meets more.
    if (std::ranges::any_of(joints_.leaving[node], [&](Leaving l) { return joints_.is_swallowed[l / 2]; })) return {};
    for (double factor = 1.05; factor < 100; factor *= 1.05) {
      if (gap_at(node, factor * ball) < 0) continue;
      const double digits = std::pow(10, 1 - std::floor(std::log10(factor * ball)));
      return ", one of " + format_number(std::ceil(factor * ball * digits) / digits) + " mm would hold them";
    }
    return {};
  }

  bool settle_balls(bool& changed) {
    for (std::uint32_t n = 0; n < joints_.graph.nodes.size(); ++n) {
      double& ball = joints_.graph.nodes[n].radius;
      if (gap_at(n, ball) >= -touching_gap) continue;
      double low = ball, high = ball * (1 + equal_radii);
      if (changed || gap_at(n, high) < 0)
        return refuse("struts at the node " + place(at(n)) + " meet beyond its ball of radius " + rounded(ball) +
                      " mm" + larger_ball(n));
      for (int i = 0; i < 60; ++i) {
        const double middle = (low + high) / 2;
        (gap_at(n, middle) < 0 ? low : high) = middle;
      }
      snapped_.tell(high - ball);
      ball = high;
      resized_ = true;
    }
    changed = resized_;
    return true;
  }

  bool note_touching() {
    for (std::uint32_t n = 0; n < joints_.leaving.size(); ++n) {
      const auto& leaving = joints_.leaving[n];
      for (std::size_t j = 0; j < leaving.size(); ++j)
        for (std::size_t i = 0; i < j; ++i) {
          const Leaving a = leaving[i], b = leaving[j];
          const double between = angle_between(joints_.direction(a), joints_.direction(b));
          const double gap = between - joints_.end(a).angle - joints_.end(b).angle;
          if (gap > touching_gap) continue;
          const bool is_contact = joints_.is_swallowed[a / 2] || joints_.is_swallowed[b / 2];
          if (is_contact) return refuse("three balls meet near " + place(at(n)));
          if (between > std::numbers::pi - 10 * touching_gap)
            joints_.is_straight[n] = true;  // there is no third one
          else
            joints_.touching.push_back({std::min(a, b), std::max(a, b)});
        }
    }
    return true;
  }

  /// Balls and struts that have no node in common, and struts of one node farther out.
  bool keep_apart() {
    const BeamGraph& graph = joints_.graph;
    const auto strut_count = static_cast<std::uint32_t>(graph.struts.size());
    std::vector<Box3> boxes(graph.struts.size() + graph.nodes.size());
    for (std::uint32_t s = 0; s < strut_count; ++s)
      if (!joints_.is_swallowed[s])
        for (const std::uint32_t node : graph.struts[s].node) grow(boxes[s], at(node), thickness(s));
    for (std::uint32_t n = 0; n < graph.nodes.size(); ++n)
      if (graph.nodes[n].radius > 0) grow(boxes[strut_count + n], at(n), graph.nodes[n].radius);
    bool fine = true;
    visit_meeting_pairs(boxes, [&](std::size_t i, std::size_t k) {
      if (!fine) return;
      const auto a = static_cast<std::uint32_t>(i), b = static_cast<std::uint32_t>(k);
      if (b < strut_count)
        fine = struts_keep_apart(a, b);
      else if (a < strut_count)
        fine = strut_keeps_from_ball(a, b - strut_count);
      else
        fine = balls_keep_apart(a - strut_count, b - strut_count);
    });
    return fine;
  }
  static void grow(Box3& box, Vec3 p, double by) {
    box.extend(p - Vec3{by, by, by});
    box.extend(p + Vec3{by, by, by});
  }
  [[nodiscard]] double thickness(std::uint32_t strut) const {
    return std::max(joints_.graph.struts[strut].radius[0], joints_.graph.struts[strut].radius[1]);
  }

  bool struts_keep_apart(std::uint32_t a, std::uint32_t b) {
    const auto& p = joints_.graph.struts[a].node;
    const auto& q = joints_.graph.struts[b].node;
    for (const std::uint32_t i : {0u, 1u})
      for (const std::uint32_t k : {0u, 1u})
        if (p[i] == q[k]) return meeting_ == Meeting::beyond_balls || stay_in_cones(2 * a + i, 2 * b + k);
    const double distance = distance_of_segments(at(p[0]), at(p[1]), at(q[0]), at(q[1]));
    if (distance > thickness(a) + thickness(b) + least_gap) return true;
    return refuse("two struts that share no node meet near " + place(0.5 * (at(p[0]) + at(p[1]))));
  }

  /// Seen from their common node, each keeps to its side of a cone between them.
  bool stay_in_cones(Leaving a, Leaving b) {
    const double gap =
        angle_between(joints_.direction(a), joints_.direction(b)) - joints_.end(a).angle - joints_.end(b).angle;
    for (const Leaving l : {a, b}) {
      const StrutEnd& far = joints_.end(l ^ 1u);
      const double along = length_of(joints_.graph, joints_.graph.struts[l / 2]) - far.along;
      if (std::atan2(far.radius, along) <= joints_.end(l).angle + std::max(0.0, gap) / 2 + touching_gap) continue;
      return refuse("two struts that grow thicker away from the node " + place(at(joints_.node(l))) + " meet");
    }
    return true;
  }

  bool strut_keeps_from_ball(std::uint32_t strut, std::uint32_t node) {
    const auto& ends = joints_.graph.struts[strut].node;
    if (ends[0] == node || ends[1] == node) return true;
    const double distance = distance_to_segment(at(node), at(ends[0]), at(ends[1]));
    if (distance > joints_.graph.nodes[node].radius + thickness(strut) + least_gap) return true;
    return refuse("a strut meets the ball at " + place(at(node)) + ", which is not at its ends");
  }

  bool balls_keep_apart(std::uint32_t a, std::uint32_t b) {
    const double both = joints_.graph.nodes[a].radius + joints_.graph.nodes[b].radius;
    if (norm(at(a) - at(b)) > both + least_gap) return true;
    for (const Leaving l : joints_.leaving[a])
      if (joints_.is_swallowed[l / 2] && joints_.node(l ^ 1u) == b) return true;
    return refuse("the balls at " + place(at(a)) + " and " + place(at(b)) + " meet");
  }

  SnappedRadii& snapped_;
  std::string& why_;
  Meeting meeting_;
  Joints joints_;
  bool resized_ = false;
};

}  // namespace

// (r + k s)^2 + s^2 = R^2, the larger s.
StrutEnd leave_ball(double ball, double radius, double growth) {
  const double a = 1 + growth * growth, b = radius * growth, c = radius * radius - ball * ball;
  const double root = std::sqrt(std::max(0.0, b * b - a * c));
  const double along = b > 0 ? -c / (b + root) : (root - b) / a;
  const double at = radius + growth * along;
  return {along, at, std::atan2(at, along)};
}

Vec3 Joints::direction(Leaving l) const {
  const auto& node = graph.struts[l / 2].node;
  const Vec3 way = graph.nodes[node[1 - l % 2]].position - graph.nodes[node[l % 2]].position;
  return way / norm(way);
}

std::optional<Joints> joints_of(BeamGraph graph, SnappedRadii& snapped, std::string& why, Meeting meeting) {
  return JointFinder(std::move(graph), snapped, why, meeting).find();
}

}  // namespace meso::brep
