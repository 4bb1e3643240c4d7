// SPDX-License-Identifier: Apache-2.0
#pragma once
// The part of `meso sdf` and `meso convert` that writes volumes instead of surfaces.

#include <CLI/CLI.hpp>

#include "meso/operations/volume_outputs.hpp"
#include "run.hpp"

namespace meso::cli {

void add_volume_flags(CLI::App& flags, operations::VolumeOptions& options);

/// Ends the run: what was made of `out`, or that nothing was. The exit code.
int finish_volume(Run& run, const std::optional<operations::VolumeReport>& report, const std::string& out);

/// Does all that is left to do; the exit code.
int sdf_volume(Run& run, const sdf::Program& program, const operations::VolumeOptions& options);

}  // namespace meso::cli
