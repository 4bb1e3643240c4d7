// SPDX-License-Identifier: Apache-2.0
#include "beams.hpp"

#include <algorithm>
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
      if (norm(shape_.nodes[to].position - shape_.nodes[from].position) == 0) {
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

  struct Leaving {
    Vec3 direction;
    double radius;
  };

  // two cylinders of radius r whose axes meet at the angle theta have left each other at r / sin(theta / 2).
  bool make_automatic_balls() {
    std::vector<std::vector<Leaving>> leaving(shape_.nodes.size());
    for (const Strut& s : shape_.struts) {
      const Vec3 way = shape_.nodes[s.to].position - shape_.nodes[s.from].position;
      const Vec3 direction = way / norm(way);
      leaving[s.from].push_back({direction, s.radius_from});
      leaving[s.to].push_back({-direction, s.radius_to});
    }
    for (std::size_t n = 0; n < leaving.size(); ++n) {
      double radius = 0;
      for (std::size_t i = 0; i < leaving[n].size(); ++i) {
        radius = std::max(radius, leaving[n][i].radius);
        for (std::size_t j = 0; j < i; ++j) {
          // |a - b| = 2 sin(theta / 2) for unit vectors, exact also for small angles.
          const double sine = norm(leaving[n][i].direction - leaving[n][j].direction) / 2;
          if (sine < smallest_sine && !beams_.nodes[n].radius) {
            report_(Code::body_degenerate, {beams_.nodes[n].id_in_source, {}},
                    {"two beams leave this node in the same direction, so nodeRadius=\"auto\" has no value"});
            return false;
          }
          radius = std::max(radius, std::max(leaving[n][i].radius, leaving[n][j].radius) / sine);
        }
      }
      shape_.nodes[n].ball_radius = radius;
    }
    return true;
  }

  static constexpr double smallest_sine = 1e-6;

  const EvaluationData& data_;
  const BodyTable& table_;
  const BeamsBody& beams_;
  std::span<const double> slots_;
  const Report& report_;
  const NodeRules& rules_;
  std::map<std::string, std::size_t> node_position_;
  std::vector<std::vector<double>> node_slots_;
  BeamsShape shape_;
};

}  // namespace

std::optional<Shape> make_beams(const EvaluationData& data, const BodyTable& table, const BeamsBody& beams,
                                std::span<const double> slots, const Report& report, const NodeRules& rules) {
  return BeamsMaker(data, table, beams, slots, report, rules).make();
}

}  // namespace meso::eval
