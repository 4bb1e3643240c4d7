// SPDX-License-Identifier: Apache-2.0
#pragma once
// Values at points, to the bit those of a program that asks every external field exactly; but an external is asked no
// more exactly than its value counts there.
//
// Where a gyroid fills a mesh, the mesh's distance is dear and does not matter. Where the program comes to the same
// with everything from zero to infinity in its place, of its sign, that is the value: two runs show it if the root can
// go only one way when the distance grows. Elsewhere, with infinity in its place, the program gives some v, which is
// right if the distance is beyond what a root of |v| needs (bands.hpp); to know that takes no more than a look around
// the point, and where it is not beyond, the look has found the distance.

#include <span>
#include <vector>

#include "bands.hpp"
#include "program.hpp"

namespace meso::implicit {

/// One per thread.
class PointValues {
 public:
  /// `bands`: of the graph that `program` was made of; `externals`: its leaves on a grid. `reach`: how far to look
  /// first where infinity takes over, as a magnitude of the root.
  PointValues(Program program, std::vector<Band> bands, std::vector<ExternalRows*> externals, double reach);

  void values_at(std::span<const Vec3> points, double* out);

 private:
  /// Of some points, what each external is taken for.
  struct Batch {
    std::vector<Vec3> points;
    std::vector<std::vector<double>> externals;
    std::vector<double> root_within;  ///< the root is right up to this magnitude
    std::vector<std::size_t> place;   ///< in what was asked for
    void clear(std::size_t count);
    void add(Vec3 point, std::size_t at, const std::vector<std::vector<double>>& values, std::size_t n);
  };

  void block(std::span<const Vec3> points, double* out);
  void ask_signs(std::span<const Vec3> points);
  void decide_by_signs(std::span<const Vec3> points, double* out);
  void look_around(double* out);
  void decide_by_distances(double* out);
  void ask_exactly(double* out);
  void take_extremes(bool least);

  Program program_;
  std::vector<Band> bands_;
  std::vector<ExternalRows*> externals_;
  double reach_;
  bool bounded_, one_way_;
  std::vector<std::vector<double>> values_, extremes_;  ///< by external
  std::vector<double> within_, found_;
  Batch open_, exact_;
};

}  // namespace meso::implicit
