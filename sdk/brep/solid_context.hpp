// SPDX-License-Identifier: Apache-2.0
#pragma once
// What every step from shapes to solids carries along: where faults are reported and when to stop. Private.

#include <string>
#include <utility>
#include <vector>

#include "meso/base/diagnostic.hpp"
#include "meso/base/run_options.hpp"
#include "meso/model/source_map.hpp"
#include "occt.hpp"

namespace meso::brep {

/// A regularised set: closed solids, outward oriented, whose interiors do not meet. Empty means the empty set.
using Solids = std::vector<TopoDS_Shape>;

struct SolidContext {
  const SourceMap& source;
  const RunOptions& run;
  DiagnosticSink& sink;

  void report(Code code, ElementId element, std::vector<std::string> args) const {
    sink.report({.code = code,
                 .where = source.span(element),
                 .path = source.path(element),
                 .args = std::move(args),
                 .related = {}});
  }
};

}  // namespace meso::brep
