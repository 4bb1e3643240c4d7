// SPDX-License-Identifier: Apache-2.0
#pragma once
// A stream buffer that reads where the bytes are. Private.
//
//   ViewBuffer buffer(bytes->view());
//   std::istream stream(&buffer);

#include <streambuf>
#include <string_view>

namespace meso::brep {

class ViewBuffer final : public std::streambuf {
 public:
  explicit ViewBuffer(std::string_view bytes) {
    char* begin = const_cast<char*>(bytes.data());  // the interface is not const, reading is
    setg(begin, begin, begin + bytes.size());
  }

 protected:
  /// Places are asked for and returned to by the BREP reader.
  pos_type seekoff(off_type off, std::ios_base::seekdir from, std::ios_base::openmode) override {
    const off_type base = from == std::ios_base::beg   ? 0
                          : from == std::ios_base::cur ? gptr() - eback()
                                                       : egptr() - eback();
    if (base + off < 0 || base + off > egptr() - eback()) return pos_type(off_type(-1));
    setg(eback(), eback() + base + off, egptr());
    return pos_type(base + off);
  }
  pos_type seekpos(pos_type to, std::ios_base::openmode mode) override {
    return seekoff(off_type(to), std::ios_base::beg, mode);
  }
};

}  // namespace meso::brep
