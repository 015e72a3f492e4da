// Takes the place of ros2_bag.cc in a build without SONARCAL_WITH_ROS.
#include "core/types/error.h"
#include "data_io/ros/ros2_bag.h"

namespace sonarcal::data_io {

std::unique_ptr<Bag> OpenRos2Bag(const std::vector<std::filesystem::path>& files) {
  throw DataError(
      "{}: a bag of ROS 2 in SQLite storage, but this sonarcal was built without it "
      "(SONARCAL_WITH_ROS)",
      files.front().string());
}

}  // namespace sonarcal::data_io
