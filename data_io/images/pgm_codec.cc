#include "data_io/images/pgm_codec.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <sstream>
#include <string>

#include "core/types/error.h"
#include "data_io/files/file_bytes.h"

namespace sonarcal::data_io {

Grid<float> ReadPgm(const std::filesystem::path& file, int rows, int cols) {
  constexpr std::size_t kMaxHeaderBytes = 4096;
  const std::string name = file.string();
  Grid<float> grey(rows, cols);
  const std::string bytes = ReadFileBytes(file, grey.size() + kMaxHeaderBytes);
  if (!bytes.starts_with("P5")) throw DataError("{}: byte 0: expected \"P5\" (binary PGM)", name);
  std::istringstream header(bytes.substr(2, kMaxHeaderBytes));
  std::array<int, 3> numbers{};  // columns, rows, largest value
  for (int& number : numbers) {
    while ((header >> std::ws).peek() == '#') header.ignore(kMaxHeaderBytes, '\n');
    header >> number;
  }
  if (numbers[0] != cols || numbers[1] != rows || numbers[2] < 1 || numbers[2] > 255) {
    throw DataError("{}: a picture of {} rows x {} columns up to {}, expected {} x {} up to 255", name,
                    numbers[1], numbers[0], numbers[2], rows, cols);
  }
  header.clear();  // the end of the text may follow the last number
  const std::size_t begin =
      std::min(bytes.size(), 3 + static_cast<std::size_t>(header.tellg()));  // one blank
  if (bytes.size() - begin < grey.size()) {
    throw DataError("{}: {} bytes of pixels, expected {}", name, bytes.size() - begin, grey.size());
  }
  std::copy_n(reinterpret_cast<const std::uint8_t*>(&bytes[begin]), grey.size(), grey.values().begin());
  return grey;
}

}  // namespace sonarcal::data_io
