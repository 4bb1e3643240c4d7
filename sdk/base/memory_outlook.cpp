// SPDX-License-Identifier: Apache-2.0
#include "meso/base/memory_outlook.hpp"

#include <mutex>
#include <utility>

namespace meso {
namespace {

struct Outlook {
  std::mutex mutex;
  std::optional<Diagnostic> takes;
};

// Never destroyed: a thread that ends the process may ask while static objects are.
Outlook& outlook() {
  static auto* const only = new Outlook;
  return *only;
}

}  // namespace

void foresee_memory(Diagnostic takes) {
  Outlook& now = outlook();
  const std::lock_guard lock(now.mutex);
  now.takes = std::move(takes);
}

void forget_foreseen_memory() {
  Outlook& now = outlook();
  const std::lock_guard lock(now.mutex);
  now.takes.reset();
}

std::optional<Diagnostic> foreseen_memory() {
  Outlook& now = outlook();
  const std::lock_guard lock(now.mutex);
  return now.takes;
}

}  // namespace meso
