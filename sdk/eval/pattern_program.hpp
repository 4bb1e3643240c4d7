// SPDX-License-Identifier: Apache-2.0
#pragma once
// A pattern compiled once: loops and statements over numbered slots, each with the level on which it changes. A walker
// (walker.hpp) runs it. Lengths are in the document's unit.
//
// Every value has a slot of its own that nothing else ever writes. So a statement may be skipped whenever nothing that
// it depends on has moved, whatever the statements behind it have done since.

#include <array>
#include <memory>
#include <optional>
#include <set>
#include <variant>
#include <vector>

#include "evaluation_impl.hpp"
#include "field_source.hpp"
#include "meso/eval/coordinates.hpp"
#include "meso/model/document.hpp"
#include "scope.hpp"

namespace meso::eval {

/// Where a loop stands now. `index` runs from `first` to `first + count - 1`.
struct LoopState {
  std::int64_t index = 0;
  std::int64_t count = 0;
  double start = 0, spacing = 0;
  double q = 0;
  Vec3 direction;  ///< unit; zero along an axis or for a loop that only counts
};

/// The records that a scatter visits, in its order. The index of a cell is the number of its record.
struct ScatterRecords {
  std::shared_ptr<const FieldSource> source;
  std::vector<std::uint64_t> order;  ///< empty: all, as they are
  std::vector<QuantitySlot> quantities;
  bool is_own_system = true;  ///< else the pattern's coordinates are the global place

  [[nodiscard]] std::size_t record(std::int64_t position) const {
    const auto p = static_cast<std::size_t>(position);
    return order.empty() ? p : static_cast<std::size_t>(order[p]);
  }
};

struct LoopProgram {
  Place place;  ///< of the element
  std::uint32_t index_slot = 0;
  std::optional<std::size_t> axis;
  std::optional<std::array<BoundExpression, 3>> direction;
  std::optional<BoundExpression> count, start, spacing, position, size;
  bool cumulative = false;                  ///< R-6.3.5: the spacing names the loop's own index
  bool stepped = false;                     ///< has spacing, position or size: a step to be conformal with
  std::int64_t first = 0;                   ///< of a fill range: its lowest n
  LoopState initial;                        ///< what the absent expressions leave unsaid
  std::vector<std::vector<double>> places;  ///< of a list: one row of coordinates per index
  std::optional<ScatterRecords> scatter;
};

struct Assign {
  BoundExpression expression;
  std::uint32_t slot;
};
/// A value of a cell parameter must keep to a bound.
struct Bound {
  const CellParameter* parameter;
  Place place;  ///< of the bound
  std::uint32_t value, bound;
  bool upper;
};
/// Asks a field at the point in slots `point`, x y z.
struct Sample {
  std::shared_ptr<const FieldSource> source;
  Place place;
  std::uint32_t point;
  std::vector<QuantitySlot> quantities;
};
struct When {
  std::uint32_t slot;
};
/// Slots of an x y z triple are consecutive.
struct Orient {
  const OrientInstruction* instruction;
  std::uint32_t vector, second;
};
struct Rotate {
  const RotateInstruction* instruction;
  std::uint32_t axis, angle;
};
struct Scale {
  const ScaleInstruction* instruction;
  std::uint32_t factors;
};
struct Translate {
  std::uint32_t vector;
};
struct Statement {
  int level = constant_level;
  std::variant<Assign, Bound, When, Sample, Orient, Rotate, Scale, Translate> action;

  [[nodiscard]] bool moves() const { return action.index() >= 4; }
};

struct PatternProgram {
  std::shared_ptr<const EvaluationData> evaluation;
  const Pattern* pattern = nullptr;
  const UnitCell* cell = nullptr;
  std::shared_ptr<const CoordinateFrame> frame;  ///< document unit
  CellMapping mapping = CellMapping::rigid;

  // Slots: document parameters, cell parameters (final values), indices, axes, global, global of a node, temporaries.
  std::size_t parameter_slot = 0, index_slot = 0, axis_slot = 0, global_slot = 0, node_global_slot = 0;
  std::vector<double> slots;  ///< as they are before the first cell

  /// New slots behind all others.
  std::uint32_t add_slots(std::size_t count, double value) {
    const std::size_t first = slots.size();
    slots.resize(first + count, value);
    return static_cast<std::uint32_t>(first);
  }

  std::vector<LoopProgram> loops;  ///< first outermost
  int turn_level = constant_level;
  int global_level = constant_level;  ///< of P(q)
  std::vector<Statement> statements;
  std::set<std::string> named_quantities;  ///< of fields
  bool drops_cells = false;                ///< `when`, or an orientation with zero="drop"
  std::vector<std::variant<Assign, Sample>>
      node_statements;       ///< `set at="node"`, what it samples, what follows from it
  bool sets_points = false;  ///< `set at="point"`

  [[nodiscard]] std::string cell_name(std::span<const std::int64_t> index) const;
};

/// Nothing if something was reported.
[[nodiscard]] std::shared_ptr<const PatternProgram> compile_pattern(std::shared_ptr<const EvaluationData> evaluation,
                                                                    const Pattern& pattern, DiagnosticSink& sink);

}  // namespace meso::eval
