// SPDX-License-Identifier: Apache-2.0
#include "mesh_grid.hpp"

#include <algorithm>
#include <cmath>

#include "meso/base/number.hpp"
#include "meso/base/unit.hpp"
#include "meso/expr/expression.hpp"

namespace meso::operations {
namespace {

using implicit::Grid;

const MeshSettings* settings_of(const Document& document, const std::string& part) {
  for (const BuildItem& item : document.build)
    if (item.mesh && (part.empty() || item.part.text == part)) return &*item.mesh;
  return nullptr;
}

/// Values of <mesh>, reported where they cannot be.
class Reader {
 public:
  Reader(const eval::Evaluation& evaluation, const MeshSettings& settings, DiagnosticSink& sink)
      : evaluation_(evaluation), settings_(settings), sink_(sink) {}

  [[nodiscard]] bool ok() const { return ok_; }

  void length(const std::optional<Expression>& expression, std::string_view attribute, double& mm) {
    if (!expression) return;
    const auto value = evaluation_.value(*expression, settings_.id_in_source, attribute, sink_);
    if (value) mm = *value * millimeters_per(evaluation_.document().unit);
    ok_ = ok_ && value;
  }
  std::vector<double> samples() {
    std::vector<double> result;
    for (const expr::ListItem& item : expr::split_list(settings_.samples->text)) {
      const auto value =
          evaluation_.value(Expression{std::string(item.text)}, settings_.id_in_source, "samples", sink_);
      ok_ = ok_ && value;
      result.push_back(value.value_or(0));
    }
    return result;
  }

 private:
  const eval::Evaluation& evaluation_;
  const MeshSettings& settings_;
  DiagnosticSink& sink_;
  bool ok_ = true;
};

std::int32_t nodes_at(double length, double spacing) {
  // A length that the spacing divides, up to rounding, is divided so.
  const double cells = std::ceil(length / spacing - 1e-6);
  return static_cast<std::int32_t>(std::clamp(cells + 1, 2.0, 2e9));
}

Grid with_spacing(const Box3& box, double spacing) {
  Grid grid{.box = box};
  for (std::size_t a = 0; a < 3; ++a) grid.nodes[a] = nodes_at(box.max[a] - box.min[a], spacing);
  return grid;
}

Grid with_samples(const Box3& box, const std::vector<double>& samples) {
  Grid grid{.box = box};
  if (samples.size() == 1) {
    grid.nodes = implicit::nodes_for_total(box, samples[0]);
  } else {
    for (std::size_t a = 0; a < 3; ++a)
      grid.nodes[a] = static_cast<std::int32_t>(std::clamp(std::round(samples[a]), 2.0, 2e9));
  }
  return grid;
}

double spacing_of(double smallest_feature_mm, const Box3& box) {
  const Vec3 size = box.max - box.min;
  // A part without a feature of its own, such as an import, is looked at in a hundred steps along its longest side.
  const double wanted = std::isfinite(smallest_feature_mm) ? smallest_feature_mm / features_per_sample
                                                           : std::max({size.x, size.y, size.z}) / 100;
  return std::max(wanted, std::cbrt(size.x * size.y * size.z / most_default_samples));
}

}  // namespace

std::vector<PlacedPart> built_parts(const eval::Evaluation& evaluation, const std::string& part_id,
                                    DiagnosticSink& sink) {
  const Document& document = evaluation.document();
  std::vector<PlacedPart> result;
  const auto list = [&] {
    std::string ids;
    for (const Part& part : document.parts) ids += (ids.empty() ? "" : ", ") + part.id.text;
    return ids;
  };
  if (!part_id.empty()) {
    const Part* part = evaluation.find_part(part_id);
    if (part == nullptr)
      sink.report({.code = Code::usage, .args = {"--part: there is no part '" + part_id + "'; parts: " + list()}});
    else
      result.push_back({part, {}});
    return result;
  }
  for (const BuildItem& item : document.build) result.push_back({evaluation.find_part(item.part.text), item.placement});
  if (!result.empty()) return result;
  if (document.parts.items.size() == 1)
    result.push_back({&document.parts.items.front(), {}});
  else
    sink.report({.code = Code::usage,
                 .args = {document.parts.items.empty()
                              ? std::string("the document has no part to make")
                              : "the document has no build and several parts; name one with --part: " + list()}});
  return result;
}

std::optional<Grid> mesh_grid(const eval::Evaluation& evaluation, const MakeOptions& options, const Box3& bounds,
                              double smallest_feature_mm, DiagnosticSink& sink) {
  Box3 box = bounds;
  std::vector<double> samples = options.samples;
  if (const MeshSettings* stated = settings_of(evaluation.document(), options.part)) {
    Reader read(evaluation, *stated, sink);
    Vec3 corner = box.min, size = box.max - box.min;
    read.length(stated->x, "x", corner.x), read.length(stated->y, "y", corner.y), read.length(stated->z, "z", corner.z);
    read.length(stated->dx, "dx", size.x), read.length(stated->dy, "dy", size.y), read.length(stated->dz, "dz", size.z);
    if (samples.empty() && !options.spacing_mm && stated->samples) samples = read.samples();
    if (!read.ok()) return std::nullopt;
    box = {corner, corner + size};
  }
  const Grid grid = !samples.empty()     ? with_samples(box, samples)
                    : options.spacing_mm ? with_spacing(box, *options.spacing_mm)
                                         : with_spacing(box, spacing_of(smallest_feature_mm, box));
  const double spacing = std::max({grid.spacing(0), grid.spacing(1), grid.spacing(2)});
  if (smallest_feature_mm < 2 * spacing) {
    const auto parts = built_parts(evaluation, options.part, sink);
    sink.report({.code = Code::feature_below_spacing,
                 .args = {parts.empty() ? "" : parts.front().part->id.text, format_number(smallest_feature_mm),
                          format_number(spacing)}});
  }
  return grid;
}

void pass_on_of_grid(const DiagnosticSink& told, const eval::Evaluation& evaluation, const MakeOptions& options,
                     DiagnosticSink& sink) {
  const MeshSettings* stated = settings_of(evaluation.document(), options.part);
  const SourceMap& source = evaluation.checked().source();
  const bool by_document = stated != nullptr && stated->samples && options.samples.empty() && !options.spacing_mm;
  for (Diagnostic d : told.diagnostics()) {
    if ((d.code == Code::limit_grid || d.code == Code::limit_grid_memory) && d.where.file.empty()) {
      if (by_document)
        d.where = source.span(stated->id_in_source, "samples"), d.path = source.path(stated->id_in_source, "samples");
      else
        d.where.file = source.span(evaluation.document().id_in_source).file;
    }
    sink.report(std::move(d));
  }
}

bool states_samples(const Document& document, const std::string& part_id) {
  const MeshSettings* stated = settings_of(document, part_id);
  return stated != nullptr && stated->samples;
}

}  // namespace meso::operations
