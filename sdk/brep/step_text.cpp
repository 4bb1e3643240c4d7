// SPDX-License-Identifier: Apache-2.0
#include "meso/brep/step_text.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

namespace meso::brep {

std::size_t behind_string_or_comment(std::string_view step, std::size_t at) {
  const auto behind = [&](std::string_view close, std::size_t from) {
    const std::size_t end = step.find(close, from);
    return end == std::string_view::npos ? step.size() : end + close.size();
  };
  if (step[at] == '\'') return behind("'", at + 1);  // a doubled apostrophe begins the next string at once
  return step.substr(at, 2) == "/*" ? behind("*/", at + 2) : at;
}

bool has_bad_number(std::string_view step) {
  const auto is_word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
  for (std::size_t i = 0; i + 3 < step.size(); ++i) {
    if (const std::size_t behind = behind_string_or_comment(step, i); behind != i) {
      i = behind - 1;
      continue;
    }
    if (is_word(step[i]) || !is_word(step[i + 1])) continue;
    std::string word;
    for (std::size_t k = i + 1; k < step.size() && is_word(step[k]) && word.size() < 9; ++k)
      word += static_cast<char>(std::tolower(static_cast<unsigned char>(step[k])));
    if (word == "nan" || word == "inf" || word == "infinity") return true;
  }
  return false;
}

std::optional<std::string> reference_fault(std::string_view step) {
  // Which entity refers to which: `#12 = NAME('text', #3, (#4, #5));`.
  std::unordered_map<std::uint64_t, std::size_t> place_of;
  std::vector<std::vector<std::uint64_t>> references;
  bool is_begin = true;
  for (std::size_t i = 0; i < step.size(); ++i) {
    if (const std::size_t behind = behind_string_or_comment(step, i); behind != i) {
      i = behind - 1;
      continue;
    }
    const char c = step[i];
    if (c == ';') is_begin = true;
    if (c != '#') continue;
    std::uint64_t id = 0;
    const auto [end, error] = std::from_chars(step.data() + i + 1, step.data() + step.size(), id);
    if (error != std::errc()) continue;
    i = static_cast<std::size_t>(end - step.data()) - 1;
    if (is_begin) {
      if (!place_of.emplace(id, references.size()).second) return "it has two entities #" + std::to_string(id);
      references.emplace_back();
    } else if (!references.empty()) {
      references.back().push_back(id);
    }
    is_begin = false;
  }
  // Depth first: an entity that is met while it is open closes a circle.
  enum class State : std::uint8_t { fresh, open, done };
  std::vector<State> states(references.size(), State::fresh);
  std::vector<std::pair<std::size_t, std::size_t>> path;  // entity, next of its references
  for (std::size_t root = 0; root < references.size(); ++root) {
    if (states[root] != State::fresh) continue;
    states[root] = State::open;
    path.assign(1, {root, 0});
    while (!path.empty()) {
      auto& [entity, next] = path.back();
      if (next == references[entity].size()) {
        states[entity] = State::done;
        path.pop_back();
        continue;
      }
      const std::uint64_t id = references[entity][next++];
      const auto found = place_of.find(id);
      if (found == place_of.end()) return "it has no entity #" + std::to_string(id);
      if (states[found->second] == State::done) continue;
      if (states[found->second] == State::open) return "its entities refer to each other in a circle";
      states[found->second] = State::open;
      path.emplace_back(found->second, 0);
    }
  }
  return {};
}

std::optional<std::string> step_text_fault(std::string_view step) {
  if (has_bad_number(step)) return "it has a number that is not finite";
  return reference_fault(step);
}

}  // namespace meso::brep
