// SPDX-License-Identifier: Apache-2.0
#include "beam_graph_cuts.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <tuple>

namespace meso::brep {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double near_gap = 0.1;                             // radians between circles that are to be parted by a cut
constexpr double longest_cut = 2;                            // radians
constexpr std::array widest_empty{1.0, 0.8, 0.6, 0.4, 0.3};  // radians from a point of the ball to the nearest site
constexpr double beside_caps = 0.02;                         // radians between a cut and the caps that it passes
constexpr double least_cosine = 0.25;                        // of a face's border, seen from its middle
constexpr int spread_points = 120;
constexpr double straight = 1.5e-6;  // radians between axes that are one line

Vec3 unit(Vec3 v) { return v / norm(v); }
Vec3 across(Vec3 v) { return unit(cross(v, std::fabs(v.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0})); }

/// A planar graph on the ball: its sites are caps and points, its edges the cuts and, without length, points of
/// contact. Half edge 2e runs from the first site of edge e to the second, 2e + 1 back; each has a face on its left.
class CutGraph {
 public:
  explicit CutGraph(const std::vector<BallCap>& caps) : sites_(caps), cap_count_(caps.size()) {}

  BallCuts divide() {
    if (!has_near_caps()) return {};
    for (const double empty : widest_empty) {
      add_points(empty);
      connect();
      if (!is_good()) continue;
      drop_cuts();
      return result();
    }
    return cap_count_ == 2 ? divide_sickle() : BallCuts{};
  }

 private:
  /// What two circles leave of a ball where a line of struts bends a little: too narrow for any of the points above.
  BallCuts divide_sickle() {
    if (angle_between(sites_[0].axis, sites_[1].axis) > pi - straight) return {};  // a zone, even all around
    sites_.resize(cap_count_);
    for (const double turn : {pi / 2, pi, 3 * pi / 2}) sites_.push_back({between_caps(turn), 0});
    connect();
    if (!is_good()) return {};
    drop_cuts();
    return result();
  }

  /// As far from one of two circles as from the other, so far about the first one's axis from where they are nearest.
  [[nodiscard]] Vec3 between_caps(double turn) const {
    const auto& [axis, angle] = sites_[0];
    const BallCap& other = sites_[1];
    const Vec3 x = unit(other.axis - dot(other.axis, axis) * axis);
    const Vec3 way = std::cos(turn) * x + std::sin(turn) * cross(axis, x);
    Vec3 p;
    double low = angle, high = pi;
    for (int i = 0; i < 60; ++i) {
      const double middle = (low + high) / 2;
      p = std::cos(middle) * axis + std::sin(middle) * way;
      (middle - angle < angle_between(p, other.axis) - other.angle ? low : high) = middle;
    }
    return p;
  }

  using Face = std::vector<std::uint32_t>;  ///< half edges
  struct Edge {
    std::array<std::uint32_t, 2> site{};
    double gap = 0;
    std::array<double, 2> azimuth{};  ///< about each site, of the direction to the other
  };

  [[nodiscard]] double gap_of(std::size_t a, std::size_t b) const {
    return angle_between(sites_[a].axis, sites_[b].axis) - sites_[a].angle - sites_[b].angle;
  }
  [[nodiscard]] bool has_near_caps() const {
    for (std::size_t b = 0; b < cap_count_; ++b)
      for (std::size_t a = 0; a < b; ++a)
        if (gap_of(a, b) < near_gap) return true;
    return false;
  }

  /// The farthest place from all sites, again and again, until none is far.
  void add_points(double widest) {
    std::vector<Vec3> places;
    Vec3 middle;
    for (std::size_t c = 0; c < cap_count_; ++c) middle += sites_[c].axis;
    if (norm(middle) > 0.1) places.push_back(-unit(middle));
    for (int i = 0; i < spread_points; ++i) {
      const double h = 1 - (2 * i + 1.0) / spread_points, r = std::sqrt(1 - h * h), turn = 2.399963229728653 * i;
      places.push_back({r * std::cos(turn), r * std::sin(turn), h});
    }
    std::vector<double> nearest(places.size(), pi);
    const auto come_near = [&](const BallCap& site) {
      for (std::size_t i = 0; i < places.size(); ++i)
        nearest[i] = std::min(nearest[i], std::acos(std::clamp(dot(places[i], site.axis), -1.0, 1.0)) - site.angle);
    };
    for (const BallCap& cap : sites_) come_near(cap);
    for (;;) {
      const auto farthest = std::ranges::max_element(nearest);
      if (*farthest <= widest) return;
      sites_.push_back({places[static_cast<std::size_t>(farthest - nearest.begin())], 0});
      come_near(sites_.back());
    }
  }

  /// The shortest cuts first, each that meets none before it and no cap.
  void connect() {
    edges_.clear();
    std::vector<std::tuple<long long, Edge>> wanted;
    for (std::uint32_t b = 0; b < sites_.size(); ++b)
      for (std::uint32_t a = 0; a < b; ++a) {
        const double gap = gap_of(a, b);
        const double from_line = pi - angle_between(sites_[a].axis, sites_[b].axis);
        if (gap >= longest_cut || from_line < (gap < near_gap ? straight : near_gap)) continue;
        wanted.emplace_back(std::llround(gap * 1e9), Edge{{a, b}, gap});
      }
    std::ranges::stable_sort(wanted, {}, [](const auto& w) { return std::get<0>(w); });
    for (auto& [order, edge] : wanted) {
      if (!passes_caps(edge) || std::ranges::any_of(edges_, [&](const Edge& e) { return cross_each_other(e, edge); }))
        continue;
      edge.azimuth = {azimuth(edge.site[0], edge.site[1]), azimuth(edge.site[1], edge.site[0])};
      edges_.push_back(edge);
    }
    is_dropped_.assign(edges_.size(), false);
    sort_around_sites();
  }

  void sort_around_sites() {
    around_.assign(sites_.size(), {});
    for (std::uint32_t half = 0; half < 2 * edges_.size(); ++half) around_[start(half)].push_back(half);
    for (auto& halves : around_)
      std::ranges::sort(halves, std::greater{}, [&](std::uint32_t half) { return azimuth(half); });
  }

  [[nodiscard]] double azimuth(std::uint32_t from, std::uint32_t to) const {
    const Vec3 z = sites_[from].axis, x = across(z), way = sites_[to].axis;
    return std::atan2(dot(way, cross(z, x)), dot(way, x));
  }
  [[nodiscard]] bool passes_caps(const Edge& edge) const {
    const Vec3 u = sites_[edge.site[0]].axis, v = sites_[edge.site[1]].axis, n = unit(cross(u, v));
    for (std::uint32_t k = 0; k < sites_.size(); ++k) {
      const Vec3 w = sites_[k].axis;
      if (k == edge.site[0] || k == edge.site[1] || dot(cross(n, u), w) < 0 || dot(cross(n, v), w) > 0) continue;
      if (std::asin(std::min(1.0, std::fabs(dot(w, n)))) < sites_[k].angle + beside_caps) return false;
    }
    return true;
  }
  [[nodiscard]] bool cross_each_other(const Edge& e, const Edge& f) const {
    for (const std::uint32_t s : e.site)
      if (s == f.site[0] || s == f.site[1]) return false;
    const Vec3 a = sites_[e.site[0]].axis, b = sites_[e.site[1]].axis, p = sites_[f.site[0]].axis,
               q = sites_[f.site[1]].axis, ab = cross(a, b), pq = cross(p, q);
    if ((dot(ab, p) < 0) == (dot(ab, q) < 0) || (dot(pq, a) < 0) == (dot(pq, b) < 0)) return false;
    return dot(unit(a + b), unit(p + q)) > 0;
  }

  /// The longest cuts first, each whose two faces are a good one without it.
  void drop_cuts() {
    for (auto e = static_cast<std::uint32_t>(edges_.size()); e-- > 0 && edges_[e].gap >= near_gap;) {
      const std::uint32_t beyond = next(2 * e);
      is_dropped_[e] = std::ranges::count(face_from(2 * e), 2 * e + 1) == 0;
      if (is_dropped_[e] && !is_good(face_from(beyond))) is_dropped_[e] = false;
    }
  }

  /// All hang together, by Euler's formula, and each face is a good one.
  [[nodiscard]] bool is_good() const {
    std::vector<bool> seen(2 * edges_.size(), false);
    std::size_t faces = 0;
    for (std::uint32_t first = 0; first < seen.size(); ++first) {
      if (seen[first]) continue;
      const Face face = face_from(first);
      if (!is_good(face)) return false;
      for (const std::uint32_t half : face) seen[half] = true;
      ++faces;
    }
    return faces + sites_.size() == edges_.size() + 2;
  }
  /// A border that passes nothing twice, less than half around.
  [[nodiscard]] bool is_good(const Face& face) const { return is_simple(face) && is_small(face); }

  [[nodiscard]] std::uint32_t start(std::uint32_t half) const { return edges_[half / 2].site[half % 2]; }
  [[nodiscard]] double azimuth(std::uint32_t half) const { return edges_[half / 2].azimuth[half % 2]; }
  /// From one azimuth clockwise to another.
  static double clockwise(double from, double to) {
    const double turn = from - to;
    return turn > 0 ? turn : turn + 2 * pi;
  }

  [[nodiscard]] Face face_from(std::uint32_t first) const {
    Face face;
    std::uint32_t half = first;
    do face.push_back(half);
    while ((half = next(half)) != first);
    return face;
  }
  /// Where a half edge ends, the first one clockwise from the way back.
  [[nodiscard]] std::uint32_t next(std::uint32_t half) const {
    const std::uint32_t back = half ^ 1u;
    const auto& halves = around_[start(back)];
    auto at = static_cast<std::size_t>(std::ranges::find(halves, back) - halves.begin());
    do at = (at + 1) % halves.size();
    while (is_dropped_[halves[at] / 2]);
    return halves[at];
  }

  [[nodiscard]] bool is_simple(const Face& face) const {
    for (std::size_t i = 0; i < face.size(); ++i)
      for (std::size_t k = 0; k < i; ++k)
        if (face[i] / 2 == face[k] / 2 || (start(face[i]) == start(face[k]) && start(face[i]) >= cap_count_))
          return false;
    return true;
  }

  [[nodiscard]] bool is_small(const Face& face) const {
    std::vector<Vec3> border;
    for (std::size_t i = 0; i < face.size(); ++i) {
      const std::uint32_t half = face[(i + 1) % face.size()], back = face[i] ^ 1u;
      const BallCap& site = sites_[start(half)];
      const Vec3 x = across(site.axis), y = cross(site.axis, x);
      const double sweep = clockwise(azimuth(back), azimuth(half));
      const int steps = site.angle == 0 ? 0 : 1 + static_cast<int>(sweep / 0.4);
      for (int s = 0; s <= steps; ++s) {
        const double turn = azimuth(back) - sweep * s / std::max(1, steps);
        border.push_back(std::cos(site.angle) * site.axis +
                         std::sin(site.angle) * (std::cos(turn) * x + std::sin(turn) * y));
      }
    }
    Vec3 area;
    for (std::size_t i = 0; i < border.size(); ++i) area += cross(border[i], border[(i + 1) % border.size()]);
    if (norm(area) == 0) return false;
    Vec3 middle = unit(area);
    for (int step = 2; step < 10; ++step) {  // towards the middle of the smallest circle around, Badoiu and Clarkson
      const Vec3 farthest = *std::ranges::min_element(border, {}, [&](Vec3 p) { return dot(p, middle); });
      if (dot(farthest, middle) > least_cosine) return dot(middle, area) > 0;
      middle = unit(middle + 1.0 / step * (farthest - middle));
    }
    return false;
  }

  [[nodiscard]] BallCuts result() const {
    BallCuts out;
    for (std::size_t e = 0; e < edges_.size(); ++e)
      if (!is_dropped_[e] && edges_[e].gap > touching_gap) out.cuts.push_back(edges_[e].site);
    for (std::size_t s = cap_count_; s < sites_.size(); ++s) out.points.push_back(sites_[s].axis);
    return out;
  }

  std::vector<BallCap> sites_;  ///< points are caps of no size, behind the caps
  std::size_t cap_count_;
  std::vector<Edge> edges_;  ///< the shortest first
  std::vector<bool> is_dropped_;
  std::vector<std::vector<std::uint32_t>> around_;  ///< by site: the half edges from there, clockwise
};

}  // namespace

double angle_between(Vec3 a, Vec3 b) { return 2 * std::atan2(norm(a - b), norm(a + b)); }

BallCuts cuts_between(const std::vector<BallCap>& caps) { return CutGraph(caps).divide(); }

}  // namespace meso::brep
