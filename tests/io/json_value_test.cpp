/// Values of JSON text, against another reader of the same text.
#include <gtest/gtest.h>

#include <bit>

#include <nlohmann/json.hpp>

#include "io/json_reader.h"
#include "tests/support/random.h"

namespace rubble::io {
namespace {

using Json = nlohmann::json;
using test::Random;

std::string randomText(Random& random) {
  std::string text;
  for (int k = random.below(30); k > 0; --k)
    text += random.below(8) == 0 ? std::string("\xc3\xa9\"\\\n")
                                 : std::string(1, static_cast<char>(' ' + random.below(95)));
  return text;
}

Json randomJson(Random& random, int depth) {
  switch (random.below(depth > 0 ? 9 : 7)) {
    case 0:
      return nullptr;
    case 1:
      return random.below(2) == 0;
    case 2:
      return std::bit_cast<std::int64_t>(random.bits());
    case 3:
      return random.bits();
    case 4:
      return random.logUniform(1e-300, 1e300) * (random.below(2) == 0 ? 1 : -1);
    case 5:
      return random.below(100) - 50;
    case 6:
      return randomText(random);
    case 7: {
      Json list = Json::array();
      for (int k = random.below(6); k > 0; --k) list.push_back(randomJson(random, depth - 1));
      return list;
    }
    default: {
      Json object = Json::object();
      for (int k = random.below(random.below(4) == 0 ? 40 : 6); k > 0; --k)
        object[randomText(random)] = randomJson(random, depth - 1);
      return object;
    }
  }
}

void expectEqual(const JsonValue& value, const Json& json) {
  ASSERT_EQ(value.isNumber(), json.is_number()) << json;
  if (json.is_number()) {
    EXPECT_EQ(value.isInteger(), json.is_number_integer()) << json;
    EXPECT_EQ(std::bit_cast<std::uint64_t>(value.number()), std::bit_cast<std::uint64_t>(json.get<double>()));
    EXPECT_TRUE(!json.is_number_unsigned() || value.whole() == json.get<std::uint64_t>());
    EXPECT_EQ(describe(value), json.dump());
  }
  ASSERT_EQ(value.isBoolean(), json.is_boolean());
  EXPECT_TRUE(!json.is_boolean() || value.boolean() == json.get<bool>());
  ASSERT_EQ(value.isText(), json.is_string());
  EXPECT_TRUE(!json.is_string() || value.text() == json.get<std::string>());
  ASSERT_EQ(value.isList(), json.is_array());
  ASSERT_EQ(value.isObject(), json.is_object());
  if (!json.is_structured()) return;
  ASSERT_EQ(value.size(), json.size());
  if (json.is_array()) {
    std::size_t k = 0;
    for (const JsonValue& element : value) expectEqual(element, json[k++]);
    return;
  }
  for (const auto& item : json.items()) {
    const JsonValue* const member = value.find(item.key());
    ASSERT_NE(member, nullptr) << item.key();
    expectEqual(*member, item.value());
  }
  std::size_t k = 0;
  const std::vector<const JsonValue*> members = value.members();
  for (const auto& item : json.items()) EXPECT_EQ(members[k++]->key(), item.key());
}

TEST(JsonValues, AreThoseOfAnotherReader) {
  Random random(1);
  for (int k = 0; k < 300; ++k) {
    const Json json = randomJson(random, 5);
    std::vector<Fault> faults;
    const std::optional<JsonDocument> read = parseJson(json.dump(random.below(3) - 1), faults);
    ASSERT_TRUE(read && faults.empty()) << json;
    expectEqual(read->root(), json);
  }
  for (const char* text :
       {"-0", "-0.0", "18446744073709551615", "18446744073709551616", "-9223372036854775808",
        "-9223372036854775809", "4.9e-324", "1.7976931348623157e308", "1e-400", "0.1", "100"}) {
    std::vector<Fault> faults;
    expectEqual(parseJson(text, faults).value().root(), Json::parse(text));
  }
}

/// The one fault of a text that is read as a value at "x".
std::string faultOf(const std::string& text) {
  std::vector<Fault> faults;
  parseJson(text, faults);
  return faults.size() == 1 ? faults[0].text() : std::to_string(faults.size()) + " faults";
}

TEST(JsonValues, CutShortSayWhereTheTextEnds) {
  Random random(2);
  for (int k = 0; k < 60; ++k) {
    const std::string whole = Json{randomJson(random, 4), randomJson(random, 4)}.dump(2);
    const std::string text = whole.substr(
        0, static_cast<std::size_t>(random.below(static_cast<int>(whole.size()))));
    std::string expected;
    try {
      ADD_FAILURE() << Json::parse(text);
    } catch (const Json::parse_error& error) {
      expected = error.what();
    }
    std::vector<Fault> faults;
    EXPECT_FALSE(parseJson(text, faults));
    ASSERT_EQ(faults.size(), 1u);
    const std::string at = "line " + std::to_string(faults[0].line) + ", column ";
    EXPECT_NE(expected.find(at), std::string::npos) << expected << faults[0].text();
    EXPECT_NE(expected.find(faults[0].message), std::string::npos) << expected << faults[0].text();
  }
  EXPECT_EQ(faultOf("[1, 1e999]"), "number overflow parsing '1e999'");
}

TEST(JsonValues, ThereTwiceAreNamed) {
  EXPECT_EQ(faultOf(R"({"a": [1, {"b": {"c": 1, "d": 2, "c": 3}}]})"),
            "a[1].b.c: expected each key once, got \"c\" again");
  EXPECT_EQ(faultOf(R"([{}, {"a": 1, "a": 2}])"), "[1].a: expected each key once, got \"a\" again");
  Json many;
  for (int k = 0; k < 40; ++k) many["key" + std::to_string(k)] = k;
  std::string text = many.dump();
  text.insert(text.size() - 1, ", \"key17\": 5");
  EXPECT_EQ(faultOf(text), "key17: expected each key once, got \"key17\" again");
  std::vector<Fault> faults;
  const std::optional<JsonDocument> read = parseJson(text, faults);
  EXPECT_EQ(read->root().find("key17")->whole(), 5u);
  EXPECT_EQ(read->root().members().size(), 40u);
}

TEST(JsonValues, AreAtMost64Deep) {
  const auto nested = [](int levels) {
    return "{\"a\":" + std::string(static_cast<std::size_t>(levels - 1), '[') + "1" +
           std::string(static_cast<std::size_t>(levels - 1), ']') + "}";
  };
  EXPECT_EQ(faultOf(nested(64)), "0 faults");
  std::string path = "a";
  for (int k = 0; k < 63; ++k) path += "[0]";
  EXPECT_EQ(faultOf(nested(65)),
            path + ": expected at most 64 lists and objects within one another, got more");
  EXPECT_EQ(faultOf(std::string(1000000, '[')).substr(0, 6), "[0][0]");
}

TEST(JsonNodes, NameTheValueThatIsWrong) {
  std::vector<Fault> faults;
  const std::optional<JsonDocument> read = parseJson(
      R"({"list": [{"a": 1}, {"a": [1, "two", 3], "extra": 1, "b": -1}]})", faults);
  const Node root(read->root(), "file", faults);
  ObjectReader object(root);
  const auto list = object.get("list");
  for (const Node& element : list->elements("a list")) {
    ObjectReader own(element);
    if (const auto a = own.get("a")) a->vector();
    double b = 0;
    own.read("b", b, {0, true, 9, "a number from 0 to 9"});
    own.finish();
  }
  std::vector<std::string> texts;
  for (const Fault& fault : faults) texts.push_back(fault.text());
  EXPECT_EQ(texts, (std::vector<std::string>{"file.list[0].a: expected a list of 3 numbers, got 1",
                                             "file.list[1].a[1]: expected a number, got \"two\"",
                                             "file.list[1].b: expected a number from 0 to 9, got -1",
                                             "file.list[1].extra: unknown key; known here: a, b"}));
}

}  // namespace
}  // namespace rubble::io
