// SPDX-License-Identifier: Apache-2.0
#include "prism.hpp"

#include <algorithm>
#include <array>
#include <set>

#include "affine_map.hpp"
#include "polygon_term.hpp"
#include "shape_field.hpp"

namespace meso::implicit {
namespace {

constexpr std::size_t most_sides = 400;

/// Borders of what lies in the two planes that hold all points, counter-clockwise, and the lines that walls stand on.
struct Faces {
  std::set<Side> bottom, top, walls;
};

/// A side that two triangles share is no border. False if a side is there twice.
bool add(const Side& side, std::set<Side>& border) {
  return border.erase({side.to, side.from}) == 1 || border.insert(side).second;
}

std::optional<Faces> faces_along(std::size_t axis, double bottom, double top, const TriangleMesh& mesh) {
  const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
  Faces faces;
  for (const auto& triangle : mesh.triangles) {
    std::array<Point2, 3> flat;
    int at_top = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const Vec3& p = mesh.points[triangle[c]];
      if (p[axis] != bottom && p[axis] != top) return std::nullopt;
      flat[c] = {p[u], p[v]};
      at_top += p[axis] == top ? 1 : 0;
    }
    if (at_top == 0 || at_top == 3) {
      for (std::size_t c = 0; c < 3; ++c) {
        const Point2 &from = flat[c], &to = flat[(c + 1) % 3];
        if (!(at_top == 3 ? add({from, to}, faces.top) : add({to, from}, faces.bottom))) return std::nullopt;
      }
    } else {  // of a wall: two corners are one above the other
      const std::set<Point2> feet(flat.begin(), flat.end());
      if (feet.size() != 2) return std::nullopt;
      faces.walls.insert({*feet.begin(), *feet.rbegin()});
    }
  }
  return faces;
}

bool stand_on(const std::set<Side>& border, const std::set<Side>& walls) {
  return border.size() == walls.size() && std::all_of(border.begin(), border.end(), [&](const Side& side) {
           return walls.contains({std::min(side.from, side.to), std::max(side.from, side.to)});
         });
}

}  // namespace

std::optional<Field> prism_field(const TriangleMesh& mesh) {
  if (mesh.triangles.size() > 4 * most_sides) return std::nullopt;  // n sides take 2 n for walls, n for each end
  Box3 box;
  for (const Vec3& p : mesh.points) box.extend(p);
  for (const std::size_t axis : {2U, 0U, 1U}) {
    const double bottom = box.min[axis], top = box.max[axis];
    const auto faces = faces_along(axis, bottom, top, mesh);
    if (!faces || faces->bottom.empty() || faces->bottom != faces->top || !stand_on(faces->bottom, faces->walls))
      continue;
    const std::vector<Side> sides(faces->bottom.begin(), faces->bottom.end());
    Mat3 turned;  // x, y, z of the profile are the axes after `axis` and itself
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b) turned(a, b) = a == (axis + 1 + b) % 3 ? 1 : 0;
    return moved(extrusion(sides, bottom, top - bottom), {turned, {}});
  }
  return std::nullopt;
}

}  // namespace meso::implicit
