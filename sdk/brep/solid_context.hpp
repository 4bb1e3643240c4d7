// SPDX-License-Identifier: Apache-2.0
#pragma once
// What every step from shapes to solids carries along: where faults are reported and when to stop. Private.

#include <string>
#include <utility>
#include <vector>

#include "meso/base/diagnostic.hpp"
#include "meso/base/run_options.hpp"
#include "meso/model/document.hpp"
#include "meso/model/source_map.hpp"
#include "occt.hpp"

namespace meso::eval {
class CellStream;
struct BeamsShape;
}  // namespace meso::eval

namespace meso::brep {

/// A regularised set: closed solids, outward oriented, whose interiors do not meet. Empty means the empty set.
using Solids = std::vector<TopoDS_Shape>;

/// Who makes the parts that stand in other parts, each once.
class PartMaker {
 public:
  virtual ~PartMaker() = default;
  /// Null after a report. Lives as long as the maker.
  [[nodiscard]] virtual const Solids* solids_of(const Part& part) = 0;
  /// Of a part that is the union of one pattern's cells; null for others, or after a report. Lives as long, too.
  [[nodiscard]] virtual const eval::CellStream* only_cells_of(const Part& part) = 0;
  /// The beams of each cell, where it has a part that is nothing but the union of beams; else null. Lives as long, too.
  [[nodiscard]] virtual const eval::BeamsShape* beams_in(const eval::CellStream& cells) = 0;
};

struct SolidContext {
  const SourceMap& source;
  const RunOptions& run;
  DiagnosticSink& sink;
  PartMaker* parts = nullptr;  ///< absent: parts are not realised

  void report(Code code, ElementId element, std::vector<std::string> args) const {
    sink.report({.code = code,
                 .where = source.span(element),
                 .path = source.path(element),
                 .args = std::move(args),
                 .related = {}});
  }
};

}  // namespace meso::brep
