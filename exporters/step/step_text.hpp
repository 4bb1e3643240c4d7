// SPDX-License-Identifier: Apache-2.0
#pragma once
// The syntax of a STEP file: numbered entities with typed arguments, appended to a buffer.
//
//   const StepId p = text.entity("CARTESIAN_POINT", NoName{}, Vec3{1, 2, 3});   // #1=CARTESIAN_POINT('',(1.,2.,3.));
//   text.entity("VERTEX_POINT", NoName{}, Ref{p});
//
// Without a buffer nothing is spelled and entities are only numbered: a first pass tells where each range of a file
// begins to count, and several threads write the ranges.

#include <array>
#include <charconv>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "meso/base/byte_buffer.hpp"
#include "meso/base/vec.hpp"

namespace meso::step {

using StepId = std::uint32_t;

struct Ref {
  StepId id = 0;
};
struct NoName {};  ///< ''
struct Raw {       ///< as it is
  std::string_view text;
};
struct Quoted {  ///< a UTF-8 string, encoded
  std::string_view text;
};
struct Grid {  ///< ((..),(..)) of rows of `columns` values
  std::span<const StepId> refs;
  std::span<const double> reals;
  std::size_t columns = 0;
};

class StepText {
 public:
  /// The next entity is number `last` + 1.
  explicit StepText(ByteBuffer* buffer, StepId last = 0) : buffer_(buffer), last_(last) {}
  StepText(const StepText&) = delete;
  StepText& operator=(const StepText&) = delete;

  /// `keyword(arguments)` as the next entity.
  template <typename... Arguments>
  StepId entity(std::string_view keyword, const Arguments&... arguments) {
    if (buffer_ == nullptr) return ++last_;
    begin_entity();
    part(keyword, arguments...);
    return end_entity();
  }

  // A complex entity is written part by part between begin_complex() and end_complex().
  void begin_complex() {
    if (buffer_ == nullptr) return;
    begin_entity();
    put("(");
  }
  template <typename... Arguments>
  void part(std::string_view keyword, const Arguments&... arguments) {
    if (buffer_ == nullptr) return;
    put(keyword);
    put("(");
    std::string_view separator;
    ((put(std::exchange(separator, ",")), argument(arguments)), ...);
    put(")");
  }
  StepId end_complex() {
    if (buffer_ == nullptr) return ++last_;
    put(")");
    return end_entity();
  }

  /// Anything outside the data section.
  void raw(std::string_view text) {
    if (buffer_ != nullptr) put(text);
  }

  /// The number of the last entity.
  [[nodiscard]] StepId last() const { return last_; }

 private:
  static constexpr std::size_t longest_number = 32;

  void begin_entity() {
    put("#");
    integer(last_ + 1);
    put("=");
  }
  StepId end_entity() {
    put(";\n");
    return ++last_;
  }
  void put(std::string_view text) { buffer_->append(text); }
  void integer(std::uint64_t value) {
    char* const begin = buffer_->claim(longest_number);
    buffer_->advance(static_cast<std::size_t>(std::to_chars(begin, begin + longest_number, value).ptr - begin));
  }
  void real(double value);

  void argument(NoName) { put("''"); }
  void argument(Raw raw) { put(raw.text); }
  void argument(Quoted quoted);
  void argument(bool value) { put(value ? ".T." : ".F."); }
  void argument(int value) { integer(static_cast<std::uint64_t>(value)); }
  void argument(double value) { real(value); }
  void argument(Ref ref) {
    put("#");
    integer(ref.id);
  }
  void argument(Vec3 v) {
    list(std::array{v.x, v.y, v.z}, [this](double x) { real(x); });
  }
  void argument(const std::vector<StepId>& refs) {
    list(refs, [this](StepId id) { argument(Ref{id}); });
  }
  void argument(const std::vector<double>& values) {
    list(values, [this](double x) { real(x); });
  }
  void argument(const std::vector<int>& values) {
    list(values, [this](int i) { argument(i); });
  }
  void argument(const Grid& grid);

  // Long lists are broken into lines, so that other programs' line buffers and people's editors survive.
  template <typename Items, typename Put>
  void list(const Items& items, Put put_item) {
    put("(");
    std::size_t count = 0;
    for (const auto& item : items) {
      if (count > 0) put(count % 16 == 0 ? ",\n" : ",");
      put_item(item);
      ++count;
    }
    put(")");
  }

  ByteBuffer* buffer_;
  StepId last_;
};

}  // namespace meso::step
