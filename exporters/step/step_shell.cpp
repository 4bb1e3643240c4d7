// SPDX-License-Identifier: Apache-2.0
#include "step_shell.hpp"

#include "sphere_frame.hpp"

namespace meso::step {

using namespace brep;

StepId ShellWriter::write_face(const FaceInstance& instance) {
  const FaceTemplate& face = template_.faces[instance.face];
  const auto* const ball = std::get_if<SphereSurface>(&face.surface);
  const SphereFace* const sphere = ball == nullptr ? nullptr : &sphere_face(*ball, instance.face);
  bounds_.clear();
  for (const auto& loop : sphere == nullptr ? face.loops : sphere->loops) {
    const StepId written = write_loop(loop, instance.cell);
    bounds_.push_back(text_.entity("FACE_BOUND", NoName{}, Ref{written}, true));
  }
  pose_.set_cell(instance.cell);
  const StepId surface = sphere == nullptr ? geometry_.surface(face.surface, pose_)
                                           : geometry_.surface(SphereSurface{sphere->frame, ball->radius}, pose_);
  return text_.entity("ADVANCED_FACE", NoName{}, bounds_, Ref{surface}, !face.reversed);
}

const SphereFace& ShellWriter::sphere_face(const SphereSurface& sphere, std::uint32_t face) {
  if (growing_ != nullptr && !growing_->spheres.contains(face)) {
    FaceTemplate plain{.surface = sphere, .reversed = template_.faces[face].reversed};
    plain.loops = plain_loops(template_.faces[face], template_);
    if (plain.loops.empty()) {
      growing_->spheres[face] = {template_.faces[face].loops, sphere.frame};
    } else {
      const AxisFrame frame = clear_frame(sphere, plain, template_);
      growing_->spheres[face] = {std::move(plain.loops), frame};
    }
  }
  return known_.spheres.at(face);
}

// Edges without a curve (poles, apexes) have no place in STEP; a loop of nothing else is a point.
StepId ShellWriter::write_loop(const std::vector<Coedge>& loop, const Index3& cell) {
  coedges_.clear();
  for (const Coedge& use : loop) {
    if (template_.edges[use.edge].degenerate) continue;
    const StepId edge = edge_id(use.edge, cell + use.offset);
    coedges_.push_back(text_.entity("ORIENTED_EDGE", NoName{}, Raw{"*"}, Raw{"*"}, Ref{edge}, !use.reversed));
  }
  if (!coedges_.empty()) return text_.entity("EDGE_LOOP", NoName{}, coedges_);
  const EdgeTemplate& pole = template_.edges[loop.front().edge];
  const StepId vertex = vertex_id(pole.vertex[0], cell + loop.front().offset + pole.vertex_offset[0]);
  return text_.entity("VERTEX_LOOP", NoName{}, Ref{vertex});
}

StepId ShellWriter::edge_id(std::uint32_t index, const Index3& cell) {
  if (growing_ != nullptr) {
    const auto [id, fresh] = growing_->edges.find_or_add(index, cell);
    if (fresh) id = write_edge(template_.edges[index], cell);  // adds vertices, no edges
    return id;
  }
  const StepId id = *known_.edges.find(index, cell);
  return id > text_.last() ? write_edge(template_.edges[index], cell) : id;
}

StepId ShellWriter::write_edge(const EdgeTemplate& edge, const Index3& cell) {
  const StepId first = vertex_id(edge.vertex[0], cell + edge.vertex_offset[0]);
  const StepId last = vertex_id(edge.vertex[1], cell + edge.vertex_offset[1]);
  pose_.set_cell(cell);
  const StepId curve = geometry_.curve(edge.curve, pose_);
  return text_.entity("EDGE_CURVE", NoName{}, Ref{first}, Ref{last}, Ref{curve}, true);
}

StepId ShellWriter::vertex_id(std::uint32_t index, const Index3& cell) {
  if (growing_ != nullptr) {
    const auto [id, fresh] = growing_->vertices.find_or_add(index, cell);
    if (fresh) id = write_vertex(index, cell);
    return id;
  }
  const StepId id = *known_.vertices.find(index, cell);
  return id > text_.last() ? write_vertex(index, cell) : id;
}

StepId ShellWriter::write_vertex(std::uint32_t index, const Index3& cell) {
  pose_.set_cell(cell);
  const StepId point = geometry_.point(pose_.point(template_.vertices[index]));
  return text_.entity("VERTEX_POINT", NoName{}, Ref{point});
}

}  // namespace meso::step
