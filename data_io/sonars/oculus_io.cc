#include "data_io/sonars/oculus_io.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/types/error.h"
#include "data_io/recordings/first_readable.h"
#include "data_io/sonars/oculus_log.h"
#include "data_io/sonars/oculus_model.h"
#include "data_io/sonars/oculus_ping.h"

namespace sonarcal::data_io {
namespace {

namespace fs = std::filesystem;

class OculusRecording final : public RecordingSource {
 public:
  explicit OculusRecording(const fs::path& file) : file_(file), name_(file.string()) {
    info_.source = name_;
    is_log_ = IsOculusLog(file);
    is_log_ ? IndexLog() : IndexMessages();
    RefuseTooFewOrMany();
    DescribeFromFirstReadable(frame_count(), "ping", info_, [&](int index, RecordingInfo& info) {
      const OculusPing ping = ReadPing(index, kMaxOculusPingHeaderBytes).ping;
      info.format = fmt::format("Oculus simple ping result, version {}", ping.version);
      DescribeOculus(ping, info);
    });
    if (is_log_) {
      info_.format += ", in a log";
      info_.notes.emplace_back("Frames have the times of the log's items; their epoch is not documented.");
    }
  }

  const RecordingInfo& info() const override { return info_; }
  int frame_count() const override { return static_cast<int>(offsets_.size()); }

  FrameInfo frame_info(int index) const override {
    return InfoOf(ReadPing(index, kMaxOculusPingHeaderBytes));
  }

  Frame ReadFrame(int index) const override {
    const PingOfFile read = ReadPing(index);
    const OculusPing& ping = read.ping;
    const ByteReader message(read.bytes, name_, offsets_.at(index));
    const auto image = message.Bytes(ping.image_offset, ping.row_bytes() * ping.ranges, "image");
    const std::string what = fmt::format("{}: ping {}", name_, index);
    return {InfoOf(read), OculusImage(ping, OculusSamples(ping, image, what + ": image"), what)};
  }

 private:
  struct PingOfFile {
    OculusPing ping;
    std::vector<std::byte> bytes;           // first bytes of the message, as many as requested
    std::optional<double> log_time_s = {};  // time in a log
  };

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
        info_.notes.push_back(fmt::format(
            "The {} bytes from byte {} on are not an Oculus message and were omitted.", rest, offset));
        break;
      }
      if (head->message_bytes > rest) {
        info_.notes.push_back(
            fmt::format("The message at byte {} is truncated ({} of {} bytes) and was omitted.", offset, rest,
                        head->message_bytes));
        break;
      }
      if (head->message_id == kOculusSimplePingResult) {
        offsets_.push_back(offset);
      } else {
        ++others;
      }
      offset += head->message_bytes;
    }
    if (others > 0)
      info_.notes.push_back(fmt::format("{} messages that are not pings were skipped.", others));
  }

  // Finds the pings of a log, one per item. A damaged item counts as a ping that cannot be read.
  void IndexLog() {
    int others = 0;
    info_.notes = ForEachOculusLogItem(file_, [&](const OculusLogItem& item) {
      const std::uint64_t message_bytes = item.compressed ? item.original_bytes : item.payload_bytes;
      std::vector<std::byte> bytes;
      try {
        bytes = ReadOculusLogItem(file_, item, kOculusHeadBytes);
      } catch (const DataError&) {
        offsets_.push_back(item.offset);  // reading the frame throws the error again
        return;
      }
      const std::optional<OculusHead> head = ParseOculusHead({bytes, name_, item.offset});
      if (head && head->message_id == kOculusSimplePingResult && head->message_bytes <= message_bytes) {
        offsets_.push_back(item.offset);
      } else {
        ++others;
      }
    });
    if (others > 0)
      info_.notes.push_back(fmt::format("{} sonar items that hold no whole ping were skipped.", others));
  }

  void RefuseTooFewOrMany() const {
    if (offsets_.empty()) {
      throw DataError("{}: no whole simple ping result in {} bytes, expected at least one", name_,
                      RegularFileSize(file_));
    }
    if (offsets_.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
      throw DataError("{}: {} pings, expected at most {}", name_, offsets_.size(),
                      std::numeric_limits<int>::max());
    }
  }

  // First `wanted` bytes of a message, or all of it, and the parsed ping. Only the positions of pings are
  // kept in memory, so files of any length can be read.
  PingOfFile ReadPing(int index, std::uint64_t wanted = std::numeric_limits<std::uint64_t>::max()) const {
    const std::uint64_t offset = offsets_.at(index);
    PingOfFile read;
    if (is_log_) {
      const OculusLogItem item = ReadOculusLogItemHead(file_, offset);
      read.log_time_s = item.time_s;
      read.bytes = ReadOculusLogItem(file_, item, wanted);
    } else {
      const OculusHead head = HeadOf(ReadFileRange(file_, offset, kOculusHeadBytes, "message head"), offset);
      read.bytes = ReadFileRange(file_, offset, std::min(head.message_bytes, wanted), "ping");
    }
    read.ping = ParseOculusPing({read.bytes, name_, offset}, HeadOf(read.bytes, offset));
    return read;
  }

  // Header of a message that was found before.
  OculusHead HeadOf(const std::vector<std::byte>& bytes, std::uint64_t offset) const {
    const std::optional<OculusHead> head = ParseOculusHead({bytes, name_, offset});
    if (!head) throw DataError("{}: byte {}: no Oculus message any more, expected one", name_, offset);
    return *head;
  }

  FrameInfo InfoOf(const PingOfFile& read) const {
    const std::optional<double> time_s = is_log_ ? read.log_time_s : read.ping.start_s;
    const bool has_time = time_s && std::isfinite(*time_s);
    return {fmt::format("ping {}", read.ping.ping_id), has_time ? time_s : std::nullopt, std::nullopt,
            info_.settings};
  }

  fs::path file_;
  std::string name_;
  bool is_log_ = false;
  std::vector<std::uint64_t> offsets_;  // positions of messages, or of the log's items
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
  // All message ids fit into a byte, so a text file that begins with the letters of the magic number is
  // rejected.
  return parsed && parsed->message_id <= 0xff;
}

std::unique_ptr<RecordingSource> OpenOculus(const fs::path& path) {
  return std::make_unique<OculusRecording>(path);
}

}  // namespace sonarcal::data_io
