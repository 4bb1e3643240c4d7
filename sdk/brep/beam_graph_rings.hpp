// SPDX-License-Identifier: Apache-2.0
#pragma once
// The circles in which struts and balls meet and the cuts between them, their vertices and edges. Private.
//
// A ring has a vertex where the seam of a strut ends, wherever another circle of its ball touches it, and where a cut
// ends. A strut's seam runs where it is farthest from such points at both ends.

#include <span>

#include "beam_graph_joints.hpp"
#include "beam_graph_mesh.hpp"
#include "meso/brep/body.hpp"

namespace meso::brep {

struct Ring {
  AxisFrame frame;
  double radius = 0;
  struct Mark {
    double turn = 0;  ///< about the frame's z from its x
    std::uint32_t vertex = 0;
    bool is_contact = false;
  };
  std::vector<Mark> marks;       ///< by turn, at least one
  std::uint32_t first_edge = 0;  ///< edge first_edge + k runs from mark k to the next
};

/// An edge on a ball between two rings, or to a vertex between them, see cuts_between().
struct CutEdge {
  std::uint32_t edge = 0;
  std::array<std::uint32_t, 2> vertex{};
};

/// The ring at the end of a strut; `forward` if the strut's face runs along its edges, its ball's face against them.
struct RingUse {
  std::uint32_t ring = 0;
  bool forward = true;
};

class Rings {
 public:
  /// Adds vertices and edges to `geometry`, those of seams and cuts behind those of the rings. `cuts` are by node.
  Rings(const Joints& joints, const std::vector<BallCuts>& cuts, Template& geometry);

  [[nodiscard]] const RingUse& use(Leaving l) const { return use_[l]; }
  [[nodiscard]] const Ring& ring(Leaving l) const { return rings_[use_[l].ring]; }
  /// Of a strut that is not swallowed: its edge from the first ring to the second, and where it stands.
  struct Seam {
    std::uint32_t edge = 0;
    std::array<std::uint32_t, 2> vertex{};
    Vec3 direction;  ///< from the strut's axis
  };
  [[nodiscard]] const Seam& seam(std::uint32_t strut) const { return seams_[strut]; }

  [[nodiscard]] const std::vector<CutEdge>& cuts(std::uint32_t node) const { return cuts_[node]; }

  /// All edges of the ring from a vertex and back, as the strut's face runs along them.
  [[nodiscard]] std::vector<Coedge> around(Leaving l, std::uint32_t vertex) const;

 private:
  void make_rings(const Joints& joints);
  void mark_contacts(const Joints& joints, Template& geometry);
  void mark_cuts(const Joints& joints, const std::vector<BallCuts>& cuts, Template& geometry);
  void mark_seams(const Joints& joints, Template& geometry);
  void make_edges(Template& geometry);
  void add_seams(const Joints& joints, Template& geometry);
  void add_cuts(const Joints& joints, Template& geometry);
  std::uint32_t mark(Leaving l, Vec3 p, bool is_contact, Template& geometry);
  void mark(Leaving l, Vec3 p, std::uint32_t vertex, bool is_contact);

  std::vector<Ring> rings_;
  std::vector<RingUse> use_;
  std::vector<Seam> seams_;
  std::vector<std::vector<CutEdge>> cuts_;  ///< by node
};

/// How many sides a circle is given, whatever its parts.
[[nodiscard]] int sides_of(double radius, double deflection, double angle);

/// The points between the ends of each edge of the rings, in the edge's direction; equal for all who ask.
[[nodiscard]] std::vector<Vec3> inner_points(const EdgeTemplate& edge, const Template& geometry, int sides);

}  // namespace meso::brep
