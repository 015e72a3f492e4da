#include "data_io/json/json_document.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "tests/data_io/refusal.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::data_io {
namespace {

using ::testing::HasSubstr;
using testing::MessageOf;
using ::testing::StartsWith;

std::string RefusalOfJson(const std::string& text) {
  return MessageOf([&] { ParseJson(text, "x.json"); });
}

const JsonNode& Member(const JsonNode& object, std::string_view key) {
  for (const JsonMember& member : std::get<JsonNode::Object>(object.value)) {
    if (member.key == key) return member.value;
  }
  throw DataError("no member {}", key);
}

TEST(JsonDocumentTest, TextBehindANulByteIsRefused) {
  using std::string_literals::operator""s;
  EXPECT_THAT(RefusalOfJson("{}\0 x"s), HasSubstr("byte 2 is NUL"));
  EXPECT_EQ(ParseJson("{}\n\0\0"s, "x").line, 1) << "padding";
}

// Brackets in strings do not count.
TEST(JsonDocumentTest, DeepTextIsDiscarded) {
  EXPECT_EQ(SizeOfJson(R"([{"a[[": "\"[", "b": [1, 2]}])").depth, 3U);
  EXPECT_EQ(SizeOfJson(R"([{"a[[": "\"[", "b": [1, 2]}])").values, 6U);
  const auto nested = [](std::size_t depth) { return std::string(depth, '[') + std::string(depth, ']'); };
  EXPECT_FALSE(ParseLeniently(nested(kMaxJsonDepth)).is_discarded());
  EXPECT_TRUE(ParseLeniently(nested(kMaxJsonDepth + 1)).is_discarded());
  EXPECT_TRUE(ParseLeniently(std::string(1'000'000, '[')).is_discarded());
}

TEST(JsonDocumentTest, EveryValueKnowsItsLine) {
  const JsonNode root =
      ParseJson("{\n\"a\": 1,\n\n\"b\":\n[2,\n 3\n,\"x\"\n],\r\n\"c\": {\n}, \"d\": true\n}\n", "x");
  EXPECT_EQ(root.line, 1);
  EXPECT_EQ(Member(root, "a").line, 2);
  EXPECT_EQ(std::get<JsonNode::Object>(root.value)[1].line, 4) << "the key 'b'";
  const JsonNode& list = Member(root, "b");
  EXPECT_EQ(list.line, 5);
  const auto& items = std::get<JsonNode::Array>(list.value);
  EXPECT_EQ(items[0].line, 5);
  EXPECT_EQ(items[1].line, 6) << "a number ends where the next character, here a line feed, is not its own";
  EXPECT_EQ(items[2].line, 7);
  EXPECT_EQ(Member(root, "c").line, 9);
  EXPECT_EQ(Member(root, "d").line, 10);
}

TEST(JsonDocumentTest, IntegersAreExactAndLargerOnesBecomeDoubles) {
  const JsonNode root = ParseJson("[9007199254740993, -3, 18446744073709551615, 0.1]", "x");
  const auto& items = std::get<JsonNode::Array>(root.value);
  EXPECT_EQ(std::get<std::int64_t>(items[0].value), 9007199254740993);
  EXPECT_EQ(std::get<std::int64_t>(items[1].value), -3);
  EXPECT_EQ(std::get<double>(items[2].value), 18446744073709551615.0);
  EXPECT_EQ(std::get<double>(items[3].value), 0.1);
}

TEST(JsonDocumentTest, ASyntaxErrorHasItsLine) {
  EXPECT_THAT(RefusalOfJson("{\n\"a\": 1,\n\"b\" 2}"), StartsWith("x.json:3: not valid JSON: "));
  EXPECT_THAT(RefusalOfJson(""), StartsWith("x.json:1: not valid JSON: "));
  EXPECT_THAT(RefusalOfJson("{}\n{}"), StartsWith("x.json:2: not valid JSON: "));
  EXPECT_THAT(RefusalOfJson("[1,\n2"), StartsWith("x.json:2: not valid JSON: "));
}

TEST(JsonDocumentTest, NumbersThatAreNoneAreRefused) {
  EXPECT_THAT(RefusalOfJson("[1,\n1e999]"), HasSubstr("x.json:2: not valid JSON: number overflow"));
  EXPECT_THAT(RefusalOfJson("[NaN]"), HasSubstr("x.json:1: not valid JSON"));
  EXPECT_THAT(RefusalOfJson("[-Infinity]"), HasSubstr("x.json:1: not valid JSON"));
}

TEST(JsonDocumentTest, AKeyGivenTwiceIsRefusedWithBothLines) {
  EXPECT_EQ(RefusalOfJson("{\"b\": 1,\n\"a\": 1,\n\"b\": 2}"),
            "x.json:3: key 'b' is given twice, first in line 1; expected it once");
}

TEST(JsonDocumentTest, NestingDeeperThan64LevelsIsRefused) {
  const std::string deep(200'000, '[');
  EXPECT_EQ(RefusalOfJson(deep), "x.json:1: nested 65 levels deep, expected at most 64");
  EXPECT_NO_THROW(ParseJson(std::string(64, '[') + std::string(64, ']'), "x.json"));
}

TEST(JsonDocumentTest, TheNumberOfValuesIsLimited) {
  std::string many = "[0";
  for (std::size_t i = 0; i < kMaxJsonValues; ++i) many += ",0";
  EXPECT_EQ(RefusalOfJson(many + "]"), "x.json:1: more than 4000000 values, expected fewer");
}

TEST(JsonDocumentTest, TextThatIsNotUtf8IsRefusedInPrintableWords) {
  const std::string message = RefusalOfJson("[\"\xff\x1b[2J\"]");
  EXPECT_THAT(message, StartsWith("x.json:1: not valid JSON: "));
  for (const char c : message) EXPECT_TRUE(c >= ' ' && c <= '~') << static_cast<int>(c);
}

TEST(JsonDocumentTest, AnErrorDoesNotRepeatALongFile) {
  EXPECT_LT(RefusalOfJson("[\"" + std::string(100'000, 'a')).size(), 400u);
}

TEST(JsonDocumentTest, AbsentFilesAndFoldersAreRefused) {
  const testing::TempDir dir;
  EXPECT_THAT(MessageOf([&] { LoadJson(dir / "no.json"); }), HasSubstr("no.json: no such file"));
  EXPECT_THAT(MessageOf([&] { LoadJson(dir.path()); }), HasSubstr("not a file"));
}

TEST(JsonDocumentTest, DamagedTextIsReadOrRefused) {
  const std::string text = R"({"a": [1, 2.5e3, {"b": null}], "c": "d\u00e9", "e": true, "f": -0.0})";
  testing::ExpectSurvivesDamage(text, text.size(), 3000, [](const std::string& t) { ParseJson(t, "x"); });
}

}  // namespace
}  // namespace sonarcal::data_io
