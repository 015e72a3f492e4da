#include "data_io/json/json_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/data_io/refusal.h"

namespace sonarcal::data_io {
namespace {

using ::testing::ElementsAre;
using testing::MessageOf;

JsonReader Parse(const std::string& text) {
  return JsonReader::FromText(text, "x.json");
}

TEST(JsonReaderTest, ReadsEachKindOfValue) {
  const JsonReader json = Parse(R"({"n": 2.5, "i": 7, "r": 3.0, "b": true, "s": "ä", "l": [1, 2], "o": {}})");
  EXPECT_EQ(json.At("n").Number(), 2.5);
  EXPECT_EQ(json.At("i").Integer(0, 7), 7);
  EXPECT_EQ(json.At("r").Integer(0, 7), 3);
  EXPECT_TRUE(json.At("b").Bool());
  EXPECT_EQ(json.At("s").String(), "ä");
  EXPECT_THAT(json.At("l").Numbers(), ElementsAre(1.0, 2.0));
  EXPECT_EQ(json.At("l").Items()[1].path(), "l[1]");
  EXPECT_TRUE(json.At("o").is_object());
  EXPECT_NO_THROW(json.Finish());
}

TEST(JsonReaderTest, AValueOfTheWrongKindIsDescribed) {
  const JsonReader json = Parse("{\"a\":\n{\"b\": \"two\", \"c\": [1, 2], \"d\": 2.5}}");
  const JsonReader a = json.At("a");
  EXPECT_EQ(MessageOf([&] { a.At("b").Number(); }), "x.json:2: 'a.b' is \"two\", expected a number");
  EXPECT_EQ(MessageOf([&] { a.At("c").String(); }),
            "x.json:2: 'a.c' is a list of 2, expected text in quotes");
  EXPECT_EQ(MessageOf([&] { a.At("d").Integer(0, 9); }),
            "x.json:2: 'a.d' is 2.5, expected an integer from 0 to 9");
  EXPECT_EQ(MessageOf([&] { a.At("d").Bool(); }), "x.json:2: 'a.d' is 2.5, expected true or false");
  EXPECT_EQ(MessageOf([&] { a.Items(); }), "x.json:2: 'a' is an object, expected a list");
  EXPECT_EQ(MessageOf([&] { Parse("\n3").At("a"); }), "x.json:2: the document is 3, expected an object");
}

TEST(JsonReaderTest, NumbersOutsideTheirRangeAreRefusedWithTheLimit) {
  const JsonReader zero = Parse("{\"a\": 0}").At("a");
  EXPECT_EQ(zero.Number(NumberRange::AtLeast(0.0)), 0.0);
  EXPECT_EQ(MessageOf([&] { zero.Number(NumberRange::Above(0.0)); }),
            "x.json:1: 'a' is 0, expected a number > 0");
  EXPECT_EQ(MessageOf([&] { zero.Number(NumberRange::Between(1.0, 2.0)); }),
            "x.json:1: 'a' is 0, expected a number >= 1 and <= 2");
  EXPECT_EQ(MessageOf([&] { Parse("[1, 2, -3]").Numbers(NumberRange::AtLeast(0.0)); }),
            "x.json:1: '[2]' is -3, expected a number >= 0");
  EXPECT_FALSE(NumberRange{}.Contains(std::nan("")));
}

TEST(JsonReaderTest, IntegersBeyondTheirTypeAreRefused) {
  constexpr auto kMax = std::numeric_limits<std::int64_t>::max();
  EXPECT_EQ(Parse("9223372036854775807").Integer(0, kMax), kMax);
  EXPECT_THROW(Parse("9223372036854775808").Integer(0, kMax), DataError);
  EXPECT_THROW(Parse("-1e300").Integer(0, kMax), DataError);
}

TEST(JsonReaderTest, ARequiredKeyIsMissedAndAnOptionalOneIsNot) {
  const JsonReader json = Parse("{\"a\":\n{\"nothing\": null}}");
  EXPECT_EQ(MessageOf([&] { json.At("a").At("b"); }), "x.json:2: required key 'a.b' is missing");
  EXPECT_FALSE(json.At("a").Find("b"));
  EXPECT_FALSE(json.At("a").Find("nothing")) << "null counts as absent";
  double value = 4.0;
  json.At("a").Update("b", value);
  EXPECT_EQ(value, 4.0);
}

TEST(JsonReaderTest, WordsAreThoseOfTheTable) {
  enum class Fruit { kApple, kPear };
  constexpr Words<Fruit, 2> kFruits = {{{"apple", Fruit::kApple}, {"pear", Fruit::kPear}}};
  EXPECT_EQ(Parse("\"pear\"").Word(kFruits), Fruit::kPear);
  EXPECT_EQ(WordIn(kFruits, Fruit::kApple), "apple");
  EXPECT_EQ(MessageOf([&] { Parse("[\"plum\"]").Items()[0].Word(kFruits); }),
            "x.json:1: '[0]' is \"plum\", expected one of apple, pear");
}

TEST(JsonReaderTest, UnknownKeysAreRefusedWithLineAndChoice) {
  const JsonReader json = Parse("{\"good\": 1,\n\"inner\": {\n\"gian\": 2},\n\"skipped\": {\"any\": 1}}");
  json.At("good");
  json.At("inner").Find("gain");
  json.At("inner").Find("looks");
  json.Find("skipped");
  EXPECT_EQ(MessageOf([&] { json.Finish(); }),
            "x.json:3: unknown key 'inner.gian'; expected one of gain, looks");
}

TEST(JsonReaderTest, UnknownKeysComeInTheOrderOfTheFile) {
  const JsonReader json = Parse("{\"z\": 1,\n\"known\": 1,\n\"a\": 2}");
  json.At("known");
  const auto unknown = json.UnknownKeys();
  ASSERT_EQ(unknown.size(), 2u);
  EXPECT_EQ(unknown[0].path, "z");
  EXPECT_EQ(unknown[1].path, "a");
  EXPECT_EQ(unknown[1].line, 3);
}

TEST(JsonReaderTest, MembersWithFreeNamesAreKnownAndTheirUnknownKeysRefused) {
  const JsonReader json = Parse(R"({"materials": {"floor": {"A": 1}, "wall": {"B": 2}}})");
  const JsonReader materials = json.At("materials");
  for (const auto& [name, material] : materials.Members()) material.Find("A");
  EXPECT_EQ(MessageOf([&] { json.Finish(); }), "x.json:1: unknown key 'materials.wall.B'; expected one of A");
}

TEST(JsonReaderTest, AReaderOutlivesTheOneItCameFrom) {
  std::optional<JsonReader> inner;
  { inner = Parse(R"({"a": {"b": 5}})").At("a"); }
  EXPECT_EQ(inner->At("b").Number(), 5.0);
}

TEST(JsonReaderTest, HostileNamesArePrintable) {
  const std::string message = MessageOf([] {
    const JsonReader json = Parse(R"({"\u001b[2J\u0007)" + std::string(1000, 'k') + R"(": 1})");
    json.Find("a");
    json.Finish();
  });
  EXPECT_THAT(message, ::testing::StartsWith("x.json:1: unknown key '?[2J?kkk"));
  EXPECT_LT(message.size(), 200u);
}

}  // namespace
}  // namespace sonarcal::data_io
