#include "data_io/ros/bag.h"

#include <algorithm>
#include <utility>

#include "core/types/error.h"
#include "core/types/printable.h"
#include "data_io/files/compression.h"
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

std::vector<std::byte> InflatedMessage(std::vector<std::byte> stored, std::uint64_t wanted_bytes,
                                       const std::function<std::vector<std::byte>()>& read_all,
                                       const std::string& where) {
  if (!IsZstd(stored)) return stored;
  const std::uint64_t max_bytes = std::min(wanted_bytes, kMaxBagMessageBytes);
  Inflated inflated = Inflate(Codec::kZstd, read_all(), max_bytes);
  switch (inflated.end) {
    case Inflated::End::kWhole:
      return std::move(inflated.bytes);
    case Inflated::End::kMore:
      if (max_bytes == wanted_bytes) return std::move(inflated.bytes);
      throw DataError("{}: the message inflates to more than the max of {} bytes", where, max_bytes);
    case Inflated::End::kCut:
      throw DataError("{}: the compressed message is not whole: {} bytes come out", where,
                      inflated.bytes.size());
    case Inflated::End::kDamaged:
      break;
  }
  throw DataError("{}: the compressed message is damaged: {}", where, inflated.fault);
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
