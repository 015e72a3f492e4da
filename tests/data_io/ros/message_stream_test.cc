#include "data_io/ros/message_stream.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <initializer_list>

#include "core/types/error.h"
#include "tests/data_io/refusal.h"

namespace sonarcal::data_io {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<std::byte> Bytes(std::initializer_list<int> values) {
  std::vector<std::byte> bytes;
  for (const int value : values) bytes.push_back(static_cast<std::byte>(value));
  return bytes;
}

TEST(MessageStreamTest, Ros1IsPackedAndLittleEndian) {
  const auto bytes = Bytes({7, 0x34, 0x12, 3, 0, 0, 0, 'a', 'b', 'c', 0, 0, 0, 0, 0, 0, 0xf8, 0x3f});
  MessageStream stream(bytes, MessageEncoding::kRos1, "m");
  EXPECT_EQ(stream.U8("a"), 7);
  EXPECT_EQ(stream.U16("b"), 0x1234);
  EXPECT_EQ(stream.String("c"), "abc");
  EXPECT_EQ(stream.F64("d"), 1.5);
  stream.Finish();
}

// A u8 at 0, then a u32 at 4 and an f64 at 8, counted from behind the encapsulation.
TEST(MessageStreamTest, CdrIsAlignedFromBehindTheEncapsulation) {
  const auto little = Bytes({0, 1, 0, 0, 7, 9, 9, 9, 0x78, 0x56, 0x34, 0x12, 0, 0, 0, 0, 0, 0, 0xf8, 0x3f});
  const auto big = Bytes({0, 0, 0, 0, 7, 9, 9, 9, 0x12, 0x34, 0x56, 0x78, 0x3f, 0xf8, 0, 0, 0, 0, 0, 0});
  for (const auto& bytes : {little, big}) {
    MessageStream stream(bytes, MessageEncoding::kCdr, "m");
    EXPECT_EQ(stream.U8("a"), 7);
    EXPECT_EQ(stream.U32("b"), 0x12345678U);
    EXPECT_EQ(stream.F64("c"), 1.5);
    stream.Finish();
  }
}

TEST(MessageStreamTest, CdrStringsEndInNul) {
  const auto bytes = Bytes({0, 1, 0, 0, 3, 0, 0, 0, 'h', 'i', 0, 9, 1, 0, 0, 0, 0});
  MessageStream stream(bytes, MessageEncoding::kCdr, "m");
  EXPECT_EQ(stream.String("a"), "hi");
  EXPECT_EQ(stream.String("b"), "");
}

// No alignment for elements that are not there.
TEST(MessageStreamTest, AnEmptySequenceTakesItsCountOnly) {
  const auto bytes = Bytes({0, 1, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0, 5, 0, 6, 0});
  MessageStream stream(bytes, MessageEncoding::kCdr, "m");
  EXPECT_EQ(stream.Count("vectors", 24), 0U);
  EXPECT_THAT(stream.I16s("numbers"), ElementsAre(5, 6));
}

TEST(MessageStreamTest, CountsAreComparedWithTheBytesLeft) {
  const auto bytes = Bytes({0xff, 0xff, 0xff, 0xff, 1, 2, 3});
  const auto read = [&] { MessageStream(bytes, MessageEncoding::kRos1, "m").F32s("ranges"); };
  EXPECT_THAT(testing::MessageOf(read),
              HasSubstr("m: byte 0: ranges: 4294967295 elements of at least 4 bytes, but 3 bytes are left"));
}

TEST(MessageStreamTest, OtherEncapsulationsAndRestsAreRefused) {
  const auto parameter_list = Bytes({0, 3, 0, 0});
  EXPECT_THAT(testing::MessageOf([&] { MessageStream(parameter_list, MessageEncoding::kCdr, "m"); }),
              HasSubstr("0x00 0x03, expected 0x00 and 0x00 or 0x01"));
  const auto rest = Bytes({1, 2});
  MessageStream stream(rest, MessageEncoding::kRos1, "m");
  stream.U8("a");
  EXPECT_THAT(testing::MessageOf([&] { stream.Finish(); }), HasSubstr("1 bytes are left, expected none"));
}

}  // namespace
}  // namespace sonarcal::data_io
