// SPDX-License-Identifier: Apache-2.0
#pragma once
// The part of `meso sdf` that writes volumes instead of surfaces.

#include <CLI/CLI.hpp>

#include "meso/operations/volume_outputs.hpp"
#include "run.hpp"

namespace meso::cli {

void add_volume_flags(CLI::App& flags, operations::VolumeOptions& options);

/// Does all that is left to do; the exit code.
int sdf_volume(Run& run, const sdf::Program& program, const operations::VolumeOptions& options);

}  // namespace meso::cli
