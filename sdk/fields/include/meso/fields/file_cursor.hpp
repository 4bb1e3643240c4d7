// SPDX-License-Identifier: Apache-2.0
#pragma once
// Walks through the bytes of a field file: words, lines, numbers, binary blocks; and says where it is wrong.
//
//   FileCursor in(bytes, "stress.vtk", run, sink);
//   double x = 0;
//   if (!in.number(x)) return std::nullopt;   // FIELD_FILE_SYNTAX or FIELD_FILE_TRUNCATED was reported, with the line
//
// Numbers have a decimal point, in any locale. A walk that is asked to stop, or told to hold more than the budget,
// reports that once, stands at the end of the file and says nothing more. Views stay valid as long as the bytes.
// Values; one thread.

#include <cstdint>
#include <string>
#include <string_view>

#include "meso/base/diagnostic.hpp"
#include "meso/base/run_options.hpp"

namespace meso::fields {

class FileCursor {
 public:
  FileCursor(std::string_view bytes, std::string file, const RunOptions& run, DiagnosticSink& sink)
      : bytes_(bytes), file_(std::move(file)), run_(run), sink_(sink) {}

  [[nodiscard]] bool at_end() const { return at_ >= bytes_.size(); }
  [[nodiscard]] std::size_t position() const { return at_; }
  void move_to(std::size_t position) { at_ = position; }

  /// The rest of this line, without its end; empty at the end of the file.
  std::string_view line();
  /// The next word behind white space; empty at the end of the file.
  std::string_view word();
  /// The next word without moving.
  [[nodiscard]] std::string_view peek() const;
  /// Exactly so many bytes; reports and gives an empty view if there are fewer.
  std::string_view block(std::uint64_t size, std::string_view what);

  /// Looks at the clock now, before something long; the walk itself does so every 65536 words or lines.
  [[nodiscard]] bool is_stopped();
  /// Says that so much more memory will be needed than before; LIMIT_MEMORY and false beyond the budget.
  [[nodiscard]] bool takes(std::uint64_t bytes);
  void gives_back(std::uint64_t bytes) { held_ -= bytes; }

  [[nodiscard]] bool number(double& value);
  [[nodiscard]] bool integer(std::int64_t& value);
  /// An integer from 0 to `largest`.
  [[nodiscard]] bool count(std::int64_t& value, std::int64_t largest = std::int64_t{1} << 40);

  /// Reports that something else was expected where the last word or line began. Returns false.
  bool expected(std::string what);
  bool unsupported(std::string what);
  bool empty(std::string what);
  /// The warning FIELD_LEFT_OUT: the file has this too.
  void left_out(std::string what);

 private:
  void skip_space();
  void poll();
  void stop(Diagnostic reason);
  [[nodiscard]] SourceSpan here() const;

  std::string_view bytes_;
  std::string file_;
  const RunOptions& run_;
  DiagnosticSink& sink_;
  std::size_t at_ = 0, last_ = 0;
  std::uint64_t steps_ = 0, held_ = 0;
  bool is_stopped_ = false;
};

/// A number in whole; with blanks around it. nan and inf are numbers.
[[nodiscard]] bool parse_field_number(std::string_view text, double& value);
[[nodiscard]] bool parse_field_integer(std::string_view text, std::int64_t& value);

}  // namespace meso::fields
