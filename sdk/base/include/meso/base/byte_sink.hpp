// SPDX-License-Identifier: Apache-2.0
#pragma once
// Where exporters put their bytes: a file, a string, a hash. Writers buffer; a sink gets large blocks.

#include <string>
#include <string_view>

namespace meso {

class ByteSink {
 public:
  ByteSink() = default;
  ByteSink(const ByteSink&) = delete;
  ByteSink& operator=(const ByteSink&) = delete;
  virtual ~ByteSink() = default;

  /// Appends. False once anything has failed: the writer stops early, and the sink's owner reports why.
  [[nodiscard]] virtual bool write(std::string_view bytes) = 0;
};

class StringSink final : public ByteSink {
 public:
  [[nodiscard]] bool write(std::string_view bytes) override {
    text_ += bytes;
    return true;
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
};

}  // namespace meso
