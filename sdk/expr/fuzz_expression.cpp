// SPDX-License-Identifier: Apache-2.0
// libFuzzer target: any bytes give one tree or one fault inside the text, and every tree has a value or one failed
// operation inside the text. Run: meso_fuzz_expression sdk/expr/fuzz_corpus
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <vector>

#include "meso/expr/expression.hpp"

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace meso::expr;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const ParseResult result = parse_expression(text, meso::LengthUnit::inch);
  require(result.expression.has_value() != result.error.has_value());
  if (result.error) {
    require(result.error->offset + result.error->length <= size);
    return 0;
  }
  const std::vector<double> slots(result.expression->names().size(), 0.75);
  const EvalResult value = evaluate(*result.expression, slots);
  require(std::isfinite(value.value));
  require(std::size_t{value.failed_offset} + value.failed_length <= size);
  return 0;
}
