// SPDX-License-Identifier: Apache-2.0
#pragma once
// What stands around the geometry of a STEP file: header, units, product.

#include "meso/export_step/write_step.hpp"
#include "step_text.hpp"

namespace meso::step {

void write_header(StepText& text, const StepOptions& options);
/// The product's PRODUCT_DEFINITION_SHAPE.
StepId write_product(StepText& text, const StepOptions& options);
/// Millimetres, radians, and the uncertainty of points.
StepId write_context(StepText& text);

}  // namespace meso::step
