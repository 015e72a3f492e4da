#include "data_io/ros/mcap_bag.h"

#include <algorithm>
#include <map>
#include <optional>
#include <tuple>

#include "core/types/error.h"
#include "core/types/printable.h"
#include "data_io/files/compression.h"
#include "data_io/mcap/mcap_file.h"

namespace sonarcal::data_io {
namespace {

namespace fs = std::filesystem;

std::optional<MessageEncoding> EncodingOf(const std::string& name) {
  if (name == "cdr") return MessageEncoding::kCdr;
  if (name == "ros1") return MessageEncoding::kRos1;
  return std::nullopt;
}

class McapBag final : public Bag {
 public:
  explicit McapBag(const std::vector<fs::path>& files) {
    SONARCAL_CHECK(files.size() < (std::size_t{1} << (64 - kContainerBits)), "{} files", files.size());
    for (const fs::path& file : files) {
      const auto& plain = plain_files_.emplace_back(std::make_unique<PlainFile>(file));
      files_.push_back(std::make_unique<McapFile>(plain->path(), plain->name(), kMaxBagMessageBytes));
      Index(files_.size() - 1);
    }
    for (std::size_t i = 0; i < topics_.size(); ++i) {
      topics_[i].count = messages_[i].size();
      std::sort(messages_[i].begin(), messages_[i].end());
    }
  }

  std::string format() const override { return "MCAP"; }
  const std::vector<BagTopic>& topics() const override { return topics_; }
  const std::vector<std::string>& notes() const override { return notes_; }
  std::string recording_json() const override { return recording_json_; }
  std::vector<BagMessage> Messages(std::size_t topic) const override { return messages_.at(topic); }

  std::vector<std::byte> Read(const BagMessage& message, std::uint64_t wanted_bytes) const override {
    const std::uint64_t file = message.container >> kContainerBits;
    const McapMessage in_file{.log_time_ns = message.log_time_ns,
                              .container = message.container & ((std::uint64_t{1} << kContainerBits) - 1),
                              .position = static_cast<std::uint64_t>(message.position)};
    return InflatedMessage(
        files_.at(file)->Read(in_file, wanted_bytes), wanted_bytes,
        [&] { return files_[file]->Read(in_file); },
        fmt::format("{}: message at byte {}", plain_files_[file]->name(), message.position));
  }

 private:
  // The upper bits of BagMessage::container are the file, the lower ones the container in that file.
  static constexpr int kContainerBits = 40;

  void Index(std::size_t file) {
    McapFile& mcap = *files_[file];
    notes_.insert(notes_.end(), mcap.notes().begin(), mcap.notes().end());
    if (const auto record = mcap.metadata().find(kRecordingMetadata); record != mcap.metadata().end()) {
      const auto text = record->second.find(kRecordingJsonKey);
      if (text != record->second.end()) recording_json_ = text->second;
    }
    const std::map<std::uint16_t, std::vector<McapMessage>> by_channel = mcap.TakeMessages();
    for (const auto& [id, channel] : mcap.channels()) {
      const auto encoding = EncodingOf(channel.message_encoding);
      if (!encoding) {
        notes_.push_back(fmt::format("Topic {} is serialised as '{}', not as cdr or ros1, and was left out.",
                                     Printable(channel.topic), Printable(channel.message_encoding)));
        continue;
      }
      std::vector<BagMessage>& messages =
          messages_[TopicIndex(channel.topic, Ros1TypeName(channel.schema_name), *encoding)];
      const auto found = by_channel.find(id);
      if (found == by_channel.end()) continue;
      for (const McapMessage& message : found->second) {
        messages.push_back({.log_time_ns = message.log_time_ns,
                            .container = std::uint64_t{file} << kContainerBits | message.container,
                            .position = static_cast<std::int64_t>(message.position)});
      }
    }
  }

  // Several channels may have one topic: one per publisher.
  std::size_t TopicIndex(const std::string& name, const std::string& type, MessageEncoding encoding) {
    const auto [found, is_new] = topic_indices_.try_emplace({name, type, encoding}, topics_.size());
    if (is_new) {
      topics_.push_back({name, type, 0, encoding});
      messages_.emplace_back();
    }
    return found->second;
  }

  std::vector<std::unique_ptr<PlainFile>> plain_files_;
  std::vector<std::unique_ptr<McapFile>> files_;
  std::vector<BagTopic> topics_;
  std::map<std::tuple<std::string, std::string, MessageEncoding>, std::size_t> topic_indices_;
  std::vector<std::vector<BagMessage>> messages_;  // per topic
  std::vector<std::string> notes_;
  std::string recording_json_;
};

}  // namespace

std::unique_ptr<Bag> OpenMcapBag(const std::vector<fs::path>& files) {
  return std::make_unique<McapBag>(files);
}

}  // namespace sonarcal::data_io
