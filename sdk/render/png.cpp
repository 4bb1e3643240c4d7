// SPDX-License-Identifier: Apache-2.0
#include <png.h>

#include <cassert>

#include "meso/render/picture.hpp"

namespace meso::picture {

std::string png(const Image& image) {
  assert(image.rgb.size() == std::size_t{3} * image.width * image.height);
  // libpng's simplified interface: it needs no setjmp, and writes neither time nor text chunks.
  png_image control{};
  control.version = PNG_IMAGE_VERSION;
  control.width = image.width;
  control.height = image.height;
  control.format = PNG_FORMAT_RGB;
  std::string bytes(PNG_IMAGE_PNG_SIZE_MAX(control), '\0');
  png_alloc_size_t size = bytes.size();
  if (!png_image_write_to_memory(&control, bytes.data(), &size, 0, image.rgb.data(), 0, nullptr)) return {};
  bytes.resize(size);
  return bytes;
}

}  // namespace meso::picture
