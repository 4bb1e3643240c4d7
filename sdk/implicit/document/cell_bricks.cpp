// SPDX-License-Identifier: Apache-2.0
#include "cell_bricks.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "strut_rows.hpp"

namespace meso::implicit {
namespace {

constexpr std::int32_t side = 8;  ///< samples of a brick; one row of it is strut_lanes
static_assert(side == strut_lanes);

/// What all threads share.
struct Shared {
  Shared(std::shared_ptr<const PlacedCells> placed, const Grid& nodes, const Affine& map, double band)
      : cells(std::move(placed)), grid(nodes), field_from_grid(map), row(strut_row()) {
    Vec3 brick;
    for (std::size_t a = 0; a < 3; ++a) {
      edge = std::max(edge, grid.spacing(a) * norm(map.linear.column(a)));
      const std::int32_t most = std::min(side, grid.nodes[a]) - 1;
      brick += most * grid.spacing(a) / 2 *
               Vec3{std::abs(map.linear(0, a)), std::abs(map.linear(1, a)), std::abs(map.linear(2, a))};
      counts[a] = (grid.nodes[a] + side - 1) / side;
      inverse_spacing[a] = 1 / grid.spacing(a);
    }
    // Both ends of an edge that the surface crosses are exact, and everything within the band.
    exact_within = margin = band + edge * std::max(1.0, cells->lipschitz()) * (1 + 1e-9);
    is_exact = !(margin < cells->reach());
    if (is_exact) margin = cells->reach();
    far = is_exact ? margin : 2 * margin;
    half = brick * (1 + 1e-12);
    radius = norm(half);
    xs.resize(static_cast<std::size_t>(counts[0]) * side);
    for (std::size_t i = 0; i < xs.size(); ++i)
      xs[i] = grid.coordinate(0, std::min(static_cast<std::int32_t>(i), grid.nodes[0] - 1));
  }

  std::shared_ptr<const PlacedCells> cells;
  Grid grid;
  Affine field_from_grid;
  StrutRow row;
  std::array<std::int32_t, 3> counts{};
  double margin = 0, radius = 0;
  double edge = 0;          ///< the longest step of the grid, in the field's space
  double exact_within = 0;  ///< of rows: no more than is asked beside a surface, which is kept in memory
  double far = 0;           ///< what stands where nothing is near
  bool is_exact = false;    ///< values count everywhere, deep inside too
  Vec3 half;                ///< of a brick's box in the field's space
  Vec3 inverse_spacing;
  std::vector<double> xs;  ///< of nodes, to full bricks
};

/// What reaches into the bricks of one layer, looked up brick by brick when it is asked for.
class Layer {
 public:
  enum class State : std::uint8_t { unknown, outside, inside, mixed };
  struct Brick {
    State state = State::unknown;
    std::uint32_t capsule = 0, capsules = 0, field = 0, fields = 0;
  };

  void enter(std::int32_t z, std::size_t bricks) {
    z_ = z;
    bricks_.assign(bricks, {});
    capsules_.clear();
    fields_.clear();
  }
  [[nodiscard]] std::int32_t z() const { return z_; }

  const Brick& brick(const Shared& shared, std::int32_t x, std::int32_t y) {
    Brick& brick =
        bricks_[static_cast<std::size_t>(y) * static_cast<std::size_t>(shared.counts[0]) + static_cast<std::size_t>(x)];
    if (brick.state == State::unknown) look_up(shared, x, y, brick);
    return brick;
  }
  [[nodiscard]] const Capsule* capsules(const Brick& b) const { return capsules_.data() + b.capsule; }
  [[nodiscard]] std::span<const PlacedField> fields(const Brick& b) const {
    return {fields_.data() + b.field, b.fields};
  }

 private:
  struct Candidate {
    Capsule capsule;
    double distance;  ///< of the brick's middle
  };

  void look_up(const Shared& shared, std::int32_t x, std::int32_t y, Brick& brick) {
    const Vec3 middle = middle_of(shared, x, y);
    const double reach = shared.radius + shared.margin;
    const Box3 box{middle - shared.half, middle + shared.half};
    const Vec3 by{shared.margin, shared.margin, shared.margin};
    double nearest = HUGE_VAL;
    bool filled = false;
    candidates_.clear();
    brick.field = static_cast<std::uint32_t>(fields_.size());
    shared.cells->index().visit({box.min - by, box.max + by}, [&](const Primitive& primitive, Vec3 displacement) {
      if (primitive.is_capsule()) {
        Capsule capsule = primitive.capsule;
        capsule.from += displacement;
        const double distance = axis_distance(capsule, middle) - capsule.radius;
        if (distance > reach) return;
        nearest = std::min(nearest, distance);
        candidates_.push_back({capsule, distance});
      } else {
        const Interval values = primitive.placed.interval({box.min - displacement, box.max - displacement});
        if (values.lo > shared.margin) return;
        filled = filled || (!shared.is_exact && values.hi < -shared.margin && !values.undefined);
        fields_.push_back(primitive.moved_by(displacement).placed);
      }
    });
    filled = filled || (!shared.is_exact && nearest + shared.radius < -shared.margin);
    if (filled) fields_.resize(brick.field);
    brick.fields = static_cast<std::uint32_t>(fields_.size()) - brick.field;
    brick.capsule = static_cast<std::uint32_t>(capsules_.size());
    if (!filled) keep_candidates(nearest + 2 * shared.radius);
    brick.capsules = static_cast<std::uint32_t>(capsules_.size()) - brick.capsule;
    brick.state = filled ? State::inside : brick.capsules + brick.fields == 0 ? State::outside : State::mixed;
  }

  /// Those that may be the nearest somewhere in the brick, once each, equal radii together.
  void keep_candidates(double farthest) {
    std::stable_sort(candidates_.begin(), candidates_.end(),
                     [](const Candidate& a, const Candidate& b) { return a.capsule.radius > b.capsule.radius; });
    const std::size_t first = capsules_.size();
    for (const Candidate& c : candidates_) {
      if (c.distance > farthest) continue;
      const bool known = std::any_of(capsules_.begin() + static_cast<std::ptrdiff_t>(first), capsules_.end(),
                                     [&](const Capsule& other) { return are_one(c.capsule, other); });
      if (!known) capsules_.push_back(c.capsule);
    }
  }
  /// Neighbouring cells both place what they share, up to rounding.
  static bool are_one(const Capsule& a, const Capsule& b) {
    constexpr double rounding = 1e-10;
    const auto near = [](Vec3 u, Vec3 v) {
      const Vec3 d = u - v;
      return std::abs(d.x) + std::abs(d.y) + std::abs(d.z) < rounding;
    };
    return a.radius == b.radius &&
           ((near(a.from, b.from) && near(a.axis, b.axis)) || (near(a.from + a.axis, b.from) && near(a.axis, -b.axis)));
  }

  Vec3 middle_of(const Shared& shared, std::int32_t x, std::int32_t y) const {
    const std::array<std::int32_t, 3> at{x, y, z_};
    Vec3 middle;
    for (std::size_t a = 0; a < 3; ++a) {
      const std::int32_t first = at[a] * side, last = first + std::min(side, shared.grid.nodes[a]) - 1;
      // The last brick of a row may reach beyond the grid.
      middle[a] = shared.grid.box.min[a] + shared.grid.spacing(a) * (first + last) / 2;
    }
    return shared.field_from_grid * middle;
  }

  std::int32_t z_ = -1;
  std::vector<Brick> bricks_;
  std::vector<Capsule> capsules_;
  std::vector<PlacedField> fields_;
  std::vector<Candidate> candidates_;
};

class Rows final : public ExternalRows {
 public:
  explicit Rows(std::shared_ptr<const Shared> shared) : shared_(std::move(shared)) {}

  void row(std::int32_t j, std::int32_t k, std::int32_t first, std::int32_t last, double* out) override {
    const Shared& s = *shared_;
    Layer& layer = layer_at(k / side);
    const Vec3 start = s.field_from_grid * Vec3{0, s.grid.coordinate(1, j), s.grid.coordinate(2, k)};
    const Line line{start, s.field_from_grid.linear.column(0)};
    std::array<double, side> values;
    for (std::int32_t i = first; i < last;) {
      const std::int32_t x = i / side, end = std::min(last, (x + 1) * side);
      const Layer::Brick& brick = layer.brick(s, x, j / side);
      if (brick.state == Layer::State::mixed) {
        const bool whole = end - i == side;
        double* const to = whole ? out + (i - first) : values.data();
        sample(layer, brick, line, s.xs.data() + std::ptrdiff_t{x} * side, to);
        if (!whole) std::copy(to + (i - x * side), to + (end - x * side), out + (i - first));
      } else {
        std::fill(out + (i - first), out + (end - first), brick.state == Layer::State::inside ? -s.far : s.far);
      }
      i = end;
    }
  }

  void values_at(std::span<const Vec3> points, std::span<const double> within, double* out) override {
    const Shared& s = *shared_;
    for (std::size_t first = 0; first < points.size();) {
      const std::array<std::int32_t, 3> at = brick_of(points[first]);
      near_.assign(1, s.field_from_grid * points[first]);
      std::size_t last = first + 1;
      double radius = 0;
      for (; last < points.size() && brick_of(points[last]) == at; ++last) {
        const Vec3 p = s.field_from_grid * points[last];
        const double distance = norm(p - near_[0]);
        if (std::isfinite(s.cells->lipschitz()) && !(distance <= s.edge)) break;
        radius = std::max(radius, distance);
        near_.push_back(p);
      }
      Layer& layer = layer_at(at[2]);
      sample_near(layer, layer.brick(s, at[0], at[1]), radius, out + first);
      // What the brick does not know is at least the margin away.
      for (std::size_t n = first; n < last; ++n)
        if (std::abs(out[n]) > s.margin && !(within[n] <= s.margin)) out[n] = s.cells->value(near_[n - first]);
      first = last;
    }
  }

 private:
  /// The planes of a slab lie in three layers at most.
  Layer& layer_at(std::int32_t z) {
    Layer& layer = layers_[static_cast<std::size_t>(z) % layers_.size()];
    if (layer.z() != z) layer.enter(z, std::size_t(shared_->counts[0]) * std::size_t(shared_->counts[1]));
    return layer;
  }
  [[nodiscard]] std::array<std::int32_t, 3> brick_of(Vec3 p) const {
    std::array<std::int32_t, 3> at{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double node = (p[axis] - shared_->grid.box.min[axis]) * shared_->inverse_spacing[axis] + 0.5;
      at[axis] = std::clamp(static_cast<std::int32_t>(node), 0, shared_->grid.nodes[axis] - 1) / side;
    }
    return at;
  }

  /// Of `near_`, all of them within `radius` of the first. Where slopes are bounded, what fields are at the first tells
  /// which of them can be the least of all at the others. Those are asked for all points at once.
  void sample_near(const Layer& layer, const Layer::Brick& brick, double radius, double* out) {
    std::fill_n(out, near_.size(), brick.state == Layer::State::inside ? -shared_->far : shared_->far);
    const Capsule* const capsules = layer.capsules(brick);
    for (std::uint32_t c = 0; c < brick.capsules; ++c)
      for (std::size_t n = 0; n < near_.size(); ++n)
        out[n] = std::min(out[n], axis_distance(capsules[c], near_[n]) - capsules[c].radius);
    const std::span<const PlacedField> fields = layer.fields(brick);
    const bool can_tell = near_.size() > 1 && std::isfinite(shared_->cells->lipschitz());
    double most = HUGE_VAL;
    lows_.assign(fields.size(), -HUGE_VAL);
    for (std::size_t f = 0; can_tell && f < fields.size(); ++f) {
      const double value = fields[f].value(near_[0]), change = fields[f].lipschitz * radius;
      const double slack = 1e-9 * (std::abs(value) + change);  // rounding must leave none out
      lows_[f] = value - change - slack;
      most = std::min(most, value + change + slack);
    }
    values_.resize(near_.size());
    for (std::size_t f = 0; f < fields.size(); ++f) {
      if (lows_[f] > most) continue;
      fields[f].values(near_, local_, values_.data());
      for (std::size_t n = 0; n < near_.size(); ++n) out[n] = std::min(out[n], values_[n]);
    }
  }

  void sample(const Layer& layer, const Layer::Brick& brick, const Line& line, const double* x, double* out) {
    const double most = shared_->far;
    shared_->row(layer.capsules(brick), brick.capsules, line, x, out);
    for (std::int32_t i = 0; i < side; ++i) out[i] = out[i] < most ? out[i] : most;
    for (const PlacedField& field : layer.fields(brick)) {
      std::array<Vec3, side> points;
      std::array<double, side> values;
      for (std::size_t i = 0; i < side; ++i) points[i] = line.origin + x[i] * line.direction;
      field.values(points, local_, values.data());
      for (std::size_t i = 0; i < side; ++i) out[i] = std::min(out[i], values[i]);
    }
  }

  std::shared_ptr<const Shared> shared_;
  std::array<Layer, 4> layers_;
  std::vector<Vec3> near_, local_;  // points that are asked together
  std::vector<double> lows_, values_;
};

class PreparedBricks final : public ExternalField::Prepared {
 public:
  explicit PreparedBricks(std::shared_ptr<const Shared> shared) : shared_(std::move(shared)) {}
  [[nodiscard]] std::unique_ptr<ExternalRows> make_rows() const override { return std::make_unique<Rows>(shared_); }
  [[nodiscard]] double exact_within() const override { return shared_->exact_within; }

 private:
  std::shared_ptr<const Shared> shared_;
};

}  // namespace

std::unique_ptr<ExternalField::Prepared> prepare_bricks(std::shared_ptr<const PlacedCells> cells, const Grid& grid,
                                                        const Affine& field_from_grid, double band) {
  return std::make_unique<PreparedBricks>(
      std::make_shared<const Shared>(std::move(cells), grid, field_from_grid, band));
}

}  // namespace meso::implicit
