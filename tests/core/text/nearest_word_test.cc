#include "core/text/nearest_word.h"

#include <gtest/gtest.h>

namespace sonarcal {
namespace {

const std::vector<std::string> kCommands = {"fit", "compare", "simulate", "scenes", "sonars"};

TEST(NearestWordTest, ADistanceCountsLettersThatDiffer) {
  EXPECT_EQ(EditDistance("", ""), 0);
  EXPECT_EQ(EditDistance("", "fit"), 3);
  EXPECT_EQ(EditDistance("fit", "fit"), 0);
  EXPECT_EQ(EditDistance("fits", "fit"), 1);
  EXPECT_EQ(EditDistance("fxt", "fit"), 1);
  EXPECT_EQ(EditDistance("kitten", "sitting"), 3);
}

TEST(NearestWordTest, TwoLettersInTheWrongOrderAreOneMistake) {
  EXPECT_EQ(EditDistance("fti", "fit"), 1);
  EXPECT_EQ(EditDistance("recieve", "receive"), 1);
}

TEST(NearestWordTest, CaseAndKindOfHyphenDoNotCount) {
  EXPECT_EQ(EditDistance("Bridge-Pier", "bridge_pier"), 0);
}

TEST(NearestWordTest, TheNearestWordIsFoundAndTheFirstOfSeveral) {
  EXPECT_EQ(NearestWord("fti", kCommands), "fit");
  EXPECT_EQ(NearestWord("simulat", kCommands), "simulate");
  EXPECT_EQ(NearestWord("SCENE", kCommands), "scenes");
  EXPECT_EQ(NearestWord("ab", {"ac", "ad"}), "ac");
}

TEST(NearestWordTest, ABeginningIsNear) {
  EXPECT_EQ(NearestWord("sim", kCommands), "simulate");
  EXPECT_EQ(NearestWord("p900", {"didson-1.8", "p900-45"}), "p900-45");
}

TEST(NearestWordTest, NothingIsNearAnotherWord) {
  EXPECT_EQ(NearestWord("moon", kCommands), std::nullopt);
  EXPECT_EQ(NearestWord("", kCommands), std::nullopt);
  EXPECT_EQ(NearestWord("x", {"y"}), std::nullopt);
  EXPECT_EQ(NearestWord("fit", {}), std::nullopt);
  EXPECT_EQ(NearestWord(std::string(10'000, 'f'), kCommands), std::nullopt);
}

TEST(NearestWordTest, AMessageHasTheListOnlyIfItIsShortOrNothingIsNear) {
  EXPECT_EQ(ExpectedWord("beans", {"frustum", "beams"}, "frustum|beams"),
            ", expected frustum|beams; did you mean 'beams'?");
  EXPECT_EQ(ExpectedWord("moon", {"floor", "box"}), ", expected one of floor, box");
  const std::vector<std::string> many(30, "material");
  EXPECT_EQ(ExpectedWord("matreial", many), ", did you mean 'material'?");
}

}  // namespace
}  // namespace sonarcal
