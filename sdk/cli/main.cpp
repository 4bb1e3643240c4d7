// SPDX-License-Identifier: Apache-2.0
// The meso command: one verb per file, each a thin shell over a library call of the same name.

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <new>
#include <string_view>
#include <vector>

#include "meso/expr/nearest.hpp"
#include "run.hpp"
#include "stop.hpp"
#include "wall.hpp"

namespace {

void add_verbs(CLI::App& app, meso::cli::Run& run) {
  using namespace meso::cli;
  add_validate(app, run);
  add_info(app, run);
  add_canonical(app, run);
#ifdef MESO_CLI_PACKAGES
  add_package(app, run);
#endif
#ifdef MESO_CLI_EVAL
  add_eval(app, run);
  add_field(app, run);
#endif
#ifdef MESO_CLI_BREP
  add_convert(app, run);
  add_compare(app, run);
  add_verify(app, run);
#endif
#if defined(MESO_CLI_BREP) && defined(MESO_CLI_RENDER)
  add_render(app, run);
#endif
#ifdef MESO_CLI_IMPLICIT
  add_sdf(app);
#endif
  add_formats(app, run);
}

std::string no_such(const char* what, std::string_view word, const std::vector<std::string>& known) {
  const std::vector<std::string_view> names(known.begin(), known.end());
  const std::string_view meant = meso::expr::nearest(word, names);
  return fmt::format("there is no {} '{}'{}", what, word,
                     meant.empty() ? "" : fmt::format("; did you mean '{}'?", meant));
}

/// The verb or flag that is none, with what was meant; empty where every word is known, or is no verb's flag.
std::string misspelt(const CLI::App& app, const std::vector<std::string_view>& words) {
  if (words.size() < 2) return {};
  std::vector<std::string> verbs, flags;
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; })) {
    verbs.push_back(verb->get_name());
    if (verb->get_name() != words[1]) continue;
    for (const CLI::Option* option : verb->get_options())
      for (const std::string& name : option->get_lnames()) flags.push_back("--" + name);
  }
  if (!words[1].starts_with('-') && std::ranges::find(verbs, words[1]) == verbs.end())
    return no_such("verb", words[1], verbs);
  for (const std::string_view word : words) {
    const std::string_view flag = word.substr(0, word.find('='));
    if (flag.starts_with("--") && !flags.empty() && std::ranges::find(flags, flag) == flags.end())
      return no_such("flag", flag, flags);
  }
  return {};
}

/// The one verb whose words are not flags and files.
bool takes_words([[maybe_unused]] int argc, [[maybe_unused]] char** argv, [[maybe_unused]] meso::cli::Run& run) {
#ifdef MESO_CLI_IMPLICIT
  if (argc > 1 && std::string_view(argv[1]) == "sdf") {
    run.action = [&run, words = std::vector<std::string>(argv + 2, argv + argc)] {
      return meso::cli::sdf_verb(run, words);
    };
    return true;
  }
#endif
  return false;
}

int run_verb(meso::cli::Run& run) {
  try {
    return run.action();
  } catch (const std::bad_alloc&) {
    run.sink.report(meso::cli::memory_ended(run.flags.max_memory));
  } catch (const std::exception& e) {
    run.sink.report({.code = meso::Code::internal, .args = {e.what()}});
  }
  return run.finish(meso::cli::Json::object());
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string_view> words(argv, argv + argc);
  meso::cli::stand_behind_wall(std::ranges::find(words, "--json") != words.end());
  meso::cli::watch_stop_signals();
  CLI::App app("Meso: mesostructures as documents. Reads, validates, evaluates, realises and measures them.", "meso");
  app.set_version_flag("--version", MESO_VERSION);
  app.require_subcommand(1);
  app.failure_message(CLI::FailureMessage::simple);
  meso::cli::Run run;
  add_verbs(app, run);
  if (!takes_words(argc, argv, run)) {
    try {
      app.parse(argc, argv);
    } catch (const CLI::ParseError& e) {
      if (e.get_exit_code() == 0) return app.exit(e);  // help and version
      const std::string told = misspelt(app, words);
      run.flags.json = std::ranges::find(words, "--json") != words.end();
      run.usage_error(told.empty() ? e.what() : told);
      return run.finish(meso::cli::Json::object());
    }
  }
  const int code = run_verb(run);
  if (std::fflush(stdout) == 0 || code != 0) return code;
  fmt::print(stderr, "error WRITE_FAILED: cannot write to standard output\n");
  return 7;
}
