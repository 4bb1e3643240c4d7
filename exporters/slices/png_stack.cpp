// SPDX-License-Identifier: Apache-2.0
#include <png.h>

#include <cassert>
#include <cmath>
#include <csetjmp>
#include <string>
#include <vector>

#include "meso/export_slices/slice_files.hpp"

namespace meso {
namespace {

struct Png {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, fail, ignore);
  png_infop info = png != nullptr ? png_create_info_struct(png) : nullptr;
  ~Png() { png_destroy_write_struct(&png, &info); }

  static void fail(png_structp p, png_const_charp) { std::longjmp(png_jmpbuf(p), 1); }
  static void ignore(png_structp, png_const_charp) {}
};

void append(png_structp p, png_bytep data, png_size_t size) {
  static_cast<std::string*>(png_get_io_ptr(p))->append(reinterpret_cast<const char*>(data), size);
}

png_uint_32 pixels_per_metre(double spacing_mm) {
  return static_cast<png_uint_32>(std::min(std::round(1000 / spacing_mm), 2e9));
}

/// No object with a destructor may be made after setjmp: libpng jumps out on errors.
bool encode(const Png& p, const VoxelArray& a, const std::vector<png_bytep>& rows, std::string& out) {
  if (p.info == nullptr || setjmp(png_jmpbuf(p.png)) != 0) return false;
  png_set_write_fn(p.png, &out, append, nullptr);
  png_set_IHDR(p.png, p.info, a.cells[0], a.cells[1], 8, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_pHYs(p.png, p.info, pixels_per_metre(a.spacing.x), pixels_per_metre(a.spacing.y), PNG_RESOLUTION_METER);
  png_write_info(p.png, p.info);
  png_write_image(p.png, const_cast<png_bytepp>(rows.data()));
  png_write_end(p.png, nullptr);
  return true;
}

}  // namespace

bool PngStack::begin(const VoxelArray& array) {
  assert(array.type == VoxelType::uint8);
  array_ = array;
  return true;
}

bool PngStack::write_plane(std::string_view bytes) {
  std::vector<png_bytep> rows;  // from the top
  for (std::uint32_t j = array_.cells[1]; j-- > 0;)
    rows.push_back(reinterpret_cast<png_bytep>(const_cast<char*>(bytes.data())) + std::size_t{j} * array_.cells[0]);
  std::string out;
  return encode(Png(), array_, rows, out) && take_(plane_++, out);
}

}  // namespace meso
