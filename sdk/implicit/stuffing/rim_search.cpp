// SPDX-License-Identifier: Apache-2.0
#include "rim_search.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace meso::implicit::stuffing {
namespace {

constexpr int steps = 6;
constexpr double reach = 0.9, accuracy = 1e-6, beside = 1e-4;  // of the spacing

/// From a point inside or outside along `way`; the sign changes between `low` and `high`.
struct Search {
  Rim* rim;
  Vec3 way;
  double low = 0, high = 0;
};

class RimSearch {
 public:
  RimSearch(GridSampler& sampler, const BccLattice& lattice) : sampler_(sampler), lattice_(lattice) {}

  void run(std::span<Rim> rims) {
    std::vector<Search> all = directions(rims), found;
    for (int i = 1; i <= steps; ++i) {
      std::vector<Search> left;
      for (Search& s : all) s.high = reach * lattice_.spacing * i / steps;
      ask(all, [](const Search& s) { return s.high; });
      for (std::size_t n = 0; n < all.size(); ++n) {
        const bool changes = (values_[n] < 0) != all[n].rim->from_inside;
        if (!changes) all[n].low = all[n].high;
        (changes ? found : left).push_back(all[n]);
      }
      all = std::move(left);
    }
    // By signs alone: near the sides of a part that fills the box, values are those of the sides.
    const auto middle = [](const Search& s) { return 0.5 * (s.low + s.high); };
    for (double width = reach / steps; width > accuracy; width /= 2) {
      ask(found, middle);
      for (std::size_t n = 0; n < found.size(); ++n)
        ((values_[n] < 0) != found[n].rim->from_inside ? found[n].high : found[n].low) = middle(found[n]);
    }
    for (const Search& s : found) {
      s.rim->at = at(s, s.rim->from_inside ? s.low : s.high);
      s.rim->is_found = true;
    }
  }

 private:
  [[nodiscard]] Vec3 at(const Search& s, double distance) const {
    Vec3 q = s.rim->from + distance * s.way;
    for (std::size_t a = 0; a < 3; ++a) q[a] = std::clamp(q[a], lattice_.box.min[a], lattice_.box.max[a]);
    return q;
  }

  void evaluate() {
    values_.resize(points_.size());
    sampler_.values_at(points_, values_.data());
  }

  template <class Distance>
  void ask(const std::vector<Search>& searches, const Distance& distance) {
    points_.clear();
    for (const Search& s : searches) points_.push_back(at(s, distance(s)));
    evaluate();
  }

  std::vector<Search> directions(std::span<Rim> rims) {
    const double step = beside * lattice_.spacing;
    points_.clear();
    for (const Rim& rim : rims) {
      points_.push_back(rim.from);
      for (std::size_t a = 0; a < 3; ++a) {
        points_.push_back(rim.from);
        points_.back()[a] += rim.from[a] + step <= lattice_.box.max[a] ? step : -step;
      }
    }
    evaluate();
    std::vector<Search> result;
    std::vector<Rim*> flat;
    for (std::size_t i = 0; i < rims.size(); ++i) {
      Rim& rim = rims[i];
      const double here = values_[4 * i];
      rim.from_inside = here < 0;
      Vec3 slope;
      for (std::size_t a = 0; a < 3; ++a)
        slope[a] = (values_[4 * i + 1 + a] - here) / (points_[4 * i + 1 + a][a] - rim.from[a]);
      slope = within(rim.planes, slope);
      if (!std::isfinite(norm(slope)) || !std::isfinite(here)) continue;
      if (norm(slope) > 0)
        result.push_back({&rim, (rim.from_inside ? 1 : -1) / norm(slope) * slope});
      else
        flat.push_back(&rim);
    }
    // Of a part that fills the box, the field near the box's sides is that of the sides, and only its sign tells.
    for (Rim* rim : flat)
      if (const Vec3 way = way_of_signs(*rim); norm(way) > 0) result.push_back({rim, way});
    return result;
  }

  /// Between the directions within the planes in which the sign changes first; 0: it does not.
  Vec3 way_of_signs(const Rim& rim) {
    for (int i = 1; i <= steps; ++i) {
      std::vector<Vec3> ways;
      points_.clear();
      for (int n = 0; n < 125; ++n) {
        const Vec3 all{n % 5 - 2.0, n / 5 % 5 - 2.0, n / 25 - 2.0}, way = within(rim.planes, all);
        const double longest = std::max({std::abs(way.x), std::abs(way.y), std::abs(way.z)});
        if (longest < 2 || norm(all - way) > 0) continue;
        const Vec3 q = rim.from + reach * lattice_.spacing * i / steps / norm(way) * way;
        if (!lattice_.box.intersects({q, q})) continue;
        ways.push_back(way / norm(way));
        points_.push_back(q);
      }
      evaluate();
      Vec3 sum;
      for (std::size_t n = 0; n < ways.size(); ++n)
        if ((values_[n] < 0) != rim.from_inside) sum += ways[n];
      if (norm(sum) > 0) return sum / norm(sum);
    }
    return {};
  }

  GridSampler& sampler_;
  const BccLattice& lattice_;
  std::vector<Vec3> points_;
  std::vector<double> values_;
};

}  // namespace

void find_rims(std::span<Rim> rims, GridSampler& sampler, const BccLattice& lattice) {
  RimSearch(sampler, lattice).run(rims);
}

}  // namespace meso::implicit::stuffing
