// SPDX-License-Identifier: Apache-2.0
// Two walks down a field's tree, moves gathered on the way: to a Term, and to bounds. Neither recurses.

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <cstring>
#include <numbers>
#include <unordered_map>
#include <vector>

#include "node.hpp"

namespace meso::implicit {

namespace {

using Node = Field::Node;

bool is_leaf(const Node& node) { return node.a == nullptr; }

/// A node seen through the moves above it.
struct Place {
  const Node* node;
  Affine local_from_world;
  friend bool operator==(const Place&, const Place&) = default;
};

struct PlaceHash {
  std::size_t operator()(const Place& place) const {
    std::uint64_t h = reinterpret_cast<std::uintptr_t>(place.node);
    const auto mix = [&h](double v) {
      std::uint64_t bits = 0;
      v += 0.0;  // equal zeros have equal hashes
      std::memcpy(&bits, &v, sizeof bits);
      h = (h ^ bits) * 0x9E3779B97F4A7C15U;
      h ^= h >> 32;
    };
    for (const double v : place.local_from_world.linear.m) mix(v);
    for (std::size_t i = 0; i < 3; ++i) mix(place.local_from_world.translation[i]);
    return h;
  }
};

Term combined(const Node& node, const Term& a, const Term* b) {
  if (const auto* move = std::get_if<Move>(&node.kind)) return move->value_factor == 1 ? a : move->value_factor * a;
  if (const auto* offset = std::get_if<Offset>(&node.kind)) return offset->distance == 0 ? a : a - offset->distance;
  if (const auto* shell = std::get_if<Shell>(&node.kind)) return abs(a) - shell->half_thickness;
  if (std::holds_alternative<Complement>(node.kind)) return -a;
  if (std::holds_alternative<Union>(node.kind)) return min(a, *b);
  if (const auto* fillet = std::get_if<FilletedUnion>(&node.kind)) {
    const Term r = Term::constant(fillet->radius), zero = Term::constant(0);
    const Term u = max(r - a, zero), v = max(r - *b, zero);
    return max(r, min(a, *b)) - sqrt(u * u + v * v);
  }
  assert(std::holds_alternative<Intersection>(node.kind));
  return max(a, *b);
}

Box3 hull(const Box3& a, const Box3& b) {
  Box3 r = a;
  if (!b.empty()) {
    r.extend(b.min);
    r.extend(b.max);
  }
  return r;
}

Box3 common(const Box3& a, const Box3& b) {
  Box3 r;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    r.min[axis] = std::max(a.min[axis], b.min[axis]);
    r.max[axis] = std::min(a.max[axis], b.max[axis]);
    if (!(r.min[axis] <= r.max[axis])) return {};
  }
  return r;
}

/// The set {sign * f <= level} of a node seen through moves.
struct Question {
  Place place;
  double sign, level;
  friend bool operator==(const Question&, const Question&) = default;
};

struct QuestionHash {
  std::size_t operator()(const Question& q) const {
    return PlaceHash{}({q.place.node, q.place.local_from_world * Affine::from_translation({q.sign, q.level, 0})});
  }
};

struct Step {
  enum class Kind : std::uint8_t { ask, join, meet } kind;
  Question question;
  Affine world_from_local;
};

/// What a question about a node asks about its children: one or two questions, and how their boxes combine.
void ask_children(const Step& step, std::vector<Step>& open) {
  const auto& [place, sign, level] = step.question;
  const Node& node = *place.node;
  const auto ask = [&](const std::shared_ptr<const Node>& child, double child_sign, double child_level) {
    open.push_back(
        {Step::Kind::ask, {{child.get(), place.local_from_world}, child_sign, child_level}, step.world_from_local});
  };
  const auto combine = [&](Step::Kind kind) { open.push_back({kind, step.question, {}}); };
  if (const auto* move = std::get_if<Move>(&node.kind)) {
    open.push_back({Step::Kind::ask,
                    {{node.a.get(), move->inverse * place.local_from_world}, sign, level / move->value_factor},
                    step.world_from_local * move->map});
  } else if (const auto* offset = std::get_if<Offset>(&node.kind)) {
    ask(node.a, sign, level + sign * offset->distance);
  } else if (std::holds_alternative<Complement>(node.kind)) {
    ask(node.a, -sign, level);
  } else if (const auto* shell = std::get_if<Shell>(&node.kind)) {
    // |f| <= m: f <= m and -f <= m. |f| >= m: f <= -m or -f <= -m.
    const double m = shell->half_thickness + sign * level;
    combine(sign > 0 ? Step::Kind::meet : Step::Kind::join);
    ask(node.a, 1, sign * m);
    ask(node.a, -1, sign * m);
  } else if (const auto* fillet = std::get_if<FilletedUnion>(&node.kind)) {
    // r - f is at most sqrt(2) times r less the smaller of the two, and f at most that.
    const double r = fillet->radius;
    const double of_either = sign > 0 && level < r ? r - (r - level) * std::numbers::sqrt2 / 2 : level;
    combine(sign > 0 ? Step::Kind::join : Step::Kind::meet);
    ask(node.a, sign, of_either);
    ask(node.b, sign, of_either);
  } else {
    const bool narrow = std::holds_alternative<Intersection>(node.kind) == (sign > 0);
    combine(narrow ? Step::Kind::meet : Step::Kind::join);
    ask(node.a, sign, level);
    ask(node.b, sign, level);
  }
}

}  // namespace

Term lowered(const Node& root) {
  struct Visit {
    Place place;
    bool combine;
  };
  std::unordered_map<Place, Term, PlaceHash> done;
  std::vector<Visit> open{{{&root, {}}, false}};
  std::vector<Term> results;
  while (!open.empty()) {
    const Visit visit = open.back();
    open.pop_back();
    const Node& node = *visit.place.node;
    if (visit.combine) {
      Term b;
      if (node.b) {
        b = results.back();
        results.pop_back();
      }
      results.back() = combined(node, results.back(), &b);
      done.emplace(visit.place, results.back());
    } else if (const auto found = done.find(visit.place); found != done.end()) {
      results.push_back(found->second);
    } else if (is_leaf(node)) {
      results.push_back(lowered_leaf(node, visit.place.local_from_world));
      done.emplace(visit.place, results.back());
    } else {
      Affine local_from_world = visit.place.local_from_world;
      if (const auto* move = std::get_if<Move>(&node.kind)) local_from_world = move->inverse * local_from_world;
      open.push_back({visit.place, true});
      if (node.b) open.push_back({{node.b.get(), local_from_world}, false});
      open.push_back({{node.a.get(), local_from_world}, false});
    }
  }
  return results.back();
}

Box3 bounds_of(const Node& root, double sign, double level) {
  std::unordered_map<Question, Box3, QuestionHash> done;
  std::vector<Step> open{{Step::Kind::ask, {{&root, {}}, sign, level}, {}}};
  std::vector<Box3> results;
  while (!open.empty()) {
    const Step step = open.back();
    open.pop_back();
    const auto& [place, its_sign, its_level] = step.question;
    if (step.kind != Step::Kind::ask) {
      const Box3 b = results.back();
      results.pop_back();
      results.back() = step.kind == Step::Kind::join ? hull(results.back(), b) : common(results.back(), b);
      done.emplace(step.question, results.back());
    } else if (const auto found = done.find(step.question); found != done.end()) {
      results.push_back(found->second);
    } else if (is_leaf(*place.node)) {
      results.push_back(leaf_bounds(*place.node, its_sign, its_level, step.world_from_local, place.local_from_world));
    } else {
      ask_children(step, open);
    }
  }
  return results.back();
}

}  // namespace meso::implicit
