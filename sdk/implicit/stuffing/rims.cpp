// SPDX-License-Identifier: Apache-2.0
#include "rims.hpp"

#include <algorithm>
#include <cmath>

#include "rim_search.hpp"

namespace meso::implicit::stuffing {
namespace {

class Rims {
 public:
  Rims(Numbered& numbered, const BccLattice& lattice)
      : mesh_(numbered.mesh), inside_(numbered.inside), lattice_(lattice) {
    for (const Vec3& p : mesh_.points) planes_.push_back(planes_of(lattice.box, p));
    done_.assign(planes_.size(), 0);
    link();
  }

  /// False: stopped.
  bool run(const GridSource& source, Threads& threads) {
    for (int round = 0; round < 3; ++round) {
      std::vector<Candidate> found;
      for (std::uint32_t p = 0; p < mesh_.points.size(); ++p)
        if (const unsigned plane = done_[p] == 0 ? plane_beside(p) : 0; plane != 0) add_beside(p, plane, found);
      if (!find(found, source, threads)) return false;
      for (const Candidate& c : found) bring_to_plane(c);
      found.clear();
      for (std::uint32_t p = 0; p < mesh_.points.size(); ++p)
        if (done_[p] == 0 && is_at_rim(p)) found.push_back({p, {.from = mesh_.points[p], .planes = planes_[p]}});
      if (!find(found, source, threads)) return false;
      for (const Candidate& c : found) bring_to_rim(c);
    }
    return true;
  }

 private:
  // Points of the boundary near the box's planes, and what is around them.
  void link() {
    std::vector<char> near(mesh_.points.size(), 0);
    for (std::size_t p = 0; p < near.size(); ++p) {
      if (inside_[p]) continue;
      for (std::size_t a = 0; a < 3; ++a)
        if (std::min(mesh_.points[p][a] - lattice_.box.min[a], lattice_.box.max[a] - mesh_.points[p][a]) <=
            lattice_.spacing)
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

  /// Of a point on the surface, the plane of the box in which an edge of one of its tetrahedra lies.
  [[nodiscard]] unsigned plane_beside(std::uint32_t p) const {
    if (inside_[p] || planes_[p] != 0) return 0;
    unsigned plane = 0;
    visit_tets(p, [&](const RawTet& t) {
      if (plane == 0) plane = plane_of(t);
    });
    return plane;
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

  struct Candidate {
    std::uint32_t point;
    Rim rim;
  };

  /// From the foot of the point in the plane, if it is near.
  void add_beside(std::uint32_t p, unsigned plane, std::vector<Candidate>& out) const {
    Vec3 foot = mesh_.points[p];
    for (unsigned a = 0; a < 3; ++a) {
      if ((plane >> 2 * a & 1U) != 0) foot[a] = lattice_.box.min[a];
      if ((plane >> 2 * a & 2U) != 0) foot[a] = lattice_.box.max[a];
    }
    if (norm(foot - mesh_.points[p]) <= reach * lattice_.spacing) out.push_back({p, {.from = foot, .planes = plane}});
  }

  bool find(std::vector<Candidate>& candidates, const GridSource& source, Threads& threads) {
    constexpr std::size_t at_once = 512;
    const bool whole = threads.ranges("rims", candidates.size(), at_once, [&](std::size_t first, std::size_t last) {
      std::vector<Rim> rims;
      for (std::size_t i = first; i < last; ++i) rims.push_back(candidates[i].rim);
      find_rims(rims, *source.sampler(), lattice_);
      for (std::size_t i = first; i < last; ++i) candidates[i].rim = rims[i - first];
    });
    for (const Candidate& c : candidates)
      if (!c.rim.is_found && planes_[c.point] != 0) done_[c.point] = 1;
    return whole;
  }

  void bring_to_plane(const Candidate& c) {
    if (!c.rim.is_found) return;
    for (const double share : {1.0, 0.75, 0.5, 0.25}) {
      if (share < 1 && !c.rim.from_inside) return;  // what is outside stays so
      const Vec3 to = c.rim.from + share * (c.rim.at - c.rim.from);
      if (!move(c.point, to)) continue;
      planes_[c.point] = planes_of(lattice_.box, to);
      done_[c.point] = share == 1;
      return;
    }
  }

  void bring_to_rim(const Candidate& c) {
    if (!c.rim.is_found) return;
    for (const double share : {1.0, 0.85, 0.7, 0.55, 0.4, 0.2})
      if (move(c.point, c.rim.from + share * (c.rim.at - c.rim.from))) {
        done_[c.point] = share == 1;
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
  static constexpr double reach = 0.9;          // of the spacing
  static constexpr double least_volume = 2e-3;  // of the spacing's cube

  TetMesh& mesh_;
  const std::vector<bool>& inside_;
  const BccLattice& lattice_;
  std::vector<unsigned> planes_;
  std::vector<char> done_;  // moved onto the rim, or none is near
  std::vector<std::uint32_t> first_, around_;
};

}  // namespace

bool move_to_rims(Numbered& numbered, const BccLattice& lattice, const GridSource& source, Threads& threads) {
  return Rims(numbered, lattice).run(source, threads);
}

}  // namespace meso::implicit::stuffing
