// SPDX-License-Identifier: Apache-2.0
#include "make_options.hpp"

#include "overrides.hpp"

namespace meso::cli {

std::optional<operations::MakeOptions> make_options(Run& run) {
  operations::MakeOptions options{.part = run.flags.part, .run = run.options()};
  if (!parse_overrides(run, options.overrides)) return std::nullopt;
  if (!run.flags.deflection.empty())
    options.deflection_mm = run.length_mm(run.flags.deflection, LengthUnit::millimeter, "--deflection");
  if (!run.flags.angle.empty()) options.angle_rad = run.angle_rad(run.flags.angle, "--angle");
  if (run.flags.engine == "implicit") options.engine = operations::Engine::implicit;
  if (run.flags.engine == "brep") options.engine = operations::Engine::brep;
  return run.sink.has_errors() ? std::nullopt : std::optional(std::move(options));
}

Json seconds_json(const operations::Seconds& s) {
  return {{"read", s.read}, {"evaluate", s.evaluate}, {"realise", s.realise}, {"write", s.write}, {"total", s.total}};
}

}  // namespace meso::cli
