// SPDX-License-Identifier: Apache-2.0
#pragma once
// A vector field of the document, read and ready to be asked. Lengths are in the document's unit.
//
// Immutable once made; safe to share between threads. What only sampling needs (a search tree, elements) is made when
// sampling is asked for.

#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "meso/eval/coordinates.hpp"
#include "meso/eval/evaluation.hpp"
#include "meso/fields/grid_interpolation.hpp"
#include "meso/fields/mesh_interpolation.hpp"
#include "meso/fields/point_search.hpp"
#include "meso/model/field_quantities.hpp"
#include "scope.hpp"

namespace meso::eval {

struct EvaluationData;

/// A quantity that a pattern names, and the slot that takes its value.
struct QuantitySlot {
  FieldQuantity quantity;
  std::uint32_t slot = 0;
};

class FieldSource {
 public:
  /// Reads the field. Null if something was reported.
  [[nodiscard]] static std::shared_ptr<FieldSource> load(const EvaluationData& data, const VectorField& field,
                                                         const Report& report);
  /// The same, ready for at_point().
  [[nodiscard]] bool prepare_sampling(const EvaluationData& data, const Report& report);

  [[nodiscard]] const VectorField& field() const { return *field_; }
  [[nodiscard]] std::size_t records() const { return records_.rows(); }
  /// The system that positions or the grid's axes are coordinates of.
  [[nodiscard]] const CoordinateFrame& system() const { return *system_; }
  /// Coordinates of a record, one per axis of its system.
  void coordinates(std::size_t record, std::span<double> q) const;
  /// Where it stands, in global coordinates.
  [[nodiscard]] Vec3 place(std::size_t record) const;

  /// Writes the quantities into their slots. False: something was reported at `where`.
  [[nodiscard]] bool at_record(std::size_t record, std::span<const QuantitySlot> wanted, std::span<double> slots,
                               const Place& where, const Report& report) const;
  [[nodiscard]] bool at_point(Vec3 global, std::span<const QuantitySlot> wanted, std::span<double> slots,
                              const Place& where, const Report& report) const;

 private:
  friend class FieldLoader;
  struct Column {
    std::size_t column = 0;
    double factor = 1;  ///< to the document's unit and radians
  };
  /// What a value is made of: records and weights, or one number for every component.
  struct Origin {
    fields::Stencil stencil;
    std::optional<double> constant;
    std::span<const double> q;  ///< in the field's system
    Vec3 global;
  };

  [[nodiscard]] double component(std::size_t c, const Origin& origin) const;
  [[nodiscard]] double magnitude(const Origin& origin) const;
  [[nodiscard]] std::optional<Vec3> gradient(std::size_t c, const Origin& origin) const;
  [[nodiscard]] bool fill(const Origin& origin, std::span<const QuantitySlot> wanted, std::span<double> slots,
                          const Place& where, const Report& report) const;
  [[nodiscard]] bool outside(Origin& origin, const Place& where, const Report& report) const;
  [[nodiscard]] bool locate(Origin& origin, std::vector<double>& q, const Place& where, const Report& report) const;

  const VectorField* field_ = nullptr;
  std::shared_ptr<const CoordinateFrame> system_;
  fields::Records records_;
  std::vector<Column> columns_;          ///< per component
  std::vector<std::size_t> position_;    ///< components, per axis of the system; empty for grids
  std::array<std::size_t, 6> tensor_{};  ///< components xx yy zz xy yz zx
  std::vector<std::size_t> grid_axes_;   ///< of the system, per axis of the grid
  std::optional<fields::GridInterpolation> grid_;
  std::optional<double> outside_value_;
  double power_ = 2;
  double millimeters_ = 1;
  std::shared_ptr<const MacrostructureDistance> wall_;

  // For sampling.
  std::optional<fields::PointSearch> search_;
  std::optional<fields::MeshInterpolation> mesh_;
  bool is_ready_ = false;
};

/// The fields of a document, read when they are first needed.
class FieldCache {
 public:
  [[nodiscard]] std::shared_ptr<const FieldSource> find(const EvaluationData& data, const VectorField& field,
                                                        bool for_sampling, const Report& report);

 private:
  std::mutex mutex_;
  std::map<std::string, std::shared_ptr<FieldSource>, std::less<>> sources_;
};

/// Coordinates of a global point: the inverse of P. `ranges` (one per axis) say which turn of a circular coordinate and
/// which of two answers is meant. Nothing for systems whose inverse has no closed form here: more than three axes, or
/// others than linear, one circular with one distance, two circular with one distance.
[[nodiscard]] std::optional<std::vector<double>> coordinates_at(const CoordinateFrame& frame, Vec3 global,
                                                                std::span<const std::array<double, 2>> ranges);

}  // namespace meso::eval
