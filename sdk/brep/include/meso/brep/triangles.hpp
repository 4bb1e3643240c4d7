// SPDX-License-Identifier: Apache-2.0
#pragma once
// The triangles of a meshed body as a stream: what STL, 3MF and viewers read.
//
//   visit_triangles(body, [&](std::span<const Triangle> block) { count += block.size(); });
//
// Blocks are one face instance each, in shell order. Points that faces share are equal bit for bit, so welding needs no
// tolerance. About 30 million triangles a second, constant memory. Thread rule: pure.

#include <functional>
#include <span>

#include "meso/base/triangle_ranges.hpp"
#include "meso/brep/body.hpp"

namespace meso::brep {

void visit_triangles(const Body& body, const TriangleBlockCallback& callback);

/// The same as a stream that an exporter may visit more than once. `body` must outlive it.
[[nodiscard]] TriangleStream triangles_of(const Body& body);

/// The same in ranges, for exporters with several threads: 16 bytes a face instance. `body` must outlive it.
[[nodiscard]] TriangleRanges triangle_ranges(const Body& body);

}  // namespace meso::brep
