// SPDX-License-Identifier: Apache-2.0
#pragma once
// A Meso document as plain values: what is in the file, nothing computed.
//
//   Document d;
//   d.unit = LengthUnit::millimeter;
//   d.parameters.items.push_back({.id = {"pitch"}, .value = {"5mm"}});
//
// Element names are the type names in camelCase; describe.hpp holds the one table that ties both together.
// Documents are copyable values; equality ignores source places and layout.

#include <string_view>

#include "meso/base/unit.hpp"
#include "meso/model/pattern.hpp"

namespace meso {

inline constexpr std::string_view meso_namespace = "urn:meso-format:1.0";

struct Metadata : Element {
  std::string name;
  std::string text;
  friend bool operator==(const Metadata&, const Metadata&) = default;
};

/// A document parameter: an expression of earlier ones; a user may override it within min and max.
struct Parameter : Element {
  Id id;
  Expression value;
  std::optional<Expression> min, max;
  std::optional<std::string> description;
  friend bool operator==(const Parameter&, const Parameter&) = default;
};

enum class AxisKind { linear, distance, circular, scalar };
struct Axis : Element {
  Name name;
  AxisKind kind = AxisKind::linear;
  std::optional<Expression> x, y, z;  ///< direction, constant, 0 each; absent for scalar axes
  friend bool operator==(const Axis&, const Axis&) = default;
};
/// P(q) = T (sum of q_lin e_lin + R1 R2 ... sum of q_dist e_dist); the placement is rigid and constant.
struct CoordinateSystem : Element {
  Id id;
  std::optional<Ref<CoordinateSystem>> parent;
  std::optional<Placement> placement;
  std::vector<Axis> axes;
  friend bool operator==(const CoordinateSystem&, const CoordinateSystem&) = default;
};

struct Macrostructure : Element {
  Id id;
  std::optional<Placement> placement;
  std::variant<std::monostate, CsgBody, ImportBody> body;
  friend bool operator==(const Macrostructure&, const Macrostructure&) = default;
};

/// A cell's own parameter: its default may use the placement (global.x, axis names, indices).
struct CellParameter : Element {
  Name name;
  Expression value;
  std::optional<Expression> min, max;
  friend bool operator==(const CellParameter&, const CellParameter&) = default;
};
/// Corner and size: the period of implicit bodies, what conformal mapping bends, what boundary rules test.
struct CellBox : Element {
  std::optional<Expression> x, y, z;  ///< corner, 0
  Expression dx, dy, dz;
  friend bool operator==(const CellBox&, const CellBox&) = default;
};
using CellBody = std::variant<std::monostate, CsgBody, BeamsBody, ImplicitBody, ImportBody, PartBody>;
struct UnitCell : Element {
  Id id;
  std::optional<Name> library;      ///< a cell that every reader knows: then no box, no body
  std::optional<bool> clip_to_box;  ///< false; implicit bodies are always cut
  std::vector<CellParameter> parameters;
  std::optional<CellBox> box;
  CellBody body;
  friend bool operator==(const UnitCell&, const UnitCell&) = default;
};

enum class ApplyOperation { difference, union_, intersection };
enum class BoundaryRule { clip, drop_partial, keep_whole };
enum class InsideTest { box, body };
enum class FragmentRule { keep, drop, error };
/// One step of a part's left fold; exactly one of pattern and part.
struct Apply : Element {
  std::optional<Ref<Pattern>> pattern;
  std::optional<Ref<Part>> part;
  ApplyOperation operation = ApplyOperation::union_;
  std::optional<BoundaryRule> boundary;   ///< clip
  std::optional<InsideTest> test;         ///< box
  std::optional<Expression> clearance;    ///< 0
  std::optional<FragmentRule> fragments;  ///< keep
  std::optional<Expression> radius;       ///< of the fillet where both operands meet, 0
  std::optional<Expression> skin;         ///< what lies within it of the left operand's boundary stays, 0
  std::optional<Placement> placement;     ///< of a part operand, identity
  friend bool operator==(const Apply&, const Apply&) = default;
};

// What `meso verify` recomputes. Relative tolerances default to 1e-6. Values are in the document's unit.
struct ExpectedValue : Element {
  double value = 0;
  std::optional<double> tolerance;
  friend bool operator==(const ExpectedValue&, const ExpectedValue&) = default;
};
struct ExpectedCentroid : Element {
  double x = 0, y = 0, z = 0;
  std::optional<double> tolerance;  ///< absolute
  friend bool operator==(const ExpectedCentroid&, const ExpectedCentroid&) = default;
};
struct ExpectedCount : Element {
  std::optional<std::int64_t> placed, kept, solids, fragments;
  friend bool operator==(const ExpectedCount&, const ExpectedCount&) = default;
};
struct SamplePoint : Element {
  double x = 0, y = 0, z = 0;
  bool inside = false;
  friend bool operator==(const SamplePoint&, const SamplePoint&) = default;
};
struct Validation : Element {
  std::optional<ExpectedValue> volume, area;
  std::optional<ExpectedCentroid> centroid;
  std::optional<ExpectedCount> count;
  std::vector<SamplePoint> samples;
  friend bool operator==(const Validation&, const Validation&) = default;
};

/// A macrostructure or nothing, then a left fold of apply steps.
struct Part : Element {
  Id id;
  std::optional<Ref<Macrostructure>> macrostructure;
  std::vector<Apply> steps;
  std::optional<Validation> validation;
  friend bool operator==(const Part&, const Part&) = default;
};

/// Where a mesh is meant: deflection and angle of exact bodies, samples and bounds of implicit ones.
struct MeshSettings : Element {
  std::optional<Expression> deflection, angle;
  std::optional<ExpressionList> samples;          ///< one number or three
  std::optional<Expression> x, y, z, dx, dy, dz;  ///< bounds
  friend bool operator==(const MeshSettings&, const MeshSettings&) = default;
};
struct BuildItem : Element {
  Ref<Part> part;
  std::optional<Placement> placement;
  std::optional<MeshSettings> mesh;
  friend bool operator==(const BuildItem&, const BuildItem&) = default;
};

struct Document : Element {
  std::string version = "1.0";
  LengthUnit unit = LengthUnit::millimeter;
  std::optional<std::string> requires_;  ///< space-separated names a reader must understand
  std::vector<Metadata> metadata;
  Section<Parameter> parameters;
  Section<CoordinateSystem> coordinate_systems;
  Section<Macrostructure> macrostructures;
  Section<UnitCell> unit_cells;
  Section<VectorField> vector_fields;
  Section<Pattern> patterns;
  Section<Part> parts;
  Section<BuildItem> build;
  std::vector<Trivia> after;  ///< comments behind the root element
  friend bool operator==(const Document&, const Document&) = default;
};

}  // namespace meso
