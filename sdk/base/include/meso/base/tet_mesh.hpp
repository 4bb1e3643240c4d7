// SPDX-License-Identifier: Apache-2.0
#pragma once
// Tetrahedra that share points, and the faces of their boundary: what finite elements are made of.

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "meso/base/vec.hpp"

namespace meso {

struct TetMesh {
  /// Where a face of the boundary lies: in a face of the box, or on the solid's own surface.
  enum class Side : std::uint8_t { x_min, x_max, y_min, y_max, z_min, z_max, surface };
  struct Face {
    std::uint32_t tet = 0;
    std::uint8_t face = 0;  ///< of face_corners
    Side side{};
    friend bool operator==(const Face&, const Face&) = default;
  };

  std::vector<Vec3> points;                        ///< millimetres
  std::vector<std::array<std::uint32_t, 4>> tets;  ///< the fourth corner sees the other three counter-clockwise
  std::vector<Face> boundary;                      ///< by side, then by tetrahedron

  static constexpr std::size_t side_count = 7;
  static constexpr std::array<std::string_view, side_count> side_names{"x_min", "x_max", "y_min",  "y_max",
                                                                       "z_min", "z_max", "surface"};
  /// A tetrahedron's faces as Abaqus and CalculiX number them (S1 ... S4), counter-clockwise seen from outside.
  static constexpr std::array<std::array<std::uint8_t, 3>, 4> face_corners{
      {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};

  [[nodiscard]] std::array<std::uint32_t, 3> corners(const Face& f) const {
    const auto& t = tets[f.tet];
    const auto& c = face_corners[f.face];
    return {t[c[0]], t[c[1]], t[c[2]]};
  }
};

}  // namespace meso
