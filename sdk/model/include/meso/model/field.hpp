// SPDX-License-Identifier: Apache-2.0
#pragma once
// Vector fields: first the structure, then the values.

#include <variant>

#include "meso/model/geometry.hpp"

namespace meso {

struct Macrostructure;

enum class ComponentRole { position, vector, tensor, scalar };
struct FieldComponent : Element {
  Name name;
  std::optional<std::string> unit;
  std::optional<ComponentRole> role;  ///< scalar
  std::optional<std::string> order;   ///< of a symmetric tensor's component: xx yy zz xy yz zx
  friend bool operator==(const FieldComponent&, const FieldComponent&) = default;
};

struct PointsLocation : Element {
  std::optional<Ref<CoordinateSystem>> coordinate_system;
  friend bool operator==(const PointsLocation&, const PointsLocation&) = default;
};
struct GridAxis : Element {
  Name name;
  Expression start, spacing;
  std::int64_t count = 0;
  friend bool operator==(const GridAxis&, const GridAxis&) = default;
};
/// Records in order: first axis outermost, last fastest.
struct RegularGridLocation : Element {
  std::optional<Ref<CoordinateSystem>> coordinate_system;
  std::vector<GridAxis> axes;
  friend bool operator==(const RegularGridLocation&, const RegularGridLocation&) = default;
};
struct RectilinearAxis : Element {
  Name name;
  ExpressionList at;
  friend bool operator==(const RectilinearAxis&, const RectilinearAxis&) = default;
};
struct RectilinearGridLocation : Element {
  std::optional<Ref<CoordinateSystem>> coordinate_system;
  std::vector<RectilinearAxis> axes;
  friend bool operator==(const RectilinearGridLocation&, const RectilinearGridLocation&) = default;
};

enum class ValueFormat { hdf5, raw, csv, vtk, vtu, frd, msh };
/// Little-endian IEEE doubles (or int64 for connectivity) as base64 text.
struct EmbeddedValues : Element {
  std::string base64;
  friend bool operator==(const EmbeddedValues&, const EmbeddedValues&) = default;
};
struct ExternalValues : Element {
  Href href;
  ValueFormat format = ValueFormat::raw;
  std::optional<std::string> path;             ///< data set inside the file
  std::optional<std::int64_t> offset, stride;  ///< bytes, raw only
  std::optional<std::string> sha256;
  friend bool operator==(const ExternalValues&, const ExternalValues&) = default;
};
using FieldValues = std::variant<std::monostate, EmbeddedValues, ExternalValues>;

enum class MeshElementType { tetra, hexa };
struct MeshLocation : Element {
  MeshElementType type = MeshElementType::tetra;
  std::int64_t elements = 0;
  FieldValues connectivity;
  friend bool operator==(const MeshLocation&, const MeshLocation&) = default;
};
using FieldLocation =
    std::variant<std::monostate, PointsLocation, RegularGridLocation, RectilinearGridLocation, MeshLocation>;

struct FieldStructure : Element {
  std::int64_t records = 0;
  std::vector<FieldComponent> components;
  FieldLocation location;
  friend bool operator==(const FieldStructure&, const FieldStructure&) = default;
};

enum class InterpolationMethod { records, nearest, linear, inverse_distance };
struct Interpolation : Element {
  InterpolationMethod method = InterpolationMethod::records;
  std::optional<Expression> power;  ///< of the inverse distance, 2
  friend bool operator==(const Interpolation&, const Interpolation&) = default;
};
enum class OutsideRule { error, clamp, value };
struct Outside : Element {
  OutsideRule rule = OutsideRule::error;
  std::optional<Expression> value;
  friend bool operator==(const Outside&, const Outside&) = default;
};

/// Either structure and values, or a macrostructure whose signed distance, normal and curvature are the components.
struct VectorField : Element {
  Id id;
  std::optional<Ref<Macrostructure>> macrostructure;
  std::optional<FieldStructure> structure;
  FieldValues values;
  std::optional<Interpolation> interpolation;  ///< records
  std::optional<Outside> outside;              ///< error
  friend bool operator==(const VectorField&, const VectorField&) = default;
};

}  // namespace meso
