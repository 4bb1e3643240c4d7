// SPDX-License-Identifier: Apache-2.0
#pragma once
// The syntax of a STEP file: numbered entities with typed arguments, buffered into a sink. While one buffer fills, the
// one before it is written by a thread of its own, so a slow disk costs no time until it is slower than the text.
//
//   const StepId p = text.entity("CARTESIAN_POINT", NoName{}, Vec3{1, 2, 3});   // #1=CARTESIAN_POINT('',(1.,2.,3.));
//   text.entity("VERTEX_POINT", NoName{}, Ref{p});

#include <array>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <future>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "meso/base/byte_sink.hpp"
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
  explicit StepText(ByteSink& sink) : sink_(sink), buffer_(buffer_size) {}
  StepText(const StepText&) = delete;
  StepText& operator=(const StepText&) = delete;

  /// `keyword(arguments)` as the next entity.
  template <typename... Arguments>
  StepId entity(std::string_view keyword, const Arguments&... arguments) {
    begin_entity();
    part(keyword, arguments...);
    return end_entity();
  }

  // A complex entity is written part by part between begin_complex() and end_complex().
  void begin_complex() {
    begin_entity();
    put("(");
  }
  template <typename... Arguments>
  void part(std::string_view keyword, const Arguments&... arguments) {
    put(keyword);
    put("(");
    std::string_view separator;
    ((put(std::exchange(separator, ",")), argument(arguments)), ...);
    put(")");
  }
  StepId end_complex() {
    put(")");
    return end_entity();
  }

  /// Anything outside the data section.
  void raw(std::string_view text) { put(text); }

  /// Everything is in the sink when this returns.
  void flush();
  [[nodiscard]] std::uint64_t bytes() const { return flushed_ + used_; }
  [[nodiscard]] std::uint64_t entities() const { return last_; }
  [[nodiscard]] bool ok() const { return ok_; }

 private:
  static constexpr std::size_t buffer_size = std::size_t{1} << 20;
  static constexpr std::size_t longest_number = 32;

  void hand_over();
  void await();
  void begin_entity() {
    put("#");
    integer(++last_);
    put("=");
  }
  StepId end_entity() {
    put(";\n");
    return last_;
  }
  void put(std::string_view text) {
    if (text.size() > buffer_size - used_) return put_slowly(text);
    std::memcpy(buffer_.data() + used_, text.data(), text.size());
    used_ += text.size();
  }
  void put_slowly(std::string_view text);
  void integer(std::uint64_t value) {
    if (buffer_size - used_ < longest_number) hand_over();
    char* const begin = buffer_.data() + used_;
    used_ += static_cast<std::size_t>(std::to_chars(begin, begin + longest_number, value).ptr - begin);
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

  ByteSink& sink_;
  std::vector<char> buffer_, written_;  ///< the second belongs to the thread while it runs
  std::size_t used_ = 0;
  std::uint64_t flushed_ = 0;
  StepId last_ = 0;
  bool ok_ = true;
  std::future<bool> writing_;
};

}  // namespace meso::step
