// SPDX-License-Identifier: Apache-2.0
#include "progress.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace meso::cli {

ProgressStyle progress_style(std::string_view text) {
  if (text == "bar") return ProgressStyle::bar;
  if (text == "json") return ProgressStyle::json;
  if (text == "auto" && ::isatty(STDERR_FILENO) != 0) return ProgressStyle::bar;
  return ProgressStyle::none;
}

void Progress::show(std::string_view stage, double fraction) {
  if (style_ == ProgressStyle::none) return;
  const auto now = std::chrono::steady_clock::now();
  if (stage == stage_ && now - last_ < std::chrono::milliseconds(100)) return;
  stage_ = stage;
  last_ = now;
  const double part = std::clamp(fraction, 0.0, 1.0);
  if (style_ == ProgressStyle::json) {
    fmt::print(stderr, "{{\"stage\":\"{}\",\"fraction\":{:.3f}}}\n", stage, part);
  } else {
    const auto filled = static_cast<std::size_t>(part * 30);
    fmt::print(stderr, "\r\033[K{:<10} [{:<30}] {:3.0f} %", stage, std::string(filled, '#'), part * 100);
    visible_ = true;
  }
  std::fflush(stderr);
}

void Progress::reach(std::string_view stage, double fraction) {
  reached_stage_ = stage;
  reached_ = std::clamp(fraction, 0.0, 1.0);
}

std::string Progress::reached() const {
  return reached_stage_.empty() ? "" : fmt::format("{}, {:.0f} %", reached_stage_, 100 * reached_);
}

void Progress::clear() {
  if (!visible_) return;
  fmt::print(stderr, "\r\033[K");
  visible_ = false;
}

}  // namespace meso::cli
