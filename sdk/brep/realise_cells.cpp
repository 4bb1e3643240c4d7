// SPDX-License-Identifier: Apache-2.0
#include "realise_cells.hpp"

#include <algorithm>
#include <cstdint>
#include <map>

#include "boolean.hpp"
#include "solid_primitive.hpp"
#include "solid_shape.hpp"

namespace meso::brep {
namespace {

Box3 placed_box(const Box3& box, const Affine& placement) {
  Box3 out;
  for (int i = 0; i < 8; ++i)
    out.extend(placement *
               Vec3{(i & 1 ? box.max : box.min).x, (i & 2 ? box.max : box.min).y, (i & 4 ? box.max : box.min).z});
  return out;
}

bool is_rigid(const Affine& map) { return is_similarity(map) && std::fabs(determinant(map.linear) - 1) < 1e-12; }

/// Inverse of a rigid map.
Affine inverse(const Affine& rigid) {
  const Mat3 back = transposed(rigid.linear);
  return {back, -(back * rigid.translation)};
}

using Key = std::vector<double>;

/// Rounded so that sums in another order give the same key.
double rounded(double value) { return std::nearbyint(value * 1e9) / 1e9; }

/// A cell's body as a prototype under a map, and where the prototype stands.
struct Placed {
  Key key;
  Affine map;  ///< prototype_from_shape
  eval::Shape shape;
  Affine placement;  ///< world_from_prototype
};

const eval::Shape& innermost(const eval::Shape& shape) {
  const auto* boolean = std::get_if<eval::BooleanShape>(&shape.value);
  return boolean != nullptr && boolean->operands.size() == 1 ? innermost(boolean->operands.front()) : shape;
}

/// Elements of a ring are turns of one element about the outermost circular axis, and layers are translates.
Placed canonical(eval::VolumeElementShape element, ElementId source) {
  const auto& axes = element.system->axes();
  const Affine& world = element.system->world_from_system();
  const auto circular = std::ranges::find(axes, AxisKind::circular, &eval::CoordinateAxis::kind);
  Affine move;  // in the system's frame
  bool may_turn = circular != axes.end();
  for (std::size_t i = 0; i < 3; ++i) {
    const eval::CoordinateAxis& axis = axes[element.axes[i]];
    if (axis.kind != AxisKind::linear) continue;
    move.translation += element.from[i] * axis.direction;
    element.to[i] -= element.from[i];
    element.from[i] = 0;
    if (may_turn && norm(cross(axis.direction, circular->direction)) > 1e-12) may_turn = false;
  }
  for (std::size_t i = 0; may_turn && i < 3; ++i) {
    if (&axes[element.axes[i]] != &*circular) continue;
    move.linear = rotation(circular->direction, element.from[i]);
    element.to[i] -= element.from[i];
    element.from[i] = 0;
  }
  Key key;
  for (std::size_t i = 0; i < 3; ++i) {
    key.push_back(rounded(element.from[i]));
    key.push_back(rounded(element.to[i]));
  }
  const Affine system_from_world = inverse(world);
  return {std::move(key), {}, {std::move(element), source}, world * move * system_from_world};
}

/// Cells whose body belongs to them alone: the ordinal is the key.
Placed single(const eval::PlacedCell& cell, eval::Shape shape, const Affine& map) {
  return {{static_cast<double>(cell.ordinal)}, map, std::move(shape), {}};
}

class Collector {
 public:
  Collector(const eval::CellStream& cells, CellPart what, const SolidContext& context)
      : cells_(cells), what_(what), context_(context) {}

  bool collect(std::uint64_t first, std::uint64_t last) {
    const bool complete = cells_.visit(
        first, last, [&](const eval::PlacedCell& cell) { return add(cell); }, context_.sink);
    return complete && !failed_;
  }
  CellSolids take() && { return std::move(result_); }

 private:
  bool add(const eval::PlacedCell& cell) {
    const std::optional<std::size_t> prototype = place(cell);
    failed_ = !prototype;
    if (!prototype) return false;
    result_.cells.push_back({*prototype, placement_, placed_box(result_.prototypes[*prototype].box, placement_)});
    return true;
  }

  std::optional<std::size_t> place(const eval::PlacedCell& cell) {
    if (cell.mapping == CellMapping::rigid && !(what_ == CellPart::body && cells_.shape_varies())) {
      const bool rigid = is_rigid(cell.world_from_cell);
      const Affine map{rigid ? Mat3{} : cell.world_from_cell.linear, {}};
      placement_ = rigid ? cell.world_from_cell : Affine::from_translation(cell.world_from_cell.translation);
      Key key(cell.parameters.begin(), cell.parameters.end());
      key.insert(key.end(), map.linear.m.begin(), map.linear.m.end());
      if (const auto known = known_.find(key); known != known_.end()) return known->second;
      auto shape = shape_of(cell);
      return shape ? make(key, *shape, map) : std::nullopt;
    }
    auto shape = shape_of(cell);
    if (!shape) return {};
    const auto* element = std::get_if<eval::VolumeElementShape>(&innermost(*shape).value);
    Placed placed = cell.mapping == CellMapping::rigid ? single(cell, *shape, cell.world_from_cell)
                    : element != nullptr               ? canonical(*element, innermost(*shape).source)
                                                       : single(cell, *shape, {});
    placement_ = placed.placement;
    if (const auto known = known_.find(placed.key); known != known_.end()) return known->second;
    return make(placed.key, placed.shape, placed.map);
  }

  [[nodiscard]] std::optional<eval::Shape> shape_of(const eval::PlacedCell& cell) const {
    auto shape = what_ == CellPart::body ? cells_.shape(cell, context_.sink) : cells_.cell_region(cell, context_.sink);
    if (!shape || what_ != CellPart::body || !cells_.unit_cell().clip_to_box.value_or(false)) return shape;
    auto region = cells_.cell_region(cell, context_.sink);
    if (!region) return {};
    const ElementId source = shape->source;
    return eval::Shape{eval::BooleanShape{BooleanOperation::intersection, {std::move(*shape), std::move(*region)}},
                       source};
  }

  std::optional<std::size_t> make(const Key& key, const eval::Shape& shape, const Affine& map) {
    auto solids = solid_from_shape(shape, map, context_);
    if (!solids) return {};
    Prototype prototype{.solids = std::move(*solids), .box = {}, .mesh = {}, .surfaces = {}};
    for (const TopoDS_Shape& solid : prototype.solids) {
      int shells = 0;
      for (TopExp_Explorer it(solid, TopAbs_SHELL); it.More(); it.Next()) ++shells;
      prototype.is_simple = prototype.is_simple && shells == 1;
      for (TopExp_Explorer it(solid, TopAbs_FACE); it.More(); it.Next())
        prototype.surfaces.emplace_back(TopoDS::Face(it.Current()));
    }
    for (const CarrierSurface& surface : prototype.surfaces) {
      prototype.box.extend(surface.box().min);
      prototype.box.extend(surface.box().max);
    }
    prototype.mesh = coarse_mesh(prototype.solids);
    for (const TopoDS_Shape& solid : prototype.solids) {
      const CoarseMesh mesh = coarse_mesh({solid});
      if (!mesh.points.empty()) prototype.anchors.push_back(mesh.points.front());
    }
    const std::size_t index = result_.prototypes.size();
    result_.prototypes.push_back(std::move(prototype));
    known_.emplace(key, index);
    return index;
  }

  const eval::CellStream& cells_;
  CellPart what_;
  const SolidContext& context_;
  CellSolids result_;
  std::map<Key, std::size_t> known_;
  Affine placement_;
  bool failed_ = false;
};

bool boxes_near(const Box3& a, const Box3& b) {
  const Vec3 d{clear_distance, clear_distance, clear_distance};
  return Box3{a.min - d, a.max + d}.intersects(b);
}

/// Pairs of cells stand in few different ways to each other: each is decided once.
class Neighbours {
 public:
  explicit Neighbours(const CellSolids& cells) : cells_(cells) {}

  bool touch(const CellSolid& a, const CellSolid& b) {
    const Affine a_from_b = inverse(a.placement) * b.placement;
    std::vector<std::int64_t> key{static_cast<std::int64_t>(a.prototype), static_cast<std::int64_t>(b.prototype)};
    for (const double m : a_from_b.linear.m) key.push_back(std::llround(m * 1e8));
    for (std::size_t i = 0; i < 3; ++i) key.push_back(std::llround(a_from_b.translation[i] * 1e7));
    const auto [known, fresh] = known_.try_emplace(std::move(key), false);
    if (fresh) known->second = decide(cells_.prototypes[a.prototype], cells_.prototypes[b.prototype], a_from_b);
    return known->second;
  }

 private:
  static bool decide(const Prototype& a, const Prototype& b, const Affine& a_from_b) {
    if (holds_a_solid(a, b, a_from_b) || holds_a_solid(b, a, inverse(a_from_b))) return true;
    if (proven_apart(a.surfaces, a.mesh, b.mesh.placed(a_from_b))) return false;
    if (proven_apart(b.surfaces, b.mesh, a.mesh.placed(inverse(a_from_b)))) return false;
    if (proven_to_touch(a, b.mesh, a_from_b) || proven_to_touch(b, a.mesh, inverse(a_from_b))) return true;
    for (const TopoDS_Shape& solid : a.solids)
      for (const TopoDS_Shape& other : b.solids)
        if (exact_distance(solid, mapped(other, a_from_b)) <= clear_distance) return true;
    return false;
  }

  /// A solid that lies within another keeps clear of its surface, and yet the two overlap.
  static bool holds_a_solid(const Prototype& a, const Prototype& b, const Affine& a_from_b) {
    return std::ranges::any_of(b.anchors, [&](Vec3 anchor) {
      const Vec3 p = a_from_b * anchor;
      if (!a.box.intersects({p, p})) return false;
      return std::ranges::any_of(a.solids, [&](const TopoDS_Shape& solid) {
        BRepClass3d_SolidClassifier classifier(solid, to_pnt(p), clear_distance);
        return classifier.State() == TopAbs_IN;
      });
    });
  }

  /// A corner of the mesh, which lies on its body, is in or on the other: takes milliseconds, the distance a tenth of a
  /// second.
  static bool proven_to_touch(const Prototype& a, const CoarseMesh& mesh, const Affine& a_from_mesh) {
    std::vector<Vec3> near;
    for (const Vec3 point : mesh.points) {
      const Vec3 p = a_from_mesh * point;
      if (boxes_near(a.box, {p, p})) near.push_back(p);
    }
    if (near.empty()) return false;
    return std::ranges::any_of(a.solids, [&](const TopoDS_Shape& solid) {
      BRepClass3d_SolidClassifier classifier(solid);
      return std::ranges::any_of(near, [&](Vec3 p) {
        classifier.Perform(to_pnt(p), clear_distance);
        return classifier.State() == TopAbs_IN || classifier.State() == TopAbs_ON;
      });
    });
  }

  const CellSolids& cells_;
  std::map<std::vector<std::int64_t>, bool> known_;
};

}  // namespace

Solids CellSolids::solids_of(const CellSolid& cell) const {
  Solids placed;
  for (const TopoDS_Shape& solid : prototypes[cell.prototype].solids) placed.push_back(mapped(solid, cell.placement));
  return placed;
}

CoarseMesh CellSolids::mesh_of(const CellSolid& cell) const {
  return prototypes[cell.prototype].mesh.placed(cell.placement);
}

std::vector<Vec3> CellSolids::anchors_of(const CellSolid& cell) const {
  std::vector<Vec3> placed = prototypes[cell.prototype].anchors;
  for (Vec3& anchor : placed) anchor = cell.placement * anchor;
  return placed;
}

std::optional<CellSolids> cell_solids(const eval::CellStream& cells, CellPart what, const SolidContext& context) {
  Collector collector(cells, what, context);
  if (!collector.collect(0, cells.size())) return {};
  return std::move(collector).take();
}

std::optional<CellSolids> cell_solids_at(const eval::CellStream& cells, std::span<const std::uint64_t> ordinals,
                                         CellPart what, const SolidContext& context) {
  Collector collector(cells, what, context);
  for (const std::uint64_t ordinal : ordinals)
    if (!collector.collect(ordinal, ordinal + 1)) return {};
  return std::move(collector).take();
}

std::vector<bool> touching_cells(const CellSolids& cells) {
  std::vector<bool> touching(cells.cells.size(), false);
  // A sweep along x: only cells whose x-intervals meet are compared.
  std::vector<std::size_t> order(cells.cells.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return cells.cells[i].box.min.x; });
  Neighbours neighbours(cells);
  std::vector<std::size_t> open;
  for (const std::size_t i : order) {
    const Box3& box = cells.cells[i].box;
    std::erase_if(open, [&](std::size_t k) { return cells.cells[k].box.max.x < box.min.x - clear_distance; });
    for (const std::size_t k : open) {
      if (!boxes_near(cells.cells[k].box, box) || (touching[i] && touching[k])) continue;
      if (neighbours.touch(cells.cells[std::min(i, k)], cells.cells[std::max(i, k)])) touching[i] = touching[k] = true;
    }
    open.push_back(i);
  }
  return touching;
}

}  // namespace meso::brep
