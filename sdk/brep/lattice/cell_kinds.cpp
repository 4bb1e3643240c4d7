// SPDX-License-Identifier: Apache-2.0
// Which kind of box each cell is, by the neighbours that it has.
#include <algorithm>
#include <map>
#include <string>

#include "lattice/assembly.hpp"
#include "meso/brep/instance_map.hpp"

namespace meso::brep {

CellKinds::CellKinds(const Reach& reach, const KeptCells& cells, const std::function<bool(Index3)>& holds)
    : kinds_(cells.count(), 0) {
  parts_.push_back(reach.parts_with(true, ~std::uint64_t{0}));
  std::map<std::pair<bool, std::uint64_t>, std::uint32_t> known{{{true, ~std::uint64_t{0}}, 0}};
  const auto number_of = [&](const std::vector<std::uint32_t>& parts) {
    const auto number = static_cast<std::uint32_t>(std::ranges::find(parts_, parts) - parts_.begin());
    if (number == parts_.size()) parts_.push_back(parts);
    return number;
  };
  for (std::uint32_t n = 0; n < cells.count(); ++n) {
    const Index3& cell = cells.cell(n);
    if (holds && !holds(cell)) {
      kinds_[n] = number_of({});
      continue;
    }
    const bool itself = cells.in_pattern(cell);
    const std::vector<Reach::Neighbour>& others = itself ? reach.neighbours : reach.rim;
    std::uint64_t present = ~std::uint64_t{0};  // neighbours that do not matter count as being there
    for (std::size_t i = 0; i < others.size(); ++i)
      if (!cells.in_pattern(cell + others[i].shift)) present &= ~(std::uint64_t{1} << i);
    const auto [it, fresh] = known.try_emplace({itself, present}, 0);
    if (fresh) it->second = number_of(reach.parts_with(itself, present));
    kinds_[n] = it->second;
  }
}

CellKinds::CellKinds(const KeptCells& cells, const std::function<std::vector<std::uint32_t>(Index3)>& parts_of)
    : kinds_(cells.count(), 0) {
  std::map<std::vector<std::uint32_t>, std::uint32_t> known;
  for (std::uint32_t n = 0; n < cells.count(); ++n) {
    auto [it, fresh] = known.try_emplace(parts_of(cells.cell(n)), static_cast<std::uint32_t>(parts_.size()));
    if (fresh) parts_.push_back(it->first);
    kinds_[n] = it->second;
  }
}

bool fit_in_memory(std::uint64_t boxes, const RunOptions& run, DiagnosticSink& sink) {
  constexpr std::uint64_t bytes_per_box = 100;
  if (boxes <= run.max_memory_bytes / bytes_per_box) return true;
  sink.report({.code = Code::limit_memory, .args = {std::to_string(run.max_memory_bytes >> 20) + " MiB"}});
  return false;
}

}  // namespace meso::brep
