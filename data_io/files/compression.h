// Compressed blocks of bytes: LZ4 frames and Zstandard frames, as MCAP and ROS 2 use them.
//
// Output grows with what really comes out, up to a limit that the caller gives. A size that the bytes claim
// is never allocated on trust.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace sonarcal::data_io {

enum class Codec { kNone, kLz4, kZstd };

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

// One frame. Throws DataError if the library fails.
std::vector<std::byte> Compress(Codec codec, std::span<const std::byte> bytes);

// True if the bytes begin with the magic number of a Zstandard frame.
bool IsZstd(std::span<const std::byte> bytes);

// Inflated copy of a Zstandard file in the folder of temporary files, removed with the object.
class InflatedFile {
 public:
  // Throws DataError if the file is damaged or cut off, inflates to more than a recording plausibly does
  // (kMaxInflationRatio), or cannot be written.
  explicit InflatedFile(const std::filesystem::path& file);
  ~InflatedFile();
  InflatedFile(const InflatedFile&) = delete;
  InflatedFile& operator=(const InflatedFile&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  void Fill(const std::filesystem::path& file, int descriptor) const;

  std::filesystem::path path_;
};

// Largest plausible ratio of inflated to compressed bytes of a recording, beyond kMinInflationLimit.
inline constexpr std::uint64_t kMaxInflationRatio = 1000;
inline constexpr std::uint64_t kMinInflationLimit = 64 << 20;

}  // namespace sonarcal::data_io
