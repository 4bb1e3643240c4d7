// SPDX-License-Identifier: Apache-2.0
#pragma once
// One function for each format; read_surface_mesh.hpp says what they accept.

#include <optional>
#include <string>
#include <string_view>

#include "meso/base/diagnostic.hpp"
#include "meso/base/triangle_mesh.hpp"

namespace meso {

[[nodiscard]] std::optional<TriangleMesh> read_ply(std::string_view bytes, const std::string& file,
                                                   DiagnosticSink& sink);
[[nodiscard]] std::optional<TriangleMesh> read_obj(std::string_view text, const std::string& file,
                                                   DiagnosticSink& sink);
[[nodiscard]] std::optional<TriangleMesh> read_off(std::string_view text, const std::string& file,
                                                   DiagnosticSink& sink);

}  // namespace meso
