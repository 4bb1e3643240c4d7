// SPDX-License-Identifier: Apache-2.0
#pragma once
// How exact the values of external fields must be for the whole to be right.
//
//   const Band band = external_bands(graph, root)[0];      // root = external - 0.3
//   band.for_root(0) == 0.3;                               // the root's sign needs the external up to 0.3
//   band.for_root(0.2) == 0.5;                             // up to there it is itself exact up to 0.2

#include <vector>

#include "graph.hpp"

namespace meso::implicit {

/// The larger of some lines slope * t + offset, or infinity; and which way the root goes when the external grows.
class Band {
 public:
  /// Up to which magnitude an external has to be exact so that the root is exact, to the bit, up to the magnitude `t`.
  /// Whatever is beyond may be replaced by anything of its sign that is beyond as well: then a root up to t is still
  /// the same, and one beyond stays beyond, with its sign. Infinity: the value matters everywhere. t >= 0.
  [[nodiscard]] double for_root(double t) const;
  /// The other way round: up to which magnitude the root is exact if the external is up to `magnitude`. At least 0.
  [[nodiscard]] double root_for(double magnitude) const;
  [[nodiscard]] bool is_finite() const { return !everywhere_; }
  /// Where both are false the external is not read. Both: the root may go either way.
  [[nodiscard]] bool may_rise() const { return rises_; }
  [[nodiscard]] bool may_fall() const { return falls_; }

 private:
  friend std::vector<Band> external_bands(const Graph& graph, Graph::Id root);
  struct Line {
    double slope, offset;
  };
  enum class Direction : std::uint8_t { same, opposite, either };
  void add(Line line);
  void add(const Band& band, double factor, double offset, Direction direction);

  bool everywhere_ = false, rises_ = false, falls_ = false;
  std::vector<Line> lines_;
};

/// For each of graph.externals().
[[nodiscard]] std::vector<Band> external_bands(const Graph& graph, Graph::Id root);

}  // namespace meso::implicit
