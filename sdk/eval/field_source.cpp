// SPDX-License-Identifier: Apache-2.0
// Values of a field at records and at points. Reading it is in field_loader.cpp.
#include "field_source.hpp"

#include <algorithm>
#include <cmath>

#include "evaluation_impl.hpp"
#include "meso/base/number.hpp"
#include "meso/fields/symmetric_tensor.hpp"
#include "orientation.hpp"

namespace meso::eval {
namespace {

using Kind = FieldQuantity::Kind;
constexpr double singular_sine = 1e-9;  // of the angle between coordinate lines

std::string place_text(Vec3 p) { return format_number(p.x) + ", " + format_number(p.y) + ", " + format_number(p.z); }

}  // namespace

void FieldSource::coordinates(std::size_t record, std::span<double> q) const {
  if (!grid_) {
    for (std::size_t a = 0; a < position_.size(); ++a) {
      const Column& c = columns_[position_[a]];
      q[a] = c.factor * records_(record, c.column);
    }
    return;
  }
  std::fill(q.begin(), q.end(), 0);
  for (std::size_t a = grid_axes_.size(); a-- > 0;) {
    const std::vector<double>& nodes = grid_->axes()[a];
    q[grid_axes_[a]] = nodes[record % nodes.size()];
    record /= nodes.size();
  }
}

Vec3 FieldSource::place(std::size_t record) const {
  std::vector<double> q(system_->axes().size());
  coordinates(record, q);
  return system_->point(q);
}

double FieldSource::component(std::size_t c, const Origin& origin) const {
  return origin.constant ? *origin.constant : columns_[c].factor * origin.stencil(records_, columns_[c].column);
}

double FieldSource::magnitude(const Origin& origin) const {
  double sum = 0, largest = 0;
  const auto& components = field_->structure->components;
  std::vector<double> values;
  for (std::size_t c = 0; c < components.size(); ++c) {
    if (components[c].role != ComponentRole::vector) continue;
    values.push_back(component(c, origin));
    largest = std::max(largest, std::abs(values.back()));
  }
  if (largest == 0) return 0;
  for (const double v : values) sum += (v / largest) * (v / largest);
  return largest * std::sqrt(sum);
}

// With J the derivative of P along the grid's axes: the vector in the space of J's columns whose products with them are
// the derivatives, J (J^T J)^-1 d.
std::optional<Vec3> FieldSource::gradient(std::size_t c, const Origin& origin) const {
  if (origin.constant) return Vec3{};
  const std::array<double, fields::most_grid_axes> d = grid_->derivative(records_, columns_[c].column, origin.stencil);
  const Mat3 turn = system_->turn(origin.q);
  const Affine& world = system_->world_from_system();
  const auto& axes = system_->axes();
  Vec3 columns[3];
  for (std::size_t a = 0; a < grid_axes_.size(); ++a) {
    const CoordinateAxis& axis = axes[grid_axes_[a]];
    if (axis.kind == AxisKind::linear) columns[a] = world.linear * axis.direction;
    if (axis.kind == AxisKind::distance) columns[a] = world.linear * (turn * axis.direction);
    if (axis.kind != AxisKind::circular) continue;
    // The axis as the outer rotations leave it, crossed with what it turns.
    Mat3 outer;
    Vec3 turned;
    for (std::size_t i = 0; i < axes.size(); ++i) {
      if (axes[i].kind == AxisKind::circular && i < grid_axes_[a])
        outer = outer * rotation(axes[i].direction, origin.q[i]);
      if (axes[i].kind == AxisKind::distance) turned += origin.q[i] * axes[i].direction;
    }
    columns[a] = world.linear * cross(outer * axis.direction, turn * turned);
  }
  // Orthogonal directions in turn (Gram and Schmidt); with them J is triangular.
  Vec3 result, unit[3];
  double along[3]{};
  for (std::size_t a = 0; a < grid_axes_.size(); ++a) {
    Vec3 left = columns[a];
    double known = 0;
    for (std::size_t b = 0; b < a; ++b) {
      const double part = dot(columns[a], unit[b]);
      left = left - part * unit[b];
      known += part * along[b];
    }
    const double length = norm(left);
    if (!(length > singular_sine * norm(columns[a])) || norm(columns[a]) == 0) {
      if (d[a] == 0 && known == 0) continue;
      return std::nullopt;
    }
    unit[a] = left / length;
    along[a] = (d[a] - known) / length;
    result += along[a] * unit[a];
  }
  return columns_[c].factor * result;
}

bool FieldSource::fill(const Origin& origin, std::span<const QuantitySlot> wanted, std::span<double> slots,
                       const Place& where, const Report& report) const {
  std::optional<fields::Principal> principal;
  const auto tensor = [&] {
    double v[6];
    for (std::size_t i = 0; i < 6; ++i) v[i] = component(tensor_[i], origin);
    return fields::SymmetricTensor{v[0], v[1], v[2], v[3], v[4], v[5]};
  };
  for (const QuantitySlot& w : wanted) {
    const FieldQuantity& q = w.quantity;
    double& value = slots[w.slot];
    if ((q.kind == Kind::principal || q.kind == Kind::direction) && !principal) principal = fields::principal(tensor());
    switch (q.kind) {
      case Kind::component:
        value = component(q.which, origin);
        break;
      case Kind::magnitude:
        value = magnitude(origin);
        break;
      case Kind::principal:
        value = principal->value[q.which];
        break;
      case Kind::direction:
        value = principal->direction[q.which][q.axis];
        break;
      case Kind::von_mises:
        value = fields::von_mises(tensor());
        break;
      case Kind::gradient: {
        const auto g = gradient(q.which, origin);
        if (!g) {
          report(Code::field_no_derivative, where, {field_->id.text, place_text(origin.global)});
          return false;
        }
        value = (*g)[q.axis];
      }
    }
    if (std::isfinite(value)) continue;
    report(Code::expression_domain, where, {field_->id.text + "." + q.name});
    return false;
  }
  return true;
}

bool FieldSource::at_record(std::size_t record, std::span<const QuantitySlot> wanted, std::span<double> slots,
                            const Place& where, const Report& report) const {
  if (wanted.empty()) return true;
  std::vector<double> q;
  Origin origin;
  origin.stencil.add(static_cast<std::int64_t>(record), 1);
  if (grid_) {
    q.resize(system_->axes().size());
    coordinates(record, q);
    origin.q = q;
    origin.global = system_->point(q);
  }
  return fill(origin, wanted, slots, where, report);
}

bool FieldSource::outside(Origin& origin, const Place& where, const Report& report) const {
  if (outside_value_) {
    origin.constant = outside_value_;
    return true;
  }
  report(Code::field_outside, where, {field_->id.text, place_text(origin.global)});
  return false;
}

bool FieldSource::locate(Origin& origin, std::vector<double>& q, const Place& where, const Report& report) const {
  const Vec3 p = origin.global;
  const InterpolationMethod method = field_->interpolation->method;
  const bool clamps = field_->outside && field_->outside->rule == OutsideRule::clamp;
  if (method == InterpolationMethod::linear && grid_) {
    std::vector<std::array<double, 2>> ranges(system_->axes().size(), {0, 0});
    for (std::size_t a = 0; a < grid_axes_.size(); ++a)
      ranges[grid_axes_[a]] = {grid_->axes()[a].front(), grid_->axes()[a].back()};
    auto found = coordinates_at(*system_, p, ranges);
    if (!found) {
      report(Code::field_not_realised, where, {field_->id.text, "interpolation in this kind of coordinate system"});
      return false;
    }
    q = std::move(*found);
    origin.q = q;
    double on_grid[fields::most_grid_axes]{};
    for (std::size_t a = 0; a < grid_axes_.size(); ++a) on_grid[a] = q[grid_axes_[a]];
    const std::span<const double> coordinates(on_grid, grid_axes_.size());
    if (!clamps && !grid_->contains(coordinates)) return outside(origin, where, report);
    origin.stencil = grid_->at(coordinates);
    return true;
  }
  if (method == InterpolationMethod::linear) {
    if (const auto stencil = mesh_->at(p))
      origin.stencil = *stencil;
    else if (clamps)
      origin.stencil.add(search_->nearest(p), 1);
    else
      return outside(origin, where, report);
    return true;
  }
  const Box3& box = search_->box();
  Box3 point;
  point.extend(p);
  if (!clamps && !box.intersects(point)) return outside(origin, where, report);
  if (method == InterpolationMethod::nearest)
    origin.stencil.add(search_->nearest(p), 1);
  else
    origin.stencil = search_->inverse_distance(p, power_);
  // A gradient at the nearest node is that of the node.
  if (grid_) {
    q.resize(system_->axes().size());
    coordinates(static_cast<std::size_t>(origin.stencil.record[0]), q);
    origin.q = q;
  }
  return true;
}

bool FieldSource::at_point(Vec3 global, std::span<const QuantitySlot> wanted, std::span<double> slots,
                           const Place& where, const Report& report) const {
  if (wanted.empty()) return true;
  if (wall_) {
    const MacrostructureDistance::Answer answer = wall_->at(millimeters_ * global);
    const double values[] = {answer.distance / millimeters_, answer.normal.x, answer.normal.y, answer.normal.z,
                             answer.curvature.value_or(0) * millimeters_};
    for (const QuantitySlot& w : wanted) {
      slots[w.slot] = values[w.quantity.which];
      if (w.quantity.which < 4 || answer.curvature) continue;
      report(Code::field_not_realised, where, {field_->id.text, "the curvature of a macrostructure"});
      return false;
    }
    return true;
  }
  Origin origin;
  origin.global = global;
  std::vector<double> q;
  return locate(origin, q, where, report) && fill(origin, wanted, slots, where, report);
}

std::shared_ptr<const FieldSource> FieldCache::find(const EvaluationData& data, const VectorField& field,
                                                    bool for_sampling, const Report& report) {
  const std::lock_guard lock(mutex_);
  std::shared_ptr<FieldSource>& known = sources_[field.id.text];
  if (!known) {
    known = FieldSource::load(data, field, report);
    if (!known) return nullptr;
  }
  // Sampling is prepared before the first walker sees the field.
  if (for_sampling && !known->prepare_sampling(data, report)) return nullptr;
  return known;
}

}  // namespace meso::eval
