// SPDX-License-Identifier: Apache-2.0
#include "meso/worker/worker.hpp"

#include <sys/wait.h>

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>

#include "child.hpp"
#include "meso/base/number.hpp"

namespace meso::worker {
namespace {

using Json = nlohmann::json;
using Clock = std::chrono::steady_clock;

// The command gives up by itself, and says so; we wait a little longer.
constexpr std::chrono::seconds to_give_up(2);

std::vector<std::string> with_limits(std::vector<std::string> words, const Options& options) {
  words.insert(words.begin(), options.command);
  for (const auto& [flag, value] : {std::pair{"--jobs", std::uint64_t{options.run.jobs}},
                                    {"--max-cells", options.run.max_cells},
                                    {"--max-memory", options.run.max_memory_bytes}}) {
    words.emplace_back(flag);
    words.push_back(std::to_string(value));
  }
  if (options.run.deadline) {
    constexpr double least = 0.001;
    const std::chrono::duration<double> left = *options.run.deadline - Clock::now();
    words.emplace_back("--timeout");
    words.push_back(format_number(std::max(least, left.count())));
  }
  words.insert(words.end(), {"--progress", "json", "--json"});
  return words;
}

/// Nothing if the text is not an object of JSON.
std::optional<Json> object_of(std::string_view text) {
  Json parsed = Json::parse(text, nullptr, false);
  return parsed.is_object() ? std::optional(std::move(parsed)) : std::nullopt;
}

/// A code that this library does not know comes from another version: its message is passed on.
Diagnostic diagnostic_of(const Json& d) {
  const auto code = static_cast<Code>(d.value("number", 0));
  if (info(code).name != d.value("code", "")) return {.code = Code::internal, .args = {d.value("message", "")}};
  return {.code = code,
          .where = {.file = d.value("file", ""),
                    .offset = d.value("offset", std::size_t{0}),
                    .length = d.value("length", std::size_t{0}),
                    .line = d.value("line", std::size_t{0}),
                    .column = d.value("column", std::size_t{0})},
          .path = d.value("path", ""),
          .args = d.value("args", std::vector<std::string>())};
}

std::string end_of(int status) {
  if (WIFSIGNALED(status)) return strsignal(WTERMSIG(status));
  return "exit code " + std::to_string(WEXITSTATUS(status)) + " without an answer";
}

Diagnostic why_no_answer(const ChildEnd& end, const Options& options) {
  if (options.run.cancelled && options.run.cancelled()) return {.code = Code::cancelled};
  if (options.run.out_of_time()) return {.code = Code::limit_time};
  return {.code = Code::geometry_crashed, .args = {end_of(end.status)}};
}

std::optional<Json> answer_of(const std::vector<std::string>& words, const Options& options, DiagnosticSink& sink) {
  const auto hear = [&](std::string_view line) {
    const auto said = object_of(line);
    if (said && said->contains("stage")) options.run.report(said->value("stage", ""), said->value("fraction", 0.0));
  };
  const auto should_stop = [&] {
    return (options.run.cancelled && options.run.cancelled()) ||
           (options.run.deadline && Clock::now() > *options.run.deadline + to_give_up);
  };
  const ChildEnd end = run_child(words, hear, should_stop);
  if (end.start_error != 0) {
    sink.report({.code = Code::worker_not_started, .args = {options.command, std::strerror(end.start_error)}});
    return std::nullopt;
  }
  auto answer = object_of(end.output);
  if (!answer) {
    sink.report(why_no_answer(end, options));
    return std::nullopt;
  }
  for (const Json& d : answer->value("diagnostics", Json::array())) sink.report(diagnostic_of(d));
  if (!answer->contains("error")) return answer;
  return std::nullopt;
}

}  // namespace

std::optional<std::string> run(std::vector<std::string> words, const Options& options, DiagnosticSink& sink) {
  try {
    const auto answer = answer_of(with_limits(std::move(words), options), options, sink);
    return answer ? std::optional(answer->dump(2, ' ', false, Json::error_handler_t::replace)) : std::nullopt;
  } catch (const Json::exception& e) {
    sink.report({.code = Code::internal, .args = {e.what()}});
    return std::nullopt;
  }
}

std::optional<Converted> convert(const std::filesystem::path& in, const std::filesystem::path& out,
                                 const std::vector<std::string>& flags, const Options& options, DiagnosticSink& sink) {
  std::vector<std::string> words{"convert", in.string(), out.string()};
  words.insert(words.end(), flags.begin(), flags.end());
  try {
    const auto answer = answer_of(with_limits(std::move(words), options), options, sink);
    if (!answer) return std::nullopt;
    const auto count = [&](const char* name) { return answer->value(name, std::uint64_t{0}); };
    return Converted{.engine = answer->value("engine", ""),
                     .way = answer->value("way", ""),
                     .solids = count("solids"),
                     .faces = count("faces"),
                     .triangles = count("triangles"),
                     .bytes = count("bytes"),
                     .peak_bytes = count("peakBytes"),
                     .volume = answer->value("volume", 0.0),
                     .area = answer->value("area", 0.0),
                     .seconds = answer->value("seconds", Json::object()).value("total", 0.0),
                     .closed = answer->value("closed", false)};
  } catch (const Json::exception& e) {
    sink.report({.code = Code::internal, .args = {e.what()}});
    return std::nullopt;
  }
}

}  // namespace meso::worker
