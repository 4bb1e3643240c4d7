// SPDX-License-Identifier: Apache-2.0
#include "lattice/jointed_cell.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "in_memory.hpp"
#include "lattice/cell_walls.hpp"
#include "lattice/union_find.hpp"

namespace meso::brep {
namespace {

using Place = JointedBox::Place;

class CellMaker {
 public:
  CellMaker(const JointedBox& box, std::string& why)
      : box_(box), why_(why), edges_(*geometry_, box.tolerance), sectors_(box, edges_) {}

  bool make(int variant) {
    if (!sectors_.divide(why_) || !sectors_.add_faces(variant, geometry_->faces, why_)) return false;
    for (std::uint32_t s = 0; s < box_.places.size(); ++s)
      if (box_.places[s] != Place::beyond && !box_.joints.is_swallowed[s] && !add_strut(s)) return false;
    return add_walls(box_, sectors_, lines_, edges_, geometry_->faces, why_) && is_closed();
  }

  /// A solid for each connected part.
  [[nodiscard]] Body body() const {
    const auto& faces = geometry_->faces;
    UnionFind joined(faces.size());
    std::map<std::uint32_t, std::uint32_t> face_at;
    for (std::uint32_t f = 0; f < faces.size(); ++f)
      for (const auto& loop : faces[f].loops)
        for (const Coedge& use : loop) joined.join(face_at.try_emplace(use.edge, f).first->second, f);
    std::map<std::uint32_t, std::vector<std::uint32_t>> parts;
    for (std::uint32_t f = 0; f < faces.size(); ++f) parts[joined.root(f)].push_back(f);
    Body out;
    for (const auto& part : parts)
      out.solids.push_back({.outer = {.geometry = geometry_,
                                      .placement = {},
                                      .visit =
                                          [list = part.second](const auto& callback) {
                                            for (const std::uint32_t f : list) callback({f, {}});
                                          }},
                            .voids = {}});
    return out;
  }

 private:
  bool refuse(const char* why) {
    why_ = why;
    return false;
  }

  bool add_strut(std::uint32_t s) {
    const Joints& joints = box_.joints;
    const Vec3 axis = joints.direction(2 * s);
    std::array<Vec3, 2> middles;
    std::array<std::vector<Coedge>, 2> rings;  // as the strut uses them
    for (const std::uint32_t end : {0u, 1u}) {
      const Leaving l = 2 * s + end;
      middles[end] = joints.graph.nodes[joints.node(l)].position + joints.end(l).along * joints.direction(l);
      for (const Coedge& use : sectors_.ring(l)) rings[end].push_back(turned(use));
    }
    FaceTemplate face;
    const double first = joints.end(2 * s).radius, second = joints.end(2 * s + 1).radius;
    const double length = norm(middles[1] - middles[0]);
    const double half_angle = std::atan(std::fabs(second - first) / length);
    const bool is_free = box_.places[s] == Place::inside;
    const Vec3 x = is_free ? seam_direction(s, middles[0]) : off_face(s, axis);
    if (joints.graph.struts[s].radius[0] == joints.graph.struts[s].radius[1])
      face.surface = CylinderSurface{{middles[0], axis, x}, first};
    else if (second > first)
      face.surface = ConeSurface{{middles[0], axis, x}, first, half_angle};
    else
      face.surface = ConeSurface{{middles[1], -axis, x}, second, half_angle};
    if (!(is_free ? close_free(s, rings, face) : close_in_sides(s, rings, face))) return false;
    geometry_->faces.push_back(std::move(face));
    return true;
  }

  [[nodiscard]] Vec3 seam_direction(std::uint32_t s, Vec3 middle) const {
    const Vec3 way = edges_.at(sectors_.seam(2 * s)) - middle;
    return way / norm(way);
  }
  /// Out of the box, where no face is.
  [[nodiscard]] Vec3 off_face(std::uint32_t s, Vec3 axis) const {
    Vec3 out;
    for (const Side side : box_.in_sides[s]) out += outward(side);
    out = out - dot(out, axis) * axis;
    return out / norm(out);
  }

  /// Both circles, from the seam to the seam.
  bool close_free(std::uint32_t s, const std::array<std::vector<Coedge>, 2>& rings, FaceTemplate& face) {
    const Coedge seam = edges_.line(sectors_.seam(2 * s), sectors_.seam(2 * s + 1));
    auto& loop = face.loops.emplace_back();
    for (const std::uint32_t end : {0u, 1u}) {
      auto around = chained(edges_, rings[end]);
      if (around.size() != 1) return refuse("a strut's circle is broken");
      auto& uses = around.front();
      const auto first = std::ranges::find_if(
          uses, [&](const Coedge& use) { return edges_.start(use) == sectors_.seam(2 * s + end); });
      std::rotate(uses.begin(), first, uses.end());
      loop.insert(loop.end(), uses.begin(), uses.end());
      loop.push_back(end == 0 ? seam : turned(seam));
    }
    return true;
  }

  /// A part of both circles, and a line in a side from either end to the other's beginning.
  bool close_in_sides(std::uint32_t s, std::array<std::vector<Coedge>, 2>& rings, FaceTemplate& face) {
    for (auto& ring : rings)
      if (!put_in_row(ring)) return refuse("a strut's circle in a side of the box is broken");
    auto& loop = face.loops.emplace_back();
    for (const std::uint32_t end : {0u, 1u}) {
      loop.insert(loop.end(), rings[end].begin(), rings[end].end());
      const std::uint32_t from = edges_.end(rings[end].back()), to = edges_.start(rings[1 - end].front());
      const Coedge line = edges_.line(from, to);
      loop.push_back(line);
      const auto in = std::ranges::find_if(box_.in_sides[s], [&](Side side) {
        return box_.depth(edges_.at(from), side) == 0 && box_.depth(edges_.at(to), side) == 0;
      });
      if (in == box_.in_sides[s].end()) return refuse("a strut leaves the side that it runs in");
      lines_[*in].push_back(line);
    }
    return true;
  }

  /// Arcs that are one behind the other, the first one first.
  bool put_in_row(std::vector<Coedge>& arcs) const {
    for (std::size_t i = 0; i < arcs.size(); ++i) {
      // Before it stands nothing; then what follows the one before.
      const auto fits = std::find_if(arcs.begin() + static_cast<std::ptrdiff_t>(i), arcs.end(), [&](const Coedge& use) {
        if (i > 0) return edges_.start(use) == edges_.end(arcs[i - 1]);
        return std::ranges::none_of(arcs, [&](const Coedge& o) { return edges_.end(o) == edges_.start(use); });
      });
      if (fits == arcs.end()) return false;
      std::iter_swap(arcs.begin() + static_cast<std::ptrdiff_t>(i), fits);
    }
    return !arcs.empty();
  }

  /// Each edge is used once in each direction.
  bool is_closed() {
    std::vector<std::array<int, 2>> uses(geometry_->edges.size());
    for (const FaceTemplate& face : geometry_->faces)
      for (const auto& loop : face.loops)
        for (const Coedge& use : loop) ++uses[use.edge][use.reversed ? 1 : 0];
    for (const auto& [forward, back] : uses)
      if (forward != back || forward > 1) return refuse("the faces in a box do not close");
    return true;
  }

  const JointedBox& box_;
  std::string& why_;
  std::shared_ptr<Template> geometry_ = std::make_shared<Template>();
  CellEdges edges_;
  BallSectors sectors_;
  std::array<std::vector<Coedge>, 6> lines_;  ///< of struts in the sides, as these use them
};

}  // namespace

std::optional<TopoDS_Shape> jointed_cell(const std::vector<CellPrimitive>& primitives, const Box3& box,
                                         double tolerance, int variant, std::string& why) {
  const auto jointed = jointed_box(primitives, box, tolerance, why);
  if (!jointed) return {};
  CellMaker maker(*jointed, why);
  if (!maker.make(variant)) return {};
  const Body body = maker.body();
  if (body.solids.empty()) return TopoDS_Shape();
  DiagnosticSink sink;
  auto shape = to_shape_as_is(body, sink);
  if (!shape) why = "the faces in a box cannot be built";
  return shape;
}

}  // namespace meso::brep
