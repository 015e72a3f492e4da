// The compressed chunks of ROS 1 bags, inflated by librosbag-storage: the one place that uses it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace sonarcal::data_io {

enum class Ros1Compression { kNone, kBz2, kLz4 };

// `bytes` comes out, the caller having checked that it is no more than he wants to hold. Throws DataError
// beginning with `where` where the data are damaged.
std::vector<std::byte> InflateRos1Chunk(std::span<const std::byte> packed, Ros1Compression compression,
                                        std::uint32_t bytes, const std::string& where);

}  // namespace sonarcal::data_io
