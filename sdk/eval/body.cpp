// SPDX-License-Identifier: Apache-2.0
// CSG trees, imports, boxes. Beams are in beams.cpp.
#include "body.hpp"

#include <algorithm>
#include <numbers>

#include "beams.hpp"
#include "body_reader.hpp"

namespace meso::eval {
namespace {

/// Corners that fall together are one, and what is left of a face that has fewer than three is none.
PolyhedronShape wedge(Vec3 bottom, double dx, double dy, Vec3 top, double top_dx, double top_dy) {
  const Vec3 corners[] = {bottom, bottom + Vec3{dx, 0, 0},  bottom + Vec3{dx, dy, 0},      bottom + Vec3{0, dy, 0},
                          top,    top + Vec3{top_dx, 0, 0}, top + Vec3{top_dx, top_dy, 0}, top + Vec3{0, top_dy, 0}};
  static constexpr std::size_t sides[][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                             {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  Polyhedron body;
  std::array<std::size_t, 8> place{};
  for (std::size_t i = 0; i < 8; ++i) {
    const auto found = std::find(body.vertices.begin(), body.vertices.end(), corners[i]);
    place[i] = static_cast<std::size_t>(found - body.vertices.begin());
    if (found == body.vertices.end()) body.vertices.push_back(corners[i]);
  }
  for (const auto& side : sides) {
    std::vector<std::size_t> face;
    for (const std::size_t i : side)
      if (std::find(face.begin(), face.end(), place[i]) == face.end()) face.push_back(place[i]);
    if (face.size() > 2) body.faces.push_back(std::move(face));
  }
  return {std::move(body)};
}

class ShapeMaker {
 public:
  explicit ShapeMaker(BodyReader& read) : read_(read) {}

  Shape make(const CsgBody& body) {
    if (body.operands.size() == 1) return make(body.operands.front());
    return {BooleanShape{BooleanOperation::union_, make_all(body.operands)}, body.id_in_source};
  }
  Shape make(const ImportBody& body) {
    const auto file = read_.data().checked.resources().find(body.href.text);
    if (!file) read_.fail(Code::href_outside, {body.id_in_source, "href"}, {body.href.text});
    return {ImportShape{.file = file.value_or(Resource{}),
                        .sha256 = body.sha256,
                        .scale = body.unit ? millimeters_per(*body.unit) : 1,
                        .transform = body.transform
                                         ? read_.affine(body.transform->matrix, body.transform->mirror.value_or(false))
                                         : Affine{}},
            body.id_in_source};
  }
  Shape make(const ImplicitBody& body) { return {ImplicitShape{&body}, body.id_in_source}; }
  Shape make(const PartBody& body) {
    const auto& parts = read_.data().document().parts.items;
    const auto part =
        std::find_if(parts.begin(), parts.end(), [&](const Part& p) { return p.id.text == body.part.text; });
    return {PartShape{part == parts.end() ? nullptr : &*part}, body.id_in_source};
  }

 private:
  using Expr = std::optional<Expression>;

  Shape make(const CsgNode& node) {
    return std::visit([&](const auto& e) { return Shape{make_node(e), e.id_in_source}; }, node.value);
  }
  std::vector<Shape> make_all(const std::vector<CsgNode>& nodes) {
    std::vector<Shape> shapes;
    shapes.reserve(nodes.size());
    for (const CsgNode& node : nodes) shapes.push_back(make(node));
    return shapes;
  }

  // A template, so that an Expression is not copied into an optional: the table knows expressions by their address.
  template <class E>
  Vec3 point(const E& x, const E& y, const E& z) {
    return {read_.length(x), read_.length(y), read_.length(z)};
  }
  void need_volume(bool good, const Element& e, std::string why) {
    if (!good) read_.fail(Code::body_degenerate, {e.id_in_source, {}}, {std::move(why)});
  }
  template <class E>
  std::pair<Vec3, Vec3> ends(const E& e) {
    const Vec3 from = point(e.x1, e.y1, e.z1), to = point(e.x2, e.y2, e.z2);
    need_volume(norm(to - from) > 0, e, "its two ends are one point");
    return {from, to};
  }

  using Value = decltype(Shape::value);
  Value make_node(const BoxPrimitive& e) {
    return BoxShape{point(e.x, e.y, e.z),
                    {read_.positive_length(e.dx), read_.positive_length(e.dy), read_.positive_length(e.dz)}};
  }
  Value make_node(const SpherePrimitive& e) {
    return SphereShape{point(e.x, e.y, e.z), read_.positive_length(e.radius)};
  }
  Value make_node(const EllipsoidPrimitive& e) {
    return EllipsoidShape{point(e.x, e.y, e.z),
                          {read_.positive_length(e.rx), read_.positive_length(e.ry), read_.positive_length(e.rz)}};
  }
  Value make_node(const CylinderPrimitive& e) {
    const auto [from, to] = ends(e);
    return CylinderShape{from, to, read_.positive_length(e.radius)};
  }
  Value make_node(const ConePrimitive& e) {
    const auto [from, to] = ends(e);
    const double r1 = read_.length_not_negative(e.radius1), r2 = read_.length_not_negative(e.radius2);
    need_volume(r1 > 0 || r2 > 0, e, "both radii are 0");
    if (r1 == r2) return CylinderShape{from, to, r1};
    return ConeShape{from, to, r1, r2};
  }
  Value make_node(const TorusPrimitive& e) {
    const double major = read_.positive_length(e.major_radius), minor = read_.positive_length(e.minor_radius);
    if (major <= minor)
      read_.fail(Code::torus_radii, {e.id_in_source, {}}, {format_number(major), format_number(minor)});
    const bool has_axis = e.ax || e.ay || e.az;
    const Vec3 axis = has_axis ? point(e.ax, e.ay, e.az) : Vec3{0, 0, 1};
    if (norm(axis) == 0) read_.fail(Code::direction_zero, {e.id_in_source, {}}, {});
    return TorusShape{point(e.x, e.y, e.z), axis / norm(axis), major, minor};
  }
  Value make_node(const ExtrusionPrimitive& e) {
    ExtrusionShape shape{read_.length(e.z), read_.positive_length(e.height), {}};
    for (const ProfilePoint& p : e.points) shape.points.emplace_back(read_.length(p.x), read_.length(p.y));
    double doubled_area = 0;
    for (std::size_t i = 0; i < shape.points.size(); ++i) {
      const auto [x1, y1] = shape.points[i];
      const auto [x2, y2] = shape.points[(i + 1) % shape.points.size()];
      doubled_area += x1 * y2 - x2 * y1;
      need_volume(x1 != x2 || y1 != y2, e, "two neighbouring points of its profile are equal");
    }
    need_volume(doubled_area != 0, e, "its profile has no area");
    return shape;
  }
  Value make_node(const WedgePrimitive& e) {
    const Vec3 size{read_.positive_length(e.dx), read_.positive_length(e.dy), read_.positive_length(e.dz)};
    const Vec3 bottom = point(e.x, e.y, e.z), top = bottom + Vec3{read_.length(e.top_x), read_.length(e.top_y), size.z};
    return wedge(bottom, size.x, size.y, top, e.top_dx ? read_.length_not_negative(*e.top_dx) : size.x,
                 e.top_dy ? read_.length_not_negative(*e.top_dy) : size.y);
  }
  Value make_node(const RevolutionPrimitive& e);
  Value make_node(const PolyhedronPrimitive& e);
  Value make_node(const VolumeElementPrimitive& e);
  template <BooleanOperation Operation>
  Value make_node(const CsgBoolean<Operation>& e) {
    return BooleanShape{Operation, make_all(e.operands)};
  }
  Value make_node(const CsgTransform& e) {
    return TransformedShape{read_.affine(e.matrix, e.mirror.value_or(false)), make_all(e.operands)};
  }
  Value make_node(const CsgTranslate& e) {
    return TransformedShape{Affine::from_translation(point(e.x, e.y, e.z)), make_all(e.operands)};
  }
  Value make_node(const CsgRotate& e) {
    const Vec3 axis{read_.number(e.x), read_.number(e.y), read_.number(e.z)};
    if (norm(axis) == 0) read_.fail(Code::direction_zero, {e.id_in_source, {}}, {});
    return TransformedShape{{rotation(axis / norm(axis), read_.number(e.angle)), {}}, make_all(e.operands)};
  }
  Value make_node(const CsgScale& e) {
    Affine map;
    const Expr* factors[] = {&e.x, &e.y, &e.z};
    for (std::size_t i = 0; i < 3; ++i) {
      const Expr& factor = e.factor ? e.factor : *factors[i];
      map.linear(i, i) = factor ? read_.positive(*factor) : 1;
    }
    return TransformedShape{map, make_all(e.operands)};
  }

  BodyReader& read_;
};

ShapeMaker::Value ShapeMaker::make_node(const RevolutionPrimitive& e) {
  RevolutionShape shape;
  for (const MeridianPoint& p : e.points) shape.points.emplace_back(read_.length_not_negative(p.r), read_.length(p.z));
  if (const auto fault = polygon_fault(shape.points, 0))
    read_.fail(Code::revolution_profile, {e.id_in_source, {}}, {*fault});
  return shape;
}

ShapeMaker::Value ShapeMaker::make_node(const PolyhedronPrimitive& e) {
  Polyhedron body;
  for (const PolyhedronVertex& v : e.vertices) body.vertices.push_back(point(v.x, v.y, v.z));
  for (const PolyhedronFace& face : e.faces) body.faces.push_back(read_.indices(face.vertices));
  if (!read_.ok()) return {};
  if (auto fault = polyhedron_fault(body))
    read_.fail(fault->code, {e.faces[fault->face].id_in_source, "vertices"}, std::move(fault->args));
  return PolyhedronShape{std::move(body)};
}

ShapeMaker::Value ShapeMaker::make_node(const VolumeElementPrimitive& e) {
  VolumeElementShape shape;
  const auto found = read_.data().frames.find(e.coordinate_system.text);
  const double scale = read_.data().millimeters();
  shape.system = std::make_shared<CoordinateFrame>(found->second->scaled(scale));
  for (std::size_t i = 0; i < 3 && i < e.ranges.size(); ++i) {
    const AxisRange& range = e.ranges[i];
    const auto& axes = shape.system->axes();
    const auto axis =
        std::find_if(axes.begin(), axes.end(), [&](const CoordinateAxis& a) { return a.name == range.axis.text; });
    const bool circular = axis->kind == AxisKind::circular;
    shape.axes[i] = static_cast<std::size_t>(axis - axes.begin());
    shape.from[i] = circular ? read_.number(range.from) : read_.length(range.from);
    shape.to[i] = circular ? read_.number(range.to) : read_.length(range.to);
    const std::string from = format_number(circular ? shape.from[i] : shape.from[i] / scale);
    if (!(shape.from[i] < shape.to[i]))
      read_.fail(Code::range_empty, {range.id_in_source, "to"},
                 {from, format_number(circular ? shape.to[i] : shape.to[i] / scale)});
    if (axis->kind == AxisKind::distance && shape.from[i] < 0)
      read_.fail(Code::distance_negative, {range.id_in_source, "from"}, {range.axis.text, from});
    if (circular && shape.to[i] - shape.from[i] > 2 * std::numbers::pi * (1 + 1e-12))
      read_.fail(Code::range_full_turn, {range.id_in_source, "to"}, {format_number(shape.to[i] - shape.from[i])});
  }
  return shape;
}

}  // namespace

std::optional<Shape> make_shape(const EvaluationData& data, const BodyTable& table,
                                const Macrostructure& macrostructure, std::span<const double> slots,
                                const Report& report) {
  BodyReader read(data, table, slots, report);
  ShapeMaker maker(read);
  const auto* csg = std::get_if<CsgBody>(&macrostructure.body);
  Shape shape = csg != nullptr ? maker.make(*csg) : maker.make(std::get<ImportBody>(macrostructure.body));
  if (!read.ok()) return std::nullopt;
  return shape;
}

std::optional<Shape> make_shape(const EvaluationData& data, const BodyTable& table, const UnitCell& cell,
                                std::span<const double> slots, const Report& report, const NodeRules& rules) {
  if (const auto* beams = std::get_if<BeamsBody>(&cell.body))
    return make_beams(data, table, *beams, slots, report, rules);
  BodyReader read(data, table, slots, report);
  ShapeMaker maker(read);
  Shape shape = std::visit(
      [&](const auto& body) -> Shape {
        using T = std::decay_t<decltype(body)>;
        if constexpr (std::is_same_v<T, std::monostate> || std::is_same_v<T, BeamsBody>)
          return {};
        else
          return maker.make(body);
      },
      cell.body);
  if (!read.ok()) return std::nullopt;
  return shape;
}

std::optional<BoxShape> make_box(const EvaluationData& data, const BodyTable& table, const CellBox& box,
                                 std::span<const double> slots, const Report& report) {
  BodyReader read(data, table, slots, report);
  const BoxShape shape{{read.length(box.x), read.length(box.y), read.length(box.z)},
                       {read.positive_length(box.dx), read.positive_length(box.dy), read.positive_length(box.dz)}};
  if (!read.ok()) return std::nullopt;
  return shape;
}

}  // namespace meso::eval
