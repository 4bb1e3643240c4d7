// SPDX-License-Identifier: Apache-2.0
#include "solid_shape.hpp"

#include "boolean.hpp"
#include "import_solid.hpp"
#include "solid_beams.hpp"
#include "solid_primitive.hpp"

namespace meso::brep {
namespace {

using Result = std::optional<Solids>;

class Builder {
 public:
  Builder(const Affine& map, ElementId where, const SolidContext& context)
      : map_(map), where_(where), context_(context) {}

  template <class Primitive>
  Result operator()(const Primitive& primitive) const {
    const OptionalSolid solid = primitive_solid(primitive, map_, where_, context_);
    if (!solid) return {};
    return Solids{*solid};
  }
  Result operator()(const eval::PolyhedronShape& polyhedron) const {
    return polyhedron_solids(polyhedron, map_, where_, context_);
  }
  Result operator()(const eval::ImportShape& import) const { return import_solids(import, map_, where_, context_); }
  Result operator()(const eval::BeamsShape& beams) const {
    const Result primitives = beam_primitives(beams, map_, where_, context_);
    return primitives ? fuse(*primitives, where_, context_) : std::nullopt;
  }
  Result operator()(const eval::TransformedShape& transformed) const {
    return unite(transformed.operands, map_ * transformed.map);
  }
  Result operator()(const eval::BooleanShape& boolean) const {
    const std::vector<eval::Shape>& operands = boolean.operands;
    if (operands.empty()) return Solids{};
    if (boolean.operation == BooleanOperation::union_) return unite(operands, map_);
    Result result = solid_from_shape(operands.front(), map_, context_);
    if (boolean.operation == BooleanOperation::difference) {
      const Result tools = gather({operands.begin() + 1, operands.end()}, map_);
      return result && tools ? cut(*result, *tools, where_, context_) : std::nullopt;
    }
    for (std::size_t i = 1; result && i < operands.size(); ++i) {
      const Result next = solid_from_shape(operands[i], map_, context_);
      result = next ? common(*result, *next, where_, context_) : std::nullopt;
    }
    return result;
  }
  Result operator()(const eval::ImplicitShape&) const { return not_realised("an implicit body"); }
  Result operator()(const eval::PartShape& shape) const {
    if (context_.parts == nullptr) return not_realised("a part as the body of a unit cell");
    const Solids* made = context_.parts->solids_of(*shape.part);
    if (made == nullptr) return {};
    Solids solids = *made;
    for (TopoDS_Shape& solid : solids) solid = mapped(solid, map_);
    return solids;
  }

 private:
  Result not_realised(const char* what) const {
    context_.report(Code::brep_not_realised, where_, {what});
    return {};
  }
  /// The solids of all operands; they may overlap.
  Result gather(const std::vector<eval::Shape>& operands, const Affine& map) const {
    Solids all;
    for (const eval::Shape& operand : operands) {
      const Result solids = solid_from_shape(operand, map, context_);
      if (!solids) return {};
      all.insert(all.end(), solids->begin(), solids->end());
    }
    return all;
  }
  Result unite(const std::vector<eval::Shape>& operands, const Affine& map) const {
    const Result all = gather(operands, map);
    return all ? fuse(*all, where_, context_) : std::nullopt;
  }

  const Affine& map_;
  ElementId where_;
  const SolidContext& context_;
};

}  // namespace

std::optional<Solids> solid_from_shape(const eval::Shape& shape, const Affine& map, const SolidContext& context) {
  if (!(std::fabs(determinant(map.linear)) > 0) || !std::isfinite(determinant(map.linear))) {
    context.report(Code::geometry_size, shape.source, {"the determinant of a transform", "0 or not finite"});
    return {};
  }
  try {
    return std::visit(Builder(map, shape.source, context), shape.value);
  } catch (const Standard_Failure& failure) {
    context.report(Code::geometry_kernel, shape.source, {"making a solid", what(failure)});
    return {};
  }
}

}  // namespace meso::brep
