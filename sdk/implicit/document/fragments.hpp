// SPDX-License-Identifier: Apache-2.0
#pragma once
// Pieces that cutting leaves loose, told apart on a mesh. Private.

#include <cstdint>
#include <optional>

#include "meso/base/diagnostic.hpp"
#include "meso/base/run_options.hpp"
#include "meso/implicit/field.hpp"

namespace meso::implicit {

struct Fragments {
  std::uint64_t count = 0;      ///< of those that hold at least a cell of the grid
  std::optional<Field> pieces;  ///< all of them, as a body; nothing if there are none
};

/// Of `body`, which a step has made of `before`, on samples `spacing` apart. Nothing if something was reported.
[[nodiscard]] std::optional<Fragments> fragments_of(const Field& body, const Field& before, double spacing,
                                                    const RunOptions& run, DiagnosticSink& sink);

}  // namespace meso::implicit
