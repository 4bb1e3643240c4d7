// SPDX-License-Identifier: Apache-2.0
#include "shape_field.hpp"

#include <algorithm>

#include "affine_map.hpp"
#include "far_from_mesh.hpp"
#include "meso/mesh_distance/mesh_field.hpp"
#include "polygon_term.hpp"
#include "volume_element.hpp"

namespace meso::implicit {

Field moved(const Field& field, const Affine& map) {
  if (map == Affine{}) return field;
  if (map.linear == Mat3{}) return field.translated(map.translation);
  return field.mapped(map, inverse(map), least_stretch(map.linear));
}

Field joined(const Field& a, const Field& b) { return union_of(a.offset(seam), b.offset(seam)); }

Field nothing() { return Field::from_term(Term::constant(1e30)); }

void Reporter::operator()(Code code, ElementId where, std::vector<std::string> args) const {
  sink_.report({.code = code,
                .where = evaluation_.checked().source().span(where),
                .path = evaluation_.checked().source().path(where),
                .args = std::move(args)});
}

struct ShapeFields::Maker {
  ShapeFields& self;
  ElementId source;

  using Result = std::optional<Field>;

  Result operator()(const eval::BoxShape& s) const {
    self.see(std::min({s.size.x, s.size.y, s.size.z}));
    return Field::box(0.5 * s.size).translated(s.corner + 0.5 * s.size);
  }
  Result operator()(const eval::SphereShape& s) const {
    self.see(2 * s.radius);
    return Field::ball(s.radius).translated(s.center);
  }
  Result operator()(const eval::EllipsoidShape& s) const {
    self.see(2 * std::min({s.radii.x, s.radii.y, s.radii.z}));
    return Field::ball(1).scaled(s.radii).translated(s.center);
  }
  Result operator()(const eval::CylinderShape& s) const {
    return (*this)(eval::ConeShape{s.from, s.to, s.radius, s.radius});
  }
  Result operator()(const eval::ConeShape& s) const {
    self.see(std::min(2 * std::max(s.radius_from, s.radius_to), norm(s.to - s.from)));
    return Field::cone(s.radius_from, s.radius_to, norm(s.to - s.from)).oriented(s.to - s.from).translated(s.from);
  }
  Result operator()(const eval::TorusShape& s) const {
    self.see(2 * s.minor_radius);
    return Field::torus(s.major_radius, s.minor_radius).oriented(s.axis).translated(s.center);
  }
  Result operator()(const eval::ExtrusionShape& s) const {
    self.see(s.height);
    return extrusion(s);
  }
  Result operator()(const eval::VolumeElementShape& s) const {
    self.see(shortest_edge_of(s));
    const auto field = volume_element(s);
    if (!field) self.report_(Code::conformal_not_inverted, source, {});
    return field;
  }
  Result operator()(const eval::ImportShape& s) const {
    const auto mesh = self.import(s);
    if (!mesh) return std::nullopt;
    const double k = s.scale;
    return moved(Field::external(mesh), s.transform * Affine{Mat3::from_columns({k, 0, 0}, {0, k, 0}, {0, 0, k}), {}});
  }
  Result operator()(const eval::BooleanShape& s) const {
    std::optional<Field> result;
    for (const eval::Shape& operand : s.operands) {
      const auto field = self.make(operand);
      if (!field) return std::nullopt;
      result = !result                                       ? *field
               : s.operation == BooleanOperation::union_     ? joined(*result, *field)
               : s.operation == BooleanOperation::difference ? difference_of(*result, field->offset(seam))
                                                             : intersection_of(*result, *field);
    }
    return result ? result : nothing();
  }
  Result operator()(const eval::TransformedShape& s) const {
    const auto inner = (*this)(eval::BooleanShape{BooleanOperation::union_, s.operands});
    return inner ? std::optional(moved(*inner, s.map)) : std::nullopt;
  }
  Result operator()(const eval::PartShape& s) const { return self.make_part_(*s.part); }
  Result operator()(const eval::BeamsShape&) const { return nothing(); }
  Result operator()(const eval::ImplicitShape&) const { return nothing(); }
};

std::optional<Field> ShapeFields::make(const eval::Shape& shape) {
  return std::visit(Maker{*this, shape.source}, shape.value);
}

std::shared_ptr<const ExternalField> ShapeFields::import(const eval::ImportShape& shape) {
  if (const auto known = imports_.find(shape.file); known != imports_.end()) return known->second;
  std::shared_ptr<const ExternalField> field;
  if (const auto mesh = options_.imports ? options_.imports(shape, report_.sink()) : std::nullopt)
    field = MeshField::make(*mesh, shape.file.string(), options_.run, report_.sink());
  if (field && field->lipschitz() <= 1) field = std::make_shared<const FarFromMesh>(field);
  imports_.emplace(shape.file, field);
  return field;
}

}  // namespace meso::implicit
