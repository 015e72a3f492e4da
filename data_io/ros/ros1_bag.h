// Bags of ROS 1, format 2.0 (`.bag`): "#ROSBAG V2.0\n", then records. Each record has a u32 header length,
// the fields of the header, a u32 data length and the data. Each field is a u32 length, a name, '=' and a
// value. All numbers are little-endian. The field `op` tells the kind of the record:
//
//   op  record        fields of the header                  data
//   2   message       conn u32, time                        the serialised message
//   3   bag header    index_pos u64, conn_count u32,        blanks
//                     chunk_count u32, encryptor (refused)
//   4   index data    ver u32 = 1, conn u32, count u32      of the chunk before: count x (u32 s, ns, offset)
//   5   chunk         compression none|bz2|lz4, size u32    records of op 2 and 7; size: their inflated bytes
//   6   chunk info    (not read)
//   7   connection    conn u32, topic                       fields type, md5sum, message_definition
//
// Source: wiki.ros.org/Bags/Format/2.0.
//
// librosbag-storage inflates the chunks and does no more. Its own reader trusts the offsets inside a chunk,
// and it refuses a bag whose recording was cut off. Here each record's head is compared with the file before
// a message is read. A damaged record and all that follows it are omitted with a note, and missing
// connections are looked up inside the chunks.
#pragma once

#include <filesystem>
#include <memory>

#include "data_io/ros/bag.h"

namespace sonarcal::data_io {

// Throws DataError for a file of another version, an encrypted bag, and a file that cannot be read.
std::unique_ptr<Bag> OpenRos1Bag(const std::filesystem::path& file);

}  // namespace sonarcal::data_io
