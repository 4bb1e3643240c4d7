// SPDX-License-Identifier: Apache-2.0
#include "read_back.hpp"

#include <algorithm>
#include <memory>
#include <string>

#include "meso/brep/measure.hpp"
#include "meso/brep/read_step.hpp"
#include "meso/export_step/write_step.hpp"
#include "meso/resource/resource.hpp"

namespace meso::operations {
namespace {

class TextSink final : public ByteSink {
 public:
  explicit TextSink(std::string& text) : text_(text) {}
  [[nodiscard]] bool write(std::string_view bytes) override {
    text_ += bytes;
    return true;
  }

 private:
  std::string& text_;
};

}  // namespace

std::optional<brep::Body> read_back(const brep::Body& body, const RunOptions& run, DiagnosticSink& sink) {
  const auto step = std::make_shared<std::string>();
  TextSink out(*step);
  (void)write_step(body, {}, out);
  return brep::read_step(Resource("read back.step", step), {}, run, sink);
}

std::vector<double> shell_volumes(const brep::Body& body) {
  std::vector<double> volumes;
  const auto add = [&](const brep::Shell& shell) {
    brep::Body one;
    one.solids.push_back({shell, {}});
    volumes.push_back(brep::measure(one).volume);
  };
  for (const brep::Solid& solid : body.solids) {
    add(solid.outer);
    std::ranges::for_each(solid.voids, add);
  }
  std::ranges::sort(volumes);
  return volumes;
}

}  // namespace meso::operations
