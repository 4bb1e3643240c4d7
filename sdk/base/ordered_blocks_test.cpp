// SPDX-License-Identifier: Apache-2.0
#include "meso/base/ordered_blocks.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <stdexcept>
#include <string>

namespace meso {
namespace {

void number(std::size_t block, ByteBuffer& out) { out.append(std::to_string(block) + " "); }

/// As memory may run out in StringSink.
class ThrowingSink final : public ByteSink {
 public:
  [[nodiscard]] bool write(std::string_view) override {
    // The others are to wait for their turns by then.
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    throw std::runtime_error("sink");
  }
};

TEST(OrderedBlocks, AreInOrderForAnyNumberOfThreads) {
  for (const unsigned jobs : {1u, 2u, 5u}) {
    StringSink sink;
    const auto done = write_in_order(12, jobs, sink, number);
    EXPECT_TRUE(done.complete);
    EXPECT_EQ(sink.text(), "0 1 2 3 4 5 6 7 8 9 10 11 ");
    EXPECT_EQ(done.bytes, sink.text().size());
  }
}

TEST(OrderedBlocks, ThrowAgainWhatTheSinkThrows) {
  for (const unsigned jobs : {1u, 4u}) {
    ThrowingSink sink;
    EXPECT_THROW((void)write_in_order(100, jobs, sink, number), std::runtime_error);
  }
}

TEST(OrderedBlocks, ThrowAgainWhatTheirMakerThrows) {
  for (const unsigned jobs : {1u, 4u}) {
    StringSink sink;
    const auto make = [](std::size_t block, ByteBuffer& out) {
      if (block == 7) throw std::runtime_error("block");
      number(block, out);
    };
    EXPECT_THROW((void)write_in_order(100, jobs, sink, make), std::runtime_error);
    EXPECT_EQ(std::string("0 1 2 3 4 5 6 ").substr(0, sink.text().size()), sink.text());
  }
}

}  // namespace
}  // namespace meso
