// SPDX-License-Identifier: Apache-2.0
// which records a scatter visits, and in which order.
#include <algorithm>
#include <cmath>
#include <span>

#include "field_names.hpp"
#include "generator.hpp"
#include "meso/base/number.hpp"
#include "meso/fields/number_block.hpp"
#include "meso/fields/point_search.hpp"

namespace meso::eval {
namespace {

constexpr std::uint64_t bytes_per_sorted = 24;    // a key, a number, and half of one to merge
constexpr std::uint64_t bytes_per_thinned = 144;  // numbers, a place, and the cube that holds it

class ScatterCompiler {
 public:
  ScatterCompiler(PatternProgram& program, Scope& scope, const Report& report)
      : program_(program), scope_(scope), report_(report), scatter_(*program.pattern->scatter) {}

  bool compile(ScatterRecords& records) {
    const auto& data = *program_.evaluation;
    const auto& all = data.document().vector_fields;
    const VectorField& field =
        *std::find_if(all.begin(), all.end(), [&](const VectorField& f) { return f.id.text == scatter_.field.text; });
    records.source = data.fields->find(data, field, false, report_);
    if (!records.source) return false;
    records.is_own_system = &records.source->system() == program_.frame.get();
    records.quantities = define_quantities(program_, scope_, field, 0);
    return sort(records) && thin(records);
  }

 private:
  [[nodiscard]] const RunOptions& run() const { return program_.evaluation->run; }
  bool stopped() const {
    report_.sink.report({.code = run().out_of_time() ? Code::limit_time : Code::cancelled});
    return false;
  }
  bool is_stopped(std::size_t done) const {
    constexpr std::size_t poll_mask = 0xFFFF;
    return (done & poll_mask) == 0 && run().should_stop();
  }

  bool has_room(std::uint64_t bytes_per_record, const ScatterRecords& records, const Place& place) const {
    const std::uint64_t budget = run().max_memory_bytes;
    if (records.source->records() * bytes_per_record <= budget - budget / fields::numbers_part) return true;
    report_(Code::limit_memory, place, {std::to_string(budget >> 20) + " MiB"});
    return false;
  }

  /// A stable sort by merging sorted parts, with a look at the clock between two of them.
  template <class Before>
  bool sort(std::span<std::uint64_t> order, const Before& before) {
    constexpr std::size_t part = 1 << 18;
    if (order.size() <= part) {
      std::stable_sort(order.begin(), order.end(), before);
      return true;
    }
    if (run().should_stop()) return false;
    const std::size_t half = order.size() / 2;
    if (!sort(order.first(half), before) || !sort(order.subspan(half), before)) return false;
    std::inplace_merge(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(half), order.end(), before);
    return true;
  }

  bool sort(ScatterRecords& records) {
    if (!scatter_.sort) return true;
    const Place place{scatter_.sort->id_in_source, "by"};
    const auto by = scope_.bind(scatter_.sort->by.text, place, program_.evaluation->unit(), report_);
    if (!by || !has_room(bytes_per_sorted, records, place)) return false;
    std::vector<double> keys(records.source->records());
    std::vector<double> slots = program_.slots;
    for (std::size_t r = 0; r < keys.size(); ++r) {
      if (is_stopped(r)) return stopped();
      Report at_record = report_;
      at_record.related.push_back({report_.source.span(scatter_.id_in_source), "in record " + std::to_string(r)});
      if (!records.source->at_record(r, records.quantities, slots, place, at_record)) return false;
      const auto key = evaluate(*by, slots, at_record);
      if (!key) return false;
      keys[r] = *key;
    }
    fill_order(records);
    const bool descends = scatter_.sort->order == SortOrder::descending;
    const bool sorted = sort(std::span(records.order), [&](std::uint64_t a, std::uint64_t b) {
      return descends ? keys[a] > keys[b] : keys[a] < keys[b];
    });
    return sorted || stopped();
  }

  bool thin(ScatterRecords& records) {
    if (!scatter_.thin) return true;
    const Place place{scatter_.thin->id_in_source, "distance"};
    const auto distance = program_.evaluation->value(scatter_.thin->distance, place, report_);
    if (!distance) return false;
    if (*distance < 0) {
      report_(Code::value_negative, place, {"distance", format_number(*distance)});
      return false;
    }
    if (!has_room(bytes_per_thinned, records, place)) return false;
    fill_order(records);
    std::vector<Vec3> points;
    points.reserve(records.order.size());
    for (const std::uint64_t r : records.order) {
      if (is_stopped(points.size())) return stopped();
      points.push_back(records.source->place(static_cast<std::size_t>(r)));
    }
    const auto kept = fields::thin(points, *distance, run());
    if (!kept) return stopped();
    std::vector<std::uint64_t> order;
    order.reserve(kept->size());
    for (const std::size_t position : *kept) order.push_back(records.order[position]);
    records.order = std::move(order);
    return true;
  }
  static void fill_order(ScatterRecords& records) {
    if (!records.order.empty()) return;
    records.order.resize(records.source->records());
    for (std::size_t r = 0; r < records.order.size(); ++r) records.order[r] = r;
  }

  PatternProgram& program_;
  Scope& scope_;
  const Report& report_;
  const Scatter& scatter_;
};

}  // namespace

std::optional<ScatterRecords> compile_scatter(PatternProgram& program, Scope& scope, const Report& report) {
  ScatterRecords records;
  if (!ScatterCompiler(program, scope, report).compile(records)) return std::nullopt;
  return records;
}

}  // namespace meso::eval
