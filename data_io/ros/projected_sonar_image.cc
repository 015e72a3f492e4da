#include "data_io/ros/projected_sonar_image.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "core/types/error.h"
#include "core/types/units.h"
#include "data_io/json/recording_limits.h"

namespace sonarcal::data_io {
namespace {

struct SampleType {
  const char* name;
  std::uint64_t bytes;
  double largest;  // 0 for floats
};
template <typename T>
constexpr SampleType Whole(const char* name) {
  return {name, sizeof(T), static_cast<double>(std::numeric_limits<T>::max())};
}
constexpr std::array<SampleType, 10> kSampleTypes = {{Whole<std::uint8_t>("u8"), Whole<std::int8_t>("i8"),
                                                      Whole<std::uint16_t>("u16"), Whole<std::int16_t>("i16"),
                                                      Whole<std::uint32_t>("u32"), Whole<std::int32_t>("i32"),
                                                      Whole<std::uint64_t>("u64"), Whole<std::int64_t>("i64"),
                                                      SampleType{"f32", 4, 0.0}, SampleType{"f64", 8, 0.0}}};

const SampleType& TypeOf(const ProjectedSonarImage& message, const std::string& where) {
  if (message.sample_type >= kSampleTypes.size())
    throw DataError("{}: image.dtype is {}, expected 0..9", where, message.sample_type);
  return kSampleTypes[message.sample_type];
}

// Sample as a number; `raw` has its bits in the lowest bytes.
double SampleOf(std::uint32_t type, std::uint64_t raw) {
  switch (type) {
    case 1:
      return static_cast<std::int8_t>(raw);
    case 3:
      return static_cast<std::int16_t>(raw);
    case 5:
      return static_cast<std::int32_t>(raw);
    case 7:
      return static_cast<double>(static_cast<std::int64_t>(raw));
    case 8:
      return std::bit_cast<float>(static_cast<std::uint32_t>(raw));
    case 9:
      return std::bit_cast<double>(raw);
    default:
      return static_cast<double>(raw);
  }
}

void CheckSizes(const ProjectedSonarImage& message, const std::string& where) {
  const std::uint64_t beams = message.beam_direction.size();
  const std::uint64_t ranges = message.range_m.size();
  if (message.beam_count != beams)
    throw DataError("{}: image.beam_count is {}, beam_directions are {}", where, message.beam_count, beams);
  const std::uint64_t expected = beams * ranges * TypeOf(message, where).bytes;
  if (message.data.size() != expected) {
    throw DataError("{}: image.data has {} bytes, expected {} ({} beams x {} ranges of {})", where,
                    message.data.size(), expected, beams, ranges, TypeOf(message, where).name);
  }
}

// All samples in the message's order.
std::vector<float> Samples(const ProjectedSonarImage& message, const std::string& where) {
  const std::uint64_t bytes = TypeOf(message, where).bytes;
  const bool is_whole = TypeOf(message, where).largest > 0.0;
  const double max = is_whole ? kMaxRecordedFullScale : std::numeric_limits<float>::max();
  std::vector<float> samples(message.data.size() / bytes);
  const std::byte* next = message.data.data();
  for (std::size_t i = 0; i < samples.size(); ++i, next += bytes) {
    std::uint64_t raw = 0;
    for (std::uint64_t k = 0; k < bytes; ++k) {
      raw = raw << 8 | std::to_integer<std::uint64_t>(next[message.is_big_endian ? k : bytes - 1 - k]);
    }
    const double sample = SampleOf(message.sample_type, raw);
    if (!std::isfinite(sample) || (is_whole && sample < 0.0) || std::abs(sample) > max) {
      throw DataError("{}: sample {} is {:g}, expected {}", where, i, sample,
                      is_whole ? fmt::format("0 or more, at most {:g}", max) : "a finite number");
    }
    samples[i] = static_cast<float>(sample);
  }
  return samples;
}

// True if the beams lie around X rather than Z, which is not the definition's frame.
bool LookAlongX(const ProjectedSonarImage& message) {
  constexpr double kNone = 1e-6;
  return std::ranges::all_of(message.beam_direction, [](const Eigen::Vector3d& direction) {
    return std::abs(direction.z()) <= kNone && direction.x() > kNone;
  });
}

std::vector<double> AzimuthsRad(const ProjectedSonarImage& message, const SonarMessageOptions& options) {
  const bool along_x = LookAlongX(message);
  std::vector<double> azimuth_rad;
  for (const Eigen::Vector3d& direction : message.beam_direction) {
    const double to_right_rad =
        along_x ? std::atan2(-direction.y(), direction.x()) : std::atan2(direction.y(), direction.z());
    azimuth_rad.push_back(options.mirrored ? -to_right_rad : to_right_rad);
  }
  return azimuth_rad;
}

bool RunsDown(const std::vector<double>& azimuth_rad) {
  return azimuth_rad.size() > 1 && azimuth_rad.front() > azimuth_rad.back();
}

bool RangesAreEdges(const ProjectedSonarImage& message, double bin_m) {
  constexpr double kSlack = 0.05;  // fraction of a bin
  return message.range_m.front() < (0.5 - kSlack) * bin_m;
}

PolarAxes AxesOf(const ProjectedSonarImage& message, const std::string& where,
                 const SonarMessageOptions& options) {
  constexpr double kUneven = 0.05;  // fraction of a bin
  const std::vector<float>& range_m = message.range_m;
  if (range_m.size() < 2 || range_m.size() > std::numeric_limits<int>::max())
    throw DataError("{}: {} ranges, expected at least 2", where, range_m.size());
  const auto bins = static_cast<int>(range_m.size());
  const double bin_m = (static_cast<double>(range_m.back()) - range_m.front()) / (bins - 1);
  for (int i = 0; i < bins; ++i) {
    const double even_m = range_m.front() + i * bin_m;
    if (!(std::abs(range_m[i] - even_m) <= kUneven * bin_m)) {
      throw DataError("{}: ranges[{}] is {:g} m, expected {:g} m: only evenly spaced ranges can be read",
                      where, i, range_m[i], even_m);
    }
  }
  const double near_m = range_m.front() - (RangesAreEdges(message, bin_m) ? 0.0 : 0.5 * bin_m);
  PolarAxes axes{std::max(0.0, near_m), near_m + bins * bin_m, bins, AzimuthsRad(message, options)};
  if (RunsDown(axes.beam_azimuth_rad))
    std::reverse(axes.beam_azimuth_rad.begin(), axes.beam_azimuth_rad.end());
  axes.Validate(where);
  return axes;
}

ImageScale ScaleOf(const ProjectedSonarImage& message, const std::string& where) {
  ImageScale scale;
  scale.full_scale = std::min(TypeOf(message, where).largest, kMaxRecordedFullScale);
  if (scale.full_scale == 0.0) {
    scale.quantity = Quantity::kPower;
    scale.full_scale = 1.0;
  }
  return scale;
}

// Mean of the finite, valid angles, in degrees; 0 if there is none.
double MeanDeg(const std::vector<float>& width_rad) {
  double sum_rad = 0.0;
  int count = 0;
  for (const float width : width_rad) {
    if (!(width > 0.0F && width < static_cast<float>(kPi))) continue;
    sum_rad += width;
    ++count;
  }
  return count == 0 ? 0.0 : DegFromRad(sum_rad / count);
}

// Mean change from each sample to the one `step` later.
double MeanChange(const std::vector<float>& samples, std::size_t step) {
  double sum = 0.0;
  for (std::size_t i = step; i < samples.size(); ++i) sum += std::abs(samples[i] - samples[i - step]);
  return sum / static_cast<double>(samples.size() - step);
}

// In the correct order, samples one row apart (the next beam or range) are similar.
void NoteOrder(const ProjectedSonarImage& message, const std::string& where,
               const SonarMessageOptions& options, RecordingInfo& info) {
  constexpr double kClearly = 1.25;
  const bool by_beam = options.sample_order == SampleOrder::kByBeam;
  const std::size_t beams = message.beam_direction.size();
  const std::size_t ranges = message.range_m.size();
  info.notes.push_back(fmt::format("Samples are read {}; the message's sizes do not determine the order.",
                                   by_beam ? "beam by beam, as its definition says" : "range by range"));
  if (beams == ranges) return;
  const std::vector<float> samples = Samples(message, where);
  const double change = MeanChange(samples, by_beam ? ranges : beams);
  const double other = MeanChange(samples, by_beam ? beams : ranges);
  if (change > kClearly * other) {
    info.notes.push_back(
        fmt::format("The first frame speaks for the other order, {} (--sample-order {}): neighbours there "
                    "differ by {:.3g} instead of {:.3g}.",
                    by_beam ? "range by range" : "beam by beam", by_beam ? "range" : "beam", other, change));
  }
}

}  // namespace

PolarImage ImageOf(const ProjectedSonarImage& message, const std::string& where,
                   const SonarMessageOptions& options) {
  CheckSizes(message, where);
  PolarImage image{AxesOf(message, where, options), ScaleOf(message, where), {}};
  const std::vector<float> samples = Samples(message, where);
  const int bins = image.axes.range_bins;
  const int beams = image.axes.beam_count();
  const bool turned = RunsDown(AzimuthsRad(message, options));
  image.value = Grid<float>(bins, beams);
  for (int bin = 0; bin < bins; ++bin) {
    for (int beam = 0; beam < beams; ++beam) {
      const std::size_t at = options.sample_order == SampleOrder::kByBeam
                                 ? static_cast<std::size_t>(beam) * bins + bin
                                 : static_cast<std::size_t>(bin) * beams + beam;
      image.value(bin, turned ? beams - 1 - beam : beam) = samples[at];
    }
  }
  return image;
}

void Describe(const ProjectedSonarImage& message, const std::string& where,
              const SonarMessageOptions& options, RecordingInfo& info) {
  CheckSizes(message, where);
  SonarModel& sonar = info.sonar;
  sonar.name = "sonar of a ProjectedSonarImage";
  sonar.axes = AxesOf(message, where, options);
  if (kSonarFrequencyHz.Contains(message.frequency_hz)) {
    sonar.frequency_hz = message.frequency_hz;
  } else if (message.frequency_hz != 0.0F) {
    info.notes.push_back(fmt::format("Frequency {} Hz is invalid and was omitted.", message.frequency_hz));
  }
  sonar.sound_speed_m_per_s =
      kSonarSoundSpeedMPerS.Contains(message.sound_speed_m_per_s) ? message.sound_speed_m_per_s : 0.0;
  sonar.azimuth_beam_width_deg = MeanDeg(message.rx_beam_width_rad);
  sonar.elevation_beam_width_deg = MeanDeg(message.tx_beam_width_rad);
  info.scale = ScaleOf(message, where);
  info.details.emplace_back("samples", TypeOf(message, where).name);
  info.notes.emplace_back(kNoSettingsRecorded);
  if (info.scale.quantity == Quantity::kPower) info.notes.emplace_back(kFloatsAreTakenAsPower);
  NoteOrder(message, where, options, info);
  if (LookAlongX(message)) {
    info.notes.emplace_back(
        "Beams lie around X, not around Z as the definition says: X is read as forward, Y as left.");
  } else {
    info.notes.emplace_back(
        "Left and right follow the definition, X up; a driver that means X down makes mirrored pictures.");
  }
  const double bin_m = sonar.axes.range_bin_m();
  if (RangesAreEdges(message, bin_m))
    info.notes.emplace_back("Ranges begin nearer than half a bin and are read as the bins' near edges.");
  if (options.mirrored) info.notes.emplace_back("Left and right are exchanged, as asked for.");
}

}  // namespace sonarcal::data_io
