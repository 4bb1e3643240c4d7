// SPDX-License-Identifier: Apache-2.0
#include "realise_cells.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "boolean.hpp"
#include "solid_primitive.hpp"
#include "solid_shape.hpp"

namespace meso::brep {
namespace {

/// Around the placed prototype: what the box and the ball around it agree on.
Box3 placed_box(const Prototype& prototype, const Affine& placement) {
  Box3 out;
  if (prototype.box.empty()) return out;
  const Box3& box = prototype.box;
  for (int i = 0; i < 8; ++i)
    out.extend(placement *
               Vec3{(i & 1 ? box.max : box.min).x, (i & 2 ? box.max : box.min).y, (i & 4 ? box.max : box.min).z});
  const Vec3 centre = placement * prototype.centre;
  for (std::size_t i = 0; i < 3; ++i) {
    out.min[i] = std::max(out.min[i], centre[i] - prototype.radius);
    out.max[i] = std::min(out.max[i], centre[i] + prototype.radius);
  }
  return out;
}

bool is_rigid(const Affine& map) { return is_similarity(map) && std::fabs(determinant(map.linear) - 1) < 1e-12; }

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
  const Affine system_from_world = inverse_of_rigid(world);
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
    result_.cells.push_back({*prototype, placement_, placed_box(result_.prototypes[*prototype], placement_)});
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
    Prototype prototype;
    prototype.solids = std::move(*solids);
    for (const TopoDS_Shape& solid : prototype.solids) {
      int shells = 0;
      for (TopExp_Explorer it(solid, TopAbs_SHELL); it.More(); it.Next()) ++shells;
      prototype.is_simple = prototype.is_simple && shells == 1;
      for (TopExp_Explorer it(solid, TopAbs_FACE); it.More(); it.Next())
        prototype.surfaces.emplace_back(TopoDS::Face(it.Current()));
      const TopExp_Explorer vertex(solid, TopAbs_VERTEX);
      if (vertex.More()) prototype.anchors.push_back(to_vec(BRep_Tool::Pnt(TopoDS::Vertex(vertex.Current()))));
    }
    enclose(prototype);
    const std::size_t index = result_.prototypes.size();
    result_.prototypes.push_back(std::move(prototype));
    known_.emplace(key, index);
    return index;
  }

  /// Box and ball around the body.
  static void enclose(Prototype& prototype) {
    for (const CarrierSurface& surface : prototype.surfaces) {
      prototype.box.extend(surface.box().min);
      prototype.box.extend(surface.box().max);
    }
    if (prototype.box.empty()) return;
    prototype.centre = (prototype.box.min + prototype.box.max) / 2;
    if (const auto radius = radius_by_edges(prototype)) {
      prototype.radius = *radius;
      return;
    }
    const CoarseMesh& mesh = prototype.mesh();
    if (std::isinf(mesh.error)) {
      prototype.radius = norm(prototype.box.max - prototype.centre);
      return;
    }
    Box3 points;
    for (const Vec3 p : mesh.points) points.extend(p);
    for (std::size_t i = 0; i < 3; ++i) {
      prototype.box.min[i] = std::max(prototype.box.min[i], points.min[i] - mesh.error);
      prototype.box.max[i] = std::min(prototype.box.max[i], points.max[i] + mesh.error);
    }
    prototype.centre = (points.min + points.max) / 2;
    for (const Vec3 p : mesh.points)
      prototype.radius = std::max(prototype.radius, norm(p - prototype.centre) + mesh.error);
  }

  /// Faces that are ruled lie between their edges; of those only lines and circles are measured, and ellipsoids. Empty
  /// for all other bodies.
  static std::optional<double> radius_by_edges(const Prototype& prototype) {
    double radius = 0;
    for (const CarrierSurface& surface : prototype.surfaces) {
      if (const auto ellipsoid = surface.is_closed() ? ellipsoid_of(surface.face()) : std::nullopt) {
        radius = std::max(radius, norm(ellipsoid->map.translation - prototype.centre) + radii_of(*ellipsoid).x);
        continue;
      }
      const GeomAbs_SurfaceType type = BRepAdaptor_Surface(surface.face(), false).GetType();
      if (type != GeomAbs_Plane && type != GeomAbs_Cylinder && type != GeomAbs_Cone) return {};
      for (TopExp_Explorer it(surface.face(), TopAbs_EDGE); it.More(); it.Next()) {
        const TopoDS_Edge& edge = TopoDS::Edge(it.Current());
        for (TopExp_Explorer ends(edge, TopAbs_VERTEX); ends.More(); ends.Next())
          radius = std::max(radius, norm(to_vec(BRep_Tool::Pnt(TopoDS::Vertex(ends.Current()))) - prototype.centre));
        if (BRep_Tool::Degenerated(edge)) continue;
        const BRepAdaptor_Curve curve(edge);
        if (curve.GetType() == GeomAbs_Line) continue;
        if (curve.GetType() != GeomAbs_Circle) return {};
        const Vec3 offset = to_vec(curve.Circle().Location()) - prototype.centre;
        const double along = dot(offset, to_vec(curve.Circle().Axis().Direction()));
        const double across = std::sqrt(std::max(0.0, dot(offset, offset) - along * along));
        radius = std::max(radius, std::hypot(along, across + curve.Circle().Radius()));
      }
    }
    return radius;
  }

  const eval::CellStream& cells_;
  CellPart what_;
  const SolidContext& context_;
  CellSolids result_;
  std::map<Key, std::size_t> known_;
  Affine placement_;
  bool failed_ = false;
};

}  // namespace

const FacetTree* Prototype::facets() const {
  if (!facets_) {
    auto triangles = solids.empty() ? std::nullopt : facets_of(solids);
    facets_.emplace();
    if (triangles) facets_->emplace(std::move(*triangles));
  }
  return *facets_ ? &**facets_ : nullptr;
}

Solids CellSolids::solids_of(const CellSolid& cell) const {
  Solids placed;
  for (const TopoDS_Shape& solid : prototypes[cell.prototype].solids) placed.push_back(mapped(solid, cell.placement));
  return placed;
}

CoarseMesh CellSolids::mesh_of(const CellSolid& cell) const {
  return prototypes[cell.prototype].mesh().placed(cell.placement);
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

}  // namespace meso::brep
