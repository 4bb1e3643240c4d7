// SPDX-License-Identifier: Apache-2.0
#pragma once
// Room for the numbers of a file that must be unpacked or parsed: in memory while they are few, beyond that in a
// temporary file, mapped, so that memory stays bounded however many records there are.
//
//   auto block = NumberBlock::make(rows * columns, run, sink);   // nothing: FIELD_NO_SPACE was reported
//   std::copy(..., block->data());
//   const Records records = std::move(*block).records(rows, columns);
//
// More than a quarter of `run.max_memory_bytes` goes to a file in TMPDIR, else in /var/tmp, else in /tmp; it has no
// name and ends with the records. Numbers are 0 until they are written. Values that move; one thread until records() is
// called.

#include <cstdint>
#include <memory>
#include <optional>

#include "meso/base/diagnostic.hpp"
#include "meso/base/run_options.hpp"
#include "meso/fields/records.hpp"

namespace meso::fields {

/// Of the memory budget, what the numbers of a field may take; the rest is for what finds them.
inline constexpr std::uint64_t numbers_part = 4;

class NumberBlock {
 public:
  /// REQUIRES: 0 < count < 2^60.
  [[nodiscard]] static std::optional<NumberBlock> make(std::uint64_t count, const RunOptions& run,
                                                       DiagnosticSink& sink);
  [[nodiscard]] static bool is_in_memory(std::uint64_t count, const RunOptions& run) {
    return count <= run.max_memory_bytes / numbers_part / sizeof(double);
  }

  [[nodiscard]] double* data() { return static_cast<double*>(bytes_.get()); }
  /// The first rows x columns of them. REQUIRES: there are so many.
  [[nodiscard]] Records records(std::size_t rows, std::size_t columns) &&;

 private:
  std::shared_ptr<void> bytes_;
};

}  // namespace meso::fields
