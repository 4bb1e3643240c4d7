// SPDX-License-Identifier: Apache-2.0
#pragma once
// A shape as a field. Private.

#include <functional>
#include <map>
#include <optional>

#include "meso/eval/shape.hpp"
#include "meso/implicit/document_field.hpp"

namespace meso::implicit {

/// Joined, also where the two only touch.
[[nodiscard]] Field joined(const Field& a, const Field& b);
/// A field without an inside.
[[nodiscard]] Field nothing();

/// Reports with the place of a document's element.
class Reporter {
 public:
  Reporter(const eval::Evaluation& evaluation, DiagnosticSink& sink) : evaluation_(evaluation), sink_(sink) {}
  void operator()(Code code, ElementId where, std::vector<std::string> args, std::string_view attribute = {}) const;
  [[nodiscard]] DiagnosticSink& sink() const { return sink_; }

 private:
  const eval::Evaluation& evaluation_;
  DiagnosticSink& sink_;
};

/// Makes fields of shapes; files are read once.
class ShapeFields {
 public:
  using PartMaker = std::function<std::optional<Field>(const Part&)>;

  ShapeFields(const Reporter& report, const DocumentFieldOptions& options, PartMaker make_part)
      : report_(report), options_(options), make_part_(std::move(make_part)) {}

  /// Nothing if something was reported. REQUIRES: no beams and no implicit body, which belong to patterns.
  [[nodiscard]] std::optional<Field> make(const eval::Shape& shape);
  /// The smallest length that a shape was seen to have.
  [[nodiscard]] double smallest_feature_mm() const { return smallest_; }

 private:
  struct Maker;
  void see(double feature) { smallest_ = std::fmin(smallest_, feature); }
  [[nodiscard]] std::optional<Field> import(const eval::ImportShape& shape);

  const Reporter& report_;
  const DocumentFieldOptions& options_;
  PartMaker make_part_;
  std::map<std::filesystem::path, std::optional<Field>> imports_;
  double smallest_ = HUGE_VAL;
};

}  // namespace meso::implicit
