#include "data_io/ros/bag_recording.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>

#include "core/types/error.h"
#include "core/types/printable.h"
#include "data_io/json/json_reader.h"
#include "data_io/recordings/first_readable.h"
#include "data_io/ros/mcap_bag.h"
#include "data_io/ros/ros_messages.h"
#include "data_io/ros/sonar_info.h"

namespace sonarcal::data_io {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPoints =
    "as drivers of mechanically scanning sonars write them, which have neither beams nor range bins";

// Reason why a requested topic is not a sonar's.
std::string WhyNot(const Bag& bag, const std::string& asked, bool pictures) {
  const auto index = bag.FindTopic(asked);
  if (!index) return "does not exist";
  const BagTopic& topic = bag.topics()[*index];
  if (!pictures && IsPictureType(topic.type)) {
    return fmt::format(
        "has bare pictures ({}), which do not contain their window and beams: give --picture-geometry",
        Printable(topic.type));
  }
  if (IsPointsType(topic.type)) return fmt::format("has points ({}), {}", Printable(topic.type), kPoints);
  return fmt::format("has {} of type {}", topic.count == 0 ? "no message" : "messages",
                     Printable(topic.type));
}

// Names the topics that may be those of a sonar but cannot be read: of points, and without messages.
std::string AlmostSonars(const Bag& bag) {
  std::vector<BagTopic> points;
  std::vector<BagTopic> empty;
  for (const BagTopic& topic : bag.topics()) {
    if (IsPointsType(topic.type)) points.push_back(topic);
    if (IsSonarType(topic.type) && topic.count == 0) empty.push_back(topic);
  }
  std::string text;
  if (!points.empty()) text += fmt::format("; {} has points, {}", DescribeTopics(points), kPoints);
  if (!empty.empty()) text += fmt::format("; {} is a sonar's topic without messages", DescribeTopics(empty));
  return text;
}

// Damage of the bag, which may be why a topic is missing.
std::string FirstNote(const Bag& bag) {
  return bag.notes().empty() ? "" : fmt::format(" ({})", bag.notes().front());
}

// Index of the sonar's topic.
std::size_t ChooseTopic(const Bag& bag, const std::string& file, const BagOptions& options) {
  const bool pictures = options.message.geometry.has_value();
  std::vector<std::size_t> found;
  std::vector<BagTopic> sonars;
  for (std::size_t i = 0; i < bag.topics().size(); ++i) {
    const BagTopic& topic = bag.topics()[i];
    if (!(pictures ? IsPictureType(topic.type) : IsSonarType(topic.type)) || topic.count == 0) continue;
    if (!options.topic.empty() && topic.name != options.topic) continue;
    found.push_back(i);
    sonars.push_back(topic);
  }
  if (found.size() == 1) return found.front();
  if (found.size() > 1) {
    throw DataError("{}: {} topics of {}, expected the name of one of them (--topic): {}", file, found.size(),
                    pictures ? "pictures" : "sonars", DescribeTopics(sonars));
  }
  if (!options.topic.empty()) {
    throw DataError("{}: topic '{}' {}, expected {}; the bag has {}", file, Printable(options.topic),
                    WhyNot(bag, options.topic, pictures), pictures ? "pictures" : "a sonar's",
                    DescribeTopics(bag.topics()));
  }
  throw DataError("{}: no topic of a sonar{}; expected one of {}; the bag has {}", file, AlmostSonars(bag),
                  pictures ? "sensor_msgs/Image or sensor_msgs/CompressedImage"
                           : "marine_acoustic_msgs/ProjectedSonarImage, sonar_oculus/OculusPing, "
                             "oculus_interfaces/Ping, OculusPing or OculusStampedPing (of sensor_msgs/Image "
                             "or CompressedImage with --picture-geometry)",
                  DescribeTopics(bag.topics()) + FirstNote(bag));
}

class BagRecording final : public RecordingSource {
 public:
  BagRecording(const fs::path& path, const BagOptions& options)
      : bag_(Bag::Open(path)), options_(options.message) {
    info_.source = path.string();
    const std::size_t index = ChooseTopic(*bag_, info_.source, options);
    topic_ = bag_->topics()[index];
    messages_ = bag_->Messages(index);
    if (messages_.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
      throw DataError("{}: {} messages, expected an int's", info_.source, messages_.size());
    info_.format = fmt::format("{}, {}", bag_->format(), topic_.type);
    const FirstMessage first = DescribeFirst();
    ReadSonarInfos();
    DescribeSettings(first);
    ReadOrigin();
    NoteBag(first);
  }

  const RecordingInfo& info() const override { return info_; }
  int frame_count() const override { return static_cast<int>(messages_.size()); }

  FrameInfo frame_info(int index) const override {
    return InfoOf(index, bag_->Read(messages_.at(index), kRosStampBytes));
  }

  Frame ReadFrame(int index) const override {
    const std::vector<std::byte> bytes = bag_->Read(messages_.at(index));
    Frame frame{InfoOf(index, bytes),
                DecodeSonarMessage(topic_.type, bytes, topic_.encoding, Where(index), options_)};
    if (const SonarInfo* sonar = SonarInfoAt(TimeNs(index, bytes))) Apply(*sonar, frame.image);
    return frame;
  }

 private:
  // First message that can be read.
  struct FirstMessage {
    int index = 0;
    std::vector<std::byte> bytes;
  };

  std::string Where(int index) const {
    return fmt::format("{}: {}: message {}", info_.source, Printable(topic_.name), index);
  }

  std::int64_t StampNs(int index, std::span<const std::byte> bytes) const {
    MessageStream stream(bytes.first(std::min(bytes.size(), kRosStampBytes)), topic_.encoding, Where(index));
    return ReadStampNs(stream);
  }

  std::int64_t TimeNs(int index, std::span<const std::byte> bytes) const {
    const std::int64_t stamp_ns = StampNs(index, bytes);
    return stamp_ns == 0 ? messages_.at(index).log_time_ns : stamp_ns;
  }

  FrameInfo InfoOf(int index, std::span<const std::byte> bytes) const {
    const std::int64_t time_ns = TimeNs(index, bytes);
    const SonarInfo* sonar = SonarInfoAt(time_ns);
    return {fmt::format("frame {}", index), SecondsOfNs(time_ns), std::nullopt,
            sonar == nullptr ? settings_ : SettingsWith(*sonar, message_scale_, settings_)};
  }

  // Last message of SonarInfo at or before this time, otherwise the first one; nullptr if there is none.
  const SonarInfo* SonarInfoAt(std::int64_t time_ns) const {
    const auto after = std::ranges::upper_bound(sonar_infos_, time_ns, {}, &SonarInfo::stamp_ns);
    if (after == sonar_infos_.end() && sonar_infos_.empty()) return nullptr;
    return after == sonar_infos_.begin() ? &*after : &*std::prev(after);
  }

  // Index of the topic of SonarInfo that belongs to the sonar: the only one, or that beside the sonar's.
  std::optional<std::size_t> FindSonarInfoTopic() {
    const auto parent = [](const std::string& name) { return name.substr(0, name.rfind('/') + 1); };
    std::vector<std::size_t> all;
    std::vector<std::size_t> beside;
    for (std::size_t i = 0; i < bag_->topics().size(); ++i) {
      const BagTopic& topic = bag_->topics()[i];
      if (topic.type != kSonarInfoType || topic.count == 0) continue;
      all.push_back(i);
      if (parent(topic.name) == parent(topic_.name)) beside.push_back(i);
    }
    if (all.size() == 1) return all.front();
    if (beside.size() == 1) return beside.front();
    if (!all.empty()) {
      info_.notes.push_back(fmt::format(
          "{} topics of SonarInfo were ignored: expected one, or exactly one beside the topic of the sonar.",
          all.size()));
    }
    return std::nullopt;
  }

  // Keeps the messages that state something new, by their stamps. Those may have another order than the times
  // of recording.
  void ReadSonarInfos() {
    const std::optional<std::size_t> index = FindSonarInfoTopic();
    if (!index) return;
    const BagTopic& topic = bag_->topics()[*index];
    int damaged = 0;
    std::vector<SonarInfo> contents;  // different from one to the next, by time of recording
    struct Stamp {
      std::int64_t time_ns;
      std::size_t content;
    };
    std::vector<Stamp> stamps;
    const std::vector<BagMessage> messages = bag_->Messages(*index);
    for (std::size_t i = 0; i < messages.size(); ++i) {
      const std::string where = fmt::format("{}: {}: message {}", info_.source, Printable(topic.name), i);
      try {
        SonarInfo sonar = ReadSonarInfo(bag_->Read(messages[i]), topic.encoding, where);
        const std::int64_t time_ns = sonar.stamp_ns == 0 ? messages[i].log_time_ns : sonar.stamp_ns;
        if (contents.empty() || !HasSameContent(sonar, contents.back())) contents.push_back(std::move(sonar));
        stamps.push_back({time_ns, contents.size() - 1});
      } catch (const DataError& error) {
        if (++damaged == 1) info_.notes.push_back(fmt::format("SonarInfo was left out: {}.", error.what()));
      }
    }
    std::ranges::stable_sort(stamps, {}, &Stamp::time_ns);
    for (const Stamp& stamp : stamps) {
      const SonarInfo& sonar = contents[stamp.content];
      if (!sonar_infos_.empty() && HasSameContent(sonar, sonar_infos_.back())) continue;
      sonar_infos_.push_back(sonar);
      sonar_infos_.back().stamp_ns = stamp.time_ns;
    }
  }

  // Completes the description from the SonarInfo that holds for the first message.
  void DescribeSettings(const FirstMessage& first) {
    settings_ = info_.settings;
    message_scale_ = info_.scale;
    const SonarInfo* sonar = SonarInfoAt(TimeNs(first.index, first.bytes));
    if (sonar == nullptr) return;
    Describe(*sonar, info_);
    if (sonar_infos_.size() > 1) {
      info_.notes.push_back(
          fmt::format("SonarInfo has {} versions, each for a part of the frames: settings and scale differ.",
                      sonar_infos_.size()));
    }
  }

  // Throws DataError if none of the first messages can be read.
  FirstMessage DescribeFirst() {
    FirstMessage first;
    first.index =
        DescribeFromFirstReadable(frame_count(), "message", info_, [&](int index, RecordingInfo& info) {
          first.bytes = bag_->Read(messages_[index]);
          DescribeSonarMessage(topic_.type, first.bytes, topic_.encoding, Where(index), options_, info);
        });
    return first;
  }

  // A simulated recording is marked as synthetic in every format.
  void ReadOrigin() {
    const std::string text = bag_->recording_json();
    if (text.empty()) return;
    try {
      const std::string where = fmt::format("{}: {}", info_.source, kRecordingJsonKey);
      const JsonReader json = JsonReader::FromText(text, where);
      const auto synthetic = json.Find("synthetic");
      info_.synthetic = synthetic && synthetic->Bool();
    } catch (const DataError& error) {
      info_.notes.push_back(fmt::format("The metadata of the recording were left out: {}.", error.what()));
    }
  }

  void NoteBag(const FirstMessage& first) {
    info_.details.emplace_back("topic", Printable(topic_.name));
    for (const BagTopic& topic : bag_->topics()) {
      if (topic.name == topic_.name && topic.type == topic_.type && topic.encoding == topic_.encoding)
        continue;
      info_.details.emplace_back("other topic " + Printable(topic.name),
                                 fmt::format("{}, {} {}", Printable(topic.type), topic.count,
                                             topic.count == 1 ? "message" : "messages"));
    }
    if (StampNs(first.index, first.bytes) == 0) {
      info_.notes.emplace_back(
          "The header of the first message has no time: such frames have the time they were recorded.");
    }
    info_.notes.emplace_back("The reader follows the published definitions; it was tried on no real bag.");
    info_.notes.insert(info_.notes.end(), bag_->notes().begin(), bag_->notes().end());
  }

  std::unique_ptr<Bag> bag_;
  SonarMessageOptions options_;
  BagTopic topic_;
  std::vector<BagMessage> messages_;
  RecordingInfo info_;
  std::vector<SonarInfo> sonar_infos_;  // by time
  // Settings and scale as the sonar's own messages state them.
  SonarSettings settings_;
  ImageScale message_scale_;
};

}  // namespace

std::unique_ptr<RecordingSource> OpenBagRecording(const fs::path& path, const BagOptions& options) {
  return std::make_unique<BagRecording>(path, options);
}

std::unique_ptr<RecordingSource> OpenBag(const fs::path& path) {
  return OpenBagRecording(path, {});
}

}  // namespace sonarcal::data_io
