// SPDX-License-Identifier: Apache-2.0
#pragma once
// Patterns: where the copies of a unit cell stand, and what happens to each.

#include <variant>

#include "meso/model/field.hpp"

namespace meso {

struct UnitCell;

// Generators.

/// Index 0 ... count-1. Either `spacing` (q_i = start + sum of spacing(m), m < i) or `position` (q_i = position(i)),
/// along an axis of the system or along a direction; with neither axis nor direction the loop only counts. Along an
/// axis `size` in their place: a function of the coordinate, cell i begins where the integral of 1 / size from start is
/// i.
struct Loop : Element {
  Name index;
  Expression count;
  std::optional<Name> axis;
  std::optional<Expression> x, y, z;  ///< direction, normalised
  std::optional<Expression> start;    ///< 0
  std::optional<Expression> spacing, position, size;
  friend bool operator==(const Loop&, const Loop&) = default;
};

enum class SortOrder { ascending, descending };
struct Sort : Element {
  Expression by;
  std::optional<SortOrder> order;  ///< ascending
  friend bool operator==(const Sort&, const Sort&) = default;
};
/// Greedy: keep a record if it is farther than `distance` from all kept ones.
struct Thin : Element {
  Expression distance;
  friend bool operator==(const Thin&, const Thin&) = default;
};
/// One cell per record of a field, in record order.
struct Scatter : Element {
  Ref<VectorField> field;
  std::optional<Name> index;
  std::optional<Sort> sort;
  std::optional<Thin> thin;
  friend bool operator==(const Scatter&, const Scatter&) = default;
};

/// Coordinates in the order of the system's axes; axes left out are 0.
struct ListPlace : Element {
  ExpressionList at;
  friend bool operator==(const ListPlace&, const ListPlace&) = default;
};
struct PlacementList : Element {
  std::optional<Name> index;
  std::vector<ListPlace> places;
  friend bool operator==(const PlacementList&, const PlacementList&) = default;
};

/// Integers n, ascending, with n*step >= from and (n+1)*step <= to, within 1e-9*step.
struct FillRange : Element {
  Name axis;
  std::optional<Name> index;
  Expression from, to, step;
  friend bool operator==(const FillRange&, const FillRange&) = default;
};
struct Fill : Element {
  std::vector<FillRange> ranges;  ///< first outermost
  friend bool operator==(const Fill&, const Fill&) = default;
};

// Instructions, in document order, each in the frame that the earlier ones left.

enum class SetAt { cell, node, point };
struct SetInstruction : Element {
  Name parameter;
  Expression value;
  std::optional<SetAt> at;  ///< cell
  friend bool operator==(const SetInstruction&, const SetInstruction&) = default;
};

enum class CellAxis { x, y, z };
enum class ZeroVectorRule { error, keep, drop };
enum class VectorFrame { cell, global };
/// The cell's second axis as near to (x, y, z) as the first allows.
struct SecondDirection : Element {
  CellAxis axis = CellAxis::x;
  Expression x, y, z;
  friend bool operator==(const SecondDirection&, const SecondDirection&) = default;
};
/// Turns the frame so that a cell axis points along (x, y, z); without a second direction by the smallest rotation.
struct OrientInstruction : Element {
  CellAxis axis = CellAxis::z;
  Expression x, y, z;
  std::optional<VectorFrame> frame;    ///< cell: components in the current local frame
  std::optional<ZeroVectorRule> zero;  ///< error
  std::optional<bool>
      signless;  ///< false; true: v and -v are the same, the one with the last non-zero component > 0 is taken
  std::optional<SecondDirection> second;
  friend bool operator==(const OrientInstruction&, const OrientInstruction&) = default;
};
/// About an axis through the current origin, right-handed.
struct RotateInstruction : Element {
  Expression x, y, z, angle;
  friend bool operator==(const RotateInstruction&, const RotateInstruction&) = default;
};
struct ScaleInstruction : Element {
  std::optional<Expression> x, y, z;  ///< three factors > 0, 1 each ...
  std::optional<Expression> factor;   ///< ... or one
  friend bool operator==(const ScaleInstruction&, const ScaleInstruction&) = default;
};
struct TranslateInstruction : Element {
  std::optional<Expression> x, y, z;
  friend bool operator==(const TranslateInstruction&, const TranslateInstruction&) = default;
};
/// Makes the field's components known as `field.component`, sampled at (x, y, z), by default the cell's origin in
/// global coordinates.
struct SampleInstruction : Element {
  Ref<VectorField> field;
  std::optional<Expression> x, y, z;
  friend bool operator==(const SampleInstruction&, const SampleInstruction&) = default;
};
/// Keeps the cell only if the test is true; dropped cells keep their index.
struct WhenInstruction : Element {
  Expression test;
  friend bool operator==(const WhenInstruction&, const WhenInstruction&) = default;
};
using Instruction = std::variant<SetInstruction, OrientInstruction, RotateInstruction, ScaleInstruction,
                                 TranslateInstruction, SampleInstruction, WhenInstruction>;

enum class CellMapping { rigid, conformal };

/// Exactly one generator: loops, scatter, list or fill.
struct Pattern : Element {
  Id id;
  Ref<UnitCell> unit_cell;
  std::optional<Ref<CoordinateSystem>> coordinate_system;  ///< global Cartesian x y z
  std::optional<CellMapping> mapping;                      ///< rigid
  std::vector<Loop> loops;                                 ///< first outermost, last fastest
  std::optional<Scatter> scatter;
  std::optional<PlacementList> list;
  std::optional<Fill> fill;
  std::vector<Instruction> instructions;
  friend bool operator==(const Pattern&, const Pattern&) = default;
};

}  // namespace meso
