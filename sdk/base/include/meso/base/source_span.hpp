// SPDX-License-Identifier: Apache-2.0
#pragma once
// A place in a text file: what a diagnostic points at.

#include <cstddef>
#include <string>

namespace meso {

/// `offset` and `length` count bytes of the UTF-8 text; `line` and `column` are 1-based, `column` counts code points.
/// line == 0 means: no place known (a document built in memory).
struct SourceSpan {
  std::string file;
  std::size_t offset = 0;
  std::size_t length = 0;
  std::size_t line = 0;
  std::size_t column = 0;

  friend bool operator==(const SourceSpan&, const SourceSpan&) = default;
};

}  // namespace meso
