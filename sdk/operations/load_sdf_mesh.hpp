// SPDX-License-Identifier: Apache-2.0
#pragma once
// What `file` of the command language reads. Private.

#include <memory>
#include <string>

#include "meso/base/run_options.hpp"
#include "meso/implicit/external_field.hpp"

namespace meso::operations {

[[nodiscard]] std::shared_ptr<const implicit::ExternalField> load_sdf_mesh(const std::string& path,
                                                                           const RunOptions& run, DiagnosticSink& sink);

}  // namespace meso::operations
