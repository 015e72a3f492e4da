#include "data_io/files/compression.h"

#include <bzlib.h>
#include <lz4frame.h>
#include <unistd.h>
#include <zstd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <string_view>
#include <system_error>

#include "core/types/error.h"
#include "data_io/files/byte_reader.h"
#include "data_io/files/file_bytes.h"

namespace sonarcal::data_io {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kFirstOutputBytes = 64 << 10;

// Grows `bytes` for more output, at most to `max_bytes`. Returns false if it has that size already.
bool Grow(std::vector<std::byte>& bytes, std::uint64_t max_bytes) {
  if (bytes.size() >= max_bytes) return false;
  bytes.resize(std::min(max_bytes, std::max<std::uint64_t>(kFirstOutputBytes, 2 * bytes.size())));
  return true;
}

// A step of a decoder: bytes taken and given, whether a frame is complete, and why it failed, if it did.
struct Step {
  std::size_t taken = 0;
  std::size_t given = 0;
  bool frame_is_complete = false;
  const char* fault = nullptr;
};

class Lz4Decoder {
 public:
  Lz4Decoder() {
    SONARCAL_CHECK(!LZ4F_isError(LZ4F_createDecompressionContext(&context_, LZ4F_VERSION)),
                   "lz4 has no memory");
  }
  ~Lz4Decoder() { LZ4F_freeDecompressionContext(context_); }
  Lz4Decoder(const Lz4Decoder&) = delete;
  Lz4Decoder& operator=(const Lz4Decoder&) = delete;

  Step Next(std::span<const std::byte> in, std::span<std::byte> out) {
    std::size_t taken = in.size();
    std::size_t given = out.size();
    const std::size_t result = LZ4F_decompress(context_, out.data(), &given, in.data(), &taken, nullptr);
    if (LZ4F_isError(result) != 0) return {.fault = LZ4F_getErrorName(result)};
    return {taken, given, result == 0, nullptr};
  }

 private:
  LZ4F_dctx* context_ = nullptr;
};

// Refuses frames that require a window of more than 128 MiB, which is the limit of zstd itself. Frames that
// were written as a stream require the window of their compression level, however short they are.
class ZstdDecoder {
 public:
  ZstdDecoder() : context_(ZSTD_createDCtx(), ZSTD_freeDCtx) {
    SONARCAL_CHECK(context_ != nullptr, "zstd has no memory");
  }

  Step Next(std::span<const std::byte> in, std::span<std::byte> out) {
    ZSTD_inBuffer input{in.data(), in.size(), 0};
    ZSTD_outBuffer output{out.data(), out.size(), 0};
    const std::size_t result = ZSTD_decompressStream(context_.get(), &output, &input);
    if (ZSTD_isError(result) != 0) return {.fault = ZSTD_getErrorName(result)};
    return {input.pos, output.pos, result == 0, nullptr};
  }

 private:
  std::unique_ptr<ZSTD_DCtx, std::size_t (*)(ZSTD_DCtx*)> context_;
};

class Bzip2Decoder {
 public:
  Bzip2Decoder() { Begin(); }
  ~Bzip2Decoder() { BZ2_bzDecompressEnd(&stream_); }
  Bzip2Decoder(const Bzip2Decoder&) = delete;
  Bzip2Decoder& operator=(const Bzip2Decoder&) = delete;

  Step Next(std::span<const std::byte> in, std::span<std::byte> out) {
    const auto in_bytes = static_cast<unsigned>(std::min<std::size_t>(in.size(), kMaxStepBytes));
    const auto out_bytes = static_cast<unsigned>(std::min<std::size_t>(out.size(), kMaxStepBytes));
    // The library reads through this pointer only.
    stream_.next_in = const_cast<char*>(reinterpret_cast<const char*>(in.data()));
    stream_.avail_in = in_bytes;
    stream_.next_out = reinterpret_cast<char*>(out.data());
    stream_.avail_out = out_bytes;
    const int result = BZ2_bzDecompress(&stream_);
    if (result != BZ_OK && result != BZ_STREAM_END)
      return {.fault = result == BZ_MEM_ERROR ? "bzip2 has no memory" : "no valid bzip2 data"};
    if (result == BZ_STREAM_END) {
      BZ2_bzDecompressEnd(&stream_);
      Begin();
    }
    return {in_bytes - stream_.avail_in, out_bytes - stream_.avail_out, result == BZ_STREAM_END, nullptr};
  }

 private:
  static constexpr std::size_t kMaxStepBytes = 1 << 30;  // counts of bytes are unsigned int

  // Keeps the counts of bytes of the last step.
  void Begin() { SONARCAL_CHECK(BZ2_bzDecompressInit(&stream_, 0, 0) == BZ_OK, "bzip2 has no memory"); }

  bz_stream stream_ = {};
};

template <typename Decoder>
Inflated InflateWith(Decoder decoder, std::span<const std::byte> packed, std::uint64_t max_bytes) {
  Inflated inflated;
  std::vector<std::byte>& bytes = inflated.bytes;
  std::uint64_t size = 0;
  bool is_complete = false;
  // One byte more than wanted shows that there is more.
  const std::uint64_t capacity = max_bytes == ~std::uint64_t{0} ? max_bytes : max_bytes + 1;
  while (true) {
    if (size == bytes.size() && !Grow(bytes, capacity)) break;
    const Step step = decoder.Next(packed, std::span(bytes).subspan(size));
    if (step.fault != nullptr) {
      inflated.end = Inflated::End::kDamaged;
      inflated.fault = step.fault;
      break;
    }
    packed = packed.subspan(step.taken);
    size += step.given;
    is_complete = step.frame_is_complete;
    if (packed.empty() && (is_complete || step.given == 0)) {
      inflated.end = is_complete ? Inflated::End::kWhole : Inflated::End::kCut;
      break;
    }
    if (step.taken == 0 && step.given == 0) {
      inflated.end = Inflated::End::kDamaged;
      inflated.fault = "the decoder does not advance";
      break;
    }
  }
  if (size > max_bytes) {
    inflated.end = Inflated::End::kMore;
    size = max_bytes;
  }
  bytes.resize(size);
  return inflated;
}

}  // namespace

Inflated Inflate(Codec codec, std::span<const std::byte> packed, std::uint64_t max_bytes) {
  // An empty block of frames is no frame at all.
  if (codec != Codec::kNone && packed.empty()) return {.bytes = {}, .end = Inflated::End::kCut, .fault = {}};
  switch (codec) {
    case Codec::kLz4:
      return InflateWith<Lz4Decoder&>(*std::make_unique<Lz4Decoder>(), packed, max_bytes);
    case Codec::kZstd:
      return InflateWith<ZstdDecoder&>(*std::make_unique<ZstdDecoder>(), packed, max_bytes);
    case Codec::kBzip2:
      return InflateWith<Bzip2Decoder&>(*std::make_unique<Bzip2Decoder>(), packed, max_bytes);
    case Codec::kNone:
      break;
  }
  const bool is_more = packed.size() > max_bytes;
  const auto kept = is_more ? packed.first(max_bytes) : packed;
  return {{kept.begin(), kept.end()}, is_more ? Inflated::End::kMore : Inflated::End::kWhole, {}};
}

std::vector<std::byte> Compress(Codec codec, std::span<const std::byte> bytes) {
  std::vector<std::byte> packed;
  const auto fail = [&](const char* why) {
    throw DataError("{} bytes cannot be compressed: {}", bytes.size(), why);
  };
  switch (codec) {
    case Codec::kNone:
      packed.assign(bytes.begin(), bytes.end());
      break;
    case Codec::kLz4: {
      LZ4F_preferences_t preferences = {};
      preferences.frameInfo.blockMode = LZ4F_blockIndependent;
      preferences.frameInfo.contentChecksumFlag = LZ4F_contentChecksumEnabled;
      packed.resize(LZ4F_compressFrameBound(bytes.size(), &preferences));
      const std::size_t size =
          LZ4F_compressFrame(packed.data(), packed.size(), bytes.data(), bytes.size(), &preferences);
      if (LZ4F_isError(size) != 0) fail(LZ4F_getErrorName(size));
      packed.resize(size);
      break;
    }
    case Codec::kZstd: {
      packed.resize(ZSTD_compressBound(bytes.size()));
      const std::size_t size =
          ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), ZSTD_CLEVEL_DEFAULT);
      if (ZSTD_isError(size) != 0) fail(ZSTD_getErrorName(size));
      packed.resize(size);
      break;
    }
    case Codec::kBzip2:
      fail("bzip2 is only read");
  }
  return packed;
}

bool IsZstd(std::span<const std::byte> bytes) {
  return bytes.size() >= kZstdMagicBytes && LittleEndian(bytes.first(kZstdMagicBytes)) == ZSTD_MAGICNUMBER;
}

PlainFile::PlainFile(const fs::path& file) : file_(file) {
  if (!IsZstd(FirstBytes(file, kZstdMagicBytes))) return;
  std::error_code no_folder;
  std::string name = (fs::temp_directory_path(no_folder) / "sonarcal_XXXXXX").string();
  const int descriptor = no_folder ? -1 : mkstemp(name.data());
  if (descriptor < 0) {
    throw DataError("{}: cannot be written, for the inflated content of {}: {}", name, file.string(),
                    no_folder ? no_folder.message() : std::generic_category().message(errno));
  }
  copy_ = name;
  try {
    FillCopy(descriptor);
  } catch (...) {
    close(descriptor);
    std::error_code ignored;
    fs::remove(copy_, ignored);
    throw;
  }
  close(descriptor);
}

PlainFile::~PlainFile() {
  std::error_code ignored;
  if (!copy_.empty()) fs::remove(copy_, ignored);
}

void PlainFile::FillCopy(int descriptor) const {
  constexpr std::size_t kPieceBytes = 1 << 20;
  const std::uint64_t file_bytes = RegularFileSize(file_);
  const std::uint64_t limit = std::max(kMinInflationLimit, file_bytes * kMaxInflationRatio);
  ZstdDecoder decoder;
  std::vector<std::byte> out(kPieceBytes);
  std::uint64_t written = 0;
  bool is_complete = false;
  for (std::uint64_t offset = 0; offset < file_bytes; offset += kPieceBytes) {
    const std::vector<std::byte> piece =
        ReadFileRange(file_, offset, std::min<std::uint64_t>(kPieceBytes, file_bytes - offset), "content");
    std::span<const std::byte> rest = piece;
    std::size_t given = 0;
    while (!rest.empty() || given == out.size()) {
      const Step step = decoder.Next(rest, out);
      if (step.fault != nullptr) {
        throw DataError("{}: byte {}: the compressed content is damaged: {}", name(),
                        offset + piece.size() - rest.size(), step.fault);
      }
      rest = rest.subspan(step.taken);
      given = step.given;
      is_complete = step.frame_is_complete;
      written += given;
      if (written > limit) {
        throw DataError("{}: {} bytes inflate to more than {}, expected at most {} times as many", name(),
                        file_bytes, limit, kMaxInflationRatio);
      }
      if (const int error = WriteAll(descriptor, std::span(out).first(given)); error != 0) {
        throw DataError("{}: cannot be written, for the inflated content of {}: {}", copy_.string(), name(),
                        std::generic_category().message(error));
      }
      if (rest.empty() && is_complete) break;
    }
  }
  if (!is_complete) {
    throw DataError("{}: the compressed content ends after {} bytes within a frame: the file was cut off",
                    name(), file_bytes);
  }
}

std::vector<std::byte> FirstBytes(const fs::path& file, std::size_t max_bytes) {
  return ReadFileRange(file, 0, std::min<std::uint64_t>(max_bytes, RegularFileSize(file)), "first bytes");
}

std::vector<std::byte> FirstPlainBytes(const fs::path& file, std::size_t max_bytes) {
  constexpr std::size_t kFirstBlockBytes = 256 << 10;  // a block of a frame has at most 128 KiB
  std::vector<std::byte> bytes = FirstBytes(file, max_bytes);
  if (!IsZstd(bytes)) return bytes;
  return Inflate(Codec::kZstd, FirstBytes(file, kFirstBlockBytes), max_bytes).bytes;
}

}  // namespace sonarcal::data_io
