// SPDX-License-Identifier: Apache-2.0
// Which kind of box each cell is, by the neighbours that it has.
#include <algorithm>
#include <map>
#include <string>

#include "lattice/assembly.hpp"
#include "meso/brep/instance_map.hpp"

namespace meso::brep {

CellKinds::CellKinds(const Reach& reach, const KeptCells& cells) : kinds_(cells.count(), 0) {
  parts_.push_back(reach.parts_with(true, ~std::uint64_t{0}));
  std::map<std::pair<bool, std::uint64_t>, std::uint32_t> known{{{true, ~std::uint64_t{0}}, 0}};
  for (std::uint32_t n = 0; n < cells.count(); ++n) {
    const Index3& cell = cells.cell(n);
    const bool itself = cells.in_pattern(cell);
    const std::vector<Reach::Neighbour>& others = itself ? reach.neighbours : reach.rim;
    std::uint64_t present = ~std::uint64_t{0};  // neighbours that do not matter count as being there
    for (std::size_t i = 0; i < others.size(); ++i)
      if (!cells.in_pattern(cell + others[i].shift)) present &= ~(std::uint64_t{1} << i);
    const auto [it, fresh] = known.try_emplace({itself, present}, 0);
    if (fresh) {
      const std::vector<std::uint32_t> parts = reach.parts_with(itself, present);
      it->second = static_cast<std::uint32_t>(std::find(parts_.begin(), parts_.end(), parts) - parts_.begin());
      if (it->second == parts_.size()) parts_.push_back(parts);
    }
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
