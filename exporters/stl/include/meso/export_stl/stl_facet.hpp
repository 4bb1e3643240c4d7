// SPDX-License-Identifier: Apache-2.0
#pragma once
// The parts of an STL file, for whoever writes one: what stands before, for and after the triangles.
//
//   bytes.append(stl_begin(StlFormat::binary, count));
//   if (const StlFacet facet = to_stl_facet(triangle); !is_folded(facet)) put_facet(facet, StlFormat::binary, bytes);
//   bytes.append(stl_end(StlFormat::binary));
//
// Thread rule: pure.

#include <array>
#include <cstdint>
#include <string>

#include "meso/base/byte_buffer.hpp"
#include "meso/base/triangle_stream.hpp"

namespace meso {

enum class StlFormat { ascii, binary };

/// Corners as STL stores them.
using StlPoint = std::array<float, 3>;
using StlFacet = std::array<StlPoint, 3>;

inline constexpr std::size_t stl_facet_bytes = 50;     ///< of a binary facet
inline constexpr std::uint64_t stl_count_offset = 80;  ///< where the count of a binary file stands, in 32 bits

[[nodiscard]] StlPoint to_stl_point(Vec3 p);
[[nodiscard]] StlFacet to_stl_facet(const Triangle& triangle);
/// Two corners have rounded to the same point.
[[nodiscard]] inline bool is_folded(const StlFacet& f) { return f[0] == f[1] || f[1] == f[2] || f[2] == f[0]; }
void put_facet(const StlFacet& facet, StlFormat format, ByteBuffer& out);

/// `count` counts for binary files only.
[[nodiscard]] std::string stl_begin(StlFormat format, std::uint32_t count);
[[nodiscard]] std::string stl_end(StlFormat format);

}  // namespace meso
