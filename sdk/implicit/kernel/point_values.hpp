// SPDX-License-Identifier: Apache-2.0
#pragma once
// Values at points, to the bit those of a program that asks every external field exactly; but an external is asked no
// more exactly than its value counts there.
//
// Where a gyroid fills a mesh, the mesh's distance is dear and does not matter: with infinity in its place, of its
// sign, the program gives some v. That is right if the distance is beyond what a root of |v| needs (bands.hpp), and to
// know that takes no more than a look around the point. Where it is not beyond, the look has found the distance.

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
    void clear();
  };

  void block(std::span<const Vec3> points, double* out);
  void ask_signs(std::span<const Vec3> points);
  void look_around(std::span<const Vec3> points, const double* out);
  void run(const std::vector<std::vector<double>>& externals, std::span<const Vec3> points, double* out);

  Program program_;
  std::vector<Band> bands_;
  std::vector<ExternalRows*> externals_;
  double reach_;
  std::vector<std::vector<double>> values_;  ///< by external
  std::vector<double> within_, found_, root_within_;
  std::vector<char> changed_;
  Batch open_, exact_;
};

}  // namespace meso::implicit
