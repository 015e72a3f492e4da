// Bags of ROS 1, format 2.0 (`.bag`): a sequence of records, each a header of "name=value" fields, and data.
//
// "#ROSBAG V2.0\n", then records, little-endian: u32 header length; for each field u32 length, name, '=',
// value; u32 data length, data. A field `op` gives the type:
//
//   3 bag header   index_pos u64, conn_count u32, chunk_count u32; encryptor, which is rejected
//   5 chunk        compression "none", "bz2" or "lz4", size u32 inflated; data: records of op 2 and 7
//   4 index data   after its chunk: ver u32 = 1, conn u32, count u32; data: count x (u32 s, u32 ns, u32
//                  offset)
//   7 connection   conn u32, topic; data: fields type, md5sum, message_definition
//   2 message      conn u32, time
//   6 chunk info   not needed
//
// Source: wiki.ros.org/Bags/Format/2.0.
//
// The header of every record is read and checked against the file before any message; no length is trusted.
// Records after a damaged one are omitted with a note. A truncated bag is therefore read up to its end, with
// its connections taken from the chunks. librosbag-storage inflates the chunks (data_io/ros/ros1_chunk.h) and
// does nothing else, because its own reader trusts the offsets inside a chunk.
#pragma once

#include <filesystem>
#include <memory>

#include "data_io/ros/bag.h"

namespace sonarcal::data_io {

// True if the file begins with "#ROSBAG V".
bool IsRos1Bag(const std::filesystem::path& path);

std::unique_ptr<Bag> OpenRos1Bag(const std::filesystem::path& file);

}  // namespace sonarcal::data_io
