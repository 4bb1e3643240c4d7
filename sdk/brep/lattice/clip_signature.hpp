// SPDX-License-Identifier: Apache-2.0
#pragma once
// When do two cells see the same piece of a body? When every face that touches the one touches the other with the same
// surface and the same boundary, seen from the cell. Private.
//
// The geometry is told modulo what leaves the surface as it is: a cylinder along the lattice looks the same from every
// layer. Planes, cylinders, cones, spheres and tori are recognised; any other surface is its own. The boundary is told
// by the straight edges, clipped to the box, and by circles; other curves are their own.

#include <vector>

#include "lattice/cell_grid.hpp"
#include "occt.hpp"

namespace meso::brep {

class ClipSignatures {
 public:
  using Signature = std::vector<std::int64_t>;

  /// Throws Standard_Failure.
  ClipSignatures(const TopoDS_Shape& body, const CellGrid& grid);

  /// Of the faces with these numbers, in the body's order, as seen from the cell: equal signatures, equal local bodies
  /// within 1e-7 of the cell.
  [[nodiscard]] Signature of(const Index3& cell, const std::vector<std::uint32_t>& faces) const;

 private:
  enum class Form : std::uint8_t { plane, cylinder, cone, sphere, torus, line, circle, other };
  /// A surface or curve by its axis, a point on it, and two lengths or angles.
  struct Shape {
    Form form = Form::other;
    Vec3 point, axis;
    double a = 0, b = 0;
  };
  struct Edge {
    Shape shape;
    Vec3 from, to;  ///< in the direction in which the face has it on its left
    std::vector<Vec3> points;
    double reach = 0;
  };
  struct Face {
    Shape shape;
    bool reversed = false;
    double reach = 0;
    std::vector<Edge> edges;
  };

  [[nodiscard]] static Face read(const TopoDS_Face& face, double curved_reach);
  void tell(Signature& to, const Shape& shape, std::int64_t number, const Index3& cell) const;
  void tell(Signature& to, Vec3 v) const;

  CellGrid grid_;
  std::vector<Face> faces_;
};

}  // namespace meso::brep
