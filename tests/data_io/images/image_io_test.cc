#include "data_io/images/image_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <random>
#include <string_view>

#include "core/types/error.h"
#include "tests/data_io/byte_writer.h"
#include "tests/data_io/refusal.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::data_io {
namespace {

using testing::ExpectSurvivesDamage;
using ::testing::HasSubstr;
using testing::MessageOf;
using testing::ReadFile;
using ::testing::StartsWith;
using testing::TempDir;
using testing::WriteFile;

template <typename T>
Grid<T> RandomGrid(int rows, int cols, T largest) {
  Grid<T> grid(rows, cols);
  std::mt19937 random(7);
  for (T& value : grid.values()) value = static_cast<T>(random() % (static_cast<std::uint64_t>(largest) + 1));
  return grid;
}

void Decode(const std::string& bytes) {
  const ImageFile file(bytes, "x");
  EXPECT_LE(file.header().pixels(), kMaxImagePixels);
  if (file.header().channels == 1) {
    file.DecodeGrey();
  } else {
    file.DecodeRgb();
  }
}

std::string RefusalOfImage(const std::string& bytes) {
  return MessageOf([&] { Decode(bytes); });
}

std::string Text(const std::vector<std::uint8_t>& bytes) {
  return {bytes.begin(), bytes.end()};
}

std::string BigEndian(std::uint32_t value) {
  return {static_cast<char>(value >> 24), static_cast<char>(value >> 16), static_cast<char>(value >> 8),
          static_cast<char>(value)};
}

// TIFF of 2 x 2 pixels of 8 bits, 0 to 3, with a palette.
std::string SmallTiff(std::uint32_t photometric_interpretation) {
  constexpr std::uint32_t kPixels = 8;
  constexpr std::uint32_t kPalette = kPixels + 4;
  constexpr std::uint32_t kPaletteValues = 3 * 256;
  constexpr std::uint32_t kDirectory = kPalette + 2 * kPaletteValues;
  constexpr std::uint16_t kShort = 3;
  struct Tag {
    std::uint16_t id;
    std::uint32_t count;
    std::uint32_t value;
  };
  const Tag tags[] = {
      {256, 1, 2}, {257, 1, 2}, {258, 1, 8}, {259, 1, 1}, {262, 1, photometric_interpretation},
      {273, 1, 8}, {277, 1, 1}, {278, 1, 2}, {279, 1, 4}, {320, kPaletteValues, kPalette}};
  testing::ByteWriter file;
  file.U32(0, 0x002a4949);  // "II*"
  file.U32(4, kDirectory);
  file.U32(kPixels, 0x03020100);
  file.U16(kDirectory, static_cast<std::uint16_t>(std::size(tags)));
  std::size_t at = kDirectory + 2;
  for (const Tag& tag : tags) {
    file.U16(at, tag.id);
    file.U16(at + 2, kShort);
    file.U32(at + 4, tag.count);
    file.U32(at + 8, tag.value);
    at += 12;
  }
  file.Grow(at + 4);
  return file.bytes();
}

TEST(ImageIoTest, GreyPngComesBack) {
  const TempDir dir;
  const auto grey8 = RandomGrid<std::uint8_t>(13, 7, 255);
  const auto grey16 = RandomGrid<std::uint16_t>(5, 9, 65535);
  WritePng(dir / "8.png", grey8);
  WritePng(dir / "16.png", grey16);
  EXPECT_EQ(ImageFile(dir / "8.png").DecodeGrey8(), grey8);
  EXPECT_EQ(ImageFile(dir / "16.png").DecodeGrey16(), grey16);
  const Grid<float> value = ImageFile(dir / "16.png").DecodeGrey();
  EXPECT_EQ(value(4, 8), static_cast<float>(grey16(4, 8)));
}

TEST(ImageIoTest, AMaskIsOneWhereAGreyImageIsAboveZero) {
  const TempDir dir;
  Grid<std::uint16_t> grey(2, 2);
  grey(0, 1) = 1;
  grey(1, 0) = 0xffff;
  WritePng(dir / "mask.png", grey);
  const Mask mask = ReadMask(dir / "mask.png");
  EXPECT_EQ(mask(0, 0), 0);
  EXPECT_EQ(mask(0, 1), 1);
  EXPECT_EQ(mask(1, 0), 1);
  EXPECT_EQ(mask(1, 1), 0);
}

TEST(ImageIoTest, FloatTiffComesBack) {
  const TempDir dir;
  Grid<float> value(3, 2);
  value(0, 0) = -1.25e-30F;
  value(2, 1) = 3.4e38F;
  WriteTiff(dir / "a.tiff", value);
  EXPECT_EQ(ImageFile(dir / "a.tiff").DecodeGrey(), value);
  EXPECT_EQ(ImageFile(dir / "a.tiff").header().Describe(),
            "32-bit float grey, 3 x 2 pixels (rows x columns)");
}

TEST(ImageIoTest, ColourComesBackAndGreyBecomesColourOnlyWhenAsked) {
  const TempDir dir;
  RgbImage image(2, 3, {10, 20, 30});
  image(1, 2) = {255, 0, 7};
  WritePng(dir / "a.png", image);
  EXPECT_EQ(ImageFile(dir / "a.png").DecodeRgb(), image);
  EXPECT_THAT(MessageOf([&] { ImageFile(dir / "a.png").DecodeGrey(); }),
              HasSubstr("a.png: 8-bit colour, 2 x 3 pixels (rows x columns), expected 8-bit grey"));
  WritePng(dir / "b.png", Grid<std::uint16_t>(1, 1, 0x1234));
  EXPECT_EQ(ImageFile(dir / "b.png").DecodeRgb()(0, 0), (std::array<std::uint8_t, 3>{0x12, 0x12, 0x12}));
}

TEST(ImageIoTest, DepthsAreNotConvertedUnasked) {
  const TempDir dir;
  WritePng(dir / "8.png", Grid<std::uint8_t>(2, 2));
  EXPECT_THAT(MessageOf([&] { ImageFile(dir / "8.png").DecodeGrey16(); }), HasSubstr("expected 16-bit grey"));
  WriteTiff(dir / "a.tiff", Grid<float>(2, 2));
  EXPECT_THAT(MessageOf([&] { ImageFile(dir / "a.tiff").DecodeGrey8(); }), HasSubstr("expected 8-bit grey"));
  EXPECT_THAT(MessageOf([&] { ImageFile(dir / "a.tiff").DecodeRgb(); }), HasSubstr("expected a PNG"));
}

TEST(ImageIoTest, ATiffWhoseValuesAreNoGreyIsRefused) {
  constexpr std::uint32_t kWhiteIsZero = 0;
  constexpr std::uint32_t kBlackIsZero = 1;
  constexpr std::uint32_t kPalette = 3;
  EXPECT_EQ(ImageFile(SmallTiff(kBlackIsZero), "x").DecodeGrey8()(1, 1), 3);
  EXPECT_EQ(RefusalOfImage(SmallTiff(kPalette)),
            "x: TIFF photometric interpretation 3, expected 1 (grey, 0 is black)");
  EXPECT_THAT(RefusalOfImage(SmallTiff(kWhiteIsZero)), HasSubstr("photometric interpretation 0"));
}

// A palette is stored with 1 to 8 bits per pixel, so the file is smaller than its colours allow.
TEST(ImageIoTest, APalettePngOfFewBytesIsRead) {
  // 400 x 400 pixels of 1 bit, all of the second colour of the palette (0, 0, 0), (10, 20, 30).
  constexpr std::string_view kHex =
      "89504e470d0a1a0a0000000d4948445200000190000001900103000000ba71a48f00000006504c54450000000a141e7c"
      "51d62f000000564944415478daedcb310d00000c03a0fa37dd6ad8bbc04f7a1645511445511445511445511445511445"
      "511445511445511445511445511445511445511445511445511445511445511445511445511445511445f95e063cd8d6"
      "648730bbae0000000049454e44ae426082";
  std::string bytes;
  for (std::size_t i = 0; i < kHex.size(); i += 2)
    bytes += static_cast<char>(std::stoi(std::string(kHex.substr(i, 2)), nullptr, 16));
  const ImageFile file(bytes, "palette.png");
  EXPECT_EQ(file.header().Describe(), "8-bit colour, 400 x 400 pixels (rows x columns)");
  EXPECT_EQ(file.DecodeRgb(), RgbImage(400, 400, {10, 20, 30}));
  EXPECT_THAT(MessageOf([&] { file.DecodeGrey(); }), HasSubstr("expected 8-bit grey"));
}

TEST(ImageIoTest, EncodedPngIsTheFile) {
  const TempDir dir;
  const auto grey = RandomGrid<std::uint8_t>(4, 4, 255);
  WritePng(dir / "a.png", grey);
  const std::vector<std::uint8_t> encoded = EncodePng(grey);
  EXPECT_EQ(ReadFile(dir / "a.png"), std::string(encoded.begin(), encoded.end()));
}

TEST(ImageIoTest, OtherFilesAreRefused) {
  const TempDir dir;
  WriteFile(dir / "a.png", "GIF89a");
  EXPECT_THAT(MessageOf([&] { ImageFile(dir / "a.png"); }),
              HasSubstr("a.png: neither a PNG nor a TIFF file"));
  EXPECT_THAT(MessageOf([&] { ImageFile(dir / "none.png"); }), HasSubstr("none.png: no such file"));
}

TEST(ImageIoTest, APngThatEndsEarlyIsRefusedWhereverItIsCut) {
  const std::string bytes = Text(EncodePng(RandomGrid<std::uint8_t>(20, 20, 255)));
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    EXPECT_THAT(RefusalOfImage(bytes.substr(0, length)), StartsWith("x: "));
  }
}

TEST(ImageIoTest, ATiffThatEndsEarlyIsRefusedWhereverItIsCut) {
  const TempDir dir;
  WriteTiff(dir / "whole.tiff", Grid<float>(10, 10, 1.5F));
  const std::string bytes = ReadFile(dir / "whole.tiff");
  constexpr std::size_t kEndOfDirectory = 4;  // says that no image follows; nobody misses it
  for (std::size_t length = 0; length + kEndOfDirectory < bytes.size(); ++length) {
    EXPECT_THAT(RefusalOfImage(bytes.substr(0, length)), StartsWith("x: "));
  }
}

TEST(ImageIoTest, AWrongChecksumIsRefused) {
  std::string bytes = Text(EncodePng(RandomGrid<std::uint8_t>(20, 20, 255)));
  bytes[bytes.size() / 2] ^= 1;
  EXPECT_THAT(RefusalOfImage(bytes), StartsWith("x: damaged PNG: "));
}

TEST(ImageIoTest, AHeaderThatClaimsTooMuchIsRefusedBeforeDecoding) {
  // A valid header, its checksum included, and the beginning of no pixels.
  const auto header = [](std::uint32_t size, const std::string& checksum) {
    return std::string("\x89PNG\r\n\x1a\n") + BigEndian(13) + "IHDR" + BigEndian(size) + BigEndian(size) +
           std::string("\x08\0\0\0\0", 5) + checksum + BigEndian(0) + "IDAT" + "\x35\xaf\x06\x1e";
  };
  EXPECT_THAT(RefusalOfImage(header(100'000, "\x8d\x39\x54\x14")),
              StartsWith("x: an image of 100000 x 100000 pixels, expected at most"));
  EXPECT_THAT(
      RefusalOfImage(header(8000, "\x23\x9a\xf2\x28")),
      StartsWith("x: announces 8-bit grey, 8000 x 8000 pixels (rows x columns) but has only 45 bytes"));
}

TEST(ImageIoTest, DamagedPngIsReadOrRefused) {
  ExpectSurvivesDamage(Text(EncodePng(RandomGrid<std::uint8_t>(16, 16, 255))), 100, 3000, Decode);
  ExpectSurvivesDamage(Text(EncodePng(RgbImage(8, 8, {1, 2, 3}))), 100, 3000, Decode);
}

TEST(ImageIoTest, DamagedTiffIsReadOrRefused) {
  const TempDir dir;
  WriteTiff(dir / "a.tiff", Grid<float>(6, 5, 2.5F));
  ExpectSurvivesDamage(ReadFile(dir / "a.tiff"), 1000, 20'000, Decode);
}

TEST(ImageIoTest, ComplaintsOfTheLibrariesDoNotReachTheTerminal) {
  const TempDir dir;
  WriteTiff(dir / "a.tiff", Grid<float>(6, 5, 2.5F));
  ::testing::internal::CaptureStderr();
  ExpectSurvivesDamage(ReadFile(dir / "a.tiff"), 1000, 1000, Decode);
  ExpectSurvivesDamage(Text(EncodePng(RandomGrid<std::uint8_t>(16, 16, 255))), 100, 1000, Decode);
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace sonarcal::data_io
