// SPDX-License-Identifier: Apache-2.0
#include "conformal.hpp"

#include <cmath>
#include <numbers>

#include "meso/base/number.hpp"

namespace meso::eval {
namespace {

double coordinate(const PlacedCell& cell, const BoxShape& box, Vec3 p, std::size_t axis) {
  return cell.q[axis] + (p[axis] - box.corner[axis]) / box.size[axis] * cell.step[axis];
}

class Mapper {
 public:
  Mapper(std::shared_ptr<const CoordinateFrame> frame, const PlacedCell& cell, const BoxShape& box,
         const Report& report)
      : frame_(std::move(frame)), cell_(cell), box_(box), report_(report) {}

  std::optional<Shape> map(const Shape& shape) const {
    if (const auto* box = std::get_if<BoxShape>(&shape.value)) return map_box(*box, shape.source);
    if (const auto* boolean = std::get_if<BooleanShape>(&shape.value)) {
      BooleanShape result{boolean->operation, {}};
      for (const Shape& operand : boolean->operands) {
        auto mapped = map(operand);
        if (!mapped) return std::nullopt;
        result.operands.push_back(std::move(*mapped));
      }
      return Shape{std::move(result), shape.source};
    }
    report_(Code::conformal_not_realised, {shape.source, {}}, {"this body"});
    return std::nullopt;
  }

 private:
  std::optional<Shape> map_box(const BoxShape& body, ElementId source) const {
    for (std::size_t a = 3; a < cell_.q.size(); ++a) {
      if (cell_.q[a] == 0) continue;
      report_(Code::conformal_not_realised, {source, {}},
              {"a box away from 0 on the axis '" + frame_->axes()[a].name + "'"});
      return std::nullopt;
    }
    VolumeElementShape element{frame_, {0, 1, 2}, {}, {}};
    for (std::size_t i = 0; i < 3; ++i) {
      element.from[i] = coordinate(cell_, box_, body.corner, i);
      element.to[i] = coordinate(cell_, box_, body.corner + body.size, i);
      const CoordinateAxis& axis = frame_->axes()[i];
      if (axis.kind == AxisKind::distance && element.from[i] < 0) {
        if (element.from[i] < -1e-9) {
          report_(Code::distance_negative, {source, {}}, {axis.name, format_number(element.from[i])});
          return std::nullopt;
        }
        element.from[i] = 0;
      }
      const double range = element.to[i] - element.from[i];
      if (axis.kind == AxisKind::circular && range > 2 * std::numbers::pi * (1 + 1e-12)) {
        report_(Code::range_full_turn, {source, {}}, {format_number(range)});
        return std::nullopt;
      }
    }
    return Shape{std::move(element), source};
  }

  std::shared_ptr<const CoordinateFrame> frame_;
  const PlacedCell& cell_;
  const BoxShape& box_;
  const Report& report_;
};

}  // namespace

Vec3 map_point(const CoordinateFrame& frame_mm, const PlacedCell& cell, const BoxShape& box, Vec3 p) {
  std::vector<double> q(cell.q.begin(), cell.q.end());
  for (std::size_t axis = 0; axis < 3; ++axis) q[axis] = coordinate(cell, box, p, axis);
  return frame_mm.point(q);
}

std::optional<Shape> map_shape(const std::shared_ptr<const CoordinateFrame>& frame_mm, const PlacedCell& cell,
                               const BoxShape& box, const Shape& shape, const Report& report) {
  return Mapper(frame_mm, cell, box, report).map(shape);
}

}  // namespace meso::eval
