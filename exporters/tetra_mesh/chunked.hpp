// SPDX-License-Identifier: Apache-2.0
#pragma once
// Bytes on their way to a file: gathered, written in large pieces, and given up when somebody says stop. Private.

#include <array>
#include <bit>
#include <charconv>
#include <cstring>
#include <span>
#include <string_view>

#include "meso/base/byte_buffer.hpp"
#include "meso/base/byte_sink.hpp"
#include "meso/base/diagnostic.hpp"
#include "meso/base/run_options.hpp"

namespace meso {

class Chunked {
 public:
  Chunked(ByteSink& file, const RunOptions& run, DiagnosticSink& sink) : file_(file), run_(run), sink_(sink) {}

  void text(std::string_view t) {
    buffer_.append(t);
    if (buffer_.size() >= chunk) flush();
  }
  template <class Number>
  void number(Number n) {
    char* to = buffer_.claim(32);
    buffer_.advance(static_cast<std::size_t>(std::to_chars(to, to + 32, n).ptr - to));
  }
  /// Rounded to so many significant digits.
  void number(double n, int digits) {
    char* to = buffer_.claim(32);
    buffer_.advance(
        static_cast<std::size_t>(std::to_chars(to, to + 32, n, std::chars_format::general, digits).ptr - to));
  }
  /// Little-endian, as all formats here say of themselves.
  template <class Value>
  void raw(const Value& value) {
    static_assert(std::endian::native == std::endian::little && std::is_trivially_copyable_v<Value>);
    text({reinterpret_cast<const char*>(&value), sizeof value});
  }

  /// False: nothing more needs to be written.
  [[nodiscard]] bool good() const { return good_; }
  [[nodiscard]] bool finish() {
    flush();
    return good_;
  }

 private:
  static constexpr std::size_t chunk = 1 << 18;

  void flush() {
    if (good_ && run_.should_stop()) {
      sink_.report({.code = run_.out_of_time() ? Code::limit_time : Code::cancelled});
      good_ = false;
    }
    good_ = good_ && file_.write(buffer_.view());
    buffer_.clear();
  }

  ByteSink& file_;
  const RunOptions& run_;
  DiagnosticSink& sink_;
  ByteBuffer buffer_;
  bool good_ = true;
};

}  // namespace meso
