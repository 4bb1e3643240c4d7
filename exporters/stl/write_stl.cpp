// SPDX-License-Identifier: Apache-2.0
#include "meso/export_stl/write_stl.hpp"

#include <limits>
#include <vector>

#include "meso/base/ordered_blocks.hpp"
#include "meso/export_stl/stl_facet.hpp"

namespace meso {
namespace {

struct FacetCounts {
  std::uint64_t kept = 0, folded = 0;
};

template <typename Put>
FacetCounts visit_facets(const TriangleRanges& ranges, std::size_t range, Put put) {
  FacetCounts counts;
  ranges.visit(range, [&](std::span<const Triangle> block) {
    for (const Triangle& triangle : block) {
      const StlFacet facet = to_stl_facet(triangle);
      if (is_folded(facet)) {
        ++counts.folded;
      } else {
        ++counts.kept;
        put(facet);
      }
    }
  });
  return counts;
}

StlCounts sum_of(const std::vector<FacetCounts>& ranges) {
  StlCounts sum;
  for (const FacetCounts& range : ranges) {
    sum.triangles += range.kept;
    sum.left_out += range.folded;
  }
  return sum;
}

}  // namespace

StlCounts write_stl(const TriangleRanges& ranges, StlFormat format, ByteSink& sink, unsigned jobs) {
  std::vector<FacetCounts> counts(ranges.count);
  std::uint32_t expected = 0;
  if (format == StlFormat::binary) {
    for_each_block(ranges.count, threads_for(jobs), [&](std::size_t range, std::size_t) {
      counts[range] = visit_facets(ranges, range, [](const StlFacet&) {});
    });
    StlCounts sum = sum_of(counts);
    if (sum.triangles > std::numeric_limits<std::uint32_t>::max()) {
      sum.complete = false;
      return sum;
    }
    expected = static_cast<std::uint32_t>(sum.triangles);
  }
  const std::string begin = stl_begin(format, expected), end = stl_end(format);
  const bool begun = sink.write(begin);
  WrittenBlocks blocks{0, begun};
  if (begun)
    blocks = write_in_order(ranges.count, jobs, sink, [&](std::size_t range, ByteBuffer& out) {
      counts[range] = visit_facets(ranges, range, [&](const StlFacet& facet) { put_facet(facet, format, out); });
    });
  StlCounts sum = sum_of(counts);
  sum.complete = blocks.complete && sink.write(end);
  sum.bytes = begin.size() + blocks.bytes + end.size();
  return sum;
}

StlCounts write_stl(const TriangleStream& triangles, StlFormat format, ByteSink& sink) {
  constexpr std::size_t block_triangles = 4096;
  // A stream has no end that is known: it is one range, written in pieces.
  StlCounts counts;
  ByteBuffer buffer;
  const TriangleRanges all{1, [&](std::size_t, const TriangleBlockCallback& callback) { triangles(callback); }};
  if (format == StlFormat::binary) {
    const FacetCounts known = visit_facets(all, 0, [](const StlFacet&) {});
    counts = {0, known.kept, known.folded, known.kept <= std::numeric_limits<std::uint32_t>::max()};
    if (!counts.complete) return counts;
  }
  const auto flush = [&] {
    counts.complete = counts.complete && sink.write(buffer.view());
    counts.bytes += buffer.size();
    buffer.clear();
  };
  buffer.append(stl_begin(format, static_cast<std::uint32_t>(counts.triangles)));
  const FacetCounts written = visit_facets(all, 0, [&](const StlFacet& facet) {
    if (!counts.complete) return;
    put_facet(facet, format, buffer);
    if (buffer.size() >= block_triangles * stl_facet_bytes) flush();
  });
  counts.triangles = written.kept;
  counts.left_out = written.folded;
  buffer.append(stl_end(format));
  flush();
  return counts;
}

}  // namespace meso
