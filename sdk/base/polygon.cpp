// SPDX-License-Identifier: Apache-2.0
#include "meso/base/polygon.hpp"

#include <algorithm>
#include <cmath>

namespace meso {
namespace {

double turn(Point2 a, Point2 b, Point2 c) {
  return (b.first - a.first) * (c.second - a.second) - (b.second - a.second) * (c.first - a.first);
}

bool on_segment(Point2 a, Point2 b, Point2 p) {
  return std::min(a.first, b.first) <= p.first && p.first <= std::max(a.first, b.first) &&
         std::min(a.second, b.second) <= p.second && p.second <= std::max(a.second, b.second);
}

/// Of the corner b between a and c: do its two sides lie on each other?
bool turns_back(Point2 a, Point2 b, Point2 c) {
  const double along = (b.first - a.first) * (c.first - b.first) + (b.second - a.second) * (c.second - b.second);
  return turn(a, b, c) == 0 && along < 0;
}

std::optional<std::string> corner_fault(std::span<const Point2> p, double least) {
  const std::size_t n = p.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Point2 a = p[i], b = p[(i + 1) % n], c = p[(i + 2) % n];
    if (!std::isfinite(a.first) || !std::isfinite(a.second)) return "has a point that is not finite";
    if (std::hypot(b.first - a.first, b.second - a.second) <= least)
      return "has two neighbouring points that coincide (point " + std::to_string(i + 1) + ")";
    if (turns_back(a, b, c)) return "turns back on itself at point " + std::to_string((i + 1) % n + 1);
  }
  return {};
}

}  // namespace

bool segments_meet(Point2 a, Point2 b, Point2 c, Point2 d) {
  const double abc = turn(a, b, c), abd = turn(a, b, d), cda = turn(c, d, a), cdb = turn(c, d, b);
  if (((abc > 0 && abd < 0) || (abc < 0 && abd > 0)) && ((cda > 0 && cdb < 0) || (cda < 0 && cdb > 0))) return true;
  return (abc == 0 && on_segment(a, b, c)) || (abd == 0 && on_segment(a, b, d)) || (cda == 0 && on_segment(c, d, a)) ||
         (cdb == 0 && on_segment(c, d, b));
}

bool in_polygon(std::span<const Point2> corners, Point2 p) {
  bool odd = false;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto [ax, ay] = corners[i];
    const auto [bx, by] = corners[(i + 1) % corners.size()];
    if ((ay > p.second) != (by > p.second) && p.first < ax + (p.second - ay) * (bx - ax) / (by - ay)) odd = !odd;
  }
  return odd;
}

double polygon_area(std::span<const Point2> corners) {
  double doubled = 0;
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) doubled += turn(corners[0], corners[i], corners[i + 1]);
  return doubled / 2;
}

std::optional<std::string> polygon_fault(std::span<const Point2> p, double least) {
  const std::size_t n = p.size();
  if (n < 3) return "needs at least three points";
  if (auto fault = corner_fault(p, least)) return fault;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 2; j < n; ++j) {
      if (i == 0 && j == n - 1) continue;  // neighbours around the end
      if (segments_meet(p[i], p[i + 1], p[j], p[(j + 1) % n]))
        return "crosses or touches itself (edges " + std::to_string(i + 1) + " and " + std::to_string(j + 1) + ")";
    }
  if (std::fabs(polygon_area(p)) <= least * least) return "encloses no area";
  return {};
}

}  // namespace meso
