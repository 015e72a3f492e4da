#include "data_io/files/hash.h"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <array>
#include <cstddef>
#include <fstream>
#include <memory>

#include "core/types/error.h"

namespace sonarcal::data_io {
namespace {

class Hasher {
 public:
  Hasher() : context_(EVP_MD_CTX_new(), EVP_MD_CTX_free) {
    SONARCAL_CHECK(EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) == 1, "no SHA-256 in libcrypto");
  }

  void Add(std::string_view bytes) {
    SONARCAL_CHECK(EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size()) == 1, "{} bytes",
                   bytes.size());
  }

  std::string Digits() {
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
    unsigned size = 0;
    SONARCAL_CHECK(EVP_DigestFinal_ex(context_.get(), digest.data(), &size) == 1, "no digest");
    std::string digits;
    for (unsigned i = 0; i < size; ++i) digits += fmt::format("{:02x}", digest[i]);
    return digits;
  }

 private:
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
};

}  // namespace

std::string Sha256(std::string_view bytes) {
  Hasher hasher;
  hasher.Add(bytes);
  return hasher.Digits();
}

std::string Sha256OfFile(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  Hasher hasher;
  std::array<char, 1 << 16> piece{};
  do {
    stream.read(piece.data(), piece.size());
    hasher.Add({piece.data(), static_cast<std::size_t>(stream.gcount())});
  } while (stream);
  // A directory can be opened but not read; only a regular end of file gives a valid digest.
  if (!stream.is_open() || !stream.eof()) throw DataError("{}: cannot be read", file.string());
  return hasher.Digits();
}

}  // namespace sonarcal::data_io
