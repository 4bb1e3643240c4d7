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
#include "lattice/mesh_probe.hpp"
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

  /// Of a point that keeps the reach of the faces from their triangles.
  [[nodiscard]] bool contains(Vec3 p) const { return probe_.contains(p); }

  struct Edge {
    std::vector<std::uint32_t> nodes;
    std::vector<double> at;  ///< parameters of the nodes on the curve
    double reach = 0;        ///< how far the curve is from them
    bool seam = false;
  };
  struct Face {
    std::vector<Vec3> nodes;
    std::vector<std::array<double, 2>> parameters;        ///< of the nodes, on the surface
    std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise seen from outside
    std::vector<Edge> edges;
    double reach = 0;  ///< how far the surface is from the triangles
    bool planar = false;
    Vec3 normal;
    double offset = 0;

    [[nodiscard]] Triangle3 triangle(std::size_t i) const {
      return {nodes[triangles[i][0]], nodes[triangles[i][1]], nodes[triangles[i][2]]};
    }
  };
  [[nodiscard]] const Face& face(std::uint32_t number) const { return all_[number]; }
  [[nodiscard]] std::size_t face_count() const { return all_.size(); }

 private:
  [[nodiscard]] static Face read(const TopoDS_Face& face, double deflection);
  void enter(std::uint32_t number, const Face& face);
  [[nodiscard]] bool divides_a_wall(const Face& face, const Index3& cell) const;
  void block_walls(const Face& face, const Index3& cell);
  void fill_blocks();
  [[nodiscard]] bool encloses(Vec3 p) const;
  CellGrid grid_;
  TopoDS_Compound body_;
  std::vector<Face> all_;
  MeshProbe probe_;
  std::vector<std::vector<std::uint32_t>> touched_;
  std::vector<BoxPlace> places_;
  std::vector<std::uint8_t> blocked_;  ///< bit i: a face covers the high wall across axis i
};

}  // namespace meso::brep
