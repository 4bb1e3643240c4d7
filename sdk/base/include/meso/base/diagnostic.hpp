// SPDX-License-Identifier: Apache-2.0
#pragma once
// The one diagnostic type of every room. Codes, severities and message templates are declared once, in
// schema/diagnostics.json; <meso/base/codes.hpp> is generated from it at build time.
//
//   DiagnosticSink sink;
//   sink.report({.code = Code::link_unknown_id, .where = span, .path = path, .args = {"pattern", "cor", "core"}});
//   for (const Diagnostic& d : sink.diagnostics()) std::cerr << render(d) << '\n';
//
// A Diagnostic holds no prose; render() makes it. Thread rule: one sink per thread.

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "meso/base/codes.hpp"
#include "meso/base/source_span.hpp"

namespace meso {

enum class Severity { error, warning, info };

struct Related {
  SourceSpan where;
  std::string note;
  friend bool operator==(const Related&, const Related&) = default;
};

struct Diagnostic {
  Code code{};
  SourceSpan where{};
  std::string path{};               ///< XPath-like: /meso/patterns/pattern[2]/loop[1]/@count
  std::vector<std::string> args{};  ///< fill {0}, {1} ... of the code's message template
  std::vector<Related> related{};

  friend bool operator==(const Diagnostic&, const Diagnostic&) = default;
};

/// What the registry says about a code: stable upper-case name (`XML_NOT_WELL_FORMED`), number, severity, exit code of
/// the `meso` command when this is the first error, and the message template.
struct CodeInfo {
  std::string_view name;
  int number;
  Severity severity;
  int exit_code;
  std::string_view message;
};
[[nodiscard]] const CodeInfo& info(Code code);
[[nodiscard]] inline Severity severity(const Diagnostic& d) { return info(d.code).severity; }

/// The message alone, placeholders filled.
[[nodiscard]] std::string message(const Diagnostic& d);
/// `file:line:column: error CODE_NAME: message`, one line; related places follow on lines of their own.
[[nodiscard]] std::string render(const Diagnostic& d);

/// Collects diagnostics up to a limit (then sets `truncated`). Errors decide has_errors().
class DiagnosticSink {
 public:
  explicit DiagnosticSink(std::size_t max_diagnostics = 100) : max_(max_diagnostics) {}

  void report(Diagnostic d);
  [[nodiscard]] bool has_errors() const { return errors_ > 0; }
  [[nodiscard]] std::size_t error_count() const { return errors_; }
  [[nodiscard]] bool truncated() const { return truncated_; }
  [[nodiscard]] std::size_t max_diagnostics() const { return max_; }
  [[nodiscard]] const std::vector<Diagnostic>& diagnostics() const { return diagnostics_; }

 private:
  std::size_t max_;
  std::size_t errors_ = 0;
  bool truncated_ = false;
  std::vector<Diagnostic> diagnostics_;
};

}  // namespace meso
