// SHA-256 (FIPS 180-4), by which provenance names the input files of a run.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace sonarcal {

class Sha256 {
 public:
  void Update(std::string_view bytes);

  // 64 hexadecimal digits. Ends the computation: no Update may follow.
  std::string HexDigest();

 private:
  void ProcessBlock(const unsigned char* block);

  std::array<std::uint32_t, 8> state_ = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                         0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  std::array<unsigned char, 64> pending_ = {};
  std::size_t pending_count_ = 0;
  std::uint64_t byte_count_ = 0;
};

// Of a file's content, read piece by piece. Throws DataError where it can't be read.
std::string Sha256OfFile(const std::filesystem::path& file);

}  // namespace sonarcal
