// SPDX-License-Identifier: Apache-2.0
#pragma once
// Lets OpenCASCADE ask whether to go on. Private.

#include <Message_ProgressIndicator.hxx>

#include "meso/base/run_options.hpp"

namespace meso::brep {

class StopWatch : public Message_ProgressIndicator {
 public:
  explicit StopWatch(const RunOptions& run) : run_(run) {}
  Standard_Boolean UserBreak() override { return run_.should_stop(); }

 protected:
  void Show(const Message_ProgressScope&, const Standard_Boolean) override {}

 private:
  const RunOptions& run_;
};

}  // namespace meso::brep
