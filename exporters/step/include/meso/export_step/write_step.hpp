// SPDX-License-Identifier: Apache-2.0
#pragma once
// Writes a body as STEP: one product, one advanced B-rep with all solids.
//
//   const StepCounts counts = write_step(body, {.name = "beam"}, file);
//
// Millimetres and radians, uncertainty 1e-6 mm. No pcurves: readers derive them, and files are a fifth of the size.
// Equal bodies give equal bytes, whatever `jobs` is: no clock, host or user. Cost: over two million entities a second
// and thread, about 1.1 kB a face; memory is the numbers of the shared vertices and edges of one shell (about 30 bytes
// each, and 20 a face), and a few megabytes a thread. At most 4e9 entities. Errors: `complete` is false if the sink
// failed; the sink's owner knows why. Thread rule: pure but for the sink, which is called by one thread at a time.

#include <cstdint>
#include <string>

#include "meso/base/byte_sink.hpp"
#include "meso/brep/body.hpp"

namespace meso {

enum class StepSchema { ap214, ap242 };

struct StepOptions {
  std::string name = "part";  ///< product and file name in the header, UTF-8
  StepSchema schema = StepSchema::ap214;
  std::int64_t timestamp = 0;  ///< seconds since 1970, for example SOURCE_DATE_EPOCH
  unsigned jobs = 1;           ///< threads; 0: one for each core
};

struct StepCounts {
  std::uint64_t bytes = 0, entities = 0;
  std::uint64_t touching_faces = 0;  ///< of balls whose struts touch: OpenCASCADE's reader may take their other side
  bool complete = true;
};

[[nodiscard]] StepCounts write_step(const brep::Body& body, const StepOptions& options, ByteSink& sink);

}  // namespace meso
