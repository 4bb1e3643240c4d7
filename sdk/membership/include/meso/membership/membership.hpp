// SPDX-License-Identifier: Apache-2.0
#pragma once
// Is a point inside a part? From the document's definitions alone, to judge what engines make of them.
//
//   DiagnosticSink sink;
//   const auto part = membership::Membership::make(evaluation, *evaluation.find_part("beam"), {}, sink);
//   if (part->at({1, 2, 3}) == Answer::inside) ...
//   if (part->clear_at({1, 2, 3}, 0.1) != Answer::unknown) ...   // and nothing changes within 0.1 mm along the axes
//
// Millimetres, in the part's frame. Unknown: implicit bodies, parts with a fillet or a skin, imports without a reader,
// volume elements whose system has no inverse here, points in a part whose loose fragments are dropped, and cells of
// which a boundary rule cannot be decided from points. Boundary rules look at 8 x 8 x 8 points of each cell: a body
// that enters a cell between them is missed. The answer at a surface itself is left to rounding.
//
// Errors: an empty optional and what evaluation reports, LIMIT_CELLS, LIMIT_TIME or CANCELLED. Cost: some 200 bytes a
// cell, and about a microsecond a point, growing with the logarithm of the number of cells. Thread rule: const
// functions may run on any thread, given that the imports' tests may.

#include <functional>
#include <memory>
#include <optional>

#include "meso/base/diagnostic.hpp"
#include "meso/base/run_options.hpp"
#include "meso/eval/evaluation.hpp"
#include "meso/membership/answer.hpp"

namespace meso::membership {

/// The body of a foreign file in the file's own coordinates: before ImportShape's scale and transform.
struct ImportedSolid {
  Box3 box;
  std::function<bool(Vec3)> inside;
};
/// Nothing: not known. Called once for each import element.
using ImportReader = std::function<std::optional<ImportedSolid>(const eval::ImportShape&)>;

struct Options {
  ImportReader imports{};
  RunOptions run{};
  bool no_fragments = false;  ///< it is known that cuts leave no loose fragments: then dropping them drops nothing
};

class Membership {
 public:
  [[nodiscard]] static std::optional<Membership> make(const eval::Evaluation& evaluation, const Part& part,
                                                      const Options& options, DiagnosticSink& sink);

  [[nodiscard]] Answer at(Vec3 p) const;
  /// The answer at p if it is the same at the 14 points `delta` away along the axes and, half as far along each, along
  /// the diagonals; else unknown.
  [[nodiscard]] Answer clear_at(Vec3 p, double delta) const;
  /// Contains everything that is not outside; nothing if that may be anywhere.
  [[nodiscard]] std::optional<Box3> box() const;

  struct Impl;
  explicit Membership(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}

 private:
  std::shared_ptr<const Impl> impl_;
};

}  // namespace meso::membership
