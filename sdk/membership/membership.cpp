// SPDX-License-Identifier: Apache-2.0
#include "meso/membership/membership.hpp"

#include <algorithm>

#include "cell_set.hpp"

namespace meso::membership {

struct Membership::Impl {
  Solid solid;
};

namespace {

/// A body, and what the next step leaves of it.
Solid joined(Solid body, Solid operand, ApplyOperation operation) {
  const Box3 box = operation == ApplyOperation::union_         ? united(body.box, operand.box)
                   : operation == ApplyOperation::intersection ? common(body.box, operand.box)
                                                               : body.box;
  return {box, [body = std::move(body), operand = std::move(operand), operation](Vec3 p) {
            const Answer a = body.at(p);
            switch (operation) {
              case ApplyOperation::union_:
                return a == Answer::inside ? a : std::max(a, operand.at(p));
              case ApplyOperation::intersection:
                return a == Answer::outside ? a : std::min(a, operand.at(p));
              case ApplyOperation::difference:
                break;
            }
            return a == Answer::outside ? a : std::min(a, complement(operand.at(p)));
          }};
}

/// Which loose fragments go, points cannot tell.
Solid without_fragments(Solid body) {
  const Box3 box = body.box;
  return {box, [body = std::move(body)](Vec3 p) { return std::min(body.at(p), Answer::unknown); }};
}

/// Fillets and skins follow distances, which this room does not know: nothing is said about a body that has any.
Solid undecided(Box3 box, double radius) {
  if (!box.empty()) box = {box.min - Vec3{radius, radius, radius}, box.max + Vec3{radius, radius, radius}};
  return {box, [](Vec3) { return Answer::unknown; }};
}

class PartMaker {
 public:
  PartMaker(const eval::Evaluation& evaluation, const Options& options, DiagnosticSink& sink)
      : evaluation_(evaluation), options_(options), sink_(sink) {
    surroundings_ = {options.imports, [this](const Part* part) { return part != nullptr ? nested(*part) : Solid{}; }};
  }

  std::optional<Solid> make(const Part& part) {
    Solid body;
    if (part.macrostructure) {
      auto macrostructure = macrostructure_of(part.macrostructure->text);
      if (!macrostructure) return {};
      body = std::move(*macrostructure);
    }
    for (const Apply& apply : part.steps) {
      Box3 box = body.box;
      auto next = apply.pattern ? with_cells(std::move(body), apply) : with_part(std::move(body), apply);
      if (!next) return {};
      body = std::move(*next);
      if (apply.radius || apply.skin) {
        const auto radius = length(apply, "radius", apply.radius);
        if (!radius) return {};
        if (!body.box.empty()) {
          box.extend(body.box.min);
          box.extend(body.box.max);
        }
        body = undecided(box, *radius);
      }
      if (apply.fragments == FragmentRule::drop && !options_.no_fragments) body = without_fragments(std::move(body));
    }
    return body;
  }
  [[nodiscard]] bool failed() const { return failed_; }

 private:
  Solid nested(const Part& part) {
    auto solid = make(part);
    failed_ = failed_ || !solid;
    return std::move(solid).value_or(Solid{});
  }

  std::optional<Solid> macrostructure_of(const std::string& id) {
    const auto& all = evaluation_.document().macrostructures;
    const auto found = std::ranges::find(all, id, [](const Macrostructure& m) { return m.id.text; });
    if (found == all.end()) return {};
    const auto shape = evaluation_.shape(*found, sink_);
    if (!shape) return {};
    return make_solid(*shape, surroundings_);
  }

  std::optional<Solid> with_part(Solid body, const Apply& apply) {
    const Part* part = evaluation_.find_part(apply.part->text);
    const auto placement = evaluation_.placement(apply.placement, sink_);
    if (part == nullptr || !placement) return {};
    auto operand = make(*part);
    if (!operand) return {};
    return joined(std::move(body), moved(std::move(*operand), *placement), apply.operation);
  }

  std::optional<Solid> with_cells(Solid body, const Apply& apply) {
    const Pattern* pattern = evaluation_.find_pattern(apply.pattern->text);
    const auto stream = pattern != nullptr ? evaluation_.cells(*pattern, sink_) : std::nullopt;
    auto set = stream ? CellSet::make(*stream, surroundings_, options_.run, sink_) : std::nullopt;
    if (!set) return {};
    ApplyOperation operation = apply.operation;
    if (const BoundaryRule rule = apply.boundary.value_or(BoundaryRule::clip); rule != BoundaryRule::clip) {
      const auto clearance = length(apply, "clearance", apply.clearance);
      if (!clearance) return {};
      using Kind = CellSet::Rule::Kind;
      set->take({rule == BoundaryRule::drop_partial ? Kind::inside : Kind::meeting,
                 apply.test.value_or(InsideTest::box), *clearance},
                body);
      // Whole cells stand for themselves.
      if (operation == ApplyOperation::intersection) {
        body = {};
        operation = ApplyOperation::union_;
      }
    }
    const Box3 box = set->box();
    const auto cells = std::make_shared<const CellSet>(std::move(*set));
    return joined(std::move(body), {box, [cells](Vec3 p) { return cells->at(p); }}, operation);
  }

  /// In millimetres; 0 if the attribute is absent.
  std::optional<double> length(const Apply& apply, std::string_view attribute, const std::optional<Expression>& given) {
    if (!given) return 0.0;
    const auto value = evaluation_.value(*given, apply.id_in_source, attribute, sink_);
    if (!value) return {};
    return *value * millimeters_per(evaluation_.document().unit);
  }

  const eval::Evaluation& evaluation_;
  const Options& options_;
  DiagnosticSink& sink_;
  Surroundings surroundings_;
  bool failed_ = false;
};

}  // namespace

std::optional<Membership> Membership::make(const eval::Evaluation& evaluation, const Part& part, const Options& options,
                                           DiagnosticSink& sink) {
  PartMaker maker(evaluation, options, sink);
  auto solid = maker.make(part);
  if (!solid || maker.failed()) return {};
  return Membership(std::make_shared<const Impl>(Impl{std::move(*solid)}));
}

Answer Membership::at(Vec3 p) const { return impl_->solid.at(p); }

Answer Membership::clear_at(Vec3 p, double delta) const {
  const Answer answer = at(p);
  for (int n = 0; n < 27 && answer != Answer::unknown; ++n) {
    const Vec3 d{n % 3 - 1.0, n / 3 % 3 - 1.0, n / 9 - 1.0};
    const double length2 = dot(d, d);
    if (length2 != 1 && length2 != 3) continue;
    if (at(p + (length2 == 1 ? delta : delta / 2) * d) != answer) return Answer::unknown;
  }
  return answer;
}

std::optional<Box3> Membership::box() const {
  const Box3& box = impl_->solid.box;
  const bool is_bounded = box.empty() || (box.max.x < anywhere_mm / 2 && box.min.x > -anywhere_mm / 2);
  return is_bounded ? std::optional(box) : std::nullopt;
}

}  // namespace meso::membership
