// SPDX-License-Identifier: Apache-2.0
#include "cell_set.hpp"

#include <algorithm>
#include <map>

#include "affine_inverse.hpp"
#include "meso/eval/bounds.hpp"

namespace meso::membership {
namespace {

constexpr int points_along = 8;  ///< of a cell, looked at by boundary rules
constexpr double rule_forgives =
    1e-5;  ///< millimetres: more than the 1e-6 of R-5.12.7, so that rounding decides nothing

/// Points of a region on a grid, its corners and walls included, drawn in by `inset`.
std::vector<Vec3> points_of(const eval::Shape& region, double inset) {
  std::vector<Vec3> points;
  const auto fraction = [&](int i, double size) {
    const double margin = std::min(0.5, inset / size);
    return margin + (1 - 2 * margin) * i / (points_along - 1);
  };
  const auto* box = std::get_if<eval::BoxShape>(&region.value);
  const auto* element = std::get_if<eval::VolumeElementShape>(&region.value);
  for (int i = 0; i < points_along; ++i)
    for (int j = 0; j < points_along; ++j)
      for (int k = 0; k < points_along; ++k) {
        const std::array<int, 3> at{i, j, k};
        if (box != nullptr) {
          Vec3 p = box->corner;
          for (std::size_t a = 0; a < 3; ++a) p[a] += fraction(at[a], box->size[a]) * box->size[a];
          points.push_back(p);
        } else if (element != nullptr) {
          std::vector<double> q(element->system->axes().size(), 0);
          for (std::size_t a = 0; a < 3; ++a) {
            const double size = element->to[a] - element->from[a];
            q[element->axes[a]] = element->from[a] + fraction(at[a], size) * size;
          }
          points.push_back(element->system->point(q));
        }
      }
  return points;
}

}  // namespace

class CellSet::Collector {
 public:
  Collector(CellSet& set, const eval::CellStream& cells, const Surroundings& surroundings, const RunOptions& run,
            DiagnosticSink& sink)
      : set_(set), cells_(cells), surroundings_(surroundings), run_(run), sink_(sink) {}

  bool collect() {
    const bool complete = cells_.visit(
        0, cells_.size(), [&](const eval::PlacedCell& cell) { return good_ = add(cell); }, sink_);
    if (!complete || !good_) return false;
    set_.tree_ = std::make_shared<const BoxTree>(boxes_);
    return true;
  }

 private:
  bool add(const eval::PlacedCell& cell) {
    if (set_.cells_.size() % 1024 == 0 && run_.should_stop()) {
      sink_.report({.code = run_.out_of_time() ? Code::limit_time : Code::cancelled});
      return false;
    }
    const auto solid = solid_of(cell);
    if (!solid) return false;
    const bool rigid = cell.mapping == CellMapping::rigid;
    const Affine placement = rigid ? cell.world_from_cell : Affine{};
    set_.cells_.push_back({*solid, *solid, placement, inverse(placement)});
    const Box3& box = set_.solids_[*solid].box;
    boxes_.push_back(rigid ? eval::transformed(placement, box) : box);
    return true;
  }

  std::optional<std::uint32_t> solid_of(const eval::PlacedCell& cell) {
    const std::vector<double> key(cell.parameters.begin(), cell.parameters.end());
    if (!cells_.shape_varies())
      if (const auto found = known_.find(key); found != known_.end()) return found->second;
    const auto shape = cells_.shape(cell, sink_);
    if (!shape) return {};
    const std::size_t errors = sink_.error_count();
    auto region = cells_.cell_region(cell, sink_);
    if (sink_.error_count() > errors) return {};
    Solid solid = make_solid(*shape, surroundings_);
    const UnitCell& unit_cell = cells_.unit_cell();
    if (region && (unit_cell.clip_to_box.value_or(false) || std::holds_alternative<ImplicitBody>(unit_cell.body)))
      solid = clipped(std::move(solid), make_solid(*region, surroundings_));
    const auto index = static_cast<std::uint32_t>(set_.solids_.size());
    set_.solids_.push_back(std::move(solid));
    set_.regions_.push_back(std::move(region));
    known_.emplace(key, index);
    return index;
  }

  static Solid clipped(Solid solid, Solid region) {
    const Box3 box = common(solid.box, region.box);
    return {box, [solid = std::move(solid), region = std::move(region)](Vec3 p) {
              return std::min(solid.at(p), region.at(p));
            }};
  }

  CellSet& set_;
  const eval::CellStream& cells_;
  const Surroundings& surroundings_;
  const RunOptions& run_;
  DiagnosticSink& sink_;
  std::vector<Box3> boxes_;
  std::map<std::vector<double>, std::uint32_t> known_;
  bool good_ = true;
};

std::optional<CellSet> CellSet::make(const eval::CellStream& cells, const Surroundings& surroundings,
                                     const RunOptions& run, DiagnosticSink& sink) {
  if (cells.size() > run.max_cells) {
    sink.report({.code = Code::limit_cells,
                 .args = {cells.pattern().id.text, std::to_string(cells.size()), std::to_string(run.max_cells)}});
    return {};
  }
  CellSet set;
  if (!Collector(set, cells, surroundings, run, sink).collect()) return {};
  return set;
}

Answer CellSet::at(Vec3 p) const {
  Answer answer = Answer::outside;
  tree_->visit(p, [&](std::uint32_t i) {
    const Cell& cell = cells_[i];
    if (cell.taken > answer) answer = std::max(answer, std::min(cell.taken, solids_[cell.solid].at(cell.back * p)));
    return answer != Answer::inside;
  });
  return answer;
}

namespace {

/// The largest and smallest answer of `body` at points and, with a clearance, around them.
struct Range {
  Answer least = Answer::inside, most = Answer::outside;
  void add(Answer answer) {
    least = std::min(least, answer);
    most = std::max(most, answer);
  }
};

Range answers_around(const Solid& body, const std::vector<Vec3>& points, double clearance) {
  Range range;
  for (const Vec3 p : points) {
    range.add(body.at(p));
    if (clearance <= 0) continue;
    for (int n = 0; n < 27; ++n) {
      const Vec3 d{n % 3 - 1.0, n / 3 % 3 - 1.0, n / 9 - 1.0};
      if (n != 13) range.add(body.at(p + (clearance / norm(d)) * d));
    }
  }
  return range;
}

}  // namespace

void CellSet::take(const Rule& rule, const Solid& body) {
  const double grow = rule.kind == Rule::Kind::inside ? rule.clearance - rule_forgives : 0;
  for (Cell& cell : cells_) {
    const auto& region = regions_[cell.region];
    const Box3& box = solids_[cell.solid].box;
    const eval::Shape around = region.value_or(eval::Shape{eval::BoxShape{box.min, box.max - box.min}});
    std::vector<Vec3> all, own;
    for (const Vec3 p : points_of(around, rule_forgives)) {
      all.push_back(cell.placement * p);
      if (solids_[cell.solid].at(p) == Answer::inside) own.push_back(all.back());
    }
    const Range of_all = answers_around(body, all, grow);
    if (rule.judged == InsideTest::box) {
      cell.taken = rule.kind == Rule::Kind::inside ? of_all.least : of_all.most;
      continue;
    }
    // Points in the body itself may refute that it is inside, or prove that it meets; the rest only its box can tell.
    const Range of_own = answers_around(body, own, grow);
    if (of_all.least == Answer::inside)
      cell.taken = Answer::inside;
    else if (of_all.most == Answer::outside)
      cell.taken = Answer::outside;
    else
      cell.taken = rule.kind == Rule::Kind::inside ? std::min(of_own.least, Answer::unknown)
                                                   : std::max(of_own.most, Answer::unknown);
  }
}

}  // namespace meso::membership
