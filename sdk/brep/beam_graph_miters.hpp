// SPDX-License-Identifier: Apache-2.0
#pragma once
// Where the struts of a node meet each other beyond its ball: what each of them ends at, all around. Private.
//
// Ball and stubs are convex and hold the node. Along each line of its surface a stub is hidden in the ball, then in
// other stubs, and at last in sight; what it leaves there last, or goes into in between, changes at the corners of the
// node.
//
// Units: millimetres from the node; turns in radians. Thread rule: pure.

#include <cstddef>
#include <vector>

#include "meso/base/vec.hpp"

namespace meso::brep {

/// A strut as its node sees it: a cone about `axis` through the node, as long as need be.
struct Stub {
  Vec3 axis;               ///< unit, away from the node
  Vec3 x, y;               ///< unit, across: x, y, axis are right-handed; turns count from x
  double radius = 0;       ///< at the node
  double growth = 0;       ///< per length
  double leaves_ball = 0;  ///< how far along the axis it leaves the node's ball

  [[nodiscard]] Vec3 outward(double turn) const;
  [[nodiscard]] Vec3 point(double turn, double along) const;
  [[nodiscard]] double turn_of(Vec3 p) const;  ///< from 0 to below 2 pi
};

/// What a stub has its mitre at.
inline constexpr int at_ball = -1;  ///< otherwise the number of a stub

/// Of one stub at another, over a range of turns. Mostly it leaves the other there and is in sight from then on; where
/// it goes into the other, it has been in sight before.
struct Mitre {
  double from = 0, to = 0;  ///< turns; `from` is below 2 pi, `to` is larger
  int other = at_ball;
  bool goes_in = false;
};

class NodeMiters {
 public:
  NodeMiters(double ball, std::vector<Stub> stubs);

  /// False: two stubs never part. REQUIRES: once, before all else.
  [[nodiscard]] bool find();

  /// Of each stub, in any order; one that is all around is {0, 2 pi}.
  [[nodiscard]] const std::vector<std::vector<Mitre>>& mitres() const { return mitres_; }
  [[nodiscard]] const std::vector<Stub>& stubs() const { return stubs_; }
  [[nodiscard]] double ball() const { return ball_; }

  /// How far along its axis the stub has its mitre. REQUIRES: it does so there.
  [[nodiscard]] double along(std::size_t stub, const Mitre& mitre, double turn) const;
  [[nodiscard]] Vec3 point(std::size_t stub, const Mitre& mitre, double turn) const;
  /// By which the point moves a radian. REQUIRES: not at the ball.
  [[nodiscard]] Vec3 tangent(std::size_t stub, const Mitre& mitre, double turn) const;
  /// How far along its axis all of the stub is in sight.
  [[nodiscard]] double farthest(std::size_t stub) const;
  /// The two circles on the ball are one, no ball is to be seen between them.
  [[nodiscard]] bool are_opposite(std::size_t a, std::size_t b) const;

 private:
  /// Of a stub's surface, where it goes into another stub and leaves it: along the own axis.
  struct Line {
    double height = 0, climb = 0;  ///< along the other axis: at the node, and per length
    double first = 0, last = 0;
    bool meets = false;
  };
  [[nodiscard]] Line line(std::size_t stub, std::size_t other, double turn) const;
  struct Hidden {
    double from = 0, to = -1;  ///< along the axis; none where `to` is less
  };
  [[nodiscard]] Hidden hidden(std::size_t stub, std::size_t other, double turn) const;
  /// What bounds the parts of a line that are in sight, rising: 0 the ball, then two for each stub, where the line
  /// leaves it and where it goes into it.
  using Borders = std::vector<std::size_t>;
  [[nodiscard]] Borders borders(std::size_t stub, double turn) const;
  struct Corner {
    double turn = 0;
    Borders before, behind;
  };
  void part(std::size_t stub, double from, const Borders& first, double to, const Borders& last,
            std::vector<Corner>& out) const;
  [[nodiscard]] int shown(std::size_t stub, int other) const;

  double ball_;
  std::vector<Stub> stubs_;
  std::vector<std::vector<Mitre>> mitres_;
};

}  // namespace meso::brep
