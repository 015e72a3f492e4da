// Compressed blocks of bytes: LZ4 frames, Zstandard frames and bzip2 streams, as bags of ROS use them.
//
// The output grows with the inflated bytes, up to the limit of the caller. A claimed size is never allocated
// unchecked.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace sonarcal::data_io {

enum class Codec { kNone, kLz4, kZstd, kBzip2 };

// Bytes that came out of a block, and how the block ended.
struct Inflated {
  enum class End {
    kWhole,    // the last frame is complete
    kCut,      // the block ends within a frame
    kMore,     // max_bytes came out, and there is more
    kDamaged,  // the library refused the block; `fault` says why
  };
  std::vector<std::byte> bytes;
  End end = End::kWhole;
  std::string fault;
};

// Inflates frames that follow each other, up to `max_bytes`. With kNone the bytes are copied. Never throws
// because of the content of `packed`.
Inflated Inflate(Codec codec, std::span<const std::byte> packed, std::uint64_t max_bytes);

// One frame or stream. The blocks of an LZ4 frame do not depend on each other, which ROS 1 requires. Throws
// DataError if the library fails.
std::vector<std::byte> Compress(Codec codec, std::span<const std::byte> bytes);

// True if the bytes begin with the magic number of a Zstandard frame, which has kZstdMagicBytes.
inline constexpr std::size_t kZstdMagicBytes = 4;
bool IsZstd(std::span<const std::byte> bytes);

// A file to be read from its start to its end: the file itself or, if it is one of Zstandard frames, an
// inflated copy in the folder of temporary files, which is removed with the object.
class PlainFile {
 public:
  // Throws DataError if a compressed file is damaged or cut off, inflates to more than a recording plausibly
  // does (kMaxInflationRatio), or the copy cannot be written.
  explicit PlainFile(const std::filesystem::path& file);
  ~PlainFile();
  PlainFile(const PlainFile&) = delete;
  PlainFile& operator=(const PlainFile&) = delete;

  const std::filesystem::path& path() const { return copy_.empty() ? file_ : copy_; }
  std::string name() const { return file_.string(); }  // for messages

 private:
  void FillCopy(int descriptor) const;

  std::filesystem::path file_;
  std::filesystem::path copy_;  // empty: none
};

// First bytes of a file, at most `max_bytes`.
std::vector<std::byte> FirstBytes(const std::filesystem::path& file, std::size_t max_bytes);

// First bytes of the content of a file, at most `max_bytes`: inflated if it is a file of Zstandard frames.
std::vector<std::byte> FirstPlainBytes(const std::filesystem::path& file, std::size_t max_bytes);

// Largest plausible ratio of inflated to compressed bytes of a recording, beyond kMinInflationLimit.
inline constexpr std::uint64_t kMaxInflationRatio = 1000;
inline constexpr std::uint64_t kMinInflationLimit = 64 << 20;

}  // namespace sonarcal::data_io
