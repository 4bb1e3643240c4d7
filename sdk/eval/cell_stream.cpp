// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "cell_stream_impl.hpp"
#include "meso/base/number.hpp"
#include "walker.hpp"

namespace meso::eval {

std::shared_ptr<const CellStream::Impl> make_cell_stream(const std::shared_ptr<const EvaluationData>& data,
                                                         const Pattern& pattern, DiagnosticSink& sink) {
  const auto program = compile_pattern(data, pattern, sink);
  if (!program) return nullptr;
  const Report report = data->report(sink);

  Scope scope = data->scope;
  for (std::size_t p = 0; p < program->cell->parameters.size(); ++p)
    scope.define(program->cell->parameters[p].name.text, static_cast<std::uint32_t>(program->parameter_slot + p),
                 constant_level);
  auto body = BodyTable::make(*data, *program->cell, scope, report);
  if (!body) return nullptr;

  constexpr std::uint64_t largest = std::uint64_t{1} << 62;
  const std::uint64_t limit = std::min(data->run.max_cells, largest);
  Walker walker(*program, sink);
  const auto size = walker.count(limit);
  if (!size) return nullptr;
  if (*size > limit) {
    report(Code::limit_cells, {pattern.id_in_source, {}},
           {pattern.id.text, walker.is_exact() ? std::to_string(*size) : "more than " + std::to_string(limit),
            std::to_string(limit)});
    return nullptr;
  }
  auto impl = std::make_shared<CellStream::Impl>();
  impl->program = program;
  impl->body = std::move(*body);
  impl->size = *size;
  impl->frame_mm = std::make_shared<CoordinateFrame>(program->frame->scaled(data->millimeters()));
  return impl;
}

std::uint64_t CellStream::size() const { return impl_->size; }
const Pattern& CellStream::pattern() const { return *impl_->program->pattern; }
const UnitCell& CellStream::unit_cell() const { return *impl_->program->cell; }

bool CellStream::visit(std::uint64_t first, std::uint64_t last, const Visitor& visitor, DiagnosticSink& sink) const {
  return Walker(*impl_->program, sink).visit(first, std::min(last, impl_->size), visitor);
}

std::vector<std::int64_t> CellStream::extents() const {
  std::vector<std::int64_t> result;
  DiagnosticSink unused;  // every count was evaluated once already
  for (const LoopProgram& loop : impl_->program->loops) {
    if (!loop.count) {
      result.push_back(loop.initial.count);
      continue;
    }
    if (loop.count->level != constant_level) return {};
    const auto count = eval::evaluate(*loop.count, impl_->program->slots, impl_->data().report(unused));
    result.push_back(count ? std::llround(*count) : 0);
  }
  return result;
}

}  // namespace meso::eval
