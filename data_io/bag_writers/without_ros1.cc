// Takes the place of ros1_bag_writer.cc in a build without SONARCAL_WITH_ROS.
#include "core/types/error.h"
#include "data_io/bag_writers/ros1_bag_writer.h"

namespace sonarcal::data_io {

void WriteRos1Bag(const RecordingSource&, const std::filesystem::path& file,
                  const std::function<void(int)>&) {
  throw DataError("{}: a ROS bag (.bag), but this sonarcal was built without ROS support (SONARCAL_WITH_ROS)",
                  file.string());
}

}  // namespace sonarcal::data_io
