// SPDX-License-Identifier: Apache-2.0
#include "untangle_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <span>

#include "meso/mesh/closest_point.hpp"
#include "meso/mesh/self_contact.hpp"

namespace meso::implicit {
namespace {

using Corners = std::array<std::uint32_t, 3>;
/// What the distance of a point takes, and how much is worth it: a tenth of what the mesh takes.
constexpr double point_work = 1000, least_work = 1e7, work_per_triangle = 1000;
constexpr std::uint32_t gone = std::numeric_limits<std::uint32_t>::max();

bool has(const Corners& t, std::uint32_t point) { return t[0] == point || t[1] == point || t[2] == point; }

Vec3 as_floats(Vec3 p) {
  for (std::size_t axis = 0; axis < 3; ++axis) p[axis] = static_cast<double>(static_cast<float>(p[axis]));
  return p;
}

Vec3 normal_of(const Triangle& t) { return cross(t[1] - t[0], t[2] - t[0]); }

/// Its height over its longest side.
double width_of(const Triangle& t) {
  const double longest = std::max({norm(t[1] - t[0]), norm(t[2] - t[1]), norm(t[0] - t[2])});
  return longest > 0 ? norm(normal_of(t)) / (longest * longest) : 0;
}

Box3 box_of(const Triangle& t) {
  Box3 box;
  for (const Vec3& p : t) box.extend(p);
  return box;
}

Box3 grown(Box3 box, double by) {
  for (std::size_t axis = 0; axis < 3; ++axis) box.min[axis] -= by, box.max[axis] += by;
  return box;
}

/// One way to change a few triangles: those that go, those that come, and a point that moves.
struct Change {
  std::vector<std::uint32_t> old;
  std::vector<Corners> now{};
  std::uint32_t moved = gone, removed = gone;
  Vec3 place{};
  int gain = 0;
  double way = 0;
};

enum class Search { likely, wide };

class Untangling {
 public:
  Untangling(TriangleMesh& mesh, const Box3& box, SurfaceFeet& feet, double tolerance, std::span<const char> kept)
      : mesh_(mesh), box_(box), feet_(feet), tolerance_(tolerance), kept_(kept) {
    out_.changed.assign(mesh.points.size(), 0);
    out_.stuck.assign(mesh.points.size(), 0);
    work_left_ = least_work + work_per_triangle * static_cast<double>(mesh.triangles.size());
  }

  Untangled run(const RunOptions& run);

 private:
  void sort_by_place();
  [[nodiscard]] std::vector<std::uint32_t> near(const Box3& box) const;
  void look_around(std::uint32_t a, std::uint32_t b);
  void mend(std::uint32_t a, std::uint32_t b);
  bool change_one(std::span<const std::array<std::uint32_t, 2>> pairs, Search search);
  [[nodiscard]] std::vector<std::array<std::uint32_t, 2>> meeting() const;

  [[nodiscard]] Triangle corners(std::uint32_t t) const {
    const Corners& c = mesh_.triangles[t];
    return {as_floats(mesh_.points[c[0]]), as_floats(mesh_.points[c[1]]), as_floats(mesh_.points[c[2]])};
  }
  [[nodiscard]] Vec3 place_of(std::uint32_t point, const Change& change) const {
    return point == change.moved ? change.place : mesh_.points[point];
  }
  [[nodiscard]] Triangle corners(const Corners& c, const Change& change) const {
    return {as_floats(place_of(c[0], change)), as_floats(place_of(c[1], change)), as_floats(place_of(c[2], change))};
  }
  [[nodiscard]] const std::vector<std::uint32_t>* fan(std::uint32_t point) const {
    const auto found = fans_.find(point);
    return found == fans_.end() ? nullptr : &found->second;
  }

  void add_moves(std::uint32_t point, std::span<const Vec3> places, std::vector<Change>& out) const;
  void add_collapse(std::uint32_t from, std::uint32_t onto, std::vector<Change>& out) const;
  void add_turn(std::uint32_t triangle, std::size_t side, std::vector<Change>& out) const;
  void add_merge(std::uint32_t from, std::uint32_t onto, std::uint32_t between, std::vector<Change>& out) const;
  [[nodiscard]] std::set<std::uint32_t> neighbours(std::uint32_t point) const;
  [[nodiscard]] std::vector<Change> changes(std::span<const std::array<std::uint32_t, 2>> pairs, Search search) const;
  [[nodiscard]] bool keeps_width(const Change& change) const;
  [[nodiscard]] int gain_of(const Change& change);
  [[nodiscard]] double farthest(std::span<const Triangle> triangles, std::span<const unsigned> planes, int parts);
  [[nodiscard]] bool stays_near(const Change& change);
  void carry_out(const Change& change);

  TriangleMesh& mesh_;
  Box3 box_;
  SurfaceFeet& feet_;
  double tolerance_;
  std::span<const char> kept_;
  std::vector<std::uint32_t> by_x_;  // triangles, by the lower ends of their boxes
  std::vector<double> lower_x_;      // these
  double widest_ = 0;
  Untangled out_;
  double work_left_ = 0;  // in triangles that are looked at
  std::set<std::uint32_t> given_up_;
  std::set<std::uint32_t> changed_;  // triangles, since they were sorted

  // Around the pair at hand.
  Box3 region_;
  struct Near {
    std::uint32_t number;
    Triangle corners;
    Box3 box;
  };
  std::vector<Near> near_;  // all triangles that those of the region's points may meet
  std::map<std::uint32_t, std::vector<std::uint32_t>> fans_;  // of the region's points
  std::vector<Vec3> were_;                                    // places of points that have moved
};

void Untangling::sort_by_place() {
  by_x_.resize(mesh_.triangles.size());
  std::iota(by_x_.begin(), by_x_.end(), 0U);
  std::vector<double> x(by_x_.size());
  widest_ = 0;
  changed_.clear();
  for (std::uint32_t t = 0; t < x.size(); ++t) {
    const auto& [a, b, c] = mesh_.triangles[t];
    const auto [low, high] = std::minmax({mesh_.points[a].x, mesh_.points[b].x, mesh_.points[c].x});
    x[t] = low;
    widest_ = std::max(widest_, high - low);
  }
  std::sort(by_x_.begin(), by_x_.end(),
            [&](std::uint32_t a, std::uint32_t b) { return std::pair(x[a], a) < std::pair(x[b], b); });
  lower_x_.clear();
  for (const std::uint32_t t : by_x_) lower_x_.push_back(x[t]);
}

// Those that were changed stand elsewhere in the order.
std::vector<std::uint32_t> Untangling::near(const Box3& box) const {
  std::vector<std::uint32_t> found;
  const auto add = [&](std::uint32_t t) {
    if (mesh_.triangles[t][0] != gone && box_of(corners(t)).intersects(box)) found.push_back(t);
  };
  const auto first = std::lower_bound(lower_x_.begin(), lower_x_.end(), box.min.x - widest_);
  for (auto i = static_cast<std::size_t>(first - lower_x_.begin()); i < by_x_.size() && lower_x_[i] <= box.max.x; ++i)
    if (!changed_.contains(by_x_[i])) add(by_x_[i]);
  std::ranges::for_each(changed_, add);
  return found;
}

void Untangling::look_around(std::uint32_t a, std::uint32_t b) {
  region_ = box_of(corners(a));
  for (const Vec3& p : corners(b)) region_.extend(p);
  region_ = grown(region_, tolerance_);
  Box3 reached;
  fans_.clear();
  for (const std::uint32_t t : near(region_)) {
    for (const Vec3& p : corners(t)) reached.extend(p);
    for (const std::uint32_t p : mesh_.triangles[t])
      if (kept_[p] == 0 && region_.intersects({mesh_.points[p], mesh_.points[p]})) fans_[p].push_back(t);
  }
  near_.clear();
  for (const std::uint32_t t : near(grown(reached, tolerance_))) near_.push_back({t, corners(t), box_of(corners(t))});
  were_.clear();
}

/// Pairs of triangles that meet; a pair of one triangle has no area.
std::vector<std::array<std::uint32_t, 2>> Untangling::meeting() const {
  std::set<std::uint32_t> of_region;
  for (const auto& [point, fan] : fans_) of_region.insert(fan.begin(), fan.end());
  std::vector<std::array<std::uint32_t, 2>> pairs;
  for (const std::uint32_t t : of_region) {
    const Triangle one = corners(t);
    const Box3 box = box_of(one);
    if (!(norm(normal_of(one)) > 0)) pairs.push_back({t, t});
    for (const auto& [u, other, box_of_other] : near_) {
      if (u == t || !box.intersects(box_of_other) || (u < t && of_region.contains(u))) continue;
      if (std::ranges::any_of(mesh_.triangles[t], [&](std::uint32_t p) { return has(mesh_.triangles[u], p); }))
        continue;
      if (triangles_meet(one, other)) pairs.push_back({t, u});
    }
  }
  return pairs;
}

void Untangling::add_moves(std::uint32_t point, std::span<const Vec3> places, std::vector<Change>& out) const {
  const auto* around = fan(point);
  if (around == nullptr) return;
  const unsigned planes = planes_of(box_, mesh_.points[point]);
  for (const Vec3& place : places) {
    Change change{.old = *around, .moved = point};
    const Vec3 way = within(planes, place - mesh_.points[point]);
    if (!(norm(way) > 0)) continue;
    change.place = mesh_.points[point] + way;
    for (const std::uint32_t t : *around) change.now.push_back(mesh_.triangles[t]);
    change.way = norm(way);
    out.push_back(std::move(change));
  }
}

std::set<std::uint32_t> Untangling::neighbours(std::uint32_t point) const {
  std::set<std::uint32_t> points;
  for (const std::uint32_t t : *fan(point))
    for (const std::uint32_t p : mesh_.triangles[t])
      if (p != point) points.insert(p);
  return points;
}

void Untangling::add_collapse(std::uint32_t from, std::uint32_t onto, std::vector<Change>& out) const {
  const auto *goes = fan(from), *stays = fan(onto);
  if (goes == nullptr || stays == nullptr) return;
  if ((planes_of(box_, mesh_.points[from]) & ~planes_of(box_, mesh_.points[onto])) != 0) return;
  const auto of_from = neighbours(from), of_onto = neighbours(onto);
  const auto common = std::ranges::count_if(of_from, [&](std::uint32_t p) { return of_onto.contains(p); });
  if (common != 2 || of_from.size() + of_onto.size() < 9) return;  // the link condition
  Change change{.old = *goes, .removed = from};
  for (const std::uint32_t t : *goes) {
    Corners c = mesh_.triangles[t];
    if (has(c, onto)) continue;
    std::replace(c.begin(), c.end(), from, onto);
    change.now.push_back(c);
  }
  if (change.now.size() + 2 != change.old.size()) return;
  change.way = norm(mesh_.points[from] - mesh_.points[onto]);
  out.push_back(std::move(change));
}

/// Of two points across an edge, no neighbours: turned, it would join them, and is collapsed. `between` is the triangle
/// of the edge that `onto` has.
void Untangling::add_merge(std::uint32_t from, std::uint32_t onto, std::uint32_t between,
                           std::vector<Change>& out) const {
  if ((planes_of(box_, mesh_.points[from]) & ~planes_of(box_, mesh_.points[onto])) != 0) return;
  const auto of_from = neighbours(from), of_onto = neighbours(onto);
  const auto common = std::ranges::count_if(of_from, [&](std::uint32_t p) { return of_onto.contains(p); });
  if (common != 2) return;
  Change change{.old = *fan(from), .removed = from};
  for (const std::uint32_t t : *fan(from)) {
    Corners c = mesh_.triangles[t];
    const bool is_at_edge =
        std::ranges::count_if(c, [&](std::uint32_t p) { return has(mesh_.triangles[between], p); }) == 2;
    if (is_at_edge) continue;
    std::replace(c.begin(), c.end(), from, onto);
    change.now.push_back(c);
  }
  if (change.now.size() + 1 != change.old.size()) return;
  change.old.push_back(between);
  change.way = norm(mesh_.points[from] - mesh_.points[onto]);
  out.push_back(std::move(change));
}

void Untangling::add_turn(std::uint32_t triangle, std::size_t side, std::vector<Change>& out) const {
  const Corners& one = mesh_.triangles[triangle];
  const std::uint32_t a = one[side], b = one[(side + 1) % 3], c = one[(side + 2) % 3];
  const auto *of_a = fan(a), *of_c = fan(c);
  if (of_a == nullptr || of_c == nullptr || fan(b) == nullptr) return;
  const auto other =
      std::ranges::find_if(*of_a, [&](std::uint32_t t) { return t != triangle && has(mesh_.triangles[t], b); });
  if (other == of_a->end()) return;
  std::uint32_t d = gone;
  for (const std::uint32_t p : mesh_.triangles[*other])
    if (p != a && p != b) d = p;
  if (d == c || fan(d) == nullptr) return;
  if (std::ranges::any_of(*of_c, [&](std::uint32_t t) { return has(mesh_.triangles[t], d); })) return;
  add_merge(c, d, *other, out), add_merge(d, c, triangle, out);
  if ((planes_of(box_, mesh_.points[a]) & planes_of(box_, mesh_.points[b])) != 0) return;
  out.push_back(
      {.old = {triangle, *other}, .now = {{a, d, c}, {b, c, d}}, .way = norm(mesh_.points[a] - mesh_.points[b])});
}

std::vector<Change> Untangling::changes(std::span<const std::array<std::uint32_t, 2>> pairs, Search search) const {
  std::set<std::uint32_t> triangles, points;
  std::map<std::uint32_t, std::vector<Vec3>> places;
  for (const auto& pair : pairs) {
    triangles.insert(pair.begin(), pair.end());
    // To the other side of the triangle that is met.
    for (std::size_t i = 0; i < 2; ++i) {
      const Triangle through = corners(pair[1 - i]);
      const Vec3 normal = normal_of(through) / norm(normal_of(through));
      for (const std::uint32_t p : mesh_.triangles[pair[i]]) {
        const double height = dot(mesh_.points[p] - through[0], normal);
        for (const double beyond : {0.02, 0.1})
          if (std::fabs(height) < tolerance_)
            places[p].push_back(mesh_.points[p] - (height + std::copysign(beyond * tolerance_, height)) * normal);
      }
    }
  }
  for (const std::uint32_t t : triangles) points.insert(mesh_.triangles[t].begin(), mesh_.triangles[t].end());
  std::vector<Change> all;
  std::set<std::array<std::uint32_t, 2>> edges;
  for (const std::uint32_t p : points) {
    const auto* around = fan(p);
    if (around == nullptr) continue;
    Vec3 sum;
    for (const std::uint32_t t : *around)
      for (const std::uint32_t q : mesh_.triangles[t]) {
        if (q == p) continue;
        sum += mesh_.points[q];
        edges.insert({p, q}), edges.insert({q, p});
      }
    const Vec3 to_middle = sum / (2 * static_cast<double>(around->size())) - mesh_.points[p];
    for (const double share : {0.1, 0.25, 0.5, 0.75, 1.0}) places[p].push_back(mesh_.points[p] + share * to_middle);
    if (search == Search::wide)
      for (const double length : {0.1, 0.2, 0.4, 0.7})
        for (int n = 0; n < 27; ++n) {
          const Vec3 way{n % 3 - 1.0, n / 3 % 3 - 1.0, n / 9 - 1.0};
          if (n != 13) places[p].push_back(mesh_.points[p] + length * tolerance_ / norm(way) * way);
        }
    add_moves(p, places[p], all);
  }
  for (const auto& [from, onto] : edges) add_collapse(from, onto, all);
  for (const std::uint32_t t : triangles)
    for (std::size_t side = 0; side < 3; ++side) add_turn(t, side, all);
  return all;
}

bool Untangling::keeps_width(const Change& change) const {
  constexpr double narrow = 0.01;
  double before = narrow;
  for (const std::uint32_t t : change.old) before = std::min(before, width_of(corners(t)));
  return std::ranges::all_of(change.now, [&](const Corners& c) {
    const double width = width_of(corners(c, change));
    return width > 0 && width >= before;
  });
}

/// How many pairs fewer meet.
int Untangling::gain_of(const Change& change) {
  work_left_ -= static_cast<double>(near_.size());
  const auto is_old = [&](std::uint32_t t) { return std::ranges::find(change.old, t) != change.old.end(); };
  std::vector<Triangle> old, now;
  std::vector<Corners> old_corners;
  for (const std::uint32_t t : change.old) old.push_back(corners(t)), old_corners.push_back(mesh_.triangles[t]);
  for (const Corners& c : change.now) now.push_back(corners(c, change));
  const auto meet = [](const Corners& of_s, const Triangle& s, const Corners& of_t, const Triangle& t) {
    if (std::ranges::any_of(of_s, [&](std::uint32_t p) { return has(of_t, p); })) return false;
    return box_of(s).intersects(box_of(t)) && triangles_meet(s, t);
  };
  const auto count = [&](std::span<const Corners> which, std::span<const Triangle> where) {
    int pairs = 0;
    Box3 box;
    for (std::size_t i = 0; i < which.size(); ++i) {
      pairs += norm(normal_of(where[i])) > 0 ? 0 : 1;
      for (const Vec3& p : where[i]) box.extend(p);
      for (std::size_t j = 0; j < i; ++j) pairs += meet(which[i], where[i], which[j], where[j]) ? 1 : 0;
    }
    for (const auto& [t, other, box_of_other] : near_) {
      if (!box.intersects(box_of_other) || is_old(t)) continue;
      for (std::size_t i = 0; i < which.size(); ++i)
        pairs += meet(which[i], where[i], mesh_.triangles[t], other) ? 1 : 0;
    }
    return pairs;
  };
  return count(old_corners, old) - count(change.now, now);
}

/// Of triangles, in the planes of the box that they are on, the largest distance from the surface.
double Untangling::farthest(std::span<const Triangle> triangles, std::span<const unsigned> planes, int parts) {
  std::vector<PointNearSurface> asked;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto& [a, b, c] = triangles[t];
    if (planes[t] != 0) continue;
    for (int i = 0; i <= parts; ++i)
      for (int j = 0; i + j <= parts; ++j) {
        const Vec3 p = (i * a + j * b + (parts - i - j) * c) / parts;
        asked.push_back(
            {.point = p, .planes = planes_of(box_, p), .ahead = normal_of(triangles[t]), .most = 4 * tolerance_});
      }
  }
  std::vector<double> distances;
  work_left_ -= point_work * static_cast<double>(asked.size());
  feet_.distances(asked, tolerance_, distances);
  return distances.empty() ? 0 : *std::ranges::max_element(distances);
}

bool Untangling::stays_near(const Change& change) {
  constexpr double between = 1.04;  // as measure_mesh has it
  std::vector<Triangle> now;
  std::vector<unsigned> planes;
  for (const Corners& c : change.now) {
    now.push_back(corners(c, change));
    unsigned all = ~0U;
    for (const Vec3& p : now.back()) all &= planes_of(box_, p);
    planes.push_back(all);
  }
  std::vector<Vec3> left = were_;
  for (const std::uint32_t p : {change.moved, change.removed})
    if (p != gone) left.push_back(mesh_.points[p]);
  for (const Vec3& p : left) {
    double nearest = HUGE_VAL;
    for (const Triangle& t : now) nearest = std::min(nearest, norm(to_closest_point(t, p)));
    for (const auto& [t, corners, box] : near_) {
      if (nearest <= tolerance_) break;
      if (!grown(box, tolerance_).intersects({p, p}) || std::ranges::find(change.old, t) != change.old.end()) continue;
      nearest = std::min(nearest, norm(to_closest_point(corners, p)));
    }
    if (nearest > tolerance_) return false;
  }
  return between * farthest(now, planes, 2) <= tolerance_ && between * farthest(now, planes, 8) <= tolerance_;
}

void Untangling::carry_out(const Change& change) {
  for (const std::uint32_t p : {change.moved, change.removed})
    if (p != gone) were_.push_back(mesh_.points[p]);
  if (change.moved != gone) mesh_.points[change.moved] = change.place;
  const std::vector<std::uint32_t> old = change.old;
  for (const std::uint32_t t : old) {
    for (const std::uint32_t p : mesh_.triangles[t])
      if (const auto found = fans_.find(p); found != fans_.end()) std::erase(found->second, t);
    mesh_.triangles[t][0] = gone;
    changed_.insert(t);
  }
  for (std::size_t i = 0; i < change.now.size(); ++i) {
    mesh_.triangles[old[i]] = change.now[i];
    for (const std::uint32_t p : change.now[i])
      if (const auto found = fans_.find(p); found != fans_.end()) found->second.push_back(old[i]);
    for (const std::uint32_t p : change.now[i]) out_.changed[p] = 1;
  }
  if (change.removed != gone) fans_.erase(change.removed);
  std::erase_if(near_, [&](const Near& n) { return mesh_.triangles[n.number][0] == gone; });
  for (Near& n : near_)
    if (std::ranges::find(old, n.number) != old.end()) n.corners = corners(n.number), n.box = box_of(n.corners);
}

/// The best change that stays near, of those by which fewer triangles meet.
bool Untangling::change_one(std::span<const std::array<std::uint32_t, 2>> pairs, Search search) {
  const std::size_t most_tried = search == Search::likely ? 24 : 100;
  std::vector<Change> all = changes(pairs, search);
  std::erase_if(all, [&](Change& change) { return !keeps_width(change) || (change.gain = gain_of(change)) <= 0; });
  std::ranges::stable_sort(
      all, [](const Change& p, const Change& q) { return std::pair(-p.gain, p.way) < std::pair(-q.gain, q.way); });
  if (all.size() > most_tried) all.resize(most_tried);
  const auto found = std::ranges::find_if(all, [&](const Change& change) { return stays_near(change); });
  if (found == all.end()) return false;
  carry_out(*found);
  return true;
}

void Untangling::mend(std::uint32_t a, std::uint32_t b) {
  constexpr int most_steps = 20;
  look_around(a, b);
  for (int step = 0; step < most_steps; ++step) {
    const auto pairs = meeting();
    if (pairs.empty()) return;
    if (work_left_ > 0 && (change_one(pairs, Search::likely) || change_one(pairs, Search::wide))) continue;
    for (const auto& pair : pairs) given_up_.insert(pair.begin(), pair.end());
    return;
  }
}

Untangled Untangling::run(const RunOptions& run) {
  constexpr std::size_t most_pairs = 20'000;
  constexpr int most_rounds = 2;
  for (int round = 0; round < most_rounds; ++round) {
    TriangleMesh rounded = mesh_;
    for (Vec3& p : rounded.points) p = as_floats(p);
    auto pairs = deep_self_contacts(rounded, chord_heights(rounded), most_pairs);
    for (std::uint32_t t = 0; t < rounded.triangles.size(); ++t)
      if (!(norm(normal_of(corners(t))) > 0)) pairs.push_back({t, t});
    rounded = {};
    given_up_.clear();
    if (pairs.empty()) break;
    sort_by_place();
    for (const auto& [a, b] : pairs) {
      if (run.should_stop()) break;
      if (mesh_.triangles[a][0] == gone || mesh_.triangles[b][0] == gone) continue;
      if (given_up_.contains(a) && given_up_.contains(b)) continue;
      if (a != b && !triangles_meet(corners(a), corners(b))) continue;
      mend(a, b);
    }
    if (changed_.empty() || given_up_.empty()) break;
    std::erase_if(mesh_.triangles, [](const Corners& t) { return t[0] == gone; });
  }
  for (const std::uint32_t t : given_up_)
    if (mesh_.triangles[t][0] != gone) {
      ++out_.left;
      for (const std::uint32_t p : mesh_.triangles[t]) out_.stuck[p] = 1;
    }
  std::erase_if(mesh_.triangles, [](const Corners& t) { return t[0] == gone; });
  return std::move(out_);
}

}  // namespace

Untangled untangle_mesh(TriangleMesh& mesh, const Box3& box, SurfaceFeet& feet, double tolerance,
                        std::span<const char> kept, const RunOptions& run) {
  return Untangling(mesh, box, feet, tolerance, kept).run(run);
}

}  // namespace meso::implicit
