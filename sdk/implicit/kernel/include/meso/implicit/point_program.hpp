// SPDX-License-Identifier: Apache-2.0
#pragma once
// A term at points, many at a time, by the vector kernels of rows: for leaves that are asked point by point.
//
// Values mean what FlatTerm's do, but elementary functions are our own: equal bits on every machine, whichever C
// library it has, and some times as fast.

#include <memory>
#include <span>

#include "meso/implicit/term.hpp"

namespace meso::implicit {

class PointProgram {
 public:
  explicit PointProgram(const Term& term);
  PointProgram(PointProgram&&) noexcept;
  PointProgram& operator=(PointProgram&&) noexcept;
  ~PointProgram();

  /// Many threads may call it. REQUIRES: room for as many values as points.
  void values(std::span<const Vec3> points, double* out) const;
  [[nodiscard]] double value(Vec3 p) const {
    double result = 0;
    values({&p, 1}, &result);
    return result;
  }

 private:
  struct Shared;
  std::unique_ptr<Shared> shared_;
};

}  // namespace meso::implicit
