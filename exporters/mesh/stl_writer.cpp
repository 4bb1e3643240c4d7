// SPDX-License-Identifier: Apache-2.0
#include "stl_writer.hpp"

#include <algorithm>
#include <cerrno>
#include <limits>

namespace meso {

bool StlWriter::begin() { return file_.write(stl_begin(format_, 0)); }

void StlWriter::encode_points(std::span<const Vec3> block, ByteBuffer& out) const {
  char* to = out.claim(block.size() * sizeof(StlPoint));
  for (const Vec3& p : block) {
    const StlPoint point = to_stl_point(p);
    std::memcpy(to, &point, sizeof point);
    to += sizeof point;
  }
  out.advance(block.size() * sizeof(StlPoint));
}

bool StlWriter::write_points(std::string_view bytes) {
  while (!bytes.empty()) {
    if (kept_ == pieces_.size() * piece) pieces_.emplace_back(new StlPoint[piece]);
    const std::size_t used = kept_ % piece, count = std::min(piece - used, bytes.size() / sizeof(StlPoint));
    std::memcpy(pieces_.back().get() + used, bytes.data(), count * sizeof(StlPoint));
    kept_ += count;
    bytes.remove_prefix(count * sizeof(StlPoint));
  }
  return true;
}

void StlWriter::encode_triangles(std::span<const IndexTriangle> block, ByteBuffer& out) const {
  for (const IndexTriangle& t : block)
    if (const StlFacet facet{at(t[0]), at(t[1]), at(t[2])}; !is_folded(facet)) put_facet(facet, format_, out);
}

bool StlWriter::write_triangles(std::string_view bytes) {
  facet_bytes_ += bytes.size();
  return file_.write(bytes);
}

bool StlWriter::finish(std::uint64_t) {
  pieces_.clear();
  if (format_ == StlFormat::ascii) return file_.write(stl_end(format_));
  const std::uint64_t facets = facet_bytes_ / stl_facet_bytes;
  if (facets > std::numeric_limits<std::uint32_t>::max()) return file_.fail(EFBIG);
  const auto count = static_cast<std::uint32_t>(facets);
  return file_.write_at(stl_count_offset, {reinterpret_cast<const char*>(&count), sizeof count});
}

}  // namespace meso
