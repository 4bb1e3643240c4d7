// SPDX-License-Identifier: Apache-2.0
// read(write(d)) == d for hundreds of random documents, filled through the same describe table that the reader and the
// writer visit.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

#include "meso/xml/read.hpp"
#include "meso/xml/write.hpp"
#include "shape.hpp"

namespace meso::xml {
namespace {

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  std::size_t below(std::size_t n) { return engine_() % n; }
  bool chance(unsigned percent) { return below(100) < percent; }

  std::string pick(const std::vector<std::string>& pieces, std::size_t longest) {
    std::string out;
    for (std::size_t n = below(longest + 1); n > 0; --n) out += pieces[below(pieces.size())];
    return out;
  }
  /// Everything that needs an escape somewhere.
  std::string text() {
    return pick({"a", " ", "<", ">", "&", "\"", "'", "\t", "\n", "\r", "]]>", "&lt;", "1", "\xC3\xA4",
                 "\xF0\x9F\x98\x80", "--"},
                8);
  }
  std::string name() { return pick({"a", "_", "Z"}, 1) + "b" + pick({"a", "_", "0", "Z"}, 4); }
  double number() {
    double value = NAN;
    while (!std::isfinite(value)) {
      const std::uint64_t bits = (static_cast<std::uint64_t>(engine_()) << 32) | engine_();
      std::memcpy(&value, &bits, sizeof value);
    }
    return value;
  }
  std::int64_t integer() { return static_cast<std::int64_t>(below(1'000'000'000)) * 999'999'999; }

  std::vector<Trivia> trivia(bool with_foreign = true) {
    static const std::vector<Trivia> samples = {
        {Trivia::Kind::comment, "<!-- two\n  lines -->"},
        {Trivia::Kind::instruction, "<?tool do=\"it\"?>"},
        {Trivia::Kind::comment, "<!---->"},
        {Trivia::Kind::foreign, "<v:a xmlns:v=\"urn:v\" b=\"&lt;\">t<box/>\n <v:c r:d=\"1\"/></v:a>"},
        {Trivia::Kind::foreign, "<plain xmlns=\"urn:p\"><!-- inside --></plain>"}};
    std::vector<Trivia> out;
    while (chance(15)) out.push_back(samples[below(with_foreign ? samples.size() : 3)]);
    return out;
  }
  std::vector<ForeignAttribute> foreign() {
    if (!chance(10)) return {};
    return {{"xmlns:w", "urn:w"}, {"w:note", text()}, {"r:mark", text()}, {"xml:lang", "en"}};
  }

 private:
  std::mt19937 engine_;
};

class FillVisitor {
 public:
  FillVisitor(Random& random, std::size_t depth) : random_(random), depth_(depth) {}

  template <class T>
  void attribute(std::string_view name, std::optional<T>& value) {
    if (random_.chance(50)) attribute(name, value.emplace());
  }
  template <class T>
  void attribute(std::string_view name, T& value) {
    if constexpr (std::is_enum_v<T>)
      value = static_cast<T>(random_.below(enum_texts<T>.size()));
    else if constexpr (std::is_same_v<T, bool>)
      value = random_.chance(50);
    else if constexpr (std::is_same_v<T, double>)
      value = random_.number();
    else if constexpr (std::is_same_v<T, std::int64_t>)
      value = random_.integer();
    else if constexpr (std::is_same_v<T, std::string>)
      value = string_for(name);
    else if constexpr (value_kind<T>() == ValueKind::expression || value_kind<T>() == ValueKind::expressions ||
                       value_kind<T>() == ValueKind::href)
      value.text = random_.text();
    else
      value.text = random_.name();
  }
  void text(std::string& value) { value = random_.text(); }
  template <class T>
  void child(std::string_view, std::optional<T>& value) {
    if (random_.chance(40)) fill(value.emplace());
  }
  template <class T>
  void children(std::string_view, std::vector<T>& values) {
    while (more()) fill(values.emplace_back());
  }
  template <class T>
  void sequence(std::vector<T>& values) {
    while (more()) fill_variant(variant_of(values.emplace_back()), false);
  }
  template <class... Ts>
  void choice(std::variant<Ts...>& value) {
    fill_variant(value, true);
  }
  template <class T>
  void section(std::string_view, Section<T>& section, std::string_view) {
    base(section);
    children("", section.items);
  }
  template <class E>
  void fill(E& e) {
    base(e, shape_of<E>().has_text);
    FillVisitor inner(random_, depth_ + 1);
    describe(inner, e);
  }

 private:
  bool more() { return depth_ < 8 && random_.chance(55); }
  void base(Element& e, bool has_text = false) {
    e.before = random_.trivia();
    e.inside = random_.trivia(!has_text);
    e.foreign = random_.foreign();
  }
  std::string string_for(std::string_view name) {
    if (name == "version") return "1.0";
    if (name == "requires") return "alpha beta";
    if (name == "sha256") return std::string(64, random_.chance(50) ? '0' : 'f');
    return random_.text();
  }
  template <class... Ts>
  void fill_variant(std::variant<Ts...>& value, bool may_be_none) {
    std::size_t index = random_.below(sizeof...(Ts));
    if (!may_be_none && std::is_same_v<std::variant_alternative_t<0, std::variant<Ts...>>, std::monostate>)
      index = 1 + index % (sizeof...(Ts) - 1);
    std::size_t i = 0;
    ((i++ == index ? fill_alternative(value.template emplace<Ts>()) : void()), ...);
  }
  template <class T>
  void fill_alternative(T& alternative) {
    if constexpr (!std::is_same_v<T, std::monostate>) fill(alternative);
  }

  Random& random_;
  std::size_t depth_;
};

Document random_document(unsigned seed) {
  Random random(seed);
  Document d;
  FillVisitor(random, 0).fill(d);
  d.before = random.trivia(false);
  d.after = random.trivia(false);
  d.foreign = {{"xmlns:r", "urn:r"}, {"r:mark", random.text()}};
  return d;
}

std::optional<Document> read_back(const std::string& text, unsigned seed) {
  DiagnosticSink sink;
  auto result = read_document(text, "random.meso", sink, {.understood = {"alpha", "beta"}});
  if (!result) ADD_FAILURE() << "seed " << seed << ": " << render(sink.diagnostics().at(0)) << "\n" << text;
  if (!result) return std::nullopt;
  return result->document;
}

TEST(RoundTrip, ReadOfWriteIsTheSameDocument) {
  std::size_t bytes = 0;
  for (unsigned seed = 0; seed < 500; ++seed) {
    const Document d = random_document(seed);
    const std::string text = write_document(d);
    bytes += text.size();
    const auto back = read_back(text, seed);
    ASSERT_TRUE(back);
    ASSERT_TRUE(*back == d) << "seed " << seed << "\n" << text << "\n-----\n" << write_document(*back);
    ASSERT_EQ(write_document(*back), text) << "seed " << seed;
  }
  EXPECT_GT(bytes, 500'000U) << "the documents are too small to mean anything";
}

TEST(RoundTrip, CanonicalFormIsAFixedPoint) {
  for (unsigned seed = 1000; seed < 1500; ++seed) {
    const Document d = random_document(seed);
    const std::string canonical = canonical_document(d);
    EXPECT_EQ(canonical.find("<!-- two"), std::string::npos);
    const auto back = read_back(canonical, seed);
    ASSERT_TRUE(back);
    ASSERT_EQ(canonical_document(*back), canonical) << "seed " << seed;
    const auto through_plain = read_back(write_document(d), seed);
    ASSERT_TRUE(through_plain);
    ASSERT_EQ(canonical_document(*through_plain), canonical) << "seed " << seed;
  }
}

}  // namespace
}  // namespace meso::xml
