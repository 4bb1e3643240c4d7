// SPDX-License-Identifier: Apache-2.0
// Whatever the bytes are: no crash, a refusal comes with an error, and what is read survives writing and reading.
#include <cstdint>
#include <cstdlib>

#include "meso/xml/read.hpp"
#include "meso/xml/write.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace meso;
  DiagnosticSink sink;
  const auto first = read_document(std::string(reinterpret_cast<const char*>(data), size), "fuzz.meso", sink);
  if (first.has_value() == sink.has_errors()) std::abort();
  for (const Diagnostic& d : sink.diagnostics()) static_cast<void>(render(d));
  if (!first) return 0;
  const std::string text = write_document(first->document);
  const auto second = read_document(text, "again.meso", sink);
  if (!second || second->document != first->document) std::abort();
  const std::string canonical = canonical_document(first->document);
  const auto third = read_document(canonical, "canonical.meso", sink);
  if (!third || canonical_document(third->document) != canonical) std::abort();
  return 0;
}
