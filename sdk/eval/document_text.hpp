// SPDX-License-Identifier: Apache-2.0
#pragma once
// Documents of tests: text in, evaluation or the names of the faults out.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "meso/eval/evaluation.hpp"
#include "meso/validate/validate.hpp"
#include "meso/xml/read.hpp"

namespace meso::eval {

inline std::string meso_text(const std::string& content, const std::string& unit = "millimeter") {
  return "<meso xmlns=\"urn:meso-format:1.0\" version=\"1.0\" unit=\"" + unit + "\">" + content + "</meso>";
}

inline std::string render_all(const DiagnosticSink& sink) {
  std::string text;
  for (const Diagnostic& d : sink.diagnostics()) text += render(d) + "\n";
  return text;
}

/// The evaluation of a document that must be good up to here.
inline Evaluation evaluation_of(const std::string& content, const EvaluateOptions& options = {},
                                const std::string& unit = "millimeter") {
  DiagnosticSink sink;
  auto read = read_document(meso_text(content, unit), "test.meso", sink);
  auto checked = read ? validate(std::move(read->document), std::move(read->source), ".", sink) : std::nullopt;
  auto evaluation = checked ? Evaluation::make(*checked, options, sink) : std::nullopt;
  if (!evaluation) throw std::invalid_argument(render_all(sink));
  return *evaluation;
}

/// A pattern "p" of a cell "c", which has a box of side 1 and whatever `cell` says.
inline std::string pattern_text(const std::string& generator,
                                const std::string& cell = "<csg><box dx='1' dy='1' dz='1'/></csg>",
                                const std::string& attributes = "", const std::string& more = "") {
  return more + "<unitCells><unitCell id='c'>" + cell +
         "</unitCell></unitCells><patterns><pattern id='p' unitCell='c' " + attributes + ">" + generator +
         "</pattern></patterns>";
}

/// What a test keeps of a cell.
struct CellCopy {
  std::uint64_t ordinal;
  std::vector<std::int64_t> index;
  Affine world_from_cell;
  std::vector<double> parameters, q;
  friend bool operator==(const CellCopy&, const CellCopy&) = default;
};
inline CellCopy copy_of(const PlacedCell& c) {
  return {c.ordinal,
          {c.index.begin(), c.index.end()},
          c.world_from_cell,
          {c.parameters.begin(), c.parameters.end()},
          {c.q.begin(), c.q.end()}};
}

inline CellStream stream_of(const Evaluation& evaluation) {
  DiagnosticSink sink;
  auto cells = evaluation.cells(*evaluation.find_pattern("p"), sink);
  if (!cells) throw std::invalid_argument(render_all(sink));
  return *cells;
}

inline std::vector<CellCopy> cells_of(const CellStream& stream, std::uint64_t first = 0, std::uint64_t last = ~0ULL) {
  std::vector<CellCopy> result;
  DiagnosticSink sink;
  if (!stream.visit(
          first, last, [&](const PlacedCell& c) { return result.push_back(copy_of(c)), true; }, sink))
    throw std::invalid_argument(render_all(sink));
  return result;
}
inline std::vector<CellCopy> cells_of(const std::string& content, const std::string& unit = "millimeter") {
  return cells_of(stream_of(evaluation_of(content, {}, unit)));
}

/// What goes wrong when every cell and its shape are asked for: names of codes, "related" notes behind them.
inline std::vector<std::string> faults_of(const std::string& content, const EvaluateOptions& options = {}) {
  DiagnosticSink sink;
  auto read = read_document(meso_text(content), "test.meso", sink);
  auto checked = read ? validate(std::move(read->document), std::move(read->source), ".", sink) : std::nullopt;
  if (!checked) throw std::invalid_argument(render_all(sink));
  if (const auto evaluation = Evaluation::make(*checked, options, sink)) {
    if (const Pattern* pattern = evaluation->find_pattern("p")) {
      if (const auto cells = evaluation->cells(*pattern, sink))
        (void)cells->visit(
            0, cells->size(), [&](const PlacedCell& c) { return cells->shape(c, sink).has_value(); }, sink);
    }
  }
  std::vector<std::string> result;
  for (const Diagnostic& d : sink.diagnostics()) {
    std::string text(info(d.code).name);
    for (const Related& r : d.related) text += " " + r.note;
    result.push_back(text);
  }
  return result;
}

inline void expect_near(Vec3 actual, Vec3 expected, double tolerance = 1e-12) {
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(actual[i], expected[i], tolerance) << "component " << i;
}

}  // namespace meso::eval
