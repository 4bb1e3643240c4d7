// SPDX-License-Identifier: Apache-2.0
#pragma once
// A body in OpenCASCADE's own text format (.brep), which FreeCAD and others read exactly.
//
//   const auto bytes = write_brep(body, file, sink);
//
// The shape is built in memory first: a few milliseconds and some ten kilobytes a face. Errors: GEOMETRY_KERNEL;
// nothing if the sink failed.

#include <cstdint>
#include <optional>

#include "meso/base/byte_sink.hpp"
#include "meso/base/diagnostic.hpp"
#include "meso/brep/body.hpp"

namespace meso::brep {

/// Number of bytes written.
[[nodiscard]] std::optional<std::uint64_t> write_brep(const Body& body, ByteSink& out, DiagnosticSink& sink);

}  // namespace meso::brep
