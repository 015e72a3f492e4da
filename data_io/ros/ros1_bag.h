// Bags of ROS 1, format 2.0 (`.bag`): records of a header, "name=value" fields, and data, one after the
// other.
//
//   "#ROSBAG V2.0\n", then records: u32 header length, for each field u32 length, name, '=', value; u32 data
//   length, data; little-endian. A field `op` says what it is:
//   3 bag header   index_pos u64, conn_count u32, chunk_count u32; encryptor, which is refused
//   5 chunk        compression "none", "bz2" or "lz4", size u32 inflated; data: records of op 2 and 7
//   4 index data   after its chunk: ver u32 = 1, conn u32, count u32; data: count x (u32 s, u32 ns, u32
//   offset) 7 connection   conn u32, topic; data: fields type, md5sum, message_definition 2 message      conn
//   u32, time 6 chunk info   not needed
// Source: wiki.ros.org/Bags/Format/2.0.
//
// Every record's head is read and checked against the file before any message is; no length is believed. What
// follows a damaged record is left out with a note, so that a bag whose recording was cut off is read as far
// as it goes, its connections being looked up inside the chunks. librosbag-storage inflates the chunks
// (data_io/ros/ros1_chunk.h) and does no more, as its own reader trusts the offsets inside a chunk.
#pragma once

#include <filesystem>
#include <memory>

#include "data_io/ros/bag.h"

namespace sonarcal::data_io {

// True where the file begins with "#ROSBAG V".
bool IsRos1Bag(const std::filesystem::path& path);

std::unique_ptr<Bag> OpenRos1Bag(const std::filesystem::path& file);

}  // namespace sonarcal::data_io
