#include "data_io/ros/bag.h"

#include "core/types/error.h"
#include "core/types/printable.h"
#include "data_io/ros/bag_kind.h"
#include "data_io/ros/mcap_bag.h"
#include "data_io/ros/ros1_bag.h"
#include "data_io/ros/ros2_bag.h"

namespace sonarcal::data_io {

std::unique_ptr<Bag> Bag::Open(const std::filesystem::path& path) {
  if (IsRos1Bag(path)) return OpenRos1Bag(path);
  if (const auto files = Ros2BagFiles(path, Ros2Storage::kSqlite); !files.empty()) return OpenRos2Bag(files);
  if (const auto files = Ros2BagFiles(path, Ros2Storage::kMcap); !files.empty()) return OpenMcapBag(files);
  throw DataError(
      "{}: no bag, expected one of ROS 1 (.bag), or of ROS 2 (.mcap, .db3, or the folder that holds them)",
      path.string());
}

std::optional<std::size_t> Bag::FindTopic(const std::string& name) const {
  for (std::size_t i = 0; i < topics().size(); ++i) {
    if (topics()[i].name == name) return i;
  }
  return std::nullopt;
}

bool IsBag(const std::filesystem::path& path) {
  return IsRos1Bag(path) || IsRos2Bag(path);
}

std::string DescribeTopics(const std::vector<BagTopic>& topics) {
  constexpr std::size_t kMax = 20;  // a robot may have hundreds
  std::string text;
  for (std::size_t i = 0; i < topics.size() && i < kMax; ++i) {
    text += fmt::format("{}{} ({}, {} {})", i == 0 ? "" : ", ", Printable(topics[i].name),
                        Printable(topics[i].type), topics[i].count,
                        topics[i].count == 1 ? "message" : "messages");
  }
  if (topics.size() > kMax) text += fmt::format(" and {} more", topics.size() - kMax);
  return topics.empty() ? "no topic" : text;
}

std::string Ros1TypeName(const std::string& type) {
  constexpr std::string_view kMiddle = "/msg/";
  const std::size_t at = type.find(kMiddle);
  return at == std::string::npos ? type : type.substr(0, at) + "/" + type.substr(at + kMiddle.size());
}

}  // namespace sonarcal::data_io
