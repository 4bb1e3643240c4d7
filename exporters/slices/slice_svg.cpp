// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "meso/base/number.hpp"
#include "meso/export_slices/slice_files.hpp"

namespace meso {

bool write_slice_svg(const Slice& slice, const SliceFrame& frame, ByteSink& file) {
  const std::string width = format_number(frame.max[0] - frame.min[0]),
                    height = format_number(frame.max[1] - frame.min[1]);
  std::string out = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + width + "mm\" height=\"" + height +
                    "mm\" viewBox=\"" + format_number(frame.min[0]) + " " + format_number(-frame.max[1]) + " " + width +
                    " " + height + "\">\n<desc>height " + format_number(slice.height) +
                    " mm</desc>\n<path fill-rule=\"evenodd\" d=\"";
  for (const auto& loop : slice.loops) {
    for (std::size_t i = 0; i < loop.size(); ++i)
      out += (i == 0 ? "M" : "L") + format_number(loop[i][0]) + " " + format_number(0 - loop[i][1]);
    out += "Z\n";
  }
  return file.write(out + "\"/>\n</svg>\n");
}

}  // namespace meso
