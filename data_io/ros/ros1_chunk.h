// Inflates the compressed chunks of ROS 1 bags by librosbag-storage; the only file that reads with it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace sonarcal::data_io {

enum class Ros1Compression { kNone, kBz2, kLz4 };

// Returns `bytes` bytes; the caller has checked that this is acceptable. Throws DataError, beginning with
// `where`, if the data are damaged.
std::vector<std::byte> InflateRos1Chunk(std::span<const std::byte> packed, Ros1Compression compression,
                                        std::uint32_t bytes, const std::string& where);

}  // namespace sonarcal::data_io
