// SPDX-License-Identifier: Apache-2.0
#include "cell_bricks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "brick_contents.hpp"
#include "cell_period.hpp"

namespace meso::implicit {
namespace {

constexpr std::int32_t side = 8;  ///< samples of a brick; one row of it is strut_lanes
static_assert(side == strut_lanes);
constexpr std::int32_t part_side = 4;
constexpr std::size_t brick_parts = std::size_t{side / part_side} * (side / part_side) * (side / part_side);

/// What all threads share.
struct Shared {
  Shared(std::shared_ptr<const PlacedCells> placed, const Grid& nodes, const Affine& map, double band)
      : cells(std::move(placed)), grid(nodes), field_from_grid(map) {
    Vec3 brick;
    for (std::size_t a = 0; a < 3; ++a) {
      edge = std::max(edge, grid.spacing(a) * norm(map.linear.column(a)));
      const std::int32_t most = std::min(side, grid.nodes[a]) - 1;
      brick += most * grid.spacing(a) / 2 *
               Vec3{std::abs(map.linear(0, a)), std::abs(map.linear(1, a)), std::abs(map.linear(2, a))};
      counts[a] = (grid.nodes[a] + side - 1) / side;
      inverse_spacing[a] = 1 / grid.spacing(a);
    }
    // Both ends of an edge that the surface crosses are exact, and everything within the band; with some slack, as
    // nodes are often one step away from the plane wall of another body.
    const double wanted = (band + edge * std::max(1.0, cells->lipschitz())) * (1 + 1e-5);
    const bool is_exact = !(wanted < cells->reach());
    const double margin = is_exact ? cells->reach() : wanted;
    nearness = {margin, is_exact ? margin : 2 * margin, is_exact};
    half = brick * (1 + 1e-12);
    radius = norm(half);
    xs.resize(static_cast<std::size_t>(counts[0]) * side);
    for (std::size_t i = 0; i < xs.size(); ++i)
      xs[i] = grid.coordinate(0, std::min(static_cast<std::int32_t>(i), grid.nodes[0] - 1));
  }

  std::shared_ptr<const PlacedCells> cells;
  Grid grid;
  Affine field_from_grid;
  std::array<std::int32_t, 3> counts{};
  Nearness nearness;
  double radius = 0;
  double edge = 0;  ///< the longest step of the grid, in the field's space
  Vec3 half;        ///< of a brick's box in the field's space
  Vec3 inverse_spacing;
  std::vector<double> xs;                    ///< of nodes, to full bricks
  std::unique_ptr<const CellPeriod> period;  ///< where samples are copied
};

/// What reaches into the bricks of one layer, looked up brick by brick when it is asked for.
class Layer {
 public:
  void enter(std::int32_t z, std::size_t bricks) {
    z_ = z;
    bricks_.assign(bricks, {});
    contents_.clear();
    parts_.clear();
    kept_.clear();
  }
  [[nodiscard]] std::int32_t z() const { return z_; }
  [[nodiscard]] const BrickContents& contents() const { return contents_; }

  const Brick& brick(const Shared& shared, std::int32_t x, std::int32_t y) {
    Brick& brick = bricks_[number(shared, x, y)];
    if (brick.state == Brick::State::unknown)
      brick = contents_.add({middle_of(shared, x, y), shared.half, shared.radius}, shared.nearness,
                            [&](const Box3& box, auto f) { shared.cells->index().visit(box, f); });
    return brick;
  }

  static constexpr double most_steps_off = 0.51;
  /// Which of the brick's fields can be the least somewhere in the part of it where the node is: so many steps of the
  /// grid from its nodes, or less.
  std::span<const std::uint32_t> fields_near(const Shared& shared, const std::array<std::int32_t, 3>& node) {
    const std::size_t place = number(shared, node[0] / side, node[1] / side);
    parts_.resize(bricks_.size() * brick_parts);
    Part& part = parts_[place * brick_parts + part_of(node)];
    if (part.count == 0) {
      part.first = static_cast<std::uint32_t>(kept_.size());
      keep(contents_.fields(bricks_[place]), box_of_part(shared, node));
      part.count = static_cast<std::uint32_t>(kept_.size()) - part.first;
    }
    return {kept_.data() + part.first, part.count};
  }

  /// Within its brick.
  static std::size_t part_of(const std::array<std::int32_t, 3>& node) {
    std::size_t part = 0;
    for (const std::int32_t n : node) part = part * (side / part_side) + static_cast<std::size_t>(n % side / part_side);
    return part;
  }

 private:
  static std::size_t number(const Shared& shared, std::int32_t x, std::int32_t y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(shared.counts[0]) + static_cast<std::size_t>(x);
  }

  static Box3 box_of_part(const Shared& shared, const std::array<std::int32_t, 3>& node) {
    Vec3 middle, half;
    for (std::size_t a = 0; a < 3; ++a) {
      const double step = shared.grid.spacing(a);
      middle[a] = shared.grid.box.min[a] + step * (node[a] / part_side * part_side + (part_side - 1) / 2.0);
      for (std::size_t row = 0; row < 3; ++row)
        half[row] += step * ((part_side - 1) / 2.0 + most_steps_off) * std::abs(shared.field_from_grid.linear(row, a));
    }
    middle = shared.field_from_grid * middle;
    return {middle - half, middle + half};
  }

  void keep(std::span<const PlacedField> fields, const Box3& box) {
    values_.clear();
    double most = HUGE_VAL;
    for (const PlacedField& field : fields) {
      values_.push_back(field.interval(box));
      if (!values_.back().undefined) most = std::min(most, values_.back().hi);
    }
    for (std::size_t f = 0; f < fields.size(); ++f) {
      const double slack = 1e-9 * (std::abs(values_[f].lo) + std::abs(most));  // rounding must leave none out
      if (!(values_[f].lo > most + slack)) kept_.push_back(static_cast<std::uint32_t>(f));
    }
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
  BrickContents contents_;
  struct Part {
    std::uint32_t first = 0, count = 0;  // of kept_; not known yet: none
  };
  std::vector<Part> parts_;
  std::vector<std::uint32_t> kept_;  // numbers of fields in their bricks
  std::vector<Interval> values_;
};

class Rows final : public ExternalRows {
 public:
  explicit Rows(std::shared_ptr<const Shared> shared) : shared_(std::move(shared)), sampler_(shared_->nearness) {}

  void row(std::int32_t j, std::int32_t k, std::int32_t first, std::int32_t last, double* out) override {
    if (!shared_->period) return evaluate(j, k, first, last, out);
    for (const CellPeriod::Run& run : runs_of(j, k)) {
      const std::int32_t from = std::max(first, run.first), to = std::min(last, run.last);
      if (from >= to) continue;
      if (run.copied)
        shared_->period->copy(j, k, from, to, out + (from - first));
      else
        evaluate(j, k, from, to, out + (from - first));
    }
  }

  void values_at(std::span<const Vec3> points, std::span<const double> within, double* out) override {
    evaluate(points, within, out);
    if (!shared_->period) return;
    for (std::size_t n = 0; n < points.size(); ++n) {
      const auto copied = copied_at(points[n]);
      if (copied && std::abs(*copied) <= shared_->nearness.margin) out[n] = *copied;
    }
  }

 private:
  void evaluate(std::int32_t j, std::int32_t k, std::int32_t first, std::int32_t last, double* out) {
    const Shared& s = *shared_;
    Layer& layer = layer_at(k / side);
    const Line line = line_of(j, k);
    std::array<double, side> values;
    for (std::int32_t i = first; i < last;) {
      const std::int32_t x = i / side, end = std::min(last, (x + 1) * side);
      const Brick& brick = layer.brick(s, x, j / side);
      if (brick.fields > 0) {
        const double* const row = patch(layer, brick, x, j, k) + std::ptrdiff_t{j % side} * side;
        std::copy(row + i % side, row + (end - x * side), out + (i - first));
      } else if (brick.state == Brick::State::mixed) {
        const bool whole = end - i == side;
        double* const to = whole ? out + (i - first) : values.data();
        sampler_.sample(layer.contents(), brick, {&line, 1}, s.xs.data() + std::ptrdiff_t{x} * side, to);
        if (!whole) std::copy(to + (i - x * side), to + (end - x * side), out + (i - first));
      } else {
        std::fill(out + (i - first), out + (end - first),
                  brick.state == Brick::State::inside ? -s.nearness.far : s.nearness.far);
      }
      i = end;
    }
  }

  [[nodiscard]] Line line_of(std::int32_t j, std::int32_t k) const {
    const Shared& s = *shared_;
    return {s.field_from_grid * Vec3{0, s.grid.coordinate(1, j), s.grid.coordinate(2, k)},
            s.field_from_grid.linear.column(0)};
  }

  /// All rows of a brick in the plane k, of which row j is one; the others are asked for soon.
  const double* patch(const Layer& layer, const Brick& brick, std::int32_t x, std::int32_t j, std::int32_t k) {
    const Shared& s = *shared_;
    if (patches_.empty()) patches_.resize(std::size_t(s.counts[0]) * std::size_t(s.counts[1]));
    Patch& patch = patches_[std::size_t(j / side) * std::size_t(s.counts[0]) + std::size_t(x)];
    if (patch.k == k) return patch.values.data();
    std::array<Line, side> lines;
    const std::int32_t begin = j / side * side, rows = std::min(side, s.grid.nodes[1] - begin);
    for (std::int32_t r = 0; r < rows; ++r) lines[std::size_t(r)] = line_of(begin + r, k);
    sampler_.sample(layer.contents(), brick, {lines.data(), std::size_t(rows)}, s.xs.data() + std::ptrdiff_t{x} * side,
                    patch.values.data());
    patch.k = k;
    return patch.values.data();
  }

  void evaluate(std::span<const Vec3> points, std::span<const double> within, double* out) {
    const Shared& s = *shared_;
    places_.clear();
    for (std::size_t first = 0, last = 0; first < points.size(); first = last) {
      const std::array<std::int32_t, 3> at = brick_of(points[first]);
      while (++last < points.size() && brick_of(points[last]) == at) continue;
      Layer& layer = layer_at(at[2]);
      const Brick& brick = layer.brick(s, at[0], at[1]);
      if (brick.fields > 0) {
        for (std::size_t n = first; n < last; ++n) places_.push_back({place_of(points[n]), n});
        continue;
      }
      near_.clear();
      for (std::size_t n = first; n < last; ++n) near_.push_back(s.field_from_grid * points[n]);
      sample_near(layer, brick, {}, out + first);
      for (std::size_t n = first; n < last; ++n) out[n] = known(out[n], within[n], near_[n - first]);
    }
    if (!places_.empty()) evaluate_places(points, within, out);
  }

  /// Bodies by formula are asked for many points in little more time than for one: points that stand near each other
  /// are asked together, wherever they are in the list.
  void evaluate_places(std::span<const Vec3> points, std::span<const double> within, double* out) {
    const Shared& s = *shared_;
    std::ranges::sort(places_);
    for (std::size_t first = 0, last = 0; first < places_.size(); first = last) {
      near_.clear();
      double radius = 0;
      bool is_beside = true;
      for (; last < places_.size() && places_[last].place == places_[first].place; ++last) {
        near_.push_back(s.field_from_grid * points[places_[last].point]);
        radius = std::max(radius, norm(near_.back() - near_[0]));
        is_beside = is_beside && is_beside_node(points[places_[last].point]);
      }
      const std::array<std::int32_t, 3> node = node_at(points[places_[first].point]);
      Layer& layer = layer_at(node[2] / side);
      const Brick& brick = layer.brick(s, node[0] / side, node[1] / side);
      found_.resize(near_.size());
      sample_near(layer, brick, fields_for(layer, brick, node, is_beside, radius), found_.data());
      for (std::size_t n = first; n < last; ++n) {
        const std::size_t point = places_[n].point;
        out[point] = known(found_[n - first], within[point], near_[n - first]);
      }
    }
  }

  /// What the brick does not know is at least the margin away.
  [[nodiscard]] double known(double value, double within, Vec3 p) const {
    const bool is_known = std::abs(value) <= shared_->nearness.margin || within <= shared_->nearness.margin;
    return is_known ? value : shared_->cells->value(p);
  }

  /// By part of a brick.
  [[nodiscard]] std::uint64_t place_of(Vec3 p) const {
    const std::array<std::int32_t, 3> node = node_at(p);
    std::uint64_t place = 0;
    for (const std::size_t axis : {2, 1, 0})
      place = place * std::uint64_t(shared_->counts[axis]) + std::uint64_t(node[axis] / side);
    return place * brick_parts + Layer::part_of(node);
  }

  /// What of a row is copied: the same for all rows of a band, which are asked for one after the other.
  const std::vector<CellPeriod::Run>& runs_of(std::int32_t j, std::int32_t k) {
    const CellPeriod& period = *shared_->period;
    const auto y = static_cast<std::size_t>(period.band(1, j));
    const std::int32_t z = period.band(2, k);
    if (y >= runs_.size()) runs_.resize(y + 1);
    if (runs_[y].z != z) period.find_runs(j, k, runs_[y].runs);
    runs_[y].z = z;
    return runs_[y].runs;
  }
  /// Where the point is a node whose sample is copied.
  [[nodiscard]] std::optional<double> copied_at(Vec3 p) const {
    const std::array<std::int32_t, 3> at = node_at(p);
    if (!(shared_->grid.node(at[0], at[1], at[2]) == p)) return std::nullopt;
    return shared_->period->at(at[0], at[1], at[2]);
  }

  /// The planes of a slab lie in three layers at most.
  Layer& layer_at(std::int32_t z) {
    Layer& layer = layers_[static_cast<std::size_t>(z) % layers_.size()];
    if (layer.z() != z) layer.enter(z, std::size_t(shared_->counts[0]) * std::size_t(shared_->counts[1]));
    return layer;
  }
  [[nodiscard]] std::array<std::int32_t, 3> node_at(Vec3 p) const {
    std::array<std::int32_t, 3> at{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double node = (p[axis] - shared_->grid.box.min[axis]) * shared_->inverse_spacing[axis] + 0.5;
      at[axis] = std::clamp(static_cast<std::int32_t>(node), 0, shared_->grid.nodes[axis] - 1);
    }
    return at;
  }
  [[nodiscard]] std::array<std::int32_t, 3> brick_of(Vec3 p) const {
    std::array<std::int32_t, 3> at = node_at(p);
    for (std::int32_t& a : at) a /= side;
    return at;
  }

  /// Those of the brick's fields that count at `near_`, which are beside nodes of one part of it.
  std::span<const std::uint32_t> fields_for(Layer& layer, const Brick& brick, const std::array<std::int32_t, 3>& node,
                                            bool is_beside, double radius) {
    if (std::isfinite(shared_->cells->lipschitz())) return fields_within(layer.contents().fields(brick), radius);
    if (is_beside) return layer.fields_near(*shared_, node);
    which_.resize(brick.fields);
    std::iota(which_.begin(), which_.end(), 0U);
    return which_;
  }

  /// Points outside of the grid are not.
  [[nodiscard]] bool is_beside_node(Vec3 p) const {
    const std::array<std::int32_t, 3> at = node_at(p);
    const Vec3 off = p - shared_->grid.node(at[0], at[1], at[2]);
    bool result = true;
    for (std::size_t a = 0; a < 3; ++a)
      result = result && std::abs(off[a]) * shared_->inverse_spacing[a] <= Layer::most_steps_off;
    return result;
  }

  /// Which of these can be the least of all at `near_`, all of them within `radius` of the first: slopes are bounded,
  /// and what fields are at the first tells.
  std::span<const std::uint32_t> fields_within(std::span<const PlacedField> fields, double radius) {
    which_.clear();
    double most = HUGE_VAL;
    lows_.clear();
    for (const PlacedField& field : fields) {
      const double value = field.value(near_[0]), change = field.lipschitz * radius;
      const double slack = 1e-9 * (std::abs(value) + change);  // rounding must leave none out
      lows_.push_back(value - change - slack);
      most = std::min(most, value + change + slack);
    }
    for (std::size_t f = 0; f < fields.size(); ++f)
      if (!(lows_[f] > most)) which_.push_back(static_cast<std::uint32_t>(f));
    return which_;
  }

  /// What the brick's struts, and these of its fields, are at `near_`.
  void sample_near(const Layer& layer, const Brick& brick, std::span<const std::uint32_t> fields, double* out) {
    std::fill_n(out, near_.size(),
                brick.state == Brick::State::inside ? -shared_->nearness.far : shared_->nearness.far);
    const Capsule* const capsules = layer.contents().capsules(brick);
    for (std::uint32_t c = 0; c < brick.capsules; ++c)
      for (std::size_t n = 0; n < near_.size(); ++n)
        out[n] = std::min(out[n], axis_distance(capsules[c], near_[n]) - capsules[c].radius);
    values_.resize(near_.size());
    for (const std::uint32_t f : fields) {
      layer.contents().fields(brick)[f].values(near_, local_, values_.data());
      for (std::size_t n = 0; n < near_.size(); ++n) out[n] = std::min(out[n], values_[n]);
    }
  }

  std::shared_ptr<const Shared> shared_;
  std::array<Layer, 4> layers_;
  struct Patch {
    std::int32_t k = -1;
    std::array<double, std::size_t{side} * side> values;
  };
  std::vector<Patch> patches_;  // of the plane at hand, by brick: samples that fields took part in
  struct RunsOfBand {
    std::int32_t z = -1;
    std::vector<CellPeriod::Run> runs;
  };
  std::vector<RunsOfBand> runs_;  // by band of y
  BrickSampler sampler_;
  std::vector<Vec3> near_, local_;  // points that are asked together
  std::vector<double> lows_, values_, found_;
  std::vector<std::uint32_t> which_;
  struct Place {
    std::uint64_t place;
    std::size_t point;
    friend auto operator<=>(const Place&, const Place&) = default;
  };
  std::vector<Place> places_;
};

class PreparedBricks final : public ExternalField::Prepared {
 public:
  explicit PreparedBricks(std::shared_ptr<const Shared> shared) : shared_(std::move(shared)) {}
  [[nodiscard]] std::unique_ptr<ExternalRows> make_rows() const override { return std::make_unique<Rows>(shared_); }
  [[nodiscard]] double exact_within() const override { return shared_->nearness.margin; }

 private:
  std::shared_ptr<const Shared> shared_;
};

}  // namespace

std::unique_ptr<ExternalField::Prepared> prepare_bricks(std::shared_ptr<const PlacedCells> cells, const Grid& grid,
                                                        const Affine& field_from_grid, double band,
                                                        const RunOptions& run) {
  auto shared = std::make_shared<Shared>(std::move(cells), grid, field_from_grid, band);
  shared->period = CellPeriod::find(*shared->cells, grid, field_from_grid, shared->nearness, run);
  if (run.should_stop()) return nullptr;
  return std::make_unique<PreparedBricks>(std::move(shared));
}

}  // namespace meso::implicit
