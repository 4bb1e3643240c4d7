// SPDX-License-Identifier: Apache-2.0
#pragma once
// Progress on stderr: a bar on a terminal, one JSON object a line for programs, or nothing.

#include <chrono>
#include <string>
#include <string_view>

namespace meso::cli {

enum class ProgressStyle { none, bar, json };
/// "auto" is a bar on a terminal and nothing elsewhere.
[[nodiscard]] ProgressStyle progress_style(std::string_view text);

class Progress {
 public:
  explicit Progress(ProgressStyle style) : style_(style) {}
  ~Progress() { clear(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// At most ten lines a second, except for a change of stage.
  void show(std::string_view stage, double fraction);
  /// Remembers, shown or not, how far the work is. One thread only.
  void reach(std::string_view stage, double fraction);
  /// As words: "realise, 40 %"; empty before that.
  [[nodiscard]] std::string reached() const;
  /// Takes the bar away so that text can be written.
  void clear();

 private:
  ProgressStyle style_;
  std::string reached_stage_;
  double reached_ = 0;  ///< of that stage
  std::string stage_;   ///< shown
  bool visible_ = false;
  std::chrono::steady_clock::time_point last_{};
};

}  // namespace meso::cli
