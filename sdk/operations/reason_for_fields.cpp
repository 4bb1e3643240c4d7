// SPDX-License-Identifier: Apache-2.0
// What of a document only fields can express.
#include <algorithm>
#include <set>

#include "make_mesh.hpp"
#include "mesh_grid.hpp"

namespace meso::operations {
namespace {

class Search {
 public:
  explicit Search(const eval::Evaluation& evaluation) : evaluation_(evaluation) {}

  std::string in(const Part& part) {
    if (!seen_.insert(part.id.text).second) return {};
    for (const Apply& apply : part.steps) {
      std::string reason;
      if (apply.radius || apply.skin)
        reason = "a step of part '" + part.id.text + "' has a " + (apply.radius ? "radius" : "skin");
      else if (apply.part)
        reason = in(*evaluation_.find_part(apply.part->text));
      else if (const Pattern* pattern = evaluation_.find_pattern(apply.pattern->text))
        reason = in(*pattern);
      if (!reason.empty()) return reason;
    }
    return {};
  }

 private:
  std::string in(const Pattern& pattern) {
    const auto& cells = evaluation_.document().unit_cells;
    const auto cell = std::find_if(cells.begin(), cells.end(),
                                   [&](const UnitCell& c) { return c.id.text == pattern.unit_cell.text; });
    if (cell == cells.end()) return {};
    if (std::holds_alternative<ImplicitBody>(cell->body))
      return "the body of unit cell '" + cell->id.text + "' is a field";
    const bool conformal = pattern.mapping.value_or(CellMapping::rigid) == CellMapping::conformal;
    if (conformal && !std::holds_alternative<BeamsBody>(cell->body) && !std::holds_alternative<CsgBody>(cell->body))
      return "pattern '" + pattern.id.text + "' bends bodies that have no exact form then";
    if (const auto* body = std::get_if<PartBody>(&cell->body)) return in(*evaluation_.find_part(body->part.text));
    return {};
  }

  const eval::Evaluation& evaluation_;
  std::set<std::string> seen_;
};

}  // namespace

std::string reason_for_fields(const eval::Evaluation& evaluation, const std::string& part) {
  DiagnosticSink ignored;
  Search search(evaluation);
  for (const PlacedPart& item : built_parts(evaluation, part, ignored)) {
    std::string reason = search.in(*item.part);
    if (!reason.empty()) return reason;
  }
  for (const BuildItem& item : evaluation.document().build)
    if (item.mesh && item.mesh->samples && !item.mesh->deflection && !item.mesh->angle &&
        (part.empty() || part == item.part.text))
      return "the <mesh> of part '" + item.part.text + "' states samples";
  return {};
}

}  // namespace meso::operations
