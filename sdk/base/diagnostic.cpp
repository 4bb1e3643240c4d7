// SPDX-License-Identifier: Apache-2.0
#include "meso/base/diagnostic.hpp"

#include <utility>

namespace meso {

std::string message(const Diagnostic& d) {
  const std::string_view text = info(d.code).message;
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool placeholder = text[i] == '{' && i + 2 < text.size() && text[i + 2] == '}';
    if (!placeholder) {
      out += text[i];
      continue;
    }
    const auto arg = static_cast<std::size_t>(text[i + 1] - '0');
    out += arg < d.args.size() ? d.args[arg] : "?";
    i += 2;
  }
  return out;
}

std::string render(const Diagnostic& d) {
  static constexpr std::string_view severity_names[] = {"error", "warning", "info"};
  const auto place = [](const SourceSpan& s) {
    std::string out = s.file;
    if (s.line > 0) out += (out.empty() ? "" : ":") + std::to_string(s.line) + ":" + std::to_string(s.column);
    return out;
  };
  std::string out = place(d.where);
  if (d.where.line == 0 && !d.path.empty()) out += (out.empty() ? "" : ": ") + d.path;
  if (!out.empty()) out += ": ";
  out += severity_names[static_cast<std::size_t>(severity(d))];
  out += ' ';
  out += info(d.code).name;
  out += ": ";
  out += message(d);
  for (const Related& r : d.related) {
    const std::string where = place(r.where);
    out += "\n  " + (where.empty() ? "" : where + ": ") + r.note;
  }
  return out;
}

void DiagnosticSink::report(Diagnostic d) {
  if (severity(d) == Severity::error) ++errors_;
  if (diagnostics_.size() >= max_) {
    truncated_ = true;
    return;
  }
  diagnostics_.push_back(std::move(d));
}

}  // namespace meso
