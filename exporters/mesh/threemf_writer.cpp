// SPDX-License-Identifier: Apache-2.0
#include "threemf_writer.hpp"

#include <cerrno>
#include <string>

#include "meso/zip/zip_writer.hpp"
#include "number_lines.hpp"

namespace meso {
namespace {

constexpr std::string_view content_types =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">
<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>
<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>
</Types>
)";
constexpr std::string_view relationships =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
<Relationship Target="/3D/3dmodel.model" Id="model" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>
</Relationships>
)";
constexpr std::string_view before_points =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<model unit="millimeter" xml:lang="en-US" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">
<metadata name="Application">meso</metadata>
<resources><object id="1" type="model"><mesh><vertices>
)";
constexpr std::string_view between = "</vertices><triangles>\n";
constexpr std::string_view after_triangles =
    "</triangles></mesh></object></resources>\n<build><item objectid=\"1\"/></build>\n</model>\n";

}  // namespace

template <class Real>
bool ThreeMfWriter<Real>::put(std::string_view text) {
  return std::fwrite(text.data(), 1, text.size(), model_.get()) == text.size() || file_.fail(errno);
}

template <class Real>
bool ThreeMfWriter<Real>::begin() {
  model_.reset(std::tmpfile());
  return model_ ? put(before_points) : file_.fail(errno);
}

template <class Real>
void ThreeMfWriter<Real>::encode_points(std::span<const Vec3> block, ByteBuffer& out) const {
  put_points<Real>({"<vertex x=\"", "\" y=\"", "\" z=\"", "\"/>\n"}, block, out);
}

template <class Real>
bool ThreeMfWriter<Real>::begin_triangles(std::uint64_t point_count) {
  return FileSink::begin_triangles(point_count) && put(between);
}

template <class Real>
void ThreeMfWriter<Real>::encode_triangles(std::span<const IndexTriangle> block, ByteBuffer& out) const {
  for (const IndexTriangle& t : block) put_line({"<triangle v1=\"", "\" v2=\"", "\" v3=\"", "\"/>\n"}, t, out);
}

template <class Real>
bool ThreeMfWriter<Real>::finish(std::uint64_t) {
  if (!put(after_triangles)) return false;
  ZipToFile target(file_);
  const RunOptions run;
  ZipWriter zip(target, run);
  const bool good = zip.add("[Content_Types].xml", content_types, ZipMethod::deflate) &&
                    zip.add("_rels/.rels", relationships, ZipMethod::deflate) &&
                    zip.add("3D/3dmodel.model", model_.get(), ZipMethod::fast) && zip.close();
  model_.reset();
  return good || file_.fail(EIO);
}

template class ThreeMfWriter<float>;
template class ThreeMfWriter<double>;

}  // namespace meso
