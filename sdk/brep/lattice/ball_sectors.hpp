// SPDX-License-Identifier: Apache-2.0
#pragma once
// What the struts and the sides of a cell box leave of its balls: arcs of circles, and faces between them. Private.

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "beam_graph_sphere.hpp"
#include "lattice/cell_edges.hpp"
#include "lattice/jointed_box.hpp"

namespace meso::brep {

class BallSectors {
 public:
  BallSectors(const JointedBox& box, CellEdges& edges);

  /// False, and why, where circles meet in other ways than told in jointed_box.hpp.
  [[nodiscard]] bool divide(std::string& why);
  /// The faces of all balls, about other axes for each variant; false as above.
  [[nodiscard]] bool add_faces(int variant, std::vector<FaceTemplate>& faces, std::string& why);

  /// The arcs of a strut's circle that are seen, as the ball uses them.
  [[nodiscard]] const std::vector<Coedge>& ring(Leaving l) const { return rings_.at(l); }
  /// Where the seam of a strut starts and ends, if it lies free in the box.
  [[nodiscard]] std::uint32_t seam(Leaving l) const { return seams_.at(l); }
  /// Arcs in a side, as the balls use them.
  [[nodiscard]] const std::vector<Coedge>& in_side(Side side) const { return in_sides_[side]; }

 private:
  struct Cap {
    Vec3 axis;
    double angle = 0;
    std::optional<Leaving> strut;
    std::optional<Side> side;
    std::vector<std::uint32_t> marks;  ///< vertices on its circle
  };
  struct Arc {
    Coedge use;
    SphereArc value;
    bool is_cut = false;
  };
  struct Ball {
    std::uint32_t node = 0;
    std::vector<Cap> caps;
    std::vector<std::array<std::uint32_t, 2>> cuts;  ///< between vertices
    std::vector<Arc> arcs;
  };

  [[nodiscard]] Vec3 centre(const Ball& ball) const { return box_.joints.graph.nodes[ball.node].position; }
  [[nodiscard]] double radius(const Ball& ball) const { return box_.joints.graph.nodes[ball.node].radius; }
  [[nodiscard]] Vec3 seen(const Ball& ball, std::uint32_t vertex) const;
  [[nodiscard]] Ball ball_of(std::uint32_t node) const;
  [[nodiscard]] static bool is_covered(const Ball& ball, Vec3 p, double margin);
  [[nodiscard]] bool meet(Ball& ball, std::size_t i, std::size_t j);
  void mark(Ball& ball, std::size_t cap, Vec3 p);
  [[nodiscard]] bool runs_in(const Cap& strut, const Cap& side) const;
  void cut(Ball& ball);
  void cut_between(Ball& ball, const BallCap& a, const BallCap& b);
  void add_seams();
  void add_arcs(Ball& ball);
  [[nodiscard]] std::vector<std::vector<std::size_t>> loops_of(const Ball& ball) const;

  const JointedBox& box_;
  CellEdges& edges_;
  std::vector<Ball> balls_;
  std::map<Leaving, std::vector<Coedge>> rings_;
  std::map<Leaving, std::uint32_t> seams_;
  std::array<std::vector<Coedge>, 6> in_sides_;
};

}  // namespace meso::brep
