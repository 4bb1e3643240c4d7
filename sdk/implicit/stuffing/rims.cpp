// SPDX-License-Identifier: Apache-2.0
#include "rims.hpp"

#include <algorithm>
#include <cmath>

namespace meso::implicit::stuffing {
namespace {

/// Bits 2a and 2a + 1: in the box's lower and upper plane across axis a.
unsigned planes_of(const Box3& box, Vec3 p) {
  unsigned planes = 0;
  for (unsigned a = 0; a < 3; ++a) {
    if (p[a] == box.min[a]) planes |= 1U << 2 * a;
    if (p[a] == box.max[a]) planes |= 2U << 2 * a;
  }
  return planes;
}

Vec3 within(unsigned planes, Vec3 v) {
  for (unsigned a = 0; a < 3; ++a)
    if ((planes >> 2 * a & 3U) != 0) v[a] = 0;
  return v;
}

class Rims {
 public:
  Rims(Numbered& numbered, const BccLattice& lattice, const GridSource& source)
      : mesh_(numbered.mesh), inside_(numbered.inside), lattice_(lattice), sampler_(source.sampler()) {
    for (const Vec3& p : mesh_.points) planes_.push_back(planes_of(lattice.box, p));
    done_.assign(planes_.size(), 0);
    link();
  }

  void run() {
    for (int round = 0; round < 3; ++round) {
      for (std::uint32_t p = 0; p < mesh_.points.size(); ++p)
        if (done_[p] == 0 && is_beside(p)) bring_to_plane(p);
      for (std::uint32_t p = 0; p < mesh_.points.size(); ++p)
        if (done_[p] == 0 && is_at_rim(p)) bring_to_rim(p);
    }
  }

 private:
  // Points of the boundary near the box's planes, and what is around them.
  void link() {
    std::vector<char> near(mesh_.points.size(), 0);
    const double reach = lattice_.spacing;
    for (std::size_t p = 0; p < near.size(); ++p) {
      if (inside_[p]) continue;
      for (std::size_t a = 0; a < 3; ++a)
        if (std::min(mesh_.points[p][a] - lattice_.box.min[a], lattice_.box.max[a] - mesh_.points[p][a]) <= reach)
          near[p] = 1;
    }
    first_.assign(near.size() + 1, 0);
    for (const auto& t : mesh_.tets)
      for (const std::uint32_t p : t) first_[p + 1] += near[p];
    for (std::size_t p = 0; p < near.size(); ++p) first_[p + 1] += first_[p];
    around_.resize(first_.back());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (std::uint32_t t = 0; t < mesh_.tets.size(); ++t)
      for (const std::uint32_t p : mesh_.tets[t])
        if (near[p] != 0) around_[next[p]++] = t;
  }

  template <class Visit>
  void visit_tets(std::uint32_t p, Visit visit) const {
    for (std::uint32_t i = first_[p]; i < first_[p + 1]; ++i) visit(mesh_.tets[around_[i]]);
  }

  /// On the surface, in a tetrahedron of which an edge lies in a plane of the box.
  [[nodiscard]] bool is_beside(std::uint32_t p) const {
    if (inside_[p] || planes_[p] != 0) return false;
    bool found = false;
    visit_tets(p, [&](const RawTet& t) { found = found || plane_of(t) != 0; });
    return found;
  }
  [[nodiscard]] unsigned plane_of(const RawTet& t) const {
    for (unsigned plane = 1; plane < 64; plane <<= 1)
      if (std::ranges::count_if(t, [&](std::uint32_t p) { return (planes_[p] & plane) != 0; }) >= 2) return plane;
    return 0;
  }
  /// In a plane of the box, beside a point that is on the surface only.
  [[nodiscard]] bool is_at_rim(std::uint32_t p) const {
    if (planes_[p] == 0) return false;
    bool found = false;
    visit_tets(p, [&](const RawTet& t) {
      for (const std::uint32_t q : t) found = found || (!inside_[q] && (planes_[p] & ~planes_[q]) != 0);
    });
    return found;
  }

  double value(Vec3 p) {
    double result = 0;
    sampler_->values_at({&p, 1}, &result);
    return result;
  }

  /// Between the directions within the planes in which the field changes its sign first; 0: it does not.
  Vec3 way_to_rim(Vec3 p, unsigned planes, double reach, bool inside) {
    constexpr int steps = 6;
    for (int i = 1; i <= steps; ++i) {
      Vec3 sum;
      for (int n = 0; n < 125; ++n) {
        const Vec3 all{n % 5 - 2.0, n / 5 % 5 - 2.0, n / 25 - 2.0}, way = within(planes, all);
        const double longest = std::max({std::abs(way.x), std::abs(way.y), std::abs(way.z)});
        if (longest < 2 || norm(all - way) > 0) continue;
        const Vec3 q = p + reach * i / steps / norm(way) * way;
        if (lattice_.box.intersects({q, q}) && (value(q) < 0) != inside) sum += way / norm(way);
      }
      if (norm(sum) > 0) return sum / norm(sum);
    }
    return {};
  }

  /// Where the surface is, from p within the planes; at most so far.
  bool find_rim(Vec3 p, unsigned planes, double reach, Vec3& rim) {
    constexpr int steps = 6;
    constexpr double accuracy = 1e-6;
    const double step = 1e-4 * lattice_.spacing, here = value(p);
    Vec3 slope;
    for (std::size_t a = 0; a < 3; ++a) {
      if ((planes >> 2 * a & 3U) != 0) continue;
      Vec3 beside = p;
      beside[a] += beside[a] + step <= lattice_.box.max[a] ? step : -step;
      slope[a] = (value(beside) - here) / (beside[a] - p[a]);
    }
    slope = within(planes, slope);
    if (!std::isfinite(norm(slope)) || !std::isfinite(here)) return false;
    // Of a part that fills the box, the field near the box's sides is that of the sides, and only its sign tells.
    const bool is_flat = !(norm(slope) > 0);
    const Vec3 way = is_flat ? way_to_rim(p, planes, reach, here < 0) : (here < 0 ? 1 : -1) / norm(slope) * slope;
    if (norm(way) == 0) return false;
    const auto at = [&](double t) {
      Vec3 q = p + t * way;
      for (std::size_t a = 0; a < 3; ++a) q[a] = std::clamp(q[a], lattice_.box.min[a], lattice_.box.max[a]);
      return q;
    };
    double low = 0, high = 0;
    for (int i = 1; i <= steps; ++i) {
      high = reach * i / steps;
      if ((value(at(high)) < 0) != (here < 0)) break;
      low = high;
      if (i == steps) return false;
    }
    // By signs alone: near the sides of a part that fills the box, values are those of the sides.
    while (high - low > accuracy * lattice_.spacing) {
      const double middle = 0.5 * (low + high);
      ((value(at(middle)) < 0) != (here < 0) ? high : low) = middle;
    }
    rim = at(here < 0 ? low : high);  // inside
    return true;
  }

  void bring_to_plane(std::uint32_t p) {
    unsigned plane = 0;
    visit_tets(p, [&](const RawTet& t) {
      if (plane == 0) plane = plane_of(t);
    });
    Vec3 foot = mesh_.points[p];
    for (unsigned a = 0; a < 3; ++a) {
      if ((plane >> 2 * a & 1U) != 0) foot[a] = lattice_.box.min[a];
      if ((plane >> 2 * a & 2U) != 0) foot[a] = lattice_.box.max[a];
    }
    if (norm(foot - mesh_.points[p]) > 0.9 * lattice_.spacing) return;
    Vec3 rim;
    if (!find_rim(foot, plane, 0.9 * lattice_.spacing, rim)) return;
    const bool is_inside = value(foot) < 0;
    for (const double share : {1.0, 0.75, 0.5, 0.25}) {
      if (share < 1 && !is_inside) return;  // what is outside stays so
      const Vec3 to = foot + share * (rim - foot);
      if (!move(p, to)) continue;
      planes_[p] = planes_of(lattice_.box, to);
      done_[p] = share == 1;
      return;
    }
  }

  void bring_to_rim(std::uint32_t p) {
    const Vec3 from = mesh_.points[p];
    Vec3 rim;
    if (!find_rim(from, planes_[p], 0.9 * lattice_.spacing, rim)) return;
    for (const double share : {1.0, 0.85, 0.7, 0.55, 0.4, 0.2})
      if (move(p, from + share * (rim - from))) {
        done_[p] = share == 1;
        return;
      }
  }

  [[nodiscard]] bool is_good(const RawTet& t) const {
    const Vec3 o = mesh_.points[t[0]], a = mesh_.points[t[1]] - o, b = mesh_.points[t[2]] - o,
               c = mesh_.points[t[3]] - o;
    const double h = lattice_.spacing;
    if (!(dot(cross(a, b), c) > 6 * least_volume * h * h * h)) return false;
    std::array<Vec3, 4> normal{cross(b - a, c - a), cross(c, b), cross(a, c), cross(b, a)};
    for (Vec3& n : normal) n = n / norm(n);
    const double most = std::cos(least_angle), least = std::cos(most_angle);
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j) {
        const double cosine = -dot(normal[i], normal[j]);
        if (!(cosine <= most && cosine >= least)) return false;
      }
    return true;
  }

  /// False, and nothing done: some tetrahedron would be too flat.
  bool move(std::uint32_t p, Vec3 to) {
    const Vec3 before = mesh_.points[p];
    mesh_.points[p] = to;
    bool good = true;
    visit_tets(p, [&](const RawTet& t) { good = good && is_good(t); });
    if (!good) mesh_.points[p] = before;
    return good;
  }

  // Better than the bound, 14 and 160 degrees: what more there would be to reach is little.
  static constexpr double least_angle = 0.2443, most_angle = 2.7925;
  static_assert(least_angle > min_dihedral_bound && most_angle < max_dihedral_bound);
  static constexpr double least_volume = 2e-3;  // of the spacing's cube

  TetMesh& mesh_;
  const std::vector<bool>& inside_;
  const BccLattice& lattice_;
  std::unique_ptr<GridSampler> sampler_;
  std::vector<unsigned> planes_;
  std::vector<char> done_;  // moved onto the rim
  std::vector<std::uint32_t> first_, around_;
};

}  // namespace

void move_to_rims(Numbered& numbered, const BccLattice& lattice, const GridSource& source) {
  Rims(numbered, lattice, source).run();
}

}  // namespace meso::implicit::stuffing
