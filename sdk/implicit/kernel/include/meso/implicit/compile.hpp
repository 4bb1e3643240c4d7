// SPDX-License-Identifier: Apache-2.0
#pragma once
// From a term to the rows of samples that contouring asks for: a plan of what depends on which axes, run by vector
// kernels.
//
//   const auto source = compile(gyroid, Grid{.box = {{-1, -1, -1}, {1, 1, 1}}, .nodes = {800, 800, 800}});
//   contour(*source, ...);
//
// Every operation means what Term::value() says, except that elementary functions are our own (within the 4 units in
// the last place that grants) and that, unless `strict_math`, sums and products may be regrouped: that moves a
// value by at most 1e-12 of the range that it has in the box. Samples have equal bits for every instruction set, slab
// and thread, and pruning changes no sign and no value that counts (GridSampler::row).
//
// A field that floats cannot hold (1e-60 * (x^2 + y^2 - 1)) is sampled times a power of two.
//
// Compiling costs a few milliseconds and O(n) memory for an n^3 grid; fields with a dear part of x and y alone get
// tables of n^2 doubles for it, within max_table_bytes. The source keeps its external fields alive.

#include <cstdint>
#include <memory>
#include <span>

#include "meso/base/diagnostic.hpp"
#include "meso/base/run_options.hpp"
#include "meso/implicit/grid_source.hpp"
#include "meso/implicit/term.hpp"

namespace meso::implicit {

enum class InstructionSet : std::uint8_t { automatic, sse2, avx2, avx512 };

/// Skip what interval arithmetic shows to be of one sign. `automatic`: where a sample of blocks says that it pays.
enum class Pruning : std::uint8_t { automatic, off, on };

struct CompileOptions {
  bool strict_math = false;  ///< every operation as the text says it, none regrouped
  InstructionSet instruction_set = InstructionSet::automatic;
  Pruning pruning = Pruning::automatic;
  std::uint64_t max_table_bytes = std::uint64_t{32} << 20;
};

/// Whether this machine has it.
[[nodiscard]] bool is_supported(InstructionSet set);

/// Empty after LIMIT_GRID_MEMORY, LIMIT_TIME or CANCELLED. REQUIRES: a grid of at least two nodes along each axis; an
/// instruction set that is supported.
[[nodiscard]] std::unique_ptr<GridSource> compile(const Term& term, const Grid& grid, const CompileOptions& options,
                                                  const RunOptions& run, DiagnosticSink& sink);
/// Without limits: never empty.
[[nodiscard]] std::unique_ptr<GridSource> compile(const Term& term, const Grid& grid,
                                                  const CompileOptions& options = {});

/// The term at points, many at a time: strict. REQUIRES: room for points.size() values.
void values(const Term& term, std::span<const Vec3> points, double* out,
            InstructionSet set = InstructionSet::automatic);

}  // namespace meso::implicit
