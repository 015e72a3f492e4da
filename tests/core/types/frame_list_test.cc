#include "core/types/frame_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/types/error.h"

namespace sonarcal {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

std::vector<int> FramesOf(const std::string& text, int frame_count) {
  return FrameList::Parse(text).value().In(frame_count);
}

TEST(FrameListTest, NumbersAndRangesAreReadInTheirOrder) {
  EXPECT_EQ(FramesOf("3", 10), (std::vector<int>{3}));
  EXPECT_EQ(FramesOf("7,2:5", 10), (std::vector<int>{7, 2, 3, 4}));
  EXPECT_EQ(FramesOf("7:", 10), (std::vector<int>{7, 8, 9}));
  EXPECT_EQ(FramesOf(":3,8:", 10), (std::vector<int>{0, 1, 2, 8, 9}));
  EXPECT_EQ(FramesOf(":", 2), (std::vector<int>{0, 1}));
  EXPECT_EQ(FramesOf("all", 2), (std::vector<int>{0, 1}));
  EXPECT_TRUE(FrameList().In(10).empty());
}

TEST(FrameListTest, TextAndNumbersAreThoseOfTheList) {
  for (const char* text : {"3", "7,2:5", "7:", ":", "0:2,8:"})
    EXPECT_EQ(FrameList::Parse(text)->Text(), text);
  EXPECT_EQ(FrameList({0, 1, 4}), FrameList::Parse("0:2,4"));
  EXPECT_EQ(FrameList::Parse(":2,4")->Numbers(), (std::vector<int>{0, 1, 4}));
  EXPECT_EQ(FrameList::Parse("4:")->Numbers(), std::nullopt);
}

TEST(FrameListTest, OtherTextsAreRefused) {
  for (const char* text :
       {"", ",", "1,", "-1", "a", "2:1", "2:2", "1:2:3", "1-3", " 1", "1.5", "-2:", ":-2", "99999999999"}) {
    EXPECT_EQ(FrameList::Parse(text), std::nullopt) << text;
  }
}

TEST(FrameListTest, FramesThatAreNotThereOrNamedTwiceAreRefused) {
  EXPECT_THAT([] { FrameList({9}).In(4, "held-out frame"); },
              ThrowsMessage<DataError>(HasSubstr("held-out frame 9 of a recording of 4 frames (0 .. 3)")));
  EXPECT_THAT([] { FrameList({-1}).In(4); }, ThrowsMessage<DataError>(HasSubstr("frame -1 of")));
  EXPECT_THAT([] { FramesOf("2:5", 4); }, ThrowsMessage<DataError>(HasSubstr("frames 2:5 of a recording")));
  EXPECT_THAT([] { FramesOf("4:", 4); }, ThrowsMessage<DataError>(HasSubstr("frames 4: of a recording")));
  EXPECT_THAT([] { FramesOf("1:,3", 4); },
              ThrowsMessage<UsageError>(HasSubstr("frames '1:,3' name frame 3 twice")));
}

}  // namespace
}  // namespace sonarcal
