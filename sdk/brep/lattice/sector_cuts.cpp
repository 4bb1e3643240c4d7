// SPDX-License-Identifier: Apache-2.0
#include "lattice/sector_cuts.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "lattice/union_find.hpp"

namespace meso::brep {
namespace {

constexpr double near_gap = 0.02;     ///< radians between circles that are to be parted by a cut
constexpr double longest_cut = 2;     ///< radians
constexpr double beside_caps = 0.02;  ///< radians between a cut and the caps that it passes
constexpr int points_of_cut = 8;      ///< at which it is looked for these

Vec3 unit(Vec3 v) { return v / norm(v); }

Vec3 towards(Vec3 axis, Vec3 other, double angle) {
  return std::cos(angle) * axis + std::sin(angle) * unit(other - dot(other, axis) * axis);
}

class SectorDivision {
 public:
  SectorDivision(const std::vector<BallCap>& caps, const std::vector<bool>& is_on_border) : caps_(caps) {
    for (std::uint32_t c = 0; c < caps.size(); ++c) {
      set_of_.push_back(is_on_border[c] && border_ ? *border_ : c);
      if (is_on_border[c] && !border_) border_ = c;
    }
    for (std::uint32_t b = 0; b < caps.size(); ++b)
      for (std::uint32_t a = 0; a < b; ++a)
        if (set_of_[a] != set_of_[b]) look_at(a, b);
    std::ranges::stable_sort(candidates_, {}, &Link::gap);
  }

  std::vector<BallCuts::Cut> cuts(Border border) {
    for (const Link& link : candidates_)
      if (link.gap <= near_gap && !crosses(link)) links_.push_back(link);
    close_rings();
    if (border == Border::linked && !is_border_linked()) {
      const auto nearest =
          std::ranges::find_if(candidates_, [&](const Link& link) { return is_of_border(link) && !crosses(link); });
      if (nearest != candidates_.end()) links_.push_back(*nearest);
      close_rings();
    }
    std::vector<BallCuts::Cut> out;
    for (const Link& link : links_)
      if (link.gap > touching_gap && !link.is_given_up) out.push_back(link.caps);
    return out;
  }

 private:
  struct Link {
    BallCuts::Cut caps{};
    double gap = 0;  ///< none: a contact
    bool is_given_up = false;
  };

  void close_rings() {
    while (const auto bridge = find_bridge()) {
      const auto around = std::ranges::find_if(
          candidates_, [&](const Link& link) { return !has(link) && leads_around(*bridge, link) && !crosses(link); });
      if (around != candidates_.end())
        links_.push_back(*around);
      else
        links_[*bridge].is_given_up = true;
    }
  }
  [[nodiscard]] bool is_of_border(const Link& link) const {
    return border_ && (set_of_[link.caps[0]] == *border_ || set_of_[link.caps[1]] == *border_);
  }
  [[nodiscard]] bool is_border_linked() const {
    return std::ranges::any_of(links_, [&](const Link& link) { return is_of_border(link) && !link.is_given_up; });
  }

  void look_at(std::uint32_t a, std::uint32_t b) {
    const double gap = angle_between(caps_[a].axis, caps_[b].axis) - caps_[a].angle - caps_[b].angle;
    if (gap <= touching_gap && gap >= -touching_gap) links_.push_back({{a, b}, 0});
    if (gap <= touching_gap || gap > longest_cut) return;
    const double by = std::min(beside_caps, gap / 2);
    for (int k = 0; k <= points_of_cut; ++k) {
      const Vec3 p = towards(caps_[a].axis, caps_[b].axis, caps_[a].angle + gap * k / points_of_cut);
      for (std::uint32_t c = 0; c < caps_.size(); ++c)
        if (c != a && c != b && angle_between(caps_[c].axis, p) < caps_[c].angle + by) return;
    }
    candidates_.push_back({{a, b}, gap});
  }

  [[nodiscard]] bool has(const Link& link) const {
    return std::ranges::any_of(links_, [&](const Link& known) { return known.caps == link.caps; });
  }

  /// The other end of a link's arc, too.
  [[nodiscard]] std::array<Vec3, 2> ends(const Link& link) const {
    const auto& [a, b] = link.caps;
    return {towards(caps_[a].axis, caps_[b].axis, caps_[a].angle),
            towards(caps_[b].axis, caps_[a].axis, caps_[b].angle)};
  }
  [[nodiscard]] bool crosses(const Link& link) const {
    const auto [p, q] = ends(link);
    return std::ranges::any_of(links_, [&](const Link& known) {
      if (known.gap <= touching_gap) return false;
      const auto [r, s] = ends(known);
      const Vec3 n = cross(p, q), m = cross(r, s);
      return dot(n, r) * dot(n, s) < 0 && dot(m, p) * dot(m, q) < 0 && dot(p + q, r + s) > 0;
    });
  }

  /// Sets of caps that hang together without one of the links, or with one more.
  [[nodiscard]] UnionFind joined_without(std::size_t left_out) const {
    UnionFind sets(caps_.size());
    for (std::size_t l = 0; l < links_.size(); ++l)
      if (l != left_out && !links_[l].is_given_up) sets.join(set_of_[links_[l].caps[0]], set_of_[links_[l].caps[1]]);
    return sets;
  }
  [[nodiscard]] bool parts(UnionFind& sets, const Link& link) const {
    return sets.root(set_of_[link.caps[0]]) != sets.root(set_of_[link.caps[1]]);
  }
  [[nodiscard]] std::optional<std::size_t> find_bridge() const {
    for (std::size_t l = 0; l < links_.size(); ++l) {
      if (links_[l].is_given_up) continue;
      UnionFind sets = joined_without(l);
      if (parts(sets, links_[l])) return l;
    }
    return {};
  }
  /// From one side of the bridge towards the other, if only by a cap that nothing else is linked to.
  [[nodiscard]] bool leads_around(std::size_t bridge, const Link& link) const {
    UnionFind sets = joined_without(bridge);
    return parts(sets, link) && (sets.root(set_of_[link.caps[0]]) == sets.root(set_of_[links_[bridge].caps[0]]) ||
                                 sets.root(set_of_[link.caps[0]]) == sets.root(set_of_[links_[bridge].caps[1]]) ||
                                 sets.root(set_of_[link.caps[1]]) == sets.root(set_of_[links_[bridge].caps[0]]) ||
                                 sets.root(set_of_[link.caps[1]]) == sets.root(set_of_[links_[bridge].caps[1]]));
  }

  const std::vector<BallCap>& caps_;
  std::optional<std::uint32_t> border_;
  std::vector<std::uint32_t> set_of_;  ///< by cap
  std::vector<Link> links_, candidates_;
};

}  // namespace

std::vector<BallCuts::Cut> sector_cuts(const std::vector<BallCap>& caps, const std::vector<bool>& is_on_border,
                                       Border border) {
  return SectorDivision(caps, is_on_border).cuts(border);
}

}  // namespace meso::brep
