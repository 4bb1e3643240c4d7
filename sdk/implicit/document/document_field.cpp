// SPDX-License-Identifier: Apache-2.0
#include "meso/implicit/document_field.hpp"

#include <algorithm>
#include <cmath>

#include "boundary_rule.hpp"
#include "fragments.hpp"
#include "meso/base/number.hpp"
#include "meso/base/unit.hpp"
#include "meso/eval/bounds.hpp"
#include "meso/eval/pattern_reach.hpp"
#include "pattern_field.hpp"
#include "shape_field.hpp"

namespace meso::implicit {
namespace {

class PartMaker {
 public:
  PartMaker(const eval::Evaluation& evaluation, const DocumentFieldOptions& options, DiagnosticSink& sink)
      : evaluation_(evaluation),
        options_(options),
        report_(evaluation, sink),
        shapes_(report_, options, [this](const Part& part) { return make(part); }) {}

  std::optional<Field> make(const Part& part) {
    std::optional<Field> body;
    if (part.macrostructure) {
      body = macrostructure(part.macrostructure->text);
      if (!body) return std::nullopt;
    }
    for (const Apply& apply : part.steps) {
      const Body before = body;
      body = apply.pattern ? with_cells(body, part, apply) : with_part(body, apply);
      if (body && before && apply.fragments.value_or(FragmentRule::keep) != FragmentRule::keep)
        body = without_fragments(*body, *before, part, apply);
      if (!body) return std::nullopt;
    }
    return body;
  }
  PartField finished(const Field& field) {
    result_.field = field;
    result_.smallest_feature_mm = std::min(result_.smallest_feature_mm, shapes_.smallest_feature_mm());
    return result_;
  }

 private:
  std::optional<Field> macrostructure(const std::string& id) {
    const auto& all = evaluation_.document().macrostructures;
    const auto found = std::ranges::find(all, id, [](const Macrostructure& m) { return m.id.text; });
    const auto shape = evaluation_.shape(*found, report_.sink());
    return shape ? shapes_.make(*shape) : std::nullopt;
  }

  using Body = std::optional<Field>;  ///< nothing yet: the first step is a union (R-5.12.2)

  /// What of a step is measured in lengths.
  struct Surroundings {
    double radius = 0, skin = 0;
  };
  std::optional<Surroundings> surroundings(const Apply& apply) {
    const auto radius = length(apply, "radius", apply.radius), skin = length(apply, "skin", apply.skin);
    return radius && skin ? std::optional(Surroundings{*radius, *skin}) : std::nullopt;
  }

  static Field combined(const Body& body, const Field& operand, ApplyOperation operation, Surroundings around) {
    if (!body) return operand;
    const auto [radius, skin] = around;
    switch (operation) {
      case ApplyOperation::union_:
        return radius > 0 ? union_of(*body, operand, radius) : joined(*body, operand);
      case ApplyOperation::intersection: {
        const Field fill = intersection_of(*body, operand, radius);
        return skin > 0 ? union_of(fill, difference_of(*body, body->offset(-skin))) : fill;
      }
      case ApplyOperation::difference:
        break;
    }
    const Field holes = skin > 0 ? intersection_of(operand.offset(seam), body->offset(-skin)) : operand.offset(seam);
    return difference_of(*body, holes, radius);
  }

  std::optional<Field> with_part(const Body& body, const Apply& apply) {
    const auto placement = evaluation_.placement(apply.placement, report_.sink());
    const auto operand = placement ? make(*evaluation_.find_part(apply.part->text)) : std::nullopt;
    const auto around = surroundings(apply);
    if (!operand || !around) return std::nullopt;
    return combined(body, moved(*operand, *placement), apply.operation, *around);
  }

  std::optional<Field> with_cells(const Body& body, const Part& part, const Apply& apply) {
    const auto cells = evaluation_.cells(*evaluation_.find_pattern(apply.pattern->text), report_.sink());
    if (!cells) return std::nullopt;
    const eval::MayReach may_reach = [&](const eval::PlacedCell& cell) {
      const auto own = field_of_cell(evaluation_, *cells, cell, shapes_, report_);
      return own && !own->bounds().empty() && body->interval(own->bounds()).lo <= 0;
    };
    const Box3 box = body ? body->bounds() : Box3{};
    if (!eval::check_reach(evaluation_, *cells, apply, part, box, may_reach, report_.sink())) return std::nullopt;
    const BoundaryRule rule = apply.boundary.value_or(BoundaryRule::clip);
    KeepCell keep;
    if (rule != BoundaryRule::clip) {
      const auto clearance = length(apply, "clearance", apply.clearance);
      if (!clearance) return std::nullopt;
      const BoundaryQuestion question{rule == BoundaryRule::drop_partial, *clearance};
      const bool by_body = apply.test.value_or(InsideTest::box) == InsideTest::body;
      keep = [this, &cells, &body, question, by_body](const eval::PlacedCell& cell) {
        return keeps(*cells, cell, *body, question, by_body);
      };
    }
    const auto around = surroundings(apply);
    if (!around) return std::nullopt;
    const auto pattern = field_of_pattern(evaluation_, *cells, keep, shapes_, around->radius, options_.run, report_);
    if (!pattern) return std::nullopt;
    if (around->skin > 0) result_.smallest_feature_mm = std::min(result_.smallest_feature_mm, around->skin);
    result_.cells_placed += pattern->placed;
    result_.cells_kept += pattern->kept;
    result_.smallest_feature_mm = std::min(result_.smallest_feature_mm, pattern->smallest_feature_mm);
    result_.density_spacing_mm = std::min(result_.density_spacing_mm, pattern->density_spacing_mm);
    // Whole cells stand for themselves.
    if (rule != BoundaryRule::clip && apply.operation == ApplyOperation::intersection) return pattern->field;
    return combined(body, pattern->field, apply.operation, *around);
  }

  /// a union makes no fragments, nor do whole cells.
  std::optional<Field> without_fragments(const Field& body, const Field& before, const Part& part, const Apply& apply) {
    if (apply.operation == ApplyOperation::union_ || apply.boundary.value_or(BoundaryRule::clip) != BoundaryRule::clip)
      return body;
    const double smallest = std::min(result_.smallest_feature_mm, shapes_.smallest_feature_mm());
    const Vec3 size = body.bounds().empty() ? Vec3{1, 1, 1} : body.bounds().max - body.bounds().min;
    const double spacing = options_.spacing_mm > 0   ? options_.spacing_mm
                           : std::isfinite(smallest) ? smallest / 5
                                                     : std::max({size.x, size.y, size.z}) / 100;
    const auto loose = fragments_of(body, before, spacing, options_.run, report_.sink());
    if (!loose) return std::nullopt;
    if (apply.fragments == FragmentRule::error && loose->count > 0) {
      report_(Code::geometry_fragments, apply.id_in_source, {part.id.text, std::to_string(loose->count)});
      return std::nullopt;
    }
    if (apply.fragments == FragmentRule::error || !loose->pieces) return body;
    result_.fragments += loose->count;
    // The pieces' mesh is as far from their surface as samples are from each other, at most.
    return difference_of(body, loose->pieces->offset(spacing / 2));
  }

  /// In millimetres; 0 if the attribute is absent.
  std::optional<double> length(const Apply& apply, std::string_view attribute, const std::optional<Expression>& given) {
    if (!given) return 0.0;
    const auto value = evaluation_.value(*given, apply.id_in_source, attribute, report_.sink());
    if (!value) return std::nullopt;
    if (*value < 0) {
      report_(Code::value_negative, apply.id_in_source, {std::string(attribute), format_number(*value)});
      return std::nullopt;
    }
    return *value * millimeters_per(evaluation_.document().unit);
  }

  std::optional<bool> keeps(const eval::CellStream& cells, const eval::PlacedCell& cell, const Field& body,
                            const BoundaryQuestion& question, bool by_body) {
    if (options_.run.should_stop()) {
      report_.sink().report({.code = options_.run.out_of_time() ? Code::limit_time : Code::cancelled});
      return std::nullopt;
    }
    const std::size_t errors = report_.sink().error_count();
    std::optional<Field> own;
    if (by_body) {
      own = field_of_cell(evaluation_, cells, cell, shapes_, report_);
      if (!own) return std::nullopt;
    }
    auto region = cells.cell_region(cell, report_.sink());
    if (report_.sink().error_count() > errors) return std::nullopt;
    Affine frame = cell.mapping == CellMapping::rigid ? cell.world_from_cell : Affine{};
    if (by_body) {  // its body may leave its box
      const Box3 box = own->bounds();
      region = eval::Shape{eval::BoxShape{box.min, box.max - box.min}};
      frame = {};
    }
    if (!region) return true;
    return answer(question, body, *region, frame, own ? &*own : nullptr);
  }

  const eval::Evaluation& evaluation_;
  const DocumentFieldOptions& options_;
  Reporter report_;
  ShapeFields shapes_;
  PartField result_{nothing()};
};

}  // namespace

std::optional<PartField> field_of_part(const eval::Evaluation& evaluation, const Part& part,
                                       const DocumentFieldOptions& options, DiagnosticSink& sink) {
  PartMaker maker(evaluation, options, sink);
  const std::size_t errors = sink.error_count();
  const auto field = maker.make(part);
  if (!field || sink.error_count() > errors) return std::nullopt;
  return maker.finished(*field);
}

}  // namespace meso::implicit
