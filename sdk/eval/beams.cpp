// SPDX-License-Identifier: Apache-2.0
#include "beams.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "body_reader.hpp"

namespace meso::eval {
namespace {

class BeamsMaker {
 public:
  BeamsMaker(const EvaluationData& data, const BodyTable& table, const BeamsBody& beams, std::span<const double> slots,
             const Report& report, const NodeRules& rules)
      : data_(data), table_(table), beams_(beams), slots_(slots), report_(report), rules_(rules) {}

  std::optional<Shape> make() {
    if (!place_nodes() || !make_struts() || !make_balls()) return std::nullopt;
    return Shape{std::move(shape_), beams_.id_in_source};
  }

  bool append_pole_struts(PoleBalls& poles) {
    if (!place_nodes() || !make_struts()) return false;
    for (const Strut& s : shape_.struts) {
      const Vec3 from = shape_.nodes[s.from].position, to = shape_.nodes[s.to].position;
      if (is_on_pole(s.from)) poles.add(from, to, leaving_start(shape_, s));
      if (is_on_pole(s.to)) poles.add(to, from, leaving_end(shape_, s));
    }
    return true;
  }

 private:
  bool is_auto() const { return beams_.node_radius && beams_.node_radius->text == "auto"; }

  std::span<const double> slots_at(std::size_t node) const {
    return node_slots_.empty() ? slots_ : std::span<const double>(node_slots_[node]);
  }

  bool place_nodes() {
    for (const BeamNode& node : beams_.nodes) {
      BodyReader read(data_, table_, slots_, report_);
      Vec3 p{read.number(node.x), read.number(node.y), read.number(node.z)};
      if (!read.ok()) return false;
      unplaced_.push_back(p);
      if (rules_.position) p = rules_.position(p);
      if (rules_.slots && !rules_.slots(p, node_slots_.emplace_back())) return false;
      node_position_.emplace(node.name.text, shape_.nodes.size());
      shape_.nodes.push_back({data_.millimeters() * p, 0});
    }
    return true;
  }

  /// The radius of a beam's end, in the values that hold at its node.
  std::optional<double> end_radius(const Beam& beam, const std::optional<Expression>& own, std::size_t node) const {
    const auto& radius = own ? own : beam.radius ? beam.radius : beams_.radius;
    if (!radius) {
      report_(Code::beam_without_radius, {beam.id_in_source, {}}, {beams_.nodes[node].name.text});
      return std::nullopt;
    }
    BodyReader read(data_, table_, slots_at(node), report_);
    const double value = read.positive_length(*radius);
    return read.ok() ? std::optional(value) : std::nullopt;
  }

  bool make_struts() {
    for (const Beam& beam : beams_.beams) {
      const std::size_t from = node_position_.at(beam.from.text), to = node_position_.at(beam.to.text);
      if (norm(shape_.nodes[to].position - shape_.nodes[from].position) <= (rules_.position ? same_point : 0)) {
        report_(Code::body_degenerate, {beam.id_in_source, {}}, {"its two ends are one point"});
        return false;
      }
      const auto r1 = end_radius(beam, beam.radius1, from);
      const auto r2 = r1 ? end_radius(beam, beam.radius2, to) : std::nullopt;
      if (!r2) return false;
      const BeamCap cap = beams_.cap.value_or(BeamCap::sphere);
      shape_.struts.push_back({from, to, *r1, *r2, beam.cap1.value_or(cap), beam.cap2.value_or(cap)});
    }
    return true;
  }

  bool make_balls() {
    if (is_auto() && !make_automatic_balls()) return false;
    for (std::size_t n = 0; n < shape_.nodes.size(); ++n) {
      const auto& own = beams_.nodes[n].radius;
      if (!own && (is_auto() || !beams_.node_radius)) continue;
      BodyReader read(data_, table_, slots_at(n), report_);
      shape_.nodes[n].ball_radius = read.length_not_negative(own ? *own : *beams_.node_radius);
      if (!read.ok()) return false;
    }
    return true;
  }

  /// A strut at one of its nodes.
  struct End {
    Leaving strut;
    std::size_t from = 0, to = 0;  ///< nodes
  };

  /// Where a step along one of the system's axes leads nowhere.
  bool is_on_pole(std::size_t node) const {
    if (!rules_.position || !rules_.period) return false;
    for (std::size_t a = 0; a < 3; ++a) {
      Vec3 beside = unplaced_[node];
      beside[a] += rules_.period->size[a] / data_.millimeters() / 4;
      if (norm(data_.millimeters() * rules_.position(beside) - shape_.nodes[node].position) <= same_point) return true;
    }
    return false;
  }

  /// For each node the first that stands where it does: a mapping may put several on a pole or an axis.
  std::vector<std::size_t> first_nodes() const {
    std::vector<std::size_t> first(shape_.nodes.size());
    for (std::size_t n = 0; n < first.size(); ++n) {
      first[n] = n;
      for (std::size_t m = 0; rules_.position && m < n && first[n] == n; ++m)
        if (norm(shape_.nodes[m].position - shape_.nodes[n].position) <= same_point) first[n] = m;
    }
    return first;
  }

  //
  bool make_automatic_balls() {
    const std::vector<std::size_t> first = first_nodes();
    std::vector<std::vector<End>> ends(shape_.nodes.size());
    for (const Strut& s : shape_.struts) {
      ends[first[s.from]].push_back({leaving_start(shape_, s), s.from, s.to});
      ends[first[s.to]].push_back({leaving_end(shape_, s), s.to, s.from});
    }
    for (std::size_t n = 0; n < ends.size(); ++n) {
      if (ends[n].empty() || beams_.nodes[n].radius) continue;
      if (!(is_on_pole(n) ? make_pole_ball(n) : make_automatic_ball(n, first, ends[n]))) return false;
    }
    for (std::size_t n = 0; n < first.size(); ++n)
      if (!beams_.nodes[n].radius) shape_.nodes[n].ball_radius = shape_.nodes[first[n]].ball_radius;
    return true;
  }

  bool make_automatic_ball(std::size_t node, const std::vector<std::size_t>& first, const std::vector<End>& ends) {
    double& radius = shape_.nodes[node].ball_radius;
    std::vector<Vec3> beyond;
    for (std::size_t m = node; m < first.size(); ++m)
      if (first[m] == node) append_directions_beyond(m, beyond);
    for (std::size_t i = 0; i < ends.size(); ++i) {
      const auto& [strut, from, to] = ends[i];
      radius = std::max(radius, strut.radius);
      for (std::size_t j = 0; j < i; ++j) {
        const bool is_written_twice = from == ends[j].from && to == ends[j].to;
        if (first[to] == first[ends[j].to] && !is_written_twice) continue;  // the mapping makes them one
        if (!is_fine(node, part(strut, ends[j].strut, radius))) return false;
      }
      for (const Vec3& direction : beyond)
        // A strut in a wall is the neighbour's, too.
        if (norm(direction - strut.direction) / 2 >= smallest_sine && !is_fine(node, part(strut, direction, radius)))
          return false;
    }
    return true;
  }

  bool make_pole_ball(std::size_t node) {
    const PoleBalls* poles = rules_.poles();
    if (poles == nullptr) return false;
    const PoleBalls::Ball ball = poles->at(shape_.nodes[node].position);
    shape_.nodes[node].ball_radius = ball.radius;
    return is_fine(node, ball.parting);
  }

  bool is_fine(std::size_t node, Parting parting) const {
    if (parting == Parting::fine) return true;
    report_(Code::body_degenerate, {beams_.nodes[node].id_in_source, {}},
            {parting == Parting::same_direction
                 ? "two beams leave this node in the same direction, so nodeRadius=\"auto\" has no value"
                 : "two beams grow thicker away from this node faster than they part, so nodeRadius=\"auto\" has no "
                   "value"});
    return false;
  }

  /// Where the struts of neighbouring cells leave a node in a wall of the box, if those are like this one. Their radii
  /// do not matter: they make balls of their own.
  void append_directions_beyond(std::size_t node, std::vector<Vec3>& directions) const {
    if (!rules_.period) return;
    const Vec3 size = rules_.period->size / data_.millimeters();
    for (std::size_t other = 0; other < unplaced_.size(); ++other) {
      Vec3 shift;
      bool is_same = true, is_here = true;
      for (std::size_t a = 0; a < 3; ++a) {
        const double boxes = (unplaced_[node][a] - unplaced_[other][a]) / size[a], whole = std::nearbyint(boxes);
        is_same = is_same && std::fabs(boxes - whole) <= 1e-9 && std::fabs(whole) <= 1;
        is_here = is_here && whole == 0;
        shift[a] = whole * size[a];
      }
      if (!is_same || is_here) continue;
      for (const Strut& s : shape_.struts)
        for (const auto& [near, far] : {std::pair{s.from, s.to}, {s.to, s.from}}) {
          if (near != other) continue;
          Vec3 end = unplaced_[far] + shift;
          if (rules_.position) end = rules_.position(end);
          const Vec3 way = data_.millimeters() * end - shape_.nodes[node].position;
          if (norm(way) > same_point) directions.push_back(way / norm(way));
        }
    }
  }

  const EvaluationData& data_;
  const BodyTable& table_;
  const BeamsBody& beams_;
  std::span<const double> slots_;
  const Report& report_;
  const NodeRules& rules_;
  std::map<std::string, std::size_t> node_position_;
  std::vector<std::vector<double>> node_slots_;
  std::vector<Vec3> unplaced_;  ///< the nodes in cell coordinates, in the document's unit
  BeamsShape shape_;
};

}  // namespace

std::optional<Shape> make_beams(const EvaluationData& data, const BodyTable& table, const BeamsBody& beams,
                                std::span<const double> slots, const Report& report, const NodeRules& rules) {
  return BeamsMaker(data, table, beams, slots, report, rules).make();
}

bool append_pole_struts(const EvaluationData& data, const BodyTable& table, const BeamsBody& beams,
                        std::span<const double> slots, const Report& report, const NodeRules& rules, PoleBalls& poles) {
  return BeamsMaker(data, table, beams, slots, report, rules).append_pole_struts(poles);
}

}  // namespace meso::eval
