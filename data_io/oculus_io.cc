#include "data_io/oculus_io.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "data_io/oculus_log.h"
#include "data_io/oculus_model.h"
#include "data_io/oculus_ping.h"
#include "data_io/types/error.h"

namespace sonarcal {
namespace {

namespace fs = std::filesystem;

// A ping of the file, and its head.
struct Message {
  std::uint64_t offset = 0;
  OculusHead head;
  std::optional<OculusLogItem> item = {};  // where it lies in a log
};

class OculusRecording final : public RecordingSource {
 public:
  explicit OculusRecording(const fs::path& file) : file_(file), name_(file.string()) {
    info_.source = name_;
    const bool is_log = IsOculusLog(file);
    is_log ? IndexLog() : IndexMessages();
    RefuseTooFewOrMany();
    const OculusPing first = ParsePing(0, PingHeaderBytes(0));
    info_.format = fmt::format("Oculus simple ping result, version {}", first.version);
    DescribeOculus(first, info_);
    if (is_log) {
      info_.format += ", in a log";
      info_.notes.emplace_back("Frames have the times of the log's items; their epoch is not documented.");
    }
  }

  const RecordingInfo& info() const override { return info_; }
  int frame_count() const override { return static_cast<int>(messages_.size()); }

  FrameInfo frame_info(int index) const override {
    return InfoOf(index, ParsePing(index, PingHeaderBytes(index)));
  }

  Frame ReadFrame(int index) const override {
    const std::vector<std::byte> bytes = MessageBytes(index);
    const OculusPing ping = ParsePing(index, bytes);
    Frame frame{InfoOf(index, ping),
                {AxesOf(ping, index), OculusScale(ping), Grid<float>(ping.ranges, ping.beams)}};
    const bool right_to_left = BearingsRunRightToLeft(ping);
    const std::uint64_t start = messages_.at(index).offset;
    const ByteReader image(
        ByteReader(bytes, name_, start).Bytes(ping.image_offset, ping.row_bytes() * ping.ranges, "image"),
        name_, start + ping.image_offset);
    for (int range = 0; range < ping.ranges; ++range) {
      std::uint64_t at = ping.row_bytes() * range;
      float scale = 1.0f;
      if (ping.has_gains) {
        const std::uint32_t gain = image.U32(at, "gain of a row");
        if (gain == 0) throw DataError("{}: 0, expected at least 1", image.Where(at, "gain of a row"));
        scale = 1.0f / std::sqrt(static_cast<float>(gain));
        at += 4;
      }
      for (int beam = 0; beam < ping.beams; ++beam, at += ping.bytes_per_sample) {
        const std::uint32_t sample = LittleEndian(image.Bytes(at, ping.bytes_per_sample, "sample"));
        const int column = right_to_left ? ping.beams - 1 - beam : beam;
        frame.image.value(range, column) = static_cast<float>(sample) * scale;
      }
    }
    return frame;
  }

 private:
  // Finds the whole pings of the file.
  void IndexMessages() {
    const std::uint64_t size = RegularFileSize(file_);
    std::uint64_t offset = 0;
    int others = 0;
    while (offset < size) {
      const std::uint64_t rest = size - offset;
      const std::vector<std::byte> bytes =
          ReadFileRange(file_, offset, std::min(rest, kOculusHeadBytes), "message head");
      const std::optional<OculusHead> head = ParseOculusHead({bytes, name_, offset});
      if (!head) {
        info_.notes.push_back(
            fmt::format("The {} bytes from byte {} on are no Oculus message; left out.", rest, offset));
        break;
      }
      if (head->message_bytes > rest) {
        info_.notes.push_back(fmt::format("The message at byte {} is cut short, {} of {} bytes; left out.",
                                          offset, rest, head->message_bytes));
        break;
      }
      if (head->message_id == kOculusSimplePingResult) {
        messages_.push_back({offset, *head});
      } else {
        ++others;
      }
      offset += head->message_bytes;
    }
    if (others > 0)
      info_.notes.push_back(fmt::format("{} messages that are no pings were passed over.", others));
  }

  // Finds the pings of a log, each an item of its own.
  void IndexLog() {
    OculusLog log = ReadOculusLog(file_);
    info_.notes = std::move(log.notes);
    int others = 0;
    for (const OculusLogItem& item : log.items) {
      const std::uint64_t message_bytes = item.compressed ? item.original_bytes : item.payload_bytes;
      const std::vector<std::byte> bytes = ReadOculusLogItem(file_, item, kOculusHeadBytes);
      const std::optional<OculusHead> head = ParseOculusHead({bytes, name_, item.offset});
      if (head && head->message_id == kOculusSimplePingResult && head->message_bytes <= message_bytes) {
        messages_.push_back({item.offset, *head, item});
      } else {
        ++others;
      }
    }
    if (others > 0)
      info_.notes.push_back(fmt::format("{} sonar items that hold no whole ping were passed over.", others));
  }

  void RefuseTooFewOrMany() const {
    if (messages_.empty()) {
      throw DataError("{}: no whole simple ping result in {} bytes, expected at least one", name_,
                      RegularFileSize(file_));
    }
    if (messages_.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
      throw DataError("{}: {} pings, expected at most {}", name_, messages_.size(),
                      std::numeric_limits<int>::max());
    }
  }

  // The first bytes of a message, up to the end of its bearings at least.
  std::vector<std::byte> PingHeaderBytes(int index) const {
    const Message& message = messages_.at(index);
    const std::uint64_t wanted = std::min(message.head.message_bytes, kMostOculusPingHeaderBytes);
    if (message.item) return ReadOculusLogItem(file_, *message.item, wanted);
    return ReadFileRange(file_, message.offset, wanted, "ping header");
  }

  std::vector<std::byte> MessageBytes(int index) const {
    const Message& message = messages_.at(index);
    if (message.item) return ReadOculusLogItem(file_, *message.item);
    return ReadFileRange(file_, message.offset, message.head.message_bytes, "ping");
  }

  OculusPing ParsePing(int index, const std::vector<std::byte>& bytes) const {
    const Message& message = messages_.at(index);
    return ParseOculusPing({bytes, name_, message.offset}, message.head);
  }

  PolarAxes AxesOf(const OculusPing& ping, int index) const {
    return OculusAxes(ping, fmt::format("{}: ping {}", name_, index));
  }

  FrameInfo InfoOf(int index, const OculusPing& ping) const {
    const std::optional<OculusLogItem>& item = messages_.at(index).item;
    const std::optional<double> time_s = item ? std::optional(item->time_s) : ping.start_s;
    const bool has_time = time_s && std::isfinite(*time_s);
    return {fmt::format("ping {}", ping.ping_id), has_time ? time_s : std::nullopt, std::nullopt,
            info_.settings};
  }

  fs::path file_;
  std::string name_;
  std::vector<Message> messages_;
  RecordingInfo info_;
};

}  // namespace

bool IsOculus(const fs::path& path) {
  if (IsOculusLog(path)) return true;
  std::error_code error;
  if (!fs::is_regular_file(path, error) || fs::file_size(path, error) < kOculusHeadBytes || error)
    return false;
  const std::vector<std::byte> head = ReadFileRange(path, 0, kOculusHeadBytes, "message head");
  const std::optional<OculusHead> parsed = ParseOculusHead({head, path.string()});
  // All message ids fit in a byte: a text that begins with the letters of the id is no recording.
  return parsed && parsed->message_id <= 0xff;
}

std::unique_ptr<RecordingSource> OpenOculus(const fs::path& path) {
  return std::make_unique<OculusRecording>(path);
}

}  // namespace sonarcal
