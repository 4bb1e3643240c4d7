// SPDX-License-Identifier: Apache-2.0
#include "meso/implicit/grid.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace meso::implicit {

std::array<std::int32_t, 3> nodes_for_total(const Box3& box, double total) {
  const Vec3 size = box.max - box.min;
  std::array<std::size_t, 3> order{0, 1, 2};
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return size[a] < size[b]; });
  // Shortest first: what an axis takes more than its share, because it needs two, is missing from the others.
  // Logarithms, since products of extreme sizes leave the range.
  std::array<std::int32_t, 3> nodes{};
  double log_left = std::log(total);
  for (std::size_t i = 0; i < 3; ++i) {
    double log_volume = 0;
    for (std::size_t k = i; k < 3; ++k) log_volume += std::log(size[order[k]]);
    const double per_length = (log_left - log_volume) / static_cast<double>(3 - i);
    const double count = std::clamp(std::round(std::exp(std::log(size[order[i]]) + per_length)), 2.0, 2147483647.0);
    nodes[order[i]] = static_cast<std::int32_t>(count);
    log_left = std::max(0.0, count > 2 ? log_left - (std::log(size[order[i]]) + per_length) : log_left - std::log(2.0));
  }
  return nodes;
}

unsigned planes_of(const Box3& box, Vec3 p) {
  unsigned planes = 0;
  for (unsigned axis = 0; axis < 3; ++axis) {
    if (p[axis] == box.min[axis]) planes |= 1U << 2 * axis;
    if (p[axis] == box.max[axis]) planes |= 2U << 2 * axis;
  }
  return planes;
}

Vec3 within(unsigned planes, Vec3 v) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    if ((planes >> 2 * axis & 3U) != 0) v[axis] = 0;
  return v;
}

std::string mebibytes(std::uint64_t bytes) { return std::to_string((bytes >> 20) + (bytes % (1 << 20) != 0 ? 1 : 0)); }

bool fits_memory(std::string nodes, std::uint64_t bytes, std::string_view purpose, const RunOptions& run,
                 DiagnosticSink& diagnostics) {
  if (bytes <= run.max_memory_bytes) return true;
  diagnostics.report(
      {.code = Code::limit_grid_memory,
       .args = {std::move(nodes), mebibytes(bytes), std::string(purpose), mebibytes(run.max_memory_bytes)}});
  return false;
}

bool fits_memory(const Grid& grid, std::uint64_t bytes, std::string_view purpose, const RunOptions& run,
                 DiagnosticSink& diagnostics) {
  std::string nodes;  // not their product, which may leave 64 bits
  for (const std::int32_t n : grid.nodes) nodes += (nodes.empty() ? "" : " x ") + std::to_string(n);
  return fits_memory(std::move(nodes), bytes, purpose, run, diagnostics);
}

double float_step(const Box3& box) {
  double reach = 0;
  for (std::size_t axis = 0; axis < 3; ++axis)
    reach = std::max({reach, std::abs(box.min[axis]), std::abs(box.max[axis])});
  return std::nextafter(static_cast<float>(reach), HUGE_VALF) - static_cast<float>(reach);
}

}  // namespace meso::implicit
