// SPDX-License-Identifier: Apache-2.0
#include "meso/export_stl/write_stl.hpp"

#include <limits>

#include "meso/export_stl/stl_facet.hpp"

namespace meso {
namespace {

// Gathers bytes until a write is worth its while.
class Output {
 public:
  explicit Output(ByteSink& sink) : sink_(sink) {}

  ByteBuffer& buffer() {
    if (buffer_.size() >= std::size_t{1} << 18) flush();
    return buffer_;
  }
  void put(std::string_view text) { buffer().append(text); }
  [[nodiscard]] bool ok() const { return ok_; }
  /// All bytes so far.
  std::uint64_t finish() {
    flush();
    return flushed_;
  }

 private:
  void flush() {
    ok_ = ok_ && sink_.write(buffer_.view());
    flushed_ += buffer_.size();
    buffer_.clear();
  }

  ByteSink& sink_;
  ByteBuffer buffer_;
  std::uint64_t flushed_ = 0;
  bool ok_ = true;
};

template <typename Put>
void visit_facets(const TriangleStream& triangles, StlCounts& counts, Put put) {
  triangles([&](std::span<const Triangle> block) {
    for (const Triangle& triangle : block) {
      const StlFacet facet = to_stl_facet(triangle);
      if (is_folded(facet)) {
        ++counts.left_out;
      } else {
        ++counts.triangles;
        put(facet);
      }
    }
  });
}

}  // namespace

StlCounts write_stl(const TriangleStream& triangles, StlFormat format, ByteSink& sink) {
  StlCounts counts;
  if (format == StlFormat::binary) {
    visit_facets(triangles, counts, [](const StlFacet&) {});
    if (counts.triangles > std::numeric_limits<std::uint32_t>::max()) {
      counts.complete = false;
      return counts;
    }
  }
  Output output(sink);
  output.put(stl_begin(format, static_cast<std::uint32_t>(counts.triangles)));
  counts = {};
  visit_facets(triangles, counts, [&](const StlFacet& facet) {
    if (output.ok()) put_facet(facet, format, output.buffer());
  });
  output.put(stl_end(format));
  counts.bytes = output.finish();
  counts.complete = output.ok();
  return counts;
}

}  // namespace meso
