// SPDX-License-Identifier: Apache-2.0
#include "shape_field.hpp"

#include <algorithm>

#include "affine_map.hpp"
#include "far_from_mesh.hpp"
#include "meso/eval/bounds.hpp"
#include "meso/mesh_distance/mesh_field.hpp"
#include "polygon_term.hpp"
#include "polyhedron_field.hpp"
#include "prism.hpp"
#include "volume_element.hpp"

namespace meso::implicit {

Field moved(const Field& field, const Affine& map) {
  if (map == Affine{}) return field;
  if (map.linear == Mat3{}) return field.translated(map.translation);
  return field.mapped(map, inverse(map), least_stretch(map.linear));
}

Field joined(const Field& a, const Field& b) { return union_of(a.offset(seam), b.offset(seam)); }

Field nothing() { return Field::from_term(Term::constant(1e30)); }

void Reporter::operator()(Code code, ElementId where, std::vector<std::string> args, std::string_view attribute) const {
  const SourceMap& source = evaluation_.checked().source();
  sink_.report({.code = code,
                .where = attribute.empty() ? source.span(where) : source.span(where, attribute),
                .path = source.path(where, attribute),
                .args = std::move(args)});
}

struct ShapeFields::Maker {
  ShapeFields& self;
  ElementId source;

  using Result = std::optional<Field>;

  template <class S>
  void see_bounds(const S& s) const {
    const Box3 box = *eval::bounds(eval::Shape{s});
    const Vec3 size = box.max - box.min;
    self.see(std::min({size.x, size.y, size.z}));
  }

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
  Result operator()(const eval::RevolutionShape& s) const {
    see_bounds(s);
    return revolution(s);
  }
  Result operator()(const eval::PolyhedronShape& s) const {
    see_bounds(s);
    return polyhedron_field(s.body, self.options_.run, self.report_.sink());
  }
  Result operator()(const eval::VolumeElementShape& s) const {
    self.see(shortest_edge_of(s));
    const auto field = volume_element(s);
    if (!field) self.report_(Code::conformal_not_inverted, source, {});
    return field;
  }
  Result operator()(const eval::ImportShape& s) const {
    const auto field = self.import(s);
    if (!field) return std::nullopt;
    const double k = s.scale;
    return moved(*field, s.transform * Affine{Mat3::from_columns({k, 0, 0}, {0, k, 0}, {0, 0, k}), {}});
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

namespace {

/// A prism's distance is a table; that to other meshes is searched for.
std::optional<Field> field_of(const TriangleMesh& mesh, const std::string& name, const RunOptions& run,
                              DiagnosticSink& sink) {
  const auto distance = MeshField::make(mesh, name, run, sink);
  if (!distance) return std::nullopt;
  const MeshQuality& found = distance->quality();
  const bool as_it_stands = found.closed && !found.inside_out &&
                            found.degenerate + found.cancelled + found.repeated + found.turned + found.buried == 0;
  if (as_it_stands)
    if (auto prism = prism_field(mesh)) return prism;
  if (distance->lipschitz() > 1) return Field::external(distance);
  return Field::external(std::make_shared<const FarFromMesh>(distance));
}

}  // namespace

std::optional<Field> ShapeFields::import(const eval::ImportShape& shape) {
  if (const auto known = imports_.find(shape.file.name()); known != imports_.end()) return known->second;
  std::optional<Field> field;
  if (const auto mesh = options_.imports ? options_.imports(shape, report_.sink()) : std::nullopt)
    field = field_of(*mesh, shape.file.name().string(), options_.run, report_.sink());
  return imports_.emplace(shape.file.name(), field).first->second;
}

}  // namespace meso::implicit
