// SPDX-License-Identifier: Apache-2.0
#pragma once
// What every verb shares: its flags, the diagnostics it collects, and how it ends.

#include <functional>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "meso/base/diagnostic.hpp"
#include "meso/base/output_file.hpp"
#include "meso/base/run_options.hpp"
#include "meso/model/checked_document.hpp"
#include "progress.hpp"

namespace CLI {
class App;
}

namespace meso::cli {

using Json = nlohmann::ordered_json;

/// The one table of flags (docs/command.md). A verb offers only the flags that have an effect there; others are usage
/// errors.
struct Flags {
  std::vector<std::string> set;
  std::string part;
  std::string engine = "auto";
  std::string deflection, angle;
  unsigned jobs = 0;
  double timeout = 0;
  std::string max_memory;
  std::uint64_t max_cells = 10'000'000;
  bool json = false;
  std::string progress = "auto";
  bool no_clobber = false;
};

void add_set_flag(CLI::App& verb, Flags& flags);
void add_part_flag(CLI::App& verb, Flags& flags);
void add_json_flag(CLI::App& verb, Flags& flags);
void add_no_clobber_flag(CLI::App& verb, Flags& flags);
void add_engine_flag(CLI::App& verb, Flags& flags);
void add_mesh_flags(CLI::App& verb, Flags& flags);   ///< --deflection --angle
void add_work_flags(CLI::App& verb, Flags& flags);   ///< --jobs --timeout --max-memory --progress
void add_memory_flag(CLI::App& verb, Flags& flags);  ///< --max-memory alone
void add_limit_flags(CLI::App& verb, Flags& flags);  ///< these and --max-cells

/// One call of one verb.
class Run {
 public:
  Flags flags;
  DiagnosticSink sink;
  std::function<int()> action;  ///< set by the verb that was called

  /// Budgets, progress and cancellation out of the flags; to be called once, at the verb's start.
  [[nodiscard]] RunOptions options();
  [[nodiscard]] ExistingFile existing_file() const {
    return flags.no_clobber ? ExistingFile::refuse : ExistingFile::replace;
  }
  void usage_error(std::string text) { sink.report({.code = Code::usage, .args = {std::move(text)}}); }
  /// A flag that was given and changes nothing in this call is a usage error.
  struct GivenFlag {
    const char* name;
    bool given;
  };
  void refuse_without_effect(std::initializer_list<GivenFlag> all, const char* where_it_has_one);
  [[nodiscard]] std::optional<CheckedDocument> open(const std::string& file);
  /// Prints what was collected to stderr and returns the exit code of the first error, else 0.
  int finish();
  /// The same with `report` (one object; "error" if there is one, and "diagnostics" are added) on stdout if --json was
  /// given.
  int finish(Json report);
  /// A length or angle of the command line such as 0.1mm or 20deg: millimetres or radians. Reports a usage error and
  /// gives nothing if it is none.
  [[nodiscard]] std::optional<double> length_mm(const std::string& text, LengthUnit unit, const char* flag);
  /// Any length, also negative, without a report.
  [[nodiscard]] static std::optional<double> value_mm(const std::string& text);
  [[nodiscard]] std::optional<double> angle_rad(const std::string& text, const char* flag);

 private:
  /// While work goes on, an error is kept: what it comes from may be known at the end.
  enum class Told { what_is_no_error, all };
  [[nodiscard]] const Diagnostic* first_error() const;
  void print_diagnostics(Told what);
  void explain_stop();
  [[nodiscard]] std::optional<double> positive_value(const std::string& text, LengthUnit unit, const char* flag);
  std::optional<Progress> progress_;
  std::size_t printed_ = 0;  ///< of the sink's diagnostics
  std::set<Code> helped_;    ///< whose help is printed
  std::thread::id owner_ = std::this_thread::get_id();
  std::optional<RunOptions> options_;
};

/// Why a run ended that took more than `budget` (--max-memory; empty: none was given), with what it would take where
/// that is known.
[[nodiscard]] Diagnostic memory_ended(const std::string& budget);
[[nodiscard]] Json diagnostics_json(const DiagnosticSink& sink);
/// Why a run has no result: code, number, exit code, message.
[[nodiscard]] Json error_json(const Diagnostic& error);
[[nodiscard]] std::uint64_t peak_memory_bytes();
/// "512M", "2G", "1.5GiB" in bytes.
[[nodiscard]] std::optional<std::uint64_t> parse_size(std::string_view text);

// Each verb stands in a file of its own and registers itself with these.
void add_validate(CLI::App& app, Run& run);
void add_canonical(CLI::App& app, Run& run);
void add_package(CLI::App& app, Run& run);
void add_formats(CLI::App& app, Run& run);
void add_info(CLI::App& app, Run& run);
void add_eval(CLI::App& app, Run& run);
void add_field(CLI::App& app, Run& run);
void add_convert(CLI::App& app, Run& run);
void add_compare(CLI::App& app, Run& run);
void add_verify(CLI::App& app, Run& run);
void add_render(CLI::App& app, Run& run);
void add_sdf(CLI::App& app);  ///< for the list of verbs only
int sdf_verb(Run& run, const std::vector<std::string>& words);

}  // namespace meso::cli
