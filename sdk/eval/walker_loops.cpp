// SPDX-License-Identifier: Apache-2.0
// The loops of a walker: counts, coordinates, stepping, and finding an ordinal without walking there.
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "meso/base/number.hpp"
#include "meso/expr/operations.hpp"
#include "walker.hpp"

namespace meso::eval {
namespace {

constexpr double largest_count = 0x1p53;

/// a * b, or the largest number if that is too large.
std::uint64_t saturating_product(std::uint64_t a, std::uint64_t b) {
  std::uint64_t result = 0;
  return __builtin_mul_overflow(a, b, &result) ? std::numeric_limits<std::uint64_t>::max() : result;
}

}  // namespace

bool Walker::evaluate(const BoundExpression& expression, double& value, std::size_t known_indices) {
  const expr::EvalResult result = expression.evaluate(slots_);
  if (result) {
    value = result.value;
    return true;
  }
  (void)eval::evaluate(expression, slots_, report(known_indices));
  return false;
}

bool Walker::begin_direction(std::size_t loop) {
  Vec3 v;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!evaluate((*program_.loops[loop].direction)[i], v[i], loop)) return false;
  }
  if (norm(v) == 0) {
    report(loop)(Code::direction_zero, program_.loops[loop].place, {});
    return false;
  }
  state_[loop].direction = v / norm(v);
  return true;
}

bool Walker::begin_places(std::size_t loop) {
  const LoopProgram& program = program_.loops[loop];
  LoopState& s = state_[loop];
  s.index = program.first - 1;  // no index yet: a sum of spacings begins anew
  if (program.start && !evaluate(*program.start, s.start, loop)) return false;
  if (program.direction && !begin_direction(loop)) return false;
  return !program.spacing || program.cumulative || evaluate(*program.spacing, s.spacing, loop);
}

bool Walker::begin_count(std::size_t loop) {
  const LoopProgram& program = program_.loops[loop];
  LoopState& s = state_[loop];
  if (!program.count) return true;
  double count = 0;
  if (!evaluate(*program.count, count, loop)) return false;
  const double whole = expr::snap_to_integer(count);
  if (whole != std::floor(whole) || whole < 0 || whole > largest_count) {
    report(loop)(Code::value_not_whole, {program.place.element, "count"}, {"count", "0", format_number(count)});
    return false;
  }
  s.count = static_cast<std::int64_t>(whole);
  return true;
}

// dq/du = size(q) over one unit of the phase u: 64 steps of Runge and Kutta's fourth order.
bool Walker::end_of_sized(std::size_t loop, double q, double& end) {
  const LoopProgram& program = program_.loops[loop];
  double& coordinate = slots_[program_.axis_slot + *program.axis];
  const double before = coordinate;
  constexpr int steps = 64;
  constexpr double h = 1.0 / steps;
  const auto size_at = [&](double at, double& size) {
    coordinate = at;
    if (!evaluate(*program.size, size, loop + 1)) return false;
    if (size > 0) return true;
    report(loop + 1)(Code::value_not_positive, program.size->place, {"size", format_number(size)});
    return false;
  };
  bool good = true;
  for (int i = 0; i < steps && good; ++i) {
    double a = 0, b = 0, c = 0, d = 0;
    good = size_at(q, a) && size_at(q + 0.5 * h * a, b) && size_at(q + 0.5 * h * b, c) && size_at(q + h * c, d);
    q += h / 6 * (a + 2 * b + 2 * c + d);
  }
  coordinate = before;
  end = q;
  return good;
}

// the coordinate of a loop at an index.
bool Walker::move_to(std::size_t loop, std::int64_t index) {
  const LoopProgram& program = program_.loops[loop];
  LoopState& s = state_[loop];
  changed_ = std::min(changed_, static_cast<int>(loop));
  double& index_value = slots_[program.index_slot];
  if (program.cumulative) {
    // Left to right from the start, so that every way to this index adds the same numbers in the same order.
    const bool goes_on = index > 0 && s.index == index - 1;
    std::int64_t m = goes_on ? index - 1 : 0;
    if (!goes_on) s.q = s.start;
    for (; m < index; ++m) {
      double spacing = 0;
      index_value = static_cast<double>(m);
      index_[loop] = m;
      if (program.size) {
        if (!end_of_sized(loop, s.q, s.q)) return false;
        continue;
      }
      if (!evaluate(*program.spacing, spacing, loop + 1)) return false;
      s.q += spacing;
    }
  }
  s.index = index;
  index_[loop] = program.scatter ? static_cast<std::int64_t>(program.scatter->record(index)) : index;
  index_value = static_cast<double>(index_[loop]);
  if (program.position && !evaluate(*program.position, s.q, loop + 1)) return false;
  if (!program.position && !program.cumulative) s.q = s.start + index_value * s.spacing;
  if (program.axis) slots_[program_.axis_slot + *program.axis] = s.q;
  if (!program.places.empty()) {
    const std::vector<double>& row = program.places[static_cast<std::size_t>(index)];
    std::copy(row.begin(), row.end(), slots_.begin() + static_cast<std::ptrdiff_t>(program_.axis_slot));
  }
  return !program.scatter || move_to_record(program);
}

bool Walker::move_to_record(const LoopProgram& program) {
  const ScatterRecords& records = *program.scatter;
  const auto record = static_cast<std::size_t>(index_.front());
  const std::span<double> q = std::span(slots_).subspan(program_.axis_slot, program_.frame->axes().size());
  if (records.is_own_system) {
    records.source->coordinates(record, q);
  } else {
    const Vec3 place = records.source->place(record);
    for (std::size_t i = 0; i < 3; ++i) q[i] = place[i];
  }
  return records.source->at_record(record, records.quantities, slots_, program.place, report(1));
}

bool Walker::is_product(std::size_t loop) const {
  for (std::size_t j = loop + 1; j < loops(); ++j) {
    const auto& count = program_.loops[j].count;
    if (count && count->level >= static_cast<int>(loop)) return false;
  }
  return true;
}

std::optional<std::uint64_t> Walker::count_from(std::size_t loop, std::uint64_t limit) {
  if (loop == loops()) return 1;
  if (!begin_count(loop)) return std::nullopt;
  const std::int64_t first = program_.loops[loop].first, end = first + state_[loop].count;
  if (first == end) return 0;
  if (is_product(loop)) {
    // No count further in looks at this loop, so one of its indices speaks for all.
    const auto inner = count_from(loop + 1, limit);
    if (!inner) return std::nullopt;
    const std::uint64_t all = saturating_product(static_cast<std::uint64_t>(state_[loop].count), *inner);
    is_at_least_ = is_at_least_ || all == std::numeric_limits<std::uint64_t>::max();
    return all;
  }
  if (!begin_places(loop)) return std::nullopt;
  std::uint64_t total = 0;
  for (std::int64_t i = first; i < end && total <= limit; ++i) {
    // Loops without cells take time too.
    if (++counted_ > limit) return is_at_least_ = true, limit + 1;
    if (!move_to(loop, i)) return std::nullopt;
    const auto inner = count_from(loop + 1, limit);
    if (!inner) return std::nullopt;
    total = *inner > limit - std::min(limit, total) ? limit + 1 : total + *inner;
  }
  is_at_least_ = is_at_least_ || total > limit;
  return total;
}

std::optional<std::uint64_t> Walker::count(std::uint64_t limit) {
  assert(limit < std::numeric_limits<std::uint64_t>::max());
  counted_ = 0;
  is_at_least_ = false;
  return count_from(0, limit);
}

bool Walker::seek(std::uint64_t ordinal) {
  constexpr std::uint64_t no_limit = std::numeric_limits<std::uint64_t>::max() - 1;
  changed_ = std::min(changed_, 0);
  counted_ = 0;
  for (std::size_t k = 0; k < loops(); ++k) {
    if (!begin_count(k) || !begin_places(k)) return false;
    std::int64_t index = program_.loops[k].first;
    if (is_product(k)) {
      const auto inner = count_from(k + 1, no_limit);
      if (!inner) return false;
      assert(*inner > 0);
      index += static_cast<std::int64_t>(ordinal / *inner);
      ordinal %= *inner;
      if (!move_to(k, index)) return false;
      continue;
    }
    for (;; ++index) {
      if (!move_to(k, index)) return false;
      const auto inner = count_from(k + 1, no_limit);
      if (!inner) return false;
      if (ordinal < *inner) break;
      ordinal -= *inner;
    }
  }
  return true;
}

// REQUIRES: there is a next cell.
bool Walker::next() {
  std::size_t k = loops();
  while (k > 0) {
    --k;
    const LoopProgram& program = program_.loops[k];
    if (state_[k].index + 1 >= program.first + state_[k].count) continue;  // this loop is through: one further out
    if (!move_to(k, state_[k].index + 1)) return false;
    for (++k; k < loops(); ++k) {
      if (!begin_count(k)) return false;
      if (state_[k].count == 0) break;  // nothing in here: on with the loop outside
      if (!begin_places(k) || !move_to(k, program_.loops[k].first)) return false;
    }
    if (k == loops()) return true;
  }
  assert(false);
  return false;
}

// spacing(i), or position(i + 1) - position(i).
bool Walker::fill_steps() {
  const double scale = program_.evaluation->millimeters();
  cell_.step = {};
  for (std::size_t k = 0; k < loops(); ++k) {
    const LoopProgram& program = program_.loops[k];
    const LoopState& s = state_[k];
    if (!program.axis || *program.axis >= 3 || !program.stepped) continue;
    double step = s.spacing;
    if (program.size) {
      if (!end_of_sized(k, s.q, step)) return false;
      step -= s.q;
    } else if (program.cumulative && !evaluate(*program.spacing, step, loops())) {
      return false;
    }
    if (program.position) {
      double& index = slots_[program.index_slot];
      double ahead = 0;
      index = static_cast<double>(s.index + 1);
      const bool good = evaluate(*program.position, ahead, loops());
      index = static_cast<double>(s.index);
      if (!good) return false;
      step = ahead - s.q;
    }
    const CoordinateAxis& axis = program_.frame->axes()[*program.axis];
    cell_.step[*program.axis] = axis.kind == AxisKind::circular ? step : scale * step;
  }
  for (std::size_t a = 0; a < 3; ++a) {
    if (cell_.step[a] > 0) continue;
    const std::string name = a < q_.size() ? program_.frame->axes()[a].name : std::to_string(a + 1);
    report(loops())(Code::value_not_positive, {program_.pattern->id_in_source, "mapping"},
                    {"the step on axis '" + name + "'", format_number(cell_.step[a])});
    return false;
  }
  return true;
}

}  // namespace meso::eval
