// SPDX-License-Identifier: Apache-2.0
#pragma once
// The body of a placed cell, taken apart into primitives. Private.

#include <map>
#include <vector>

#include "meso/eval/evaluation.hpp"
#include "primitive.hpp"
#include "shape_field.hpp"

namespace meso::implicit {

/// A field as a primitive where it is; grown by the seam. Empty bodies give none.
void add_field(const Field& field, std::vector<Primitive>& into);
/// The same primitive moved by a map.
[[nodiscard]] Primitive placed(const Primitive& primitive, const Affine& map);

class CellPrimitives {
 public:
  CellPrimitives(const eval::Evaluation& evaluation, const eval::CellStream& cells, ShapeFields& shapes,
                 const Reporter& report)
      : evaluation_(evaluation), cells_(cells), shapes_(shapes), report_(report) {}

  /// In the world. False if something was reported. REQUIRES: no implicit body.
  [[nodiscard]] bool add(const eval::PlacedCell& cell, std::vector<Primitive>& into);
  [[nodiscard]] double smallest_feature_mm() const { return smallest_; }

 private:
  [[nodiscard]] bool make(const eval::PlacedCell& cell, std::vector<Primitive>& made);
  [[nodiscard]] bool add_bent_part(const PartBody& body, const eval::PlacedCell& cell, std::vector<Primitive>& made);
  void add_beams(const eval::BeamsShape& beams, std::vector<Primitive>& into);

  const eval::Evaluation& evaluation_;
  const eval::CellStream& cells_;
  ShapeFields& shapes_;
  const Reporter& report_;
  std::map<std::vector<double>, std::vector<Primitive>> known_;  ///< by parameters, in cell coordinates
  std::optional<Field> part_;                                    ///< that is bent, once it is made
  double smallest_ = HUGE_VAL;
};

}  // namespace meso::implicit
