#include "data_io/bag_writers/recording_messages.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

#include "core/types/error.h"
#include "core/types/units.h"
#include "data_io/bag_writers/message_builder.h"
#include "data_io/recordings/frame_storage.h"

namespace sonarcal::data_io {
namespace {

std::string Samples(const PolarImage& image) {
  const SampleType type = SampleTypeOf(image.scale);
  std::string samples;
  for (int beam = 0; beam < image.value.cols(); ++beam) {
    for (int bin = 0; bin < image.value.rows(); ++bin) AppendSample(samples, type, image.value(bin, beam));
  }
  return samples;
}

void AddWidth(MessageBuilder& message, double width_deg) {
  message.Count(width_deg > 0.0 ? 1 : 0);
  if (width_deg > 0.0) message.Number(static_cast<float>(RadFromDeg(width_deg)));
}

// Time of a frame, or 0, which means "no time" in ROS. Time 0 becomes the first nanosecond.
std::int64_t StampNsOf(const FrameInfo& info, double max_s) {
  if (!info.time_s) return 0;
  const double time_s = *info.time_s;
  if (!(time_s >= 0.0 && time_s < max_s))
    throw DataError("{}: time_s is {:g}, expected 0 .. {:.0f} for ROS", info.name, time_s, max_s);
  const double whole_s = std::floor(time_s);
  return std::max<std::int64_t>(
      1, static_cast<std::int64_t>(whole_s) * kNsPerS + std::llround((time_s - whole_s) * 1e9));
}

// Time between the frames without a time from `first` on, the first of which follows `previous_ns`: 1 s, or
// less so that they lie before the next frame with a time.
std::int64_t StepNs(const std::vector<FrameTimes>& times, std::size_t first, std::int64_t previous_ns) {
  std::size_t next = first;
  while (next < times.size() && times[next].stamp_ns == 0) ++next;
  if (next == times.size() || times[next].stamp_ns <= previous_ns) return kNsPerS;
  const auto steps = static_cast<std::int64_t>(next - first + 1);
  return std::clamp<std::int64_t>((times[next].stamp_ns - previous_ns) / steps, 1, kNsPerS);
}

// Sets the log times by the stamps.
void SetLogTimes(std::vector<FrameTimes>& times) {
  std::int64_t logged_ns = 0;
  std::int64_t step_ns = 0;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const bool has_time = times[i].stamp_ns != 0;
    if (!has_time && (i == 0 || times[i - 1].stamp_ns != 0)) step_ns = StepNs(times, i, logged_ns);
    logged_ns = has_time ? times[i].stamp_ns : logged_ns + step_ns;
    times[i].logged_ns = logged_ns;
  }
}

}  // namespace

std::vector<FrameTimes> FrameTimesOf(const RecordingSource& recording, double max_s) {
  std::vector<FrameTimes> times;
  for (int i = 0; i < recording.frame_count(); ++i)
    times.push_back({.stamp_ns = StampNsOf(recording.frame_info(i), max_s)});
  SetLogTimes(times);
  std::map<std::int64_t, int> posed;
  for (int i = 0; i < recording.frame_count(); ++i) {
    const FrameInfo info = recording.frame_info(i);
    const std::int64_t logged_ns = times[static_cast<std::size_t>(i)].logged_ns;
    if (!info.world_from_sonar) continue;
    const auto [other, is_new] = posed.emplace(logged_ns, i);
    if (is_new) continue;
    const Pose first = *recording.frame_info(other->second).world_from_sonar;
    const Pose& second = *info.world_from_sonar;
    if (first.position_m != second.position_m || first.rotation.coeffs() != second.rotation.coeffs()) {
      throw DataError(
          "{}: frames {} and {} have the same time, {:.9f} s, but different poses, expected different times: "
          "readers of a bag find the pose of a frame by its time",
          recording.info().source, other->second, i, SecondsOfNs(logged_ns));
    }
  }
  return times;
}

std::string ImageMessage(MessageEncoding encoding, const Frame& frame, const SonarModel& sonar,
                         std::uint32_t sequence, std::int64_t stamp_ns) {
  const PolarAxes& axes = frame.image.axes;
  MessageBuilder message(encoding);
  message.Header(sequence, stamp_ns, kSonarFrame);
  message.Number(static_cast<float>(sonar.frequency_hz));
  message.Number(static_cast<float>(sonar.sound_speed_m_per_s));
  AddWidth(message, sonar.elevation_beam_width_deg);  // one fan is transmitted
  AddWidth(message, sonar.azimuth_beam_width_deg);
  message.Count(axes.beam_azimuth_rad.size());
  for (const double azimuth_rad : axes.beam_azimuth_rad) {
    message.Number(0.0).Number(std::sin(azimuth_rad)).Number(std::cos(azimuth_rad));
  }
  message.Count(static_cast<std::size_t>(axes.range_bins));
  for (int bin = 0; bin < axes.range_bins; ++bin)
    message.Number(static_cast<float>(axes.range_centre_m(bin)));
  message.Number(std::uint8_t{0});
  message.Number(static_cast<std::uint32_t>(SampleTypeOf(frame.image.scale)));
  message.Count(axes.beam_azimuth_rad.size());
  message.Bytes(Samples(frame.image));
  return message.Take();
}

std::string PoseMessage(MessageEncoding encoding, const Pose& world_from_sonar, std::uint32_t sequence,
                        std::int64_t stamp_ns) {
  MessageBuilder message(encoding);
  message.Header(sequence, stamp_ns, kWorldFrame);
  for (int axis = 0; axis < 3; ++axis) message.Number(double{world_from_sonar.position_m[axis]});
  const Eigen::Quaterniond& q = world_from_sonar.rotation;
  message.Number(q.x()).Number(q.y()).Number(q.z()).Number(q.w());
  return message.Take();
}

SampleType SampleTypeOf(const ImageScale& scale) {
  if (scale.quantity == Quantity::kPower) return SampleType::kFloat;
  if (scale.quantity != Quantity::kGrey) {
    throw DataError(
        "the recording's values are {}, expected grey or power: a ProjectedSonarImage does not state the "
        "unit of its samples",
        ToString(scale.quantity));
  }
  const int bits = MinBits(scale);
  if (bits == 32) {
    throw DataError(
        "the full scale of the recording's grey values is {:g}, expected a whole number from 2 to 65535: a "
        "ProjectedSonarImage holds grey values as whole numbers, and its floats are power",
        scale.full_scale);
  }
  return bits == 16 ? SampleType::kShort : SampleType::kByte;
}

void AppendSample(std::string& bytes, SampleType type, float value) {
  const auto append = [&bytes](std::uint32_t bits, int count) {
    for (int i = 0; i < count; ++i) bytes += static_cast<char>(bits >> 8 * i & 0xff);
  };
  switch (type) {
    case SampleType::kByte:
      return append(static_cast<std::uint8_t>(std::lround(value)), 1);
    case SampleType::kShort:
      return append(static_cast<std::uint16_t>(std::lround(value)), 2);
    case SampleType::kFloat:
      return append(std::bit_cast<std::uint32_t>(value), 4);
  }
}

}  // namespace sonarcal::data_io
