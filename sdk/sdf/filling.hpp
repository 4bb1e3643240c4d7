// SPDX-License-Identifier: Apache-2.0
#pragma once
// Bodies that fill a share of each of their periods, and blends of them: the functions are blended, and so are the
// shares; the level follows from both, so that half of one and half of the other is neither thinner nor thicker.

#include <memory>
#include <optional>
#include <vector>

#include "meso/implicit/term.hpp"

namespace meso::sdf {

class Filling {
 public:
  /// {function < level} fills a share of the period.
  Filling(const implicit::Term& function, Vec3 period, implicit::Term share);

  /// Where it was moved or scaled to: source_from_target maps back.
  [[nodiscard]] Filling moved(const Affine& source_from_target, Vec3 period) const;
  /// (1 - weight) of one and weight of the other; nothing if their periods differ.
  [[nodiscard]] static std::optional<Filling> blended(const Filling& one, const Filling& other,
                                                      const implicit::Term& weight);

  /// Tables of levels have two such axes.
  static constexpr std::size_t most_varying = 2;
  /// How many parts of functions differ from point to point, the first one aside, which is the rest.
  [[nodiscard]] std::size_t varying() const;
  /// The body, negative inside. REQUIRES: no more than most_varying.
  [[nodiscard]] implicit::Term body() const;

 private:
  Filling() = default;
  [[nodiscard]] implicit::Term mixed(const std::vector<implicit::Term>& parts) const;

  std::vector<implicit::Term> functions_;  ///< of mean square 1 over a period
  std::vector<implicit::Term> parts_;      ///< as many; from 0 to 1, their sum is 1
  implicit::Term share_;
  Vec3 period_;
};

}  // namespace meso::sdf
