// Layout of bags of ROS 1, format 2.0 (`.bag`): kRos1Magic, then records. Each record has a u32 header
// length, the fields of the header, a u32 data length and the data. Each field is a u32 length, a name, '='
// and a value. All numbers are little-endian. A time is a u32 of seconds and a u32 of nanoseconds. The field
// `op` tells the kind of the record:
//
//   op  record        fields of the header                  data
//   2   message       conn u32, time                        the serialised message
//   3   bag header    index_pos u64, conn_count u32,        blanks: it is written again at the end
//                     chunk_count u32, encryptor
//   4   index data    ver u32 = 1, conn u32, count u32      of the chunk before: count x (time, offset u32)
//   5   chunk         compression none|bz2|lz4, size u32    records of op 2 and 7; size: their inflated bytes
//   6   chunk info    ver u32 = 1, chunk_pos u64,           count x (conn u32, messages u32)
//                     start_time, end_time, count u32
//   7   connection    conn u32, topic                       fields topic, type, md5sum, message_definition
//
// index_pos is the position of the first connection after all chunks. Chunk infos follow the connections.
//
// Source: wiki.ros.org/Bags/Format/2.0.
#pragma once

#include <cstdint>
#include <string_view>

namespace sonarcal::data_io {

inline constexpr std::string_view kRos1Magic = "#ROSBAG V2.0\n";

enum class Ros1Op : std::uint8_t {
  kMessage = 2,
  kBagHeader = 3,
  kIndexData = 4,
  kChunk = 5,
  kChunkInfo = 6,
  kConnection = 7,
};

}  // namespace sonarcal::data_io
