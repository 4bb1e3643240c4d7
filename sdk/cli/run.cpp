// SPDX-License-Identifier: Apache-2.0
#include "run.hpp"

#include <fmt/core.h>
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>

#include "meso/base/help.hpp"
#include "meso/base/memory_outlook.hpp"
#include "meso/base/number.hpp"
#include "meso/expr/expression.hpp"
#include "meso/package/open_document.hpp"
#include "stop.hpp"
#include "wall.hpp"

namespace meso::cli {
namespace {

void limit_memory(std::uint64_t bytes, const std::string& text) {
  end_beyond(bytes, text);
  // Where memory is taken faster than that is noticed. Private writable memory: address space (RLIMIT_AS) would count
  // mapped files and reserved arenas.
  const std::uint64_t most = bytes + bytes / 4 + (std::uint64_t{64} << 20);
  const rlimit limit{most, most};
  setrlimit(RLIMIT_DATA, &limit);
}

Json span_json(const Diagnostic& d) {
  Json out;
  out["code"] = info(d.code).name;
  out["number"] = info(d.code).number;
  out["severity"] = severity(d) == Severity::error ? "error" : severity(d) == Severity::warning ? "warning" : "info";
  out["file"] = d.where.file;
  out["line"] = d.where.line;
  out["column"] = d.where.column;
  out["offset"] = d.where.offset;
  out["length"] = d.where.length;
  out["path"] = d.path;
  out["args"] = d.args;
  out["message"] = message(d);
  out["help"] = help(d.code);
  return out;
}

}  // namespace

void add_set_flag(CLI::App& verb, Flags& flags) {
  verb.add_option("--set", flags.set, "Override a document parameter, e.g. --set pitch=8mm (repeatable)")
      ->type_name("ID=EXPR")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}
void add_part_flag(CLI::App& verb, Flags& flags) {
  verb.add_option("--part", flags.part, "Make this part instead of the document's build")->type_name("ID");
}
void add_json_flag(CLI::App& verb, Flags& flags) {
  verb.add_flag("--json", flags.json, "One JSON object on standard output");
}
void add_no_clobber_flag(CLI::App& verb, Flags& flags) {
  verb.add_flag("--no-clobber", flags.no_clobber, "Refuse to replace an existing output");
}
void add_engine_flag(CLI::App& verb, Flags& flags) {
  verb.add_option("--engine", flags.engine, "auto, brep or implicit")
      ->type_name("NAME")
      ->check(CLI::IsMember({"auto", "brep", "implicit"}));
}
void add_mesh_flags(CLI::App& verb, Flags& flags) {
  verb.add_option("--deflection", flags.deflection, "Largest distance of triangles from the surface, e.g. 0.1mm")
      ->type_name("LEN");
  verb.add_option("--angle", flags.angle, "Largest angle between neighbouring triangles, e.g. 0.5rad or 20deg")
      ->type_name("ANG");
}
void add_memory_flag(CLI::App& verb, Flags& flags) {
  verb.add_option("--max-memory", flags.max_memory, "Give up beyond this much memory, e.g. 2G")->type_name("SIZE");
}
void add_work_flags(CLI::App& verb, Flags& flags) {
  verb.add_option("--jobs", flags.jobs, "Threads; 0 is one per core. Output bytes do not depend on it")->type_name("N");
  verb.add_option("--timeout", flags.timeout, "Give up after this many seconds")
      ->type_name("S")
      ->check([](const std::string& text) -> std::string {
        const auto seconds = parse_number(text);
        return seconds && *seconds > 0 && *seconds <= 1e9 ? "" : "'" + text + "' is not a number of seconds up to 1e9";
      });
  add_memory_flag(verb, flags);
  verb.add_option("--progress", flags.progress, "auto, bar, json or none")
      ->type_name("STYLE")
      ->check(CLI::IsMember({"auto", "bar", "json", "none"}));
}
void add_limit_flags(CLI::App& verb, Flags& flags) {
  add_work_flags(verb, flags);
  verb.add_option("--max-cells", flags.max_cells, "Refuse patterns with more cells (10000000)")->type_name("N");
}

RunOptions Run::options() {
  if (flags.json) answer_stop_in_json();
  RunOptions out;
  out.jobs = flags.jobs;
  out.max_cells = flags.max_cells;
  if (flags.timeout > 0) {
    out.deadline = std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                                          std::chrono::duration<double>(flags.timeout));
    end_after(flags.timeout);
  }
  if (!flags.max_memory.empty()) {
    if (const auto bytes = parse_size(flags.max_memory)) {
      out.max_memory_bytes = *bytes;
      limit_memory(*bytes, flags.max_memory);
    } else {
      usage_error("--max-memory: '" + flags.max_memory + "' is not a size such as 512M or 2G");
    }
  }
  out.cancelled = stop_requested;
  progress_.emplace(progress_style(flags.progress));
  out.progress = [this](std::string_view stage, double fraction) {
    // A warning helps most before the minutes that it is about; other threads may be told of progress while this one
    // adds to the sink.
    if (std::this_thread::get_id() == owner_) {
      print_diagnostics(Told::what_is_no_error);
      progress_->reach(stage, fraction);
    }
    progress_->show(stage, fraction);
  };
  options_ = out;
  return out;
}

void Run::refuse_without_effect(std::initializer_list<GivenFlag> all, const char* where_it_has_one) {
  for (const GivenFlag& flag : all) {
    if (flag.given) usage_error(std::string(flag.name) + " has an effect " + where_it_has_one + " only");
  }
}

std::optional<CheckedDocument> Run::open(const std::string& file) {
  return open_checked_document(file, options_.value_or(RunOptions{}), sink);
}

/// What is for information alone wants none, but for what makes minutes out of seconds.
static bool wants_help(const Diagnostic& d) {
  return severity(d) != Severity::info || d.code == Code::geometry_not_repeatable ||
         d.code == Code::geometry_struts_meet || d.code == Code::geometry_long_boolean;
}

void Run::print_diagnostics(Told what) {
  const auto& all = sink.diagnostics();
  const bool is_over = what == Told::all;
  const auto may_be_told = [&](const Diagnostic& d) { return is_over || severity(d) != Severity::error; };
  if (progress_ && (is_over || (printed_ < all.size() && may_be_told(all[printed_])))) progress_->clear();
  for (; printed_ < all.size() && may_be_told(all[printed_]); ++printed_) {
    const Diagnostic& d = all[printed_];
    fmt::print(stderr, "{}\n", render(d));
    if ((d.code == Code::cancelled || d.code == Code::limit_time) && progress_ && !progress_->reached().empty())
      fmt::print(stderr, "  the work was at: {}\n", progress_->reached());
    if (wants_help(d) && helped_.insert(d.code).second) fmt::print(stderr, "  help: {}\n", help(d.code));
  }
  if (is_over && sink.truncated()) fmt::print(stderr, "... and more: {} errors in all\n", sink.error_count());
}

const Diagnostic* Run::first_error() const {
  const auto& all = sink.diagnostics();
  const auto first =
      std::find_if(all.begin(), all.end(), [](const Diagnostic& d) { return severity(d) == Severity::error; });
  return first == all.end() ? nullptr : &*first;
}

int Run::finish() {
  (void)claim_answer();
  explain_stop();
  print_diagnostics(Told::all);
  const Diagnostic* error = first_error();
  return error == nullptr ? 0 : info(error->code).exit_code;
}

/// What was told after memory ran out, is its consequence.
void Run::explain_stop() {
  if (!memory_ran_out() || first_error() == nullptr) return;
  sink = DiagnosticSink();
  printed_ = 0;
  sink.report(memory_ended(flags.max_memory));
}

int Run::finish(Json report) {
  const bool is_first = claim_answer();
  explain_stop();
  if (const Diagnostic* error = first_error()) report["error"] = error_json(*error);
  report["diagnostics"] = diagnostics_json(sink);
  const int code = finish();
  if (flags.json && is_first) {
    fmt::print("{}\n", report.dump(2, ' ', false, Json::error_handler_t::replace));
    std::fflush(stdout);
    tell_wall_answered();
  }
  return code;
}

namespace {

std::optional<double> constant(const std::string& text, LengthUnit unit) {
  const auto parsed = expr::parse_expression(text, unit);
  if (!parsed.expression || !parsed.expression->is_constant()) return std::nullopt;
  const auto value = expr::evaluate(*parsed.expression, {});
  return value ? std::optional(value.value) : std::nullopt;
}

}  // namespace

std::optional<double> Run::value_mm(const std::string& text) { return constant(text, LengthUnit::millimeter); }

std::optional<double> Run::positive_value(const std::string& text, LengthUnit unit, const char* flag) {
  const auto value = constant(text, unit);
  if (value && *value > 0) return value;
  const bool is_angle = std::string_view(flag) == "--angle";
  usage_error(std::string(flag) + ": '" + text +
              (is_angle ? "' is not a positive angle such as 0.5rad; its units are deg and rad"
                        : "' is not a positive length such as 0.1mm; its units are um, mm, cm, m, in and ft"));
  return std::nullopt;
}

static bool ends_in_one_of(std::string_view text, std::initializer_list<std::string_view> units) {
  return std::ranges::any_of(units, [&](std::string_view unit) { return text.ends_with(unit); });
}

std::optional<double> Run::length_mm(const std::string& text, LengthUnit unit, const char* flag) {
  if (ends_in_one_of(text, {"deg", "rad"})) {
    usage_error(std::string(flag) + ": '" + text + "' is an angle, and a length such as 0.2mm is asked for");
    return std::nullopt;
  }
  const auto value = positive_value(text, unit, flag);
  return value ? std::optional(*value * millimeters_per(unit)) : std::nullopt;
}

std::optional<double> Run::angle_rad(const std::string& text, const char* flag) {
  if (ends_in_one_of(text, {"um", "mm", "cm", "m", "in", "ft"})) {
    usage_error(std::string(flag) + ": '" + text + "' is a length, and an angle such as 20deg is asked for");
    return std::nullopt;
  }
  return positive_value(text, LengthUnit::millimeter, flag);
}

Diagnostic memory_ended(const std::string& budget) {
  if (budget.empty()) return {.code = Code::limit_memory, .args = {"this machine's memory"}};
  return foreseen_memory().value_or(Diagnostic{.code = Code::limit_memory, .args = {budget}});
}

Json diagnostics_json(const DiagnosticSink& sink) {
  Json out = Json::array();
  for (const Diagnostic& d : sink.diagnostics()) out.push_back(span_json(d));
  return out;
}

Json error_json(const Diagnostic& error) {
  Json out;
  out["code"] = info(error.code).name;
  out["number"] = info(error.code).number;
  out["exitCode"] = info(error.code).exit_code;
  out["message"] = message(error);
  return out;
}

std::uint64_t peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

std::optional<std::uint64_t> parse_size(std::string_view text) {
  const std::size_t digits = text.find_first_not_of("0123456789.");
  const auto number = parse_number(text.substr(0, digits));
  if (!number || *number <= 0) return std::nullopt;
  const std::string_view suffix = digits == std::string_view::npos ? "" : text.substr(digits);
  static constexpr std::string_view prefixes = "KMGT";
  if (suffix.empty() || suffix == "B") {
    return *number < 9e18 ? std::optional(static_cast<std::uint64_t>(*number)) : std::nullopt;
  }
  const std::size_t power = prefixes.find(suffix[0]);
  const std::string_view rest = suffix.substr(1);
  if (power == std::string_view::npos || (!rest.empty() && rest != "B" && rest != "iB")) return std::nullopt;
  const double bytes = std::ldexp(*number, static_cast<int>(10 * (power + 1)));
  return bytes < 9e18 ? std::optional(static_cast<std::uint64_t>(bytes)) : std::nullopt;
}

}  // namespace meso::cli
