#include "data_io/files/byte_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/types/error.h"
#include "tests/data_io/byte_writer.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::data_io {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

std::span<const std::byte> AsBytes(const std::string& text) {
  return std::as_bytes(std::span<const char>(text));
}

TEST(ByteReader, ReadsLittleEndianValuesAtAnyOffset) {
  testing::ByteWriter writer;
  writer.U8(0, 0xfe);
  writer.U16(1, 0x1234);
  writer.U32(3, 0x89abcdef);
  writer.U64(7, 0x0123456789abcdef);
  writer.I16(15, -30000);
  writer.F32(17, -1.5f);
  writer.F64(21, 1e-300);
  const ByteReader reader(AsBytes(writer.bytes()), "f");
  EXPECT_EQ(reader.U8(0, "a"), 0xfe);
  EXPECT_EQ(reader.U16(1, "a"), 0x1234);
  EXPECT_EQ(reader.U32(3, "a"), 0x89abcdef);
  EXPECT_EQ(reader.U64(7, "a"), 0x0123456789abcdef);
  EXPECT_EQ(reader.I16(15, "a"), -30000);
  EXPECT_EQ(reader.F32(17, "a"), -1.5f);
  EXPECT_EQ(reader.F64(21, "a"), 1e-300);
}

TEST(ByteReader, NaNPassesThrough) {
  testing::ByteWriter writer;
  writer.F64(0, std::numeric_limits<double>::quiet_NaN());
  EXPECT_TRUE(std::isnan(ByteReader(AsBytes(writer.bytes()), "f").F64(0, "a")));
}

TEST(ByteReader, NamesFileByteAndFieldWhereTheDataEnd) {
  const std::string bytes = "12345";
  const ByteReader reader(AsBytes(bytes), "ping.raw", 1000);
  EXPECT_EQ(reader.U32(1, "gain"), 0x35343332u);
  EXPECT_THAT(
      [&] { reader.U32(2, "gain"); },
      ThrowsMessage<DataError>("ping.raw: byte 1002: gain: 4 bytes expected, but the data end at byte 1005"));
}

TEST(ByteReader, OffsetsNearTheLargestNumberDoNotWrapAround) {
  const std::string bytes = "12345";
  const ByteReader reader(AsBytes(bytes), "f");
  const std::uint64_t largest = std::numeric_limits<std::uint64_t>::max();
  EXPECT_THROW(reader.U32(largest - 1, "a"), DataError);
  EXPECT_THROW(reader.Bytes(2, largest, "a"), DataError);
  EXPECT_EQ(reader.Bytes(5, 0, "a").size(), 0u);
}

TEST(LittleEndian, PutsOneToFourBytesTogether) {
  const std::string bytes = "\x01\x02\x03\x84";
  EXPECT_EQ(LittleEndian(AsBytes(bytes).first(1)), 0x01u);
  EXPECT_EQ(LittleEndian(AsBytes(bytes).first(3)), 0x030201u);
  EXPECT_EQ(LittleEndian(AsBytes(bytes)), 0x84030201u);
}

TEST(ReadFileRange, ReadsAPartAndRefusesRangesBeyondTheFile) {
  const testing::TempDir dir;
  testing::WriteFile(dir / "f", "0123456789");
  EXPECT_EQ(RegularFileSize(dir / "f"), 10u);
  EXPECT_EQ(ReadFileRange(dir / "f", 8, 2, "tail")[0], std::byte{'8'});
  EXPECT_THAT([&] { ReadFileRange(dir / "f", 8, 3, "tail"); },
              ThrowsMessage<DataError>(HasSubstr("byte 8: tail: 2 bytes could be read, expected 3")));
  EXPECT_THROW(ReadFileRange(dir / "absent", 0, 1, "head"), DataError);
  EXPECT_THROW(RegularFileSize(dir / "absent"), DataError);
  EXPECT_THROW(RegularFileSize(dir.path()), DataError);
}

}  // namespace
}  // namespace sonarcal::data_io
