// SPDX-License-Identifier: Apache-2.0
// document parameters, the only names that must be declared before they are used.
#include "families.hpp"

namespace meso {
void check_parameters(Context& c) {
  for (const Parameter& p : c.document.parameters) {
    const bool good = c.check(p, "value", p.value, c.parameters);
    (void)c.check(p, "min", p.min, c.parameters);
    (void)c.check(p, "max", p.max, c.parameters);
    check_bounds_order(c, p, p.min, p.max);
    if (good) check_bounds(c, p, "value", p.value, p.id.text, p.min, p.max);
    const std::optional<double> value = good ? c.constant(p.value) : std::nullopt;
    c.parameters.add(p.id.text, "the parameter '" + p.id.text + "'");
    if (value) c.values.try_emplace(p.id.text, *value);
  }
}

}  // namespace meso
