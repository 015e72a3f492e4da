#include "data_io/ros/ros1_chunk.h"

#include <rosbag/chunked_file.h>

#include <exception>

#include "core/types/error.h"

namespace sonarcal::data_io {

std::vector<std::byte> InflateRos1Chunk(std::span<const std::byte> packed, Ros1Compression compression,
                                        std::uint32_t bytes, const std::string& where) {
  if (compression == Ros1Compression::kNone) return {packed.begin(), packed.end()};
  std::vector<std::byte> inflated(bytes);
  // decompress takes its source by a non-const pointer.
  std::vector<std::byte> source(packed.begin(), packed.end());
  try {
    rosbag::ChunkedFile file;
    file.decompress(
        compression == Ros1Compression::kBz2 ? rosbag::compression::BZ2 : rosbag::compression::LZ4,
        reinterpret_cast<std::uint8_t*>(inflated.data()), bytes,
        reinterpret_cast<std::uint8_t*>(source.data()), static_cast<unsigned>(source.size()));
  } catch (const std::exception& error) {
    throw DataError("{}: the compressed chunk is damaged: {}", where, error.what());
  }
  return inflated;
}

}  // namespace sonarcal::data_io
