// SPDX-License-Identifier: Apache-2.0
#pragma once
// Nodes and struts of a beams body: radii per node and per end, balls, caps.

#include "body.hpp"
#include "strut_pairs.hpp"

namespace meso::eval {

[[nodiscard]] std::optional<Shape> make_beams(const EvaluationData& data, const BodyTable& table,
                                              const BeamsBody& beams, std::span<const double> slots,
                                              const Report& report, const NodeRules& rules);

/// The struts that end in a pole; false if something was reported.
[[nodiscard]] bool append_pole_struts(const EvaluationData& data, const BodyTable& table, const BeamsBody& beams,
                                      std::span<const double> slots, const Report& report, const NodeRules& rules,
                                      PoleBalls& poles);

}  // namespace meso::eval
