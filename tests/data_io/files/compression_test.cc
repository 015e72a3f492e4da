#include "data_io/files/compression.h"

#include <gtest/gtest.h>
#include <zstd.h>

#include <algorithm>
#include <memory>
#include <random>

#include "core/types/error.h"
#include "tests/data_io/made_up_bag.h"
#include "tests/data_io/refusal.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::data_io {
namespace {

constexpr Codec kCodecs[] = {Codec::kNone, Codec::kLz4, Codec::kZstd};

// Bytes of which about half can be saved.
std::vector<std::byte> SomeBytes(std::size_t count) {
  std::mt19937 random(1);
  std::vector<std::byte> bytes(count);
  for (std::byte& byte : bytes) byte = static_cast<std::byte>(random() % 16);
  return bytes;
}

// A frame written as a stream: its size is not stated, and its window is that of `window_log`.
std::vector<std::byte> StreamedFrame(const std::vector<std::byte>& bytes, int window_log) {
  const std::unique_ptr<ZSTD_CCtx, std::size_t (*)(ZSTD_CCtx*)> context(ZSTD_createCCtx(), ZSTD_freeCCtx);
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_windowLog, window_log);
  std::vector<std::byte> packed(ZSTD_compressBound(bytes.size()));
  ZSTD_inBuffer in{bytes.data(), bytes.size(), 0};
  ZSTD_outBuffer out{packed.data(), packed.size(), 0};
  ZSTD_compressStream2(context.get(), &out, &in, ZSTD_e_flush);
  EXPECT_EQ(ZSTD_compressStream2(context.get(), &out, &in, ZSTD_e_end), 0U);
  packed.resize(out.pos);
  return packed;
}

TEST(CompressionTest, BytesComeBackFromEveryCodec) {
  for (const Codec codec : kCodecs) {
    for (const std::size_t count : {0, 1, 1000, 3'000'000}) {
      const std::vector<std::byte> bytes = SomeBytes(count);
      const std::vector<std::byte> packed = Compress(codec, bytes);
      const Inflated inflated = Inflate(codec, packed, count);
      EXPECT_EQ(inflated.end, Inflated::End::kWhole);
      EXPECT_EQ(inflated.bytes, bytes);
      EXPECT_EQ(IsZstd(packed), codec == Codec::kZstd);
      EXPECT_EQ(Inflate(codec, packed, ~std::uint64_t{0}).bytes, bytes);
    }
  }
}

TEST(CompressionTest, TheEndOfABlockIsReported) {
  const std::vector<std::byte> bytes = SomeBytes(600'000);
  for (const Codec codec : {Codec::kLz4, Codec::kZstd}) {
    std::vector<std::byte> packed = Compress(codec, bytes);
    const Inflated start = Inflate(codec, packed, 1000);
    EXPECT_EQ(start.end, Inflated::End::kMore);
    EXPECT_TRUE(std::equal(start.bytes.begin(), start.bytes.end(), bytes.begin()));
    EXPECT_EQ(start.bytes.size(), 1000U);
    const Inflated cut = Inflate(codec, std::span(packed).first(packed.size() / 2), bytes.size());
    EXPECT_EQ(cut.end, Inflated::End::kCut);
    EXPECT_GT(cut.bytes.size(), 100'000U);
    EXPECT_TRUE(std::equal(cut.bytes.begin(), cut.bytes.end(), bytes.begin()));
    EXPECT_EQ(Inflate(codec, {}, 1000).end, Inflated::End::kCut);
    packed[0] ^= std::byte{1};
    const Inflated damaged = Inflate(codec, packed, bytes.size());
    EXPECT_EQ(damaged.end, Inflated::End::kDamaged);
    EXPECT_FALSE(damaged.fault.empty());
  }
}

// Streams follow each other where bzip2 has compressed on several cores.
TEST(CompressionTest, Bzip2StreamsAreRead) {
  const std::vector<std::byte> bytes = SomeBytes(300'000);
  const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  std::string packed = testing::PackedBytes(text.substr(0, 1000), "bz2");
  const std::size_t second = packed.size();
  packed += testing::PackedBytes(text.substr(1000), "bz2");
  const auto part = [&](std::size_t count) { return std::as_bytes(std::span(packed).first(count)); };
  const Inflated whole = Inflate(Codec::kBzip2, part(packed.size()), bytes.size());
  EXPECT_EQ(whole.end, Inflated::End::kWhole) << whole.fault;
  EXPECT_EQ(whole.bytes, bytes);
  EXPECT_EQ(Inflate(Codec::kBzip2, part(packed.size()), 1500).end, Inflated::End::kMore);
  EXPECT_EQ(Inflate(Codec::kBzip2, part(second), bytes.size()).bytes.size(), 1000U);
  EXPECT_EQ(Inflate(Codec::kBzip2, part(packed.size() - 1), bytes.size()).end, Inflated::End::kCut);
  EXPECT_EQ(Inflate(Codec::kBzip2, {}, bytes.size()).end, Inflated::End::kCut);
  packed[second + 40] ^= 1;
  const Inflated damaged = Inflate(Codec::kBzip2, part(packed.size()), bytes.size());
  EXPECT_EQ(damaged.end, Inflated::End::kDamaged);
  EXPECT_EQ(damaged.fault, "no valid bzip2 data");
  EXPECT_THROW(Compress(Codec::kBzip2, bytes), DataError);
}

// Made by librosbag-storage 1.15 and by its roslz4.compress, with the same bytes.
TEST(CompressionTest, FramesOfRos1AreRead) {
  constexpr unsigned char kFrame[] = {0x04, 0x22, 0x4d, 0x18, 0x64, 0x60, 0x85, 0x34, 0x00, 0x00, 0x00, 0x6f,
                                      0x73, 0x6f, 0x6e, 0x61, 0x72, 0x20, 0x06, 0x00, 0x5f, 0xf0, 0x19, 0x00,
                                      0x01, 0x02, 0x03, 0x04, 0x05, 0x06, 0x07, 0x08, 0x09, 0x0a, 0x0b, 0x0c,
                                      0x0d, 0x0e, 0x0f, 0x10, 0x11, 0x12, 0x13, 0x14, 0x15, 0x16, 0x17, 0x18,
                                      0x19, 0x1a, 0x1b, 0x1c, 0x1d, 0x1e, 0x1f, 0x20, 0x21, 0x22, 0x23, 0x24,
                                      0x25, 0x26, 0x27, 0x00, 0x00, 0x00, 0x00, 0xfe, 0xed, 0x5f, 0x1f};
  std::string text;
  for (int i = 0; i < 20; ++i) text += "sonar ";
  for (char c = 0; c < 40; ++c) text += c;
  const Inflated inflated = Inflate(Codec::kLz4, std::as_bytes(std::span(kFrame)), text.size());
  EXPECT_EQ(inflated.end, Inflated::End::kWhole) << inflated.fault;
  const auto expected = std::as_bytes(std::span(text));
  EXPECT_TRUE(std::ranges::equal(inflated.bytes, expected));
}

// A window is that of the compression level, not that of the content.
TEST(CompressionTest, ShortFramesWithWideWindowsAreRead) {
  const std::vector<std::byte> bytes = SomeBytes(500);
  for (const int window_log : {10, 21, 27}) {
    const Inflated inflated = Inflate(Codec::kZstd, StreamedFrame(bytes, window_log), bytes.size());
    EXPECT_EQ(inflated.end, Inflated::End::kWhole) << inflated.fault;
    EXPECT_EQ(inflated.bytes, bytes);
  }
  EXPECT_EQ(Inflate(Codec::kZstd, StreamedFrame(bytes, 28), bytes.size()).end, Inflated::End::kDamaged);
}

TEST(CompressionTest, APlainFileIsTheFileItselfOrItsInflatedCopy) {
  const testing::TempDir dir;
  testing::WriteFile(dir / "plain", "some text");
  EXPECT_EQ(PlainFile(dir / "plain").path(), dir / "plain");
  const std::vector<std::byte> bytes = SomeBytes(2'500'000);
  const std::vector<std::byte> packed = StreamedFrame(bytes, 23);
  testing::WriteFile(dir / "packed", {reinterpret_cast<const char*>(packed.data()), packed.size()});
  std::filesystem::path copy;
  {
    const PlainFile file(dir / "packed");
    copy = file.path();
    EXPECT_EQ(file.name(), (dir / "packed").string());
    EXPECT_EQ(testing::ReadFile(copy),
              std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  }
  EXPECT_FALSE(std::filesystem::exists(copy));
  EXPECT_EQ(FirstPlainBytes(dir / "packed", 7), SomeBytes(7));
}

}  // namespace
}  // namespace sonarcal::data_io
