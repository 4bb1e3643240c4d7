// SPDX-License-Identifier: Apache-2.0
#include "mesh_warnings.hpp"

#include <algorithm>
#include <cmath>

#include "meso/base/number.hpp"
#include "meso/sdf/shortest_period.hpp"
#include "meso/sdf/words.hpp"

namespace meso::operations {

std::string significant(double value, int digits) {
  if (!(value > 0) || !std::isfinite(value)) return format_number(value);
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - digits + 1);
  // A tenth is 1/10, not 0.1 times 1: so the result has few digits.
  const double units = std::floor(value / unit * (1 + 1e-12));
  return format_number(unit < 1 ? units / std::round(1 / unit) : units * unit);
}

/// A count of two digits, without an exponent.
static std::string in_full(double count) {
  const double unit = std::pow(10.0, std::max(0.0, std::floor(std::log10(count)) - 1));
  constexpr double most = 1e15;
  return count < most ? std::to_string(std::llround(std::ceil(count / unit) * unit)) : format_number(count);
}

double thickness_of(const TriangleMesh& mesh) {
  double volume = 0, area = 0;
  if (mesh.points.empty()) return 0;
  const Vec3 eye = mesh.points.front();
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 twice = cross(mesh.points[b] - mesh.points[a], mesh.points[c] - mesh.points[a]);
    volume += dot(mesh.points[a] - eye, twice) / 6;
    area += norm(twice) / 2;
  }
  return area > 0 ? 2 * volume / area : 0;
}

bool warn_of_thinness(double thickness_mm, const Seen& seen, DiagnosticSink& sink) {
  if (!(thickness_mm > 0 && thickness_mm < seen.spacing_mm)) return false;
  const double enough = thickness_mm / 2, finer = seen.spacing_mm / enough;
  sink.report({.code = Code::sdf_coarse,
               .args = {significant(thickness_mm, 3), significant(seen.spacing_mm, 3),
                        in_full(seen.count * finer * finer * finer), seen.called, significant(enough, 2)}});
  return true;
}

bool warn_of_period(const sdf::Program& program, double spacing_mm, DiagnosticSink& sink) {
  const auto period = sdf::shortest_period(program);
  if (!period || !(period->length < 4 * spacing_mm)) return false;
  const sdf::Word& word = period->made_by->word;
  Diagnostic d{.code = Code::period_below_spacing,
               .args = {word.text, format_number(period->length), significant(spacing_mm, 3)}};
  point_at(d, word);
  sink.report(std::move(d));
  return true;
}

void warn_of_cavities(const MeshMeasures& measures, DiagnosticSink& sink) {
  if (measures.cavities == 0) return;
  sink.report({.code = Code::cavities_closed,
               .args = {std::to_string(measures.cavities), significant(measures.cavity_volume, 4)}});
}

}  // namespace meso::operations
