// SPDX-License-Identifier: Apache-2.0
#include "meso/brep/write_brep.hpp"

#include <BRepTools.hxx>
#include <sstream>

#include "in_memory.hpp"

namespace meso::brep {

std::optional<std::uint64_t> write_brep(const Body& body, ByteSink& out, DiagnosticSink& sink) {
  const auto shape = to_shape(body, sink);
  if (!shape) return std::nullopt;
  try {
    std::ostringstream text;
    BRepTools::Write(*shape, text);
    const std::string bytes = std::move(text).str();
    return out.write(bytes) ? std::optional<std::uint64_t>(bytes.size()) : std::nullopt;
  } catch (const Standard_Failure& failure) {
    sink.report({.code = Code::geometry_kernel, .args = {"writing .brep", what(failure)}});
    return std::nullopt;
  }
}

}  // namespace meso::brep
