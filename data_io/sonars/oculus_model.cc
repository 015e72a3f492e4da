#include "data_io/sonars/oculus_model.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/types/error.h"
#include "core/types/units.h"

namespace sonarcal::data_io {
namespace {

// Nominal values of a model in one of its modes (Blueprint Subsea, data sheets of the Oculus series).
struct Mode {
  std::uint8_t mode;
  double frequency_hz;
  const char* model;
  double azimuth_beam_width_deg;
  double elevation_beam_width_deg;
};
constexpr Mode kModes[] = {
    {1, 0.75e6, "Oculus M750d", 1.0, 20.0},           {2, 1.2e6, "Oculus M750d", 0.6, 20.0},
    {1, 1.2e6, "Oculus M1200d or M3000d", 0.6, 20.0}, {2, 2.1e6, "Oculus M1200d", 0.4, 12.0},
    {2, 3.0e6, "Oculus M3000d", 0.25, 20.0},
};
constexpr double kFrequencyTolerance = 0.05;  // the recorded frequency differs slightly from the nominal one

const Mode* FindMode(const OculusPing& ping) {
  for (const Mode& mode : kModes) {
    if (mode.mode == ping.mode &&
        std::abs(ping.frequency_hz - mode.frequency_hz) <= kFrequencyTolerance * mode.frequency_hz) {
      return &mode;
    }
  }
  return nullptr;
}

// True if the value is within the limits, and not one of the tiny numbers that uninitialised memory gives as
// a double.
bool IsPlausible(double value, double lowest, double highest) {
  return value >= lowest && value <= highest && (value == 0.0 || std::abs(value) > 1e-6);
}

void DescribeSonar(const OculusPing& ping, RecordingInfo& info) {
  info.sonar.name = "Oculus";
  info.sonar.beam_forming = BeamForming::kArray;
  info.sonar.axes = OculusAxes(ping, info.source + ": ping 0");
  info.scale = OculusScale(ping);
  info.settings.compression = Compression::kPower;
  if (ping.has_settings) {
    info.display_gamma = ping.gamma == 0 ? 1.0 : ping.gamma / 255.0;
  } else {
    info.notes.emplace_back("Neither gamma nor salinity is recorded.");
  }
  if (!ping.has_environment) {
    info.notes.emplace_back(
        "Neither model, beam widths, frequency, temperature, pressure nor sound speed is recorded.");
  } else if (const Mode* mode = FindMode(ping)) {
    info.sonar.name = mode->model;
    info.sonar.azimuth_beam_width_deg = mode->azimuth_beam_width_deg;
    info.sonar.elevation_beam_width_deg = mode->elevation_beam_width_deg;
    info.notes.emplace_back(
        "The model is not recorded: it and its beam widths are presumed from mode and frequency.");
  } else {
    info.notes.emplace_back("The model is not recorded and no known one has this mode and frequency.");
  }
  if (IsPlausible(ping.frequency_hz, 1e5, 1e7)) {
    info.sonar.frequency_hz = ping.frequency_hz;
  } else if (ping.has_environment) {
    info.notes.push_back(fmt::format("Frequency {} Hz is invalid and was omitted.", ping.frequency_hz));
  }
  if (IsPlausible(ping.sound_speed_m_per_s, 1300.0, 1700.0)) {
    info.sonar.sound_speed_m_per_s = ping.sound_speed_m_per_s;
  } else if (ping.has_environment) {
    info.notes.push_back(
        fmt::format("Sound speed {} m/s is invalid and was omitted.", ping.sound_speed_m_per_s));
  }
  info.details = {
      {"mode", ping.mode == 1 ? "1 (low frequency)" : fmt::format("{} (high frequency)", ping.mode)},
      {"range setting", fmt::format("{} {}", ping.range_setting, ping.range_is_metres ? "m" : "%")},
      {"gain", fmt::format("{} %", ping.gain_percent)}};
  if (ping.has_settings) {
    info.details.emplace_back("gamma", fmt::format("{:.3f} (byte {})", *info.display_gamma, ping.gamma));
    info.details.emplace_back("salinity setting", fmt::format("{} ppt", ping.salinity_ppt));
  }
  info.details.emplace_back("sample size", fmt::format("{} bits", 8 * ping.bytes_per_sample));
  info.details.emplace_back("gain of each row",
                            ping.has_gains ? "sent, values divided by its square root" : "not sent");
  if (ping.version == 2) {
    info.details.emplace_back("heading, pitch, roll", fmt::format("{}, {}, {} degrees", ping.heading_deg,
                                                                  ping.pitch_deg, ping.roll_deg));
  }
}

void NoteEnvironment(const OculusPing& ping, RecordingInfo& info) {
  if (!ping.has_environment) return;
  if (IsPlausible(ping.temperature_c, -3.0, 45.0) && !ping.has_settings) {
    info.details.emplace_back("temperature", fmt::format("{:.2f} C", ping.temperature_c));
  } else if (IsPlausible(ping.temperature_c, -3.0, 45.0) && IsPlausible(ping.salinity_ppt, 0.0, 50.0)) {
    info.water = Water{.temperature_c = ping.temperature_c, .salinity_ppt = ping.salinity_ppt};
    info.details.emplace_back("temperature", fmt::format("{:.2f} C", ping.temperature_c));
    info.notes.emplace_back("Acidity and depth of the water are not recorded; defaults are used.");
  } else {
    info.notes.push_back(
        fmt::format("Temperature {:.6g} C with salinity {:.6g} ppt is invalid and was omitted.",
                    ping.temperature_c, ping.salinity_ppt));
  }
  if (IsPlausible(ping.pressure_bar, 0.0, 1200.0)) {
    info.details.emplace_back("pressure", fmt::format("{:.3f} bar", ping.pressure_bar));
  } else {
    info.notes.push_back(fmt::format("Pressure {:.6g} bar is invalid and was omitted.", ping.pressure_bar));
  }
}

}  // namespace

bool BearingsRunRightToLeft(const OculusPing& ping) {
  return ping.bearing_centideg.front() > ping.bearing_centideg.back();
}

PolarAxes OculusAxes(const OculusPing& ping, const std::string& what) {
  PolarAxes axes{0.0, ping.ranges * ping.range_resolution_m, ping.ranges, {}};
  for (const std::int16_t bearing : ping.bearing_centideg) {
    axes.beam_azimuth_rad.push_back(RadFromDeg(0.01 * bearing));
  }
  if (BearingsRunRightToLeft(ping)) std::reverse(axes.beam_azimuth_rad.begin(), axes.beam_azimuth_rad.end());
  axes.Validate(what);
  return axes;
}

ImageScale OculusScale(const OculusPing& ping) {
  ImageScale scale;
  scale.full_scale = ping.full_scale();
  return scale;
}

Grid<float> OculusSamples(const OculusPing& ping, std::span<const std::byte> image,
                          const std::string& where) {
  const ByteReader reader(image, where);
  Grid<float> samples(ping.ranges, ping.beams);
  for (int range = 0; range < ping.ranges; ++range) {
    std::uint64_t at = ping.row_bytes() * range;
    float scale = 1.0f;
    if (ping.has_gains) {
      const std::uint32_t gain = reader.U32(at, "gain of a row");
      if (gain == 0) throw DataError("{}: 0, expected at least 1", reader.Where(at, "gain of a row"));
      scale = 1.0f / std::sqrt(static_cast<float>(gain));
      at += 4;
    }
    for (float& sample : samples.row(range)) {
      sample = static_cast<float>(LittleEndian(reader.Bytes(at, ping.bytes_per_sample, "sample"))) * scale;
      at += ping.bytes_per_sample;
    }
  }
  return samples;
}

PolarImage OculusImage(const OculusPing& ping, Grid<float> samples, const std::string& what) {
  PolarImage image{OculusAxes(ping, what), OculusScale(ping), std::move(samples)};
  if (BearingsRunRightToLeft(ping)) {
    for (int row = 0; row < image.value.rows(); ++row) std::ranges::reverse(image.value.row(row));
  }
  return image;
}

void DescribeOculus(const OculusPing& ping, RecordingInfo& info) {
  DescribeSonar(ping, info);
  NoteEnvironment(ping, info);
}

}  // namespace sonarcal::data_io
