// SPDX-License-Identifier: Apache-2.0
#include "meso/sdf/vocabulary.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

namespace meso::sdf {
namespace {

TEST(Vocabulary, IsFoundByItsWords) {
  for (const Vocable& v : vocabulary()) EXPECT_EQ(find_vocable(v.word), &v);
  EXPECT_EQ(find_vocable("Ball"), nullptr);
}

TEST(Vocabulary, StandsInThePage) {
  std::ifstream in(MESO_SOURCE_DIR "/docs/sdf.md");
  const std::string page((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  for (const Vocable& v : vocabulary()) {
    const std::string word(v.word), first = std::string(v.argument.substr(0, v.argument.find(" | ")));
    EXPECT_THAT(page, testing::HasSubstr("\n| `" + word + (first.empty() ? "" : " " + first) + "`")) << word;
    const std::size_t line = page.find("\n| `" + word);
    const bool ours = page.substr(line, page.find('\n', line + 1) - line).find("*(ours)*") != std::string::npos;
    EXPECT_EQ(ours, v.extension) << word;
    EXPECT_NE(page.find("` | " + (v.takes > 0 ? std::to_string(v.takes) + " " : std::string()) + "|", line),
              std::string::npos);
  }
}

}  // namespace
}  // namespace meso::sdf
