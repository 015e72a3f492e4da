#include "data_io/json/json_writer.h"

#include <gtest/gtest.h>

#include <cmath>

#include <nlohmann/json.hpp>

#include "tests/support/temp_dir.h"

namespace sonarcal::data_io {
namespace {

using Json = nlohmann::ordered_json;

TEST(JsonWriterTest, ValuesThatFitOneLineStandInOne) {
  EXPECT_EQ(JsonText({{"b", 1}, {"a", {1.5, 2}}}), "{\"b\": 1, \"a\": [1.5, 2]}\n");
  EXPECT_EQ(JsonText(Json::object()), "{}\n");
  EXPECT_EQ(JsonText(Json::array({Json::object(), Json::array()})), "[{}, []]\n");
}

TEST(JsonWriterTest, LongObjectsAreBrokenAndListsOfNumbersAreNot) {
  Json json = {{"name", std::string(60, 'x')}, {"numbers", std::vector<int>(100, 7)}};
  const std::string text = JsonText(json);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 4);
  EXPECT_EQ(Json::parse(text), json);
}

TEST(JsonWriterTest, NumbersReadBackToTheLastBit) {
  for (const double value : {0.1, 1.0 / 3.0, 1e-308, -2.5e300, 6.02214076e23, std::nextafter(1.0, 2.0)}) {
    EXPECT_EQ(Json::parse(JsonText(value)).get<double>(), value);
  }
}

TEST(JsonWriterTest, NanAndInvalidUtf8AreReplaced) {
  EXPECT_EQ(JsonText(std::nan("")), "null\n");
  EXPECT_EQ(JsonText(std::string("\xff")), "\"\xEF\xBF\xBD\"\n");
}

TEST(JsonWriterTest, AWrittenFileHoldsTheValueAndEndsInANewline) {
  const testing::TempDir dir;
  WriteJson(dir / "a.json", {{"a", 1}});
  EXPECT_EQ(testing::ReadFile(dir / "a.json"), "{\"a\": 1}\n");
}

}  // namespace
}  // namespace sonarcal::data_io
