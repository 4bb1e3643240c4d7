// SPDX-License-Identifier: Apache-2.0
#pragma once
// The topology of one shell: faces, their loops, and the edges and vertices that several of them share.

#include <map>
#include <vector>

#include "meso/brep/instance_map.hpp"
#include "sphere_pieces.hpp"
#include "step_geometry.hpp"
#include "step_text.hpp"

namespace meso::step {

/// How a face on a sphere is written: see divided(), plain_loops() and clear_frame(). Where `cut` is empty, edges of
/// the only piece are the template's.
struct SphereFace {
  std::vector<brep::FaceTemplate> pieces;
  SpherePieces cut;
  bool touches_itself = false;  ///< all the same: see StepCounts
};

using SphereFaces = std::map<std::uint32_t, SphereFace>;  ///< by face of a template

/// The numbers of what several faces share, in `vertices` and `edges`, and of the faces.
struct ShellNumbers {
  brep::InstanceMap<StepId> vertices, edges;
  std::vector<StepId> faces;
  std::uint64_t touching = 0;      ///< faces whose loops touch
  SphereFaces* spheres = nullptr;  ///< of the shell's template: shells that share one look for clear frames once
};

/// Vertices and edges are written when a face first uses them, and never twice.
class ShellWriter {
 public:
  /// Numbers the entities of the shell, in the order of its faces from the first.
  ShellWriter(StepText& text, StepGeometry& geometry, const brep::Shell& shell, ShellNumbers& numbers)
      : text_(text),
        geometry_(geometry),
        template_(*shell.geometry),
        pose_(shell),
        growing_(&numbers),
        known_(numbers) {}
  /// Writes faces of a shell whose entities have all been numbered: what has a number beyond the last one written is
  /// to be written now. So any range of faces can be written if it is known where it begins to count.
  ShellWriter(StepText& text, StepGeometry& geometry, const brep::Shell& shell, const ShellNumbers& numbers)
      : text_(text), geometry_(geometry), template_(*shell.geometry), pose_(shell), known_(numbers) {}

  void write_face(const brep::FaceInstance& instance);

 private:
  const SphereFace& sphere_face(const brep::SphereSurface& sphere, std::uint32_t index);
  void write_piece(const brep::FaceTemplate& face, const brep::Index3& cell, const SpherePieces* cut);
  void write_cut(const SpherePieces& cut, const brep::Index3& cell);
  StepId write_loop(const std::vector<brep::Coedge>& loop, const brep::Index3& cell, const SpherePieces* cut);
  StepId edge_id(std::uint32_t index, const brep::Index3& cell);
  StepId vertex_id(std::uint32_t index, const brep::Index3& cell);
  StepId write_edge(const brep::EdgeTemplate& edge, const brep::Index3& cell);
  StepId write_vertex(std::uint32_t index, const brep::Index3& cell);

  StepText& text_;
  StepGeometry& geometry_;
  const brep::Template& template_;
  Pose pose_;
  ShellNumbers* growing_ = nullptr;
  const ShellNumbers& known_;
  std::vector<StepId> bounds_, coedges_;
  std::vector<StepId> cut_edges_;  ///< of the face that is being written
};

}  // namespace meso::step
