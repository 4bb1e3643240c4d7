// SPDX-License-Identifier: Apache-2.0
#include "meso/operations/estimate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "meso/brep/body_sample.hpp"
#include "meso/brep/triangles.hpp"
#include "meso/export_step/write_step.hpp"
#include "meso/export_stl/write_stl.hpp"
#include "prepare.hpp"

namespace meso::operations {
namespace {

/// Counts bytes, and apart from them the digits of STEP's entity numbers: those grow with the size of the file.
class CountingSink final : public ByteSink {
 public:
  [[nodiscard]] bool write(std::string_view bytes) override {
    all += bytes.size();
    for (const char c : bytes) {
      if (in_number_ && c >= '0' && c <= '9') {
        ++digits;
        continue;
      }
      in_number_ = c == '#';
      if (in_number_) ++numbers;
    }
    return true;
  }
  std::uint64_t all = 0, numbers = 0, digits = 0;

 private:
  bool in_number_ = false;
};

/// What grows with a body; negative for differences.
struct Costs {
  double faces = 0, triangles = 0, ascii_stl_bytes = 0;
  double step_bytes = 0, step_numbers = 0, step_entities = 0;  ///< bytes without the digits of the numbers

  void add(const Costs& other, double weight) {
    faces += weight * other.faces;
    triangles += weight * other.triangles;
    ascii_stl_bytes += weight * other.ascii_stl_bytes;
    step_bytes += weight * other.step_bytes;
    step_numbers += weight * other.step_numbers;
    step_entities += weight * other.step_entities;
  }
};

std::uint64_t face_count(const brep::Body& body) {
  std::uint64_t faces = 0;
  const auto count = [&](const brep::Shell& shell) { shell.visit([&](const brep::FaceInstance&) { ++faces; }); };
  for (const brep::Solid& solid : body.solids) {
    count(solid.outer);
    for (const brep::Shell& hollow : solid.voids) count(hollow);
  }
  return faces;
}

Costs costs_of(const brep::Body& body) {
  CountingSink step, ascii;
  const StepCounts step_counts = write_step(body, {}, step);
  const StlCounts stl_counts = write_stl(brep::triangles_of(body), StlFormat::ascii, ascii);
  return {.faces = static_cast<double>(face_count(body)),
          .triangles = static_cast<double>(stl_counts.triangles),
          .ascii_stl_bytes = static_cast<double>(ascii.all),
          .step_bytes = static_cast<double>(step.all - step.digits),
          .step_numbers = static_cast<double>(step.numbers),
          .step_entities = static_cast<double>(step_counts.entities)};
}

/// Average number of digits of 1 ... n.
double mean_digits(double n) {
  double sum = 0, first = 1;
  for (double digits = 1; first <= n; ++digits, first *= 10) sum += digits * (std::min(n, 10 * first - 1) - first + 1);
  return n >= 1 ? sum / n : 0;
}

std::uint64_t rounded(double value) { return value > 0 ? static_cast<std::uint64_t>(std::llround(value)) : 0; }

}  // namespace

std::optional<Estimate> estimate(const std::filesystem::path& document, const MakeOptions& options,
                                 DiagnosticSink& sink) {
  MakeOptions unlimited = options;
  unlimited.mesh = true;
  unlimited.run.max_cells = std::numeric_limits<std::uint64_t>::max();
  const auto prepared = prepare(document, unlimited, sink);
  const auto sample =
      prepared ? brep::sample_build(prepared->evaluation, prepared->part(), prepared->realise, sink) : std::nullopt;
  if (!sample) return std::nullopt;
  const Costs frame = costs_of({});  // headers
  Costs total = frame;
  for (const auto& [body, weight] : sample->bodies) {
    total.add(costs_of(body), weight);
    total.add(frame, -weight);
  }
  return Estimate{.placed = sample->cells.placed,
                  .kept = sample->cells.kept,
                  .faces = rounded(total.faces),
                  .triangles = rounded(total.triangles),
                  .step_bytes = rounded(total.step_bytes + total.step_numbers * mean_digits(total.step_entities)),
                  .stl_bytes = 84 + 50 * rounded(total.triangles),
                  .ascii_stl_bytes = rounded(total.ascii_stl_bytes)};
}

}  // namespace meso::operations
