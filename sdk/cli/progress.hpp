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
  /// Takes the bar away so that text can be written.
  void clear();

 private:
  ProgressStyle style_;
  std::string stage_;
  bool visible_ = false;
  std::chrono::steady_clock::time_point last_{};
};

}  // namespace meso::cli
