// SPDX-License-Identifier: Apache-2.0
#pragma once
// The parts of a body's faces within rectangles of their parameters: a cell sees those of a face's thousands of edges
// that come near it, and no others. Private.
//
//   FaceWindows faces(least_length);
//   faces.add(side_edges);                    // as it is
//   faces.add(cap_edges, cap_mesh, window);   // edges that come near, and the window's border where it is in the face
//   for (const auto& pieces : faces.made()) ...
//
// Edges are divided where they leave a window, and in every face that has them, so the faces go on sharing edges. No
// boolean is needed: an edge enters and leaves, and between two edges the face is bounded by the border of its window
// (Weiler and Atherton 1977). Where that is not clear, or where the face's seam is near, the face is taken whole.
//
// Cost: 10 ns for each edge of a face, 50 us for each that is near. Thread rule: one for each thread.

#include <optional>
#include <vector>

#include "lattice/body_surface.hpp"

namespace meso::brep {

/// A rectangle of parameters.
struct ParameterRange {
  std::array<double, 2> low{HUGE_VAL, HUGE_VAL}, high{-HUGE_VAL, -HUGE_VAL};

  void extend(const std::array<double, 2>& at);
  void grow(double share);
  [[nodiscard]] bool empty() const { return !(low[0] < high[0] && low[1] < high[1]); }
  /// Of a segment.
  [[nodiscard]] bool meets(const std::array<double, 2>& p, const std::array<double, 2>& q) const;
};

/// A face with its edges as the mesh of the body has them: in the order of an explorer, without degenerated ones.
struct FaceEdges {
  TopoDS_Face face;
  std::vector<TopoDS_Edge> edges;  ///< as the forward face uses them
};

class FaceWindows {
 public:
  /// Points closer than `least` are one.
  explicit FaceWindows(double least) : least_(least) {}

  void add(const FaceEdges& face) { requests_.push_back({&face, nullptr, {}, {}, {}}); }
  void add(const FaceEdges& face, const BodySurface::Face& mesh, const ParameterRange& window) {
    requests_.push_back({&face, &mesh, window, {}, {}});
  }
  /// In the order of `add`, oriented as the faces are; several where a face falls into pieces. May throw
  /// Standard_Failure.
  [[nodiscard]] std::vector<std::vector<TopoDS_Face>> made();

 private:
  /// Where an edge crosses the border of a window.
  struct Crossing {
    std::size_t edge = 0;
    double at = 0;
    Vec3 point;
    double border = 0;  ///< how far around the border: side and share of it
  };
  struct Request {
    const FaceEdges* face = nullptr;
    const BodySurface::Face* mesh = nullptr;  ///< null: no window
    ParameterRange window;
    std::vector<std::size_t> near;  ///< numbers among the face's edges
    std::vector<Crossing> crossings;
  };
  struct Division {
    double at = 0;
    TopoDS_Vertex vertex;
  };
  struct Edge {
    TopoDS_Edge edge;  ///< forward
    std::vector<Division> divisions;
    std::vector<TopoDS_Edge> parts;
  };
  class Loops;

  [[nodiscard]] bool look_for_crossings(Request& request);
  void divide_edges();
  [[nodiscard]] const Edge* known(const TopoDS_Edge& edge) const;
  [[nodiscard]] TopoDS_Face with_divided_edges(const FaceEdges& face) const;

  double least_;
  std::vector<Request> requests_;
  TopTools_IndexedMapOfShape numbers_;
  std::vector<Edge> edges_;  ///< as numbered
};

}  // namespace meso::brep
