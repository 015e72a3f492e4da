// Takes the place of ros1_bag.cc and ros2_bag.cc in a build without SONARCAL_WITH_ROS.
#include "core/types/error.h"
#include "data_io/ros/ros1_bag.h"
#include "data_io/ros/ros2_bag.h"

namespace sonarcal::data_io {
namespace {

[[noreturn]] void Refuse(const std::filesystem::path& file) {
  throw DataError(
      "{}: a ROS bag (.bag or .db3), but this sonarcal was built without ROS support (SONARCAL_WITH_ROS)",
      file.string());
}

}  // namespace

std::unique_ptr<Bag> OpenRos1Bag(const std::filesystem::path& file) {
  Refuse(file);
}

std::unique_ptr<Bag> OpenRos2Bag(const std::vector<std::filesystem::path>& files) {
  Refuse(files.front());
}

}  // namespace sonarcal::data_io
