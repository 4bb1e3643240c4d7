// SPDX-License-Identifier: Apache-2.0
#pragma once
// Bodies of cells and macrostructures: every expression bound once, then shapes from slots as often as needed.

#include <cassert>
#include <functional>
#include <unordered_map>
#include <vector>

#include "evaluation_impl.hpp"
#include "meso/eval/shape.hpp"

namespace meso::eval {

/// The bound expressions of a body, by their place in the document. Looked up only, never walked.
class BodyTable {
 public:
  [[nodiscard]] static std::optional<BodyTable> make(const EvaluationData& data, const Macrostructure& macrostructure,
                                                     const Scope& scope, const Report& report);
  /// Box and body. `scope` knows document parameters and the cell's own.
  [[nodiscard]] static std::optional<BodyTable> make(const EvaluationData& data, const UnitCell& cell,
                                                     const Scope& scope, const Report& report);

  [[nodiscard]] const BoundExpression& at(const Expression& e) const { return find(&e).front(); }
  [[nodiscard]] const std::vector<BoundExpression>& at(const ExpressionList& e) const { return find(&e); }

 private:
  [[nodiscard]] const std::vector<BoundExpression>& find(const void* address) const {
    const auto found = bound_.find(address);
    assert(found != bound_.end());
    return found->second;
  }

  std::unordered_map<const void*, std::vector<BoundExpression>> bound_;
};

class PoleBalls;

/// How a cell's nodes are placed, beyond what the slots say. Lengths in the document's unit.
struct NodeRules {
  /// Where a node stands that the body puts at p; absent: there.
  std::function<Vec3(Vec3 p)> position{};
  /// The slots for the expressions of a node that stands at `position(p)`; false if something was reported. Absent:
  /// the same everywhere.
  std::function<bool(Vec3 placed, std::vector<double>& slots)> slots{};
  /// The cell's box in millimetres: beyond each wall the struts of a neighbour like this cell go on.
  std::optional<BoxShape> period{};
  /// The balls of nodes on poles; asked for if a node is on one. Null: something was reported.
  std::function<const PoleBalls*()> poles{};
};

[[nodiscard]] std::optional<Shape> make_shape(const EvaluationData& data, const BodyTable& table,
                                              const Macrostructure& macrostructure, std::span<const double> slots,
                                              const Report& report);
[[nodiscard]] std::optional<Shape> make_shape(const EvaluationData& data, const BodyTable& table, const UnitCell& cell,
                                              std::span<const double> slots, const Report& report,
                                              const NodeRules& rules);
[[nodiscard]] std::optional<BoxShape> make_box(const EvaluationData& data, const BodyTable& table, const CellBox& box,
                                               std::span<const double> slots, const Report& report);

}  // namespace meso::eval
