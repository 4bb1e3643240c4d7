// SPDX-License-Identifier: Apache-2.0
#pragma once
// From a checked document to placed cells and shapes without expressions.
//
//   DiagnosticSink sink;
//   auto evaluation = eval::Evaluation::make(checked, {.overrides = {{"pitch", "2.5mm"}}}, sink);
//   auto cells = evaluation->cells(*evaluation->find_pattern("core"), sink);
//   cells->visit(0, cells->size(), [&](const eval::PlacedCell& c) { ...; return true; }, sink);
//
// Immutable after make() and safe to share between threads. Results are millimetres and radians. Cells stream in
// normative order in constant memory; any range can be visited on its own. An expression that fails (x/0) stops the
// visit with a diagnostic that names the cell.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "meso/base/diagnostic.hpp"
#include "meso/base/run_options.hpp"
#include "meso/eval/shape.hpp"
#include "meso/model/checked_document.hpp"

namespace meso::eval {

struct Override {
  std::string id;
  std::string expression;
};

/// Where a macrostructure's surface is, for the fields that follow it. Implemented by an engine; safe to share.
class MacrostructureDistance {
 public:
  /// Millimetres, negative inside; the outward unit normal of the nearest point; the mean curvature there, positive
  /// where the body bulges, if it is known.
  struct Answer {
    double distance = 0;
    Vec3 normal;
    std::optional<double> curvature{};
  };
  virtual ~MacrostructureDistance() = default;
  [[nodiscard]] virtual Answer at(Vec3 p_mm) const = 0;
};
/// Null, with a diagnostic, if the engine cannot say.
using FindMacrostructureDistance = std::function<std::shared_ptr<const MacrostructureDistance>(
    const CheckedDocument&, const Macrostructure&, DiagnosticSink&)>;

struct EvaluateOptions {
  std::vector<Override> overrides{};
  RunOptions run{};
  FindMacrostructureDistance distance{};  ///< absent: fields of macrostructures are not realised
};

/// One copy of a unit cell. Valid only during the callback.
struct PlacedCell {
  std::uint64_t ordinal = 0;            ///< position in the normative order, dropped cells counted
  std::span<const std::int64_t> index;  ///< the index tuple: the cell's id
  CellMapping mapping = CellMapping::rigid;
  Affine world_from_cell;              ///< rigid: after all instructions
  Vec3 global;                         ///< P(q), before any instruction
  std::span<const double> parameters;  ///< the cell's own, in order, in the document's unit
  std::span<const double> q;           ///< coordinates, one per axis
  std::array<double, 3> step{};        ///< conformal: size along axes 1, 2, 3
};

/// A quantity of a vector field at points of the world, in millimetres; the value is in the document's unit. Nothing
/// where the field has none, which is told. Safe to share between threads.
using PointQuantity = std::function<std::optional<double>(Vec3 p_mm, DiagnosticSink& sink)>;

class Evaluation;

/// The cells of one pattern.
class CellStream {
 public:
  using Visitor = std::function<bool(const PlacedCell&)>;  ///< false ends the visit early

  /// Number of placed cells before `when`; the ordinals are [0, size()).
  [[nodiscard]] std::uint64_t size() const;
  /// Number of loops (or fill ranges); sizes of each if they do not depend on outer indices, else empty.
  [[nodiscard]] std::vector<std::int64_t> extents() const;
  /// Visits the kept cells with ordinals in [first, last), ascending. False: an expression failed or the run was
  /// stopped (see sink).
  [[nodiscard]] bool visit(std::uint64_t first, std::uint64_t last, const Visitor& visitor, DiagnosticSink& sink) const;
  /// Visits at least every cell whose box can touch `region` (a superset is fine, a miss is a defect).
  [[nodiscard]] bool visit_touching(const Box3& region, const Visitor& visitor, DiagnosticSink& sink) const;

  [[nodiscard]] const Pattern& pattern() const;
  [[nodiscard]] const UnitCell& unit_cell() const;
  /// If all cells are translates of one lattice with equal parameters and without `when`: cell (i,j,k) = origin +
  /// lattice * (i,j,k). A step may be 0.
  struct Lattice {
    Affine world_from_first;  ///< of cell (0, 0, 0)
    Mat3 lattice;             ///< columns: steps along the three indices, millimetres
    std::array<std::int64_t, 3> count{1, 1, 1};
  };
  [[nodiscard]] std::optional<Lattice> lattice() const;
  /// As lattice(), but the cells' parameters may differ.
  [[nodiscard]] std::optional<Lattice> lattice_of_places() const;

  /// The cell's box in cell coordinates (mm); empty if the unit cell has none.
  [[nodiscard]] std::optional<BoxShape> cell_box(const PlacedCell& cell, DiagnosticSink& sink) const;
  /// The space the cell takes up: its box in cell coordinates (rigid), or the volume element it becomes in the world
  /// (conformal). Empty if the unit cell has no box, or if something was reported.
  [[nodiscard]] std::optional<Shape> cell_region(const PlacedCell& cell, DiagnosticSink& sink) const;
  /// The cell's body in cell coordinates (rigid) or in the world (conformal: boxes become volume elements, straight
  /// beams run between mapped nodes; anything else is a diagnostic). Equal `parameters` give equal shapes for rigid
  /// cells unless shape_varies().
  [[nodiscard]] std::optional<Shape> shape(const PlacedCell& cell, DiagnosticSink& sink) const;
  /// True if shape() depends on more than the parameters: conformal mapping or `set ... at="node"`.
  [[nodiscard]] bool shape_varies() const;

  struct Impl;
  explicit CellStream(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}

 private:
  std::shared_ptr<const Impl> impl_;
};

class Evaluation {
 public:
  [[nodiscard]] static std::optional<Evaluation> make(const CheckedDocument& document, const EvaluateOptions& options,
                                                      DiagnosticSink& sink);

  [[nodiscard]] const CheckedDocument& checked() const;
  [[nodiscard]] const Document& document() const;
  /// Value of a document parameter, in the document's unit.
  [[nodiscard]] std::optional<double> parameter(std::string_view id) const;
  /// An expression of document parameters alone; `where`/`attribute` place the diagnostic.
  [[nodiscard]] std::optional<double> value(const Expression& expression, ElementId where, std::string_view attribute,
                                            DiagnosticSink& sink) const;

  [[nodiscard]] const Pattern* find_pattern(std::string_view id) const;
  [[nodiscard]] const Part* find_part(std::string_view id) const;
  /// `name` as expressions write it: field.quantity. `where` is told of points without a value. Empty after
  /// a report.
  [[nodiscard]] PointQuantity quantity(std::string_view name, ElementId where, DiagnosticSink& sink) const;
  [[nodiscard]] std::optional<CellStream> cells(const Pattern& pattern, DiagnosticSink& sink) const;
  /// The macrostructure's body in the world, placement applied.
  [[nodiscard]] std::optional<Shape> shape(const Macrostructure& macrostructure, DiagnosticSink& sink) const;
  /// A placement (of a build item or an applied part) in millimetres; determinant rule checked.
  [[nodiscard]] std::optional<Affine> placement(const std::optional<Placement>& placement, DiagnosticSink& sink) const;

  struct Impl;

 private:
  explicit Evaluation(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}
  std::shared_ptr<const Impl> impl_;
};

}  // namespace meso::eval
