// SPDX-License-Identifier: Apache-2.0
#pragma once
// The one table of the format: which attributes and children every element has, in which order, under which names.
//
// The reader, the writer, the validator and the source map are visitors of this table, so none of them can forget a
// field. A visitor V offers
//   attribute(name, value)      value: Id, Ref<T>, Name, Expression, ExpressionList, Href, string, double, int64, bool,
//   an enum, or optional of one text(string)                character content child(name, element)        element: E or
//   optional<E> children(name, vector<E>)   zero or more, in order sequence(vector)            zero or more of the
//   variant's alternatives, in document order (CSG operands, instructions) choice(variant)             at most one of
//   the alternatives; monostate = none section(name, Section<E>, item_name)   a container that may repeat in a file
// Children of an element stand in the order of this table; only the sections of the root may come in any order.

#include <array>
#include <concepts>
#include <string_view>
#include <type_traits>

#include "meso/model/document.hpp"

namespace meso {

// Element names of variant alternatives (elements whose name depends on their parent's field are named in describe()).
template <class T>
inline constexpr std::string_view element_name{};
#define MESO_ELEMENT(Type, Text) \
  template <>                    \
  inline constexpr std::string_view element_name<Type> = Text
MESO_ELEMENT(BoxPrimitive, "box");
MESO_ELEMENT(SpherePrimitive, "sphere");
MESO_ELEMENT(EllipsoidPrimitive, "ellipsoid");
MESO_ELEMENT(CylinderPrimitive, "cylinder");
MESO_ELEMENT(ConePrimitive, "cone");
MESO_ELEMENT(TorusPrimitive, "torus");
MESO_ELEMENT(ExtrusionPrimitive, "extrusion");
MESO_ELEMENT(WedgePrimitive, "wedge");
MESO_ELEMENT(RevolutionPrimitive, "revolution");
MESO_ELEMENT(PolyhedronPrimitive, "polyhedron");
MESO_ELEMENT(VolumeElementPrimitive, "volumeElement");
MESO_ELEMENT(CsgUnion, "union");
MESO_ELEMENT(CsgIntersection, "intersection");
MESO_ELEMENT(CsgDifference, "difference");
MESO_ELEMENT(CsgTransform, "transform");
MESO_ELEMENT(CsgTranslate, "translate");
MESO_ELEMENT(CsgRotate, "rotate");
MESO_ELEMENT(CsgScale, "scale");
MESO_ELEMENT(CsgBody, "csg");
MESO_ELEMENT(ImportBody, "import");
MESO_ELEMENT(BeamsBody, "beams");
MESO_ELEMENT(ImplicitBlend, "blend");
MESO_ELEMENT(ImplicitBody, "implicit");
MESO_ELEMENT(PartBody, "part");
MESO_ELEMENT(PointsLocation, "points");
MESO_ELEMENT(RegularGridLocation, "regularGrid");
MESO_ELEMENT(RectilinearGridLocation, "rectilinearGrid");
MESO_ELEMENT(MeshLocation, "mesh");
MESO_ELEMENT(EmbeddedValues, "embedded");
MESO_ELEMENT(ExternalValues, "external");
MESO_ELEMENT(SetInstruction, "set");
MESO_ELEMENT(OrientInstruction, "orient");
MESO_ELEMENT(RotateInstruction, "rotate");
MESO_ELEMENT(ScaleInstruction, "scale");
MESO_ELEMENT(TranslateInstruction, "translate");
MESO_ELEMENT(SampleInstruction, "sample");
MESO_ELEMENT(WhenInstruction, "when");
#undef MESO_ELEMENT

// Attribute texts of enumerations, in the order of the enumerators.
template <class E>
inline constexpr std::array<std::string_view, 0> enum_texts{};
template <>
inline constexpr std::array enum_texts<LengthUnit> =
    std::to_array<std::string_view>({"micrometer", "millimeter", "centimeter", "meter", "inch", "foot"});
template <>
inline constexpr std::array enum_texts<BeamCap> = std::to_array<std::string_view>({"sphere", "hemisphere", "butt"});
template <>
inline constexpr std::array enum_texts<ImplicitKind> = std::to_array<std::string_view>({"endoskeleton", "exoskeleton",
                                                                                        "shell", "eccentricShell"});
template <>
inline constexpr std::array enum_texts<ImplicitMirror> = std::to_array<std::string_view>({"x", "y", "z", "xy", "xz",
                                                                                          "yz", "xyz"});
template <>
inline constexpr std::array enum_texts<ComponentRole> = std::to_array<std::string_view>({"position", "vector", "tensor",
                                                                                         "scalar"});
template <>
inline constexpr std::array enum_texts<ValueFormat> = std::to_array<std::string_view>({"hdf5", "raw", "csv", "vtk",
                                                                                       "vtu", "frd", "msh"});
template <>
inline constexpr std::array enum_texts<MeshElementType> = std::to_array<std::string_view>({"tetra", "hexa"});
template <>
inline constexpr std::array enum_texts<InterpolationMethod> =
    std::to_array<std::string_view>({"records", "nearest", "linear", "inverseDistance"});
template <>
inline constexpr std::array enum_texts<OutsideRule> = std::to_array<std::string_view>({"error", "clamp", "value"});
template <>
inline constexpr std::array enum_texts<SortOrder> = std::to_array<std::string_view>({"ascending", "descending"});
template <>
inline constexpr std::array enum_texts<SetAt> = std::to_array<std::string_view>({"cell", "node", "point"});
template <>
inline constexpr std::array enum_texts<CellAxis> = std::to_array<std::string_view>({"x", "y", "z"});
template <>
inline constexpr std::array enum_texts<ZeroVectorRule> = std::to_array<std::string_view>({"error", "keep", "drop"});
template <>
inline constexpr std::array enum_texts<VectorFrame> = std::to_array<std::string_view>({"cell", "global"});
template <>
inline constexpr std::array enum_texts<CellMapping> = std::to_array<std::string_view>({"rigid", "conformal"});
template <>
inline constexpr std::array enum_texts<AxisKind> = std::to_array<std::string_view>({"linear", "distance", "circular",
                                                                                    "scalar"});
template <>
inline constexpr std::array enum_texts<ApplyOperation> = std::to_array<std::string_view>({"difference", "union",
                                                                                          "intersection"});
template <>
inline constexpr std::array enum_texts<BoundaryRule> = std::to_array<std::string_view>({"clip", "dropPartial",
                                                                                        "keepWhole"});
template <>
inline constexpr std::array enum_texts<InsideTest> = std::to_array<std::string_view>({"box", "body"});
template <>
inline constexpr std::array enum_texts<FragmentRule> = std::to_array<std::string_view>({"keep", "drop", "error"});

/// E is T or const T.
template <class E, class T>
concept Of = std::same_as<std::remove_const_t<E>, T>;

template <class V, class E>
void describe_center(V& v, E& e) {
  v.attribute("x", e.x);
  v.attribute("y", e.y);
  v.attribute("z", e.z);
}
template <class V, class E>
void describe_ends(V& v, E& e) {
  v.attribute("x1", e.x1);
  v.attribute("y1", e.y1);
  v.attribute("z1", e.z1);
  v.attribute("x2", e.x2);
  v.attribute("y2", e.y2);
  v.attribute("z2", e.z2);
}
template <class V, class E>
void describe_size(V& v, E& e) {
  v.attribute("dx", e.dx);
  v.attribute("dy", e.dy);
  v.attribute("dz", e.dz);
}

// --- geometry.hpp

template <class V, Of<Placement> E>
void describe(V& v, E& e) {
  v.attribute("matrix", e.matrix);
  v.attribute("mirror", e.mirror);
}
template <class V, Of<BoxPrimitive> E>
void describe(V& v, E& e) {
  describe_center(v, e);
  describe_size(v, e);
}
template <class V, Of<SpherePrimitive> E>
void describe(V& v, E& e) {
  describe_center(v, e);
  v.attribute("radius", e.radius);
}
template <class V, Of<EllipsoidPrimitive> E>
void describe(V& v, E& e) {
  describe_center(v, e);
  v.attribute("rx", e.rx);
  v.attribute("ry", e.ry);
  v.attribute("rz", e.rz);
}
template <class V, Of<CylinderPrimitive> E>
void describe(V& v, E& e) {
  describe_ends(v, e);
  v.attribute("radius", e.radius);
}
template <class V, Of<ConePrimitive> E>
void describe(V& v, E& e) {
  describe_ends(v, e);
  v.attribute("radius1", e.radius1);
  v.attribute("radius2", e.radius2);
}
template <class V, Of<TorusPrimitive> E>
void describe(V& v, E& e) {
  describe_center(v, e);
  v.attribute("ax", e.ax);
  v.attribute("ay", e.ay);
  v.attribute("az", e.az);
  v.attribute("majorRadius", e.major_radius);
  v.attribute("minorRadius", e.minor_radius);
}
template <class V, Of<ProfilePoint> E>
void describe(V& v, E& e) {
  v.attribute("x", e.x);
  v.attribute("y", e.y);
}
template <class V, Of<ExtrusionPrimitive> E>
void describe(V& v, E& e) {
  v.attribute("z", e.z);
  v.attribute("height", e.height);
  v.children("point", e.points);
}
template <class V, Of<WedgePrimitive> E>
void describe(V& v, E& e) {
  describe_center(v, e);
  describe_size(v, e);
  v.attribute("topX", e.top_x);
  v.attribute("topY", e.top_y);
  v.attribute("topDx", e.top_dx);
  v.attribute("topDy", e.top_dy);
}
template <class V, Of<MeridianPoint> E>
void describe(V& v, E& e) {
  v.attribute("r", e.r);
  v.attribute("z", e.z);
}
template <class V, Of<RevolutionPrimitive> E>
void describe(V& v, E& e) {
  v.children("point", e.points);
}
template <class V, Of<PolyhedronVertex> E>
void describe(V& v, E& e) {
  describe_center(v, e);
}
template <class V, Of<PolyhedronFace> E>
void describe(V& v, E& e) {
  v.attribute("vertices", e.vertices);
}
template <class V, Of<PolyhedronPrimitive> E>
void describe(V& v, E& e) {
  v.children("vertex", e.vertices);
  v.children("face", e.faces);
}
template <class V, Of<AxisRange> E>
void describe(V& v, E& e) {
  v.attribute("axis", e.axis);
  v.attribute("from", e.from);
  v.attribute("to", e.to);
}
template <class V, Of<VolumeElementPrimitive> E>
void describe(V& v, E& e) {
  v.attribute("coordinateSystem", e.coordinate_system);
  v.children("range", e.ranges);
}
template <class V, class E>
requires Of<E, CsgUnion> || Of<E, CsgIntersection> || Of<E, CsgDifference> || Of<E, CsgBody>
void describe(V& v, E& e) { v.sequence(e.operands); }
template <class V, Of<CsgTransform> E>
void describe(V& v, E& e) {
  v.attribute("matrix", e.matrix);
  v.attribute("mirror", e.mirror);
  v.sequence(e.operands);
}
template <class V, Of<CsgTranslate> E>
void describe(V& v, E& e) {
  describe_center(v, e);
  v.sequence(e.operands);
}
template <class V, Of<CsgRotate> E>
void describe(V& v, E& e) {
  describe_center(v, e);
  v.attribute("angle", e.angle);
  v.sequence(e.operands);
}
template <class V, Of<CsgScale> E>
void describe(V& v, E& e) {
  describe_center(v, e);
  v.attribute("factor", e.factor);
  v.sequence(e.operands);
}
template <class V, Of<ImportBody> E>
void describe(V& v, E& e) {
  v.attribute("href", e.href);
  v.attribute("unit", e.unit);
  v.attribute("sha256", e.sha256);
  v.child("transform", e.transform);
}
template <class V, Of<BeamNode> E>
void describe(V& v, E& e) {
  v.attribute("id", e.name);
  describe_center(v, e);
  v.attribute("radius", e.radius);
}
template <class V, Of<Beam> E>
void describe(V& v, E& e) {
  v.attribute("from", e.from);
  v.attribute("to", e.to);
  v.attribute("radius", e.radius);
  v.attribute("radius1", e.radius1);
  v.attribute("radius2", e.radius2);
  v.attribute("cap1", e.cap1);
  v.attribute("cap2", e.cap2);
}
template <class V, Of<BeamsBody> E>
void describe(V& v, E& e) {
  v.attribute("radius", e.radius);
  v.attribute("nodeRadius", e.node_radius);
  v.attribute("cap", e.cap);
  v.children("node", e.nodes);
  v.children("beam", e.beams);
}
template <class V, Of<ImplicitBlend> E>
void describe(V& v, E& e) {
  v.attribute("field", e.field);
  v.attribute("surface", e.surface);
  v.attribute("weight", e.weight);
}
template <class V, Of<ImplicitBody> E>
void describe(V& v, E& e) {
  v.attribute("field", e.field);
  v.attribute("surface", e.surface);
  v.attribute("kind", e.kind);
  v.attribute("isovalue", e.isovalue);
  v.attribute("lower", e.lower);
  v.attribute("upper", e.upper);
  v.attribute("thickness", e.thickness);
  v.attribute("density", e.density);
  v.attribute("wall", e.wall);
  v.attribute("mirror", e.mirror);
  v.children("blend", e.blends);
}
template <class V, Of<PartBody> E>
void describe(V& v, E& e) {
  v.attribute("ref", e.part);
}

// --- field.hpp

template <class V, Of<FieldComponent> E>
void describe(V& v, E& e) {
  v.attribute("name", e.name);
  v.attribute("unit", e.unit);
  v.attribute("role", e.role);
  v.attribute("order", e.order);
}
template <class V, Of<PointsLocation> E>
void describe(V& v, E& e) {
  v.attribute("coordinateSystem", e.coordinate_system);
}
template <class V, Of<GridAxis> E>
void describe(V& v, E& e) {
  v.attribute("name", e.name);
  v.attribute("start", e.start);
  v.attribute("spacing", e.spacing);
  v.attribute("count", e.count);
}
template <class V, Of<RectilinearAxis> E>
void describe(V& v, E& e) {
  v.attribute("name", e.name);
  v.attribute("at", e.at);
}
template <class V, class E>
requires Of<E, RegularGridLocation> || Of<E, RectilinearGridLocation>
void describe(V& v, E& e) {
  v.attribute("coordinateSystem", e.coordinate_system);
  v.children("axis", e.axes);
}
template <class V, Of<EmbeddedValues> E>
void describe(V& v, E& e) {
  v.text(e.base64);
}
template <class V, Of<ExternalValues> E>
void describe(V& v, E& e) {
  v.attribute("href", e.href);
  v.attribute("format", e.format);
  v.attribute("path", e.path);
  v.attribute("offset", e.offset);
  v.attribute("stride", e.stride);
  v.attribute("sha256", e.sha256);
}
template <class V, Of<MeshLocation> E>
void describe(V& v, E& e) {
  v.attribute("type", e.type);
  v.attribute("elements", e.elements);
  v.choice(e.connectivity);
}
template <class V, Of<FieldStructure> E>
void describe(V& v, E& e) {
  v.attribute("records", e.records);
  v.children("component", e.components);
  v.choice(e.location);
}
template <class V, Of<Interpolation> E>
void describe(V& v, E& e) {
  v.attribute("method", e.method);
  v.attribute("power", e.power);
}
template <class V, Of<Outside> E>
void describe(V& v, E& e) {
  v.attribute("rule", e.rule);
  v.attribute("value", e.value);
}
template <class V, Of<VectorField> E>
void describe(V& v, E& e) {
  v.attribute("id", e.id);
  v.attribute("macrostructure", e.macrostructure);
  v.child("structure", e.structure);
  v.choice(e.values);
  v.child("interpolation", e.interpolation);
  v.child("outside", e.outside);
}

// --- pattern.hpp

template <class V, Of<Loop> E>
void describe(V& v, E& e) {
  v.attribute("index", e.index);
  v.attribute("count", e.count);
  v.attribute("axis", e.axis);
  describe_center(v, e);
  v.attribute("start", e.start);
  v.attribute("spacing", e.spacing);
  v.attribute("position", e.position);
  v.attribute("size", e.size);
}
template <class V, Of<Sort> E>
void describe(V& v, E& e) {
  v.attribute("by", e.by);
  v.attribute("order", e.order);
}
template <class V, Of<Thin> E>
void describe(V& v, E& e) {
  v.attribute("distance", e.distance);
}
template <class V, Of<Scatter> E>
void describe(V& v, E& e) {
  v.attribute("field", e.field);
  v.attribute("index", e.index);
  v.child("sort", e.sort);
  v.child("thin", e.thin);
}
template <class V, Of<ListPlace> E>
void describe(V& v, E& e) {
  v.attribute("at", e.at);
}
template <class V, Of<PlacementList> E>
void describe(V& v, E& e) {
  v.attribute("index", e.index);
  v.children("place", e.places);
}
template <class V, Of<FillRange> E>
void describe(V& v, E& e) {
  v.attribute("axis", e.axis);
  v.attribute("index", e.index);
  v.attribute("from", e.from);
  v.attribute("to", e.to);
  v.attribute("step", e.step);
}
template <class V, Of<Fill> E>
void describe(V& v, E& e) {
  v.children("range", e.ranges);
}
template <class V, Of<SetInstruction> E>
void describe(V& v, E& e) {
  v.attribute("parameter", e.parameter);
  v.attribute("value", e.value);
  v.attribute("at", e.at);
}
template <class V, Of<SecondDirection> E>
void describe(V& v, E& e) {
  v.attribute("axis", e.axis);
  describe_center(v, e);
}
template <class V, Of<OrientInstruction> E>
void describe(V& v, E& e) {
  v.attribute("axis", e.axis);
  describe_center(v, e);
  v.attribute("frame", e.frame);
  v.attribute("zero", e.zero);
  v.attribute("signless", e.signless);
  v.child("second", e.second);
}
template <class V, Of<RotateInstruction> E>
void describe(V& v, E& e) {
  describe_center(v, e);
  v.attribute("angle", e.angle);
}
template <class V, Of<ScaleInstruction> E>
void describe(V& v, E& e) {
  describe_center(v, e);
  v.attribute("factor", e.factor);
}
template <class V, Of<TranslateInstruction> E>
void describe(V& v, E& e) {
  describe_center(v, e);
}
template <class V, Of<SampleInstruction> E>
void describe(V& v, E& e) {
  v.attribute("field", e.field);
  describe_center(v, e);
}
template <class V, Of<WhenInstruction> E>
void describe(V& v, E& e) {
  v.attribute("test", e.test);
}
template <class V, Of<Pattern> E>
void describe(V& v, E& e) {
  v.attribute("id", e.id);
  v.attribute("unitCell", e.unit_cell);
  v.attribute("coordinateSystem", e.coordinate_system);
  v.attribute("mapping", e.mapping);
  v.children("loop", e.loops);
  v.child("scatter", e.scatter);
  v.child("list", e.list);
  v.child("fill", e.fill);
  v.sequence(e.instructions);
}

// --- document.hpp

template <class V, Of<Metadata> E>
void describe(V& v, E& e) {
  v.attribute("name", e.name);
  v.text(e.text);
}
template <class V, Of<Parameter> E>
void describe(V& v, E& e) {
  v.attribute("id", e.id);
  v.attribute("value", e.value);
  v.attribute("min", e.min);
  v.attribute("max", e.max);
  v.attribute("description", e.description);
}
template <class V, Of<Axis> E>
void describe(V& v, E& e) {
  v.attribute("name", e.name);
  v.attribute("kind", e.kind);
  describe_center(v, e);
}
template <class V, Of<CoordinateSystem> E>
void describe(V& v, E& e) {
  v.attribute("id", e.id);
  v.attribute("parent", e.parent);
  v.child("placement", e.placement);
  v.children("axis", e.axes);
}
template <class V, Of<Macrostructure> E>
void describe(V& v, E& e) {
  v.attribute("id", e.id);
  v.child("placement", e.placement);
  v.choice(e.body);
}
template <class V, Of<CellParameter> E>
void describe(V& v, E& e) {
  v.attribute("id", e.name);
  v.attribute("value", e.value);
  v.attribute("min", e.min);
  v.attribute("max", e.max);
}
template <class V, Of<CellBox> E>
void describe(V& v, E& e) {
  describe_center(v, e);
  describe_size(v, e);
}
template <class V, Of<UnitCell> E>
void describe(V& v, E& e) {
  v.attribute("id", e.id);
  v.attribute("library", e.library);
  v.attribute("clipToBox", e.clip_to_box);
  v.children("parameter", e.parameters);
  v.child("box", e.box);
  v.choice(e.body);
}
template <class V, Of<Apply> E>
void describe(V& v, E& e) {
  v.attribute("pattern", e.pattern);
  v.attribute("part", e.part);
  v.attribute("operation", e.operation);
  v.attribute("boundary", e.boundary);
  v.attribute("test", e.test);
  v.attribute("clearance", e.clearance);
  v.attribute("fragments", e.fragments);
  v.attribute("radius", e.radius);
  v.attribute("skin", e.skin);
  v.child("placement", e.placement);
}
template <class V, Of<ExpectedValue> E>
void describe(V& v, E& e) {
  v.attribute("value", e.value);
  v.attribute("tolerance", e.tolerance);
}
template <class V, Of<ExpectedCentroid> E>
void describe(V& v, E& e) {
  describe_center(v, e);
  v.attribute("tolerance", e.tolerance);
}
template <class V, Of<ExpectedCount> E>
void describe(V& v, E& e) {
  v.attribute("placed", e.placed);
  v.attribute("kept", e.kept);
  v.attribute("solids", e.solids);
  v.attribute("fragments", e.fragments);
}
template <class V, Of<SamplePoint> E>
void describe(V& v, E& e) {
  describe_center(v, e);
  v.attribute("inside", e.inside);
}
template <class V, Of<Validation> E>
void describe(V& v, E& e) {
  v.child("volume", e.volume);
  v.child("area", e.area);
  v.child("centroid", e.centroid);
  v.child("count", e.count);
  v.children("sample", e.samples);
}
template <class V, Of<Part> E>
void describe(V& v, E& e) {
  v.attribute("id", e.id);
  v.attribute("macrostructure", e.macrostructure);
  v.children("apply", e.steps);
  v.child("validation", e.validation);
}
template <class V, Of<MeshSettings> E>
void describe(V& v, E& e) {
  v.attribute("deflection", e.deflection);
  v.attribute("angle", e.angle);
  v.attribute("samples", e.samples);
  describe_center(v, e);
  describe_size(v, e);
}
template <class V, Of<BuildItem> E>
void describe(V& v, E& e) {
  v.attribute("part", e.part);
  v.child("placement", e.placement);
  v.child("mesh", e.mesh);
}
template <class V, Of<Document> E>
void describe(V& v, E& e) {
  v.attribute("version", e.version);
  v.attribute("unit", e.unit);
  v.attribute("requires", e.requires_);
  v.children("metadata", e.metadata);
  v.section("parameters", e.parameters, "parameter");
  v.section("coordinateSystems", e.coordinate_systems, "coordinateSystem");
  v.section("macrostructures", e.macrostructures, "macrostructure");
  v.section("unitCells", e.unit_cells, "unitCell");
  v.section("vectorFields", e.vector_fields, "vectorField");
  v.section("patterns", e.patterns, "pattern");
  v.section("parts", e.parts, "part");
  v.section("build", e.build, "item");
}

}  // namespace meso
