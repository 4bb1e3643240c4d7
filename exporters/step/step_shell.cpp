// SPDX-License-Identifier: Apache-2.0
#include "step_shell.hpp"

#include "sphere_frame.hpp"

namespace meso::step {

using namespace brep;

void ShellWriter::write_face(const FaceInstance& instance) {
  const FaceTemplate& face = template_.faces[instance.face];
  const auto* const ball = std::get_if<SphereSurface>(&face.surface);
  if (ball == nullptr) return write_piece(face, instance.cell, nullptr);
  const SphereFace& sphere = sphere_face(*ball, instance.face);
  if (growing_ != nullptr && sphere.touches_itself) ++growing_->touching;
  const bool is_cut = !sphere.cut.edges.empty();
  if (is_cut) write_cut(sphere.cut, instance.cell);
  for (const FaceTemplate& piece : sphere.pieces) write_piece(piece, instance.cell, is_cut ? &sphere.cut : nullptr);
}

void ShellWriter::write_piece(const FaceTemplate& face, const Index3& cell, const SpherePieces* cut) {
  bounds_.clear();
  for (const auto& loop : face.loops) {
    const StepId written = write_loop(loop, cell, cut);
    bounds_.push_back(text_.entity("FACE_BOUND", NoName{}, Ref{written}, true));
  }
  pose_.set_cell(cell);
  const StepId surface = geometry_.surface(face.surface, pose_);
  const StepId written = text_.entity("ADVANCED_FACE", NoName{}, bounds_, Ref{surface}, !face.reversed);
  if (growing_ != nullptr) growing_->faces.push_back(written);
}

/// What divides a face belongs to no other, and each of its instances has its own.
void ShellWriter::write_cut(const SpherePieces& cut, const Index3& cell) {
  std::vector<StepId> vertices;
  pose_.set_cell(cell);
  for (std::size_t v = cut.vertices.size(); v < cut.border.vertices.size(); ++v) {
    const StepId point = geometry_.point(pose_.point(cut.border.vertices[v]));
    vertices.push_back(text_.entity("VERTEX_POINT", NoName{}, Ref{point}));
  }
  cut_edges_.clear();
  for (std::size_t e = cut.edges.size(); e < cut.border.edges.size(); ++e) {
    const EdgeTemplate& edge = cut.border.edges[e];
    const auto vertex = [&](std::size_t k) {
      return edge.vertex[k] < cut.vertices.size()
                 ? vertex_id(cut.vertices[edge.vertex[k]], cell + edge.vertex_offset[k])
                 : vertices[edge.vertex[k] - cut.vertices.size()];
    };
    const StepId first = vertex(0), last = vertex(1);
    pose_.set_cell(cell);
    const StepId curve = geometry_.curve(edge.curve, pose_);
    cut_edges_.push_back(text_.entity("EDGE_CURVE", NoName{}, Ref{first}, Ref{last}, Ref{curve}, true));
  }
}

const SphereFace& ShellWriter::sphere_face(const SphereSurface& sphere, std::uint32_t index) {
  SphereFaces& spheres = *known_.spheres;
  if (const auto found = spheres.find(index); found != spheres.end()) return found->second;
  const FaceTemplate& face = template_.faces[index];
  SphereFace& made = spheres[index];
  made.cut = divided(sphere, face, template_);
  const bool is_cut = !made.cut.edges.empty();
  made.pieces =
      is_cut ? std::move(made.cut.pieces) : std::vector{FaceTemplate{face.surface, face.reversed, face.loops}};
  for (FaceTemplate& piece : made.pieces) {
    const Template& border = is_cut ? made.cut.border : template_;
    Loops plain = plain_loops(piece, border);
    if (plain.empty()) continue;
    made.touches_itself = made.touches_itself || touch(plain, border);
    piece.loops = std::move(plain);
    piece.surface = SphereSurface{clear_frame(sphere, piece, border), sphere.radius};
  }
  return made;
}

// Edges without a curve (poles, apexes) have no place in STEP; a loop of nothing else is a point.
StepId ShellWriter::write_loop(const std::vector<Coedge>& loop, const Index3& cell, const SpherePieces* cut) {
  coedges_.clear();
  for (const Coedge& use : loop) {
    const bool is_own = cut != nullptr && use.edge >= cut->edges.size();
    const std::uint32_t index = cut == nullptr || is_own ? use.edge : cut->edges[use.edge];
    if (!is_own && template_.edges[index].degenerate) continue;
    const StepId edge = is_own ? cut_edges_[index - cut->edges.size()] : edge_id(index, cell + use.offset);
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
