// Reads bags of ROS 1, format 2.0 (`.bag`). The layout is that of data_io/ros/ros1_records.h.
//
// Each record's head is compared with the file before a message is read. A damaged record and all that
// follows it are omitted with a note. A bag that was cut off has no connections at its end, so they are
// looked up inside the chunks.
#pragma once

#include <filesystem>
#include <memory>

#include "data_io/ros/bag.h"

namespace sonarcal::data_io {

// Throws DataError for a file of another version, an encrypted bag, and a file that cannot be read.
std::unique_ptr<Bag> OpenRos1Bag(const std::filesystem::path& file);

}  // namespace sonarcal::data_io
