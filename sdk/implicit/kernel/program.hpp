// SPDX-License-Identifier: Apache-2.0
#pragma once
// Nodes of a graph as a list of row instructions whose operands are addresses: what runs in the inner loop.
//
//   Program program(graph, kernels, steps, root, place_of);
//   program.sample(0, 800, j, k, values, inside);     // root at the samples 0 ... 799 of row (j, k)
//
// A program owns the memory of its intermediate rows: one per thread.

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "aligned_array.hpp"
#include "graph.hpp"
#include "row_kernels.hpp"

namespace meso::implicit {

/// Sample i of row j in plane k lies at base[along i + row j + plane k].
struct Operand {
  double* base = nullptr;
  std::ptrdiff_t along = 0, row = 0, plane = 0;
  bool uniform = false;  ///< one value for the whole row

  [[nodiscard]] double* at(std::size_t i, std::size_t j, std::size_t k) const {
    return base + along * static_cast<std::ptrdiff_t>(i) + row * static_cast<std::ptrdiff_t>(j) +
           plane * static_cast<std::ptrdiff_t>(k);
  }
};

/// Rows of the external leaves on a grid, in the graph's order. Without them the fields are asked point by point.
struct ExternalInputs {
  std::span<ExternalRows* const> rows{};
  std::size_t samples = 0;  ///< of a row
};

class Program {
 public:
  /// Where a node lies; nothing: in a row of the program's own. There the coordinates are those of points, and every
  /// other node is written by its step.
  using PlaceOf = std::function<std::optional<Operand>(Graph::Id)>;

  /// Steps are nodes to be computed, in that order. Where a node is read and `stands_for` is not empty, the node
  /// stands_for[id] is read in its place.
  Program(const Graph& graph, const RowKernels& kernels, std::span<const Graph::Id> steps, Graph::Id root,
          const PlaceOf& place_of, const ExternalInputs& externals = {}, std::span<const Graph::Id> stands_for = {});

  /// Every step for samples of row (j, k). REQUIRES, here and below: begin and end are multiples of row_unit.
  void run(std::size_t begin, std::size_t end, std::size_t j, std::size_t k);

  /// The root's values and signs. `values` and `inside` belong to sample 0.
  void sample(std::size_t begin, std::size_t end, std::size_t j, std::size_t k, float* values, std::uint16_t* inside);

  /// The root's values at points. `externals`: those of each external leaf; without them, the fields are asked.
  /// REQUIRES: a program without places for the coordinates.
  void values_at(std::span<const Vec3> points, std::span<const std::vector<double>> externals, double* out);

 private:
  struct Instruction {
    Kernel kernel = nullptr;  ///< none: an external leaf
    const ExternalLeaf* leaf = nullptr;
    ExternalRows* rows = nullptr;
    std::uint32_t external = 0;  ///< the number of the leaf
    std::uint32_t first_operand = 0, operands = 0;
    Operand out;
  };
  class Assembler;

  void step(const Instruction& instruction, std::size_t i, std::size_t n, std::size_t j, std::size_t k);
  void external_at_points(const Instruction& instruction, double* out) const;
  std::span<const Input> inputs(const Instruction& instruction, std::size_t i, std::size_t j, std::size_t k);

  std::vector<Instruction> instructions_;
  std::vector<Operand> operands_;
  std::vector<Input> inputs_;  ///< of one instruction
  Instruction result_;         ///< its operands are what `store_` reads
  StoreKernel store_ = nullptr;
  std::size_t chunk_ = 0;
  AlignedArray memory_;      ///< rows of one chunk; the first three for coordinates of points
  std::size_t samples_ = 0;  ///< of a row, or of the points at hand
  std::span<const std::vector<double>> externals_at_points_;
  std::size_t first_point_ = 0;  ///< of those at hand
};

}  // namespace meso::implicit
