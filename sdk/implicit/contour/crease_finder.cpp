// SPDX-License-Identifier: Apache-2.0
#include "crease_finder.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "plane_fit.hpp"

namespace meso::implicit {
namespace {

// Planes that are 7 degrees apart meet somewhere; sheets that are 18 degrees apart where they meet are two.
constexpr double least_share = 0.004, sharp_cosine = 0.95;

/// The next guess; false where the planes tell of no crease.
bool approach(Sheets& sheets, std::span<const Plane> planes) {
  double least = 1;
  for (std::size_t i = 1; i < planes.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) least = std::min(least, dot(planes[i].normal, planes[j].normal));
  if (!(least < sharp_cosine)) return false;
  sheets.crease = nearest_to_planes(planes, sheets.crease, least_share);
  return norm(sheets.crease - sheets.start) <= sheets.reach;
}

Plane plane_at(Vec3 at, Vec3 gradient, double value, unsigned planes) {
  const Vec3 slope = within(planes, gradient);
  return {at, slope / norm(slope), value / norm(slope)};
}

/// By the gradients that are given, if they are.
bool begin(Sheets& sheets) {
  sheets.crease = sheets.start;
  std::array<Plane, 3> planes;
  for (std::size_t i = 0; i < sheets.count; ++i) {
    if (norm(sheets.gradient[i]) == 0) return true;
    planes[i] = plane_at(sheets.at[i], sheets.gradient[i], 0, sheets.planes);
  }
  return approach(sheets, {planes.data(), sheets.count});
}

// What was found must be where the field changes its sign: on the way to it, since beyond a thin tip there is nothing.
void check_creases(std::span<Sheets> sheets, double accuracy, SurfaceFeet& feet) {
  std::vector<Vec3> creases, ways;
  for (const Sheets& s : sheets) {
    if (!s.found) continue;
    creases.push_back(s.crease);
    ways.push_back(s.crease - s.start);
  }
  std::vector<char> on_surface;
  feet.check(creases, ways, accuracy, on_surface);
  auto next = on_surface.begin();
  for (Sheets& s : sheets)
    if (s.found) s.found = *next++ != 0;
}

}  // namespace

void find_creases(std::span<Sheets> sheets, double accuracy, SurfaceFeet& feet) {
  std::vector<Sheets*> open;
  for (Sheets& s : sheets)
    if (begin(s)) open.push_back(&s);
  std::vector<Vec3> near, slopes;
  std::vector<double> values;
  for (const double share : {0.8, 0.3, 0.05, 0.01}) {  // of the way from the crease to a point of its sheet
    near.clear();
    for (const Sheets* s : open)
      for (std::size_t i = 0; i < s->count; ++i) near.push_back(s->crease + share * (s->at[i] - s->crease));
    feet.slopes(near, slopes, values);
    std::size_t next = 0;
    std::erase_if(open, [&](Sheets* s) {
      std::array<Plane, 3> planes;
      for (std::size_t i = 0; i < s->count; ++i, ++next)
        planes[i] = plane_at(near[next], slopes[next], values[next], s->planes);
      const Vec3 before = s->crease;
      const bool goes_on = approach(*s, {planes.data(), s->count});
      s->found = goes_on && norm(s->crease - before) <= accuracy / 3;
      return !goes_on;
    });
  }
  check_creases(sheets, accuracy, feet);
}

}  // namespace meso::implicit
