#include "data_io/images/pgm_codec.h"

#include <charconv>
#include <string>

#include "core/types/error.h"
#include "data_io/files/file_bytes.h"

namespace sonarcal::data_io {
namespace {

bool IsBlank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

// Next number after blanks and comments.
int NextNumber(const std::string& bytes, std::size_t& at, const std::string& name) {
  while (at < bytes.size() && (IsBlank(bytes[at]) || bytes[at] == '#')) {
    if (bytes[at] == '#') at = std::min(bytes.size(), bytes.find('\n', at));
    if (at < bytes.size()) ++at;
  }
  int value = 0;
  const auto [end, error] = std::from_chars(bytes.data() + at, bytes.data() + bytes.size(), value);
  if (error != std::errc()) throw DataError("{}: byte {}: a PGM header's number was expected", name, at);
  at = static_cast<std::size_t>(end - bytes.data());
  return value;
}

}  // namespace

Grid<float> ReadPgm(const std::filesystem::path& file, int rows, int cols) {
  constexpr std::size_t kMostHeaderBytes = 4096;
  const std::string name = file.string();
  Grid<float> grey(rows, cols);
  const std::string bytes = ReadFileBytes(file, grey.size() + kMostHeaderBytes);
  if (!bytes.starts_with("P5")) throw DataError("{}: byte 0: expected \"P5\" (binary PGM)", name);
  std::size_t at = 2;
  const int found_cols = NextNumber(bytes, at, name);
  const int found_rows = NextNumber(bytes, at, name);
  const int largest = NextNumber(bytes, at, name);
  if (found_rows != rows || found_cols != cols || largest < 1 || largest > 255) {
    throw DataError("{}: a picture of {} rows x {} columns up to {}, expected {} x {} up to 255", name,
                    found_rows, found_cols, largest, rows, cols);
  }
  ++at;  // one blank
  if (at > bytes.size() || bytes.size() - at < grey.size()) {
    throw DataError("{}: {} bytes of pixels, expected {}", name, bytes.size() - std::min(at, bytes.size()),
                    grey.size());
  }
  for (float& value : grey.values()) value = static_cast<unsigned char>(bytes[at++]);
  return grey;
}

}  // namespace sonarcal::data_io
