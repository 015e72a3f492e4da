#include "data_io/files/file_bytes.h"

#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <system_error>

#include "core/types/error.h"

namespace sonarcal::data_io {

std::string ReadFileBytes(const std::filesystem::path& file, std::size_t max_bytes) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) throw DataError("{}: no such file", file.string());
  if (!std::filesystem::is_regular_file(status)) throw DataError("{}: not a file", file.string());
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (error) throw DataError("{}: cannot be read: {}", file.string(), error.message());
  if (size > max_bytes) {
    throw DataError("{}: {} bytes, expected at most {}", file.string(), size, max_bytes);
  }

  std::ifstream stream(file, std::ios::binary);
  std::string bytes(static_cast<std::size_t>(size), '\0');
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!stream.is_open() || stream.bad()) {
    throw DataError("{}: cannot be read: {}", file.string(), std::generic_category().message(errno));
  }
  bytes.resize(static_cast<std::size_t>(stream.gcount()));
  return bytes;
}

std::string_view WithoutByteOrderMark(std::string_view text) {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  return text.starts_with(kMark) ? text.substr(kMark.size()) : text;
}

int WriteAll(int descriptor, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return 0;
}

std::error_code LastError() {
  return {errno != 0 ? errno : EIO, std::generic_category()};
}

void FailToWrite(const std::filesystem::path& path, const std::error_code& error) {
  throw DataError("{}: cannot be written: {}", path.string(), error.message());
}

void RefuseWhatIsNoFile(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    throw DataError("{}: cannot be written: there is a {} of this name, expected a file or nothing",
                    path.string(), std::filesystem::is_directory(status) ? "directory" : "device");
  }
}

}  // namespace sonarcal::data_io
