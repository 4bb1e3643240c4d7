// SPDX-License-Identifier: Apache-2.0
#pragma once
// Where the faces of a body pass through the boxes of a lattice. Private.
//
//   const BodySurface surface(body_in_lattice_frame, grid);
//   if (surface.place(cell) == BoxPlace::crossing) use(surface.faces(cell), surface.signature(cell));
//
// Every face is triangulated once and its triangles are entered into the boxes they touch, grown by what a triangle can
// be off; a plane is taken as it is. A face that lies in a wall of a box and covers all of it does not cross the box.
// Boxes that no face touches make connected blocks, and each block costs one classification of a point.

#include <vector>

#include "lattice/box_overlap.hpp"
#include "lattice/cell_grid.hpp"
#include "occt.hpp"

namespace meso::brep {

enum class BoxPlace : std::uint8_t { outside, inside, crossing };

class BodySurface {
 public:
  /// `body`: outward solids whose interiors do not meet. Throws Standard_Failure.
  BodySurface(const std::vector<TopoDS_Shape>& body, const CellGrid& grid);

  [[nodiscard]] BoxPlace place(const Index3& cell) const { return places_[grid_.slot(cell)]; }
  /// Numbers of the faces that touch the closed box, rising.
  [[nodiscard]] const std::vector<std::uint32_t>& faces(const Index3& cell) const { return touched_[grid_.slot(cell)]; }
  /// A copy of the body: faces are numbered in its order.
  [[nodiscard]] const TopoDS_Compound& body() const { return body_; }

 private:
  struct Edge {
    std::vector<Vec3> points;
    double reach = 0;  ///< how far the curve is from them
  };
  struct Face {
    std::vector<Triangle3> triangles;
    std::vector<Edge> edges;
    double reach = 0;  ///< how far the surface is from the triangles
    bool planar = false;
    Vec3 normal;
    double offset = 0;
  };

  [[nodiscard]] static Face read(const TopoDS_Face& face, double deflection);
  void enter(std::uint32_t number, const Face& face);
  [[nodiscard]] bool divides_a_wall(const Face& face, const Index3& cell) const;
  void block_walls(const Face& face, const Index3& cell);
  void fill_blocks();
  [[nodiscard]] bool contains(Vec3 p) const;

  CellGrid grid_;
  TopoDS_Compound body_;
  std::vector<std::vector<std::uint32_t>> touched_;
  std::vector<BoxPlace> places_;
  std::vector<std::uint8_t> blocked_;  ///< bit i: a face covers the high wall across axis i
};

}  // namespace meso::brep
