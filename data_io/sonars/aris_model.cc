#include "data_io/sonars/aris_model.h"

#include <algorithm>
#include <cmath>

#include "core/sonars/aris_pings.h"
#include "core/types/error.h"
#include "data_io/json/recording_limits.h"
#include "data_io/sonars/header_gain.h"

namespace sonarcal::data_io {
namespace {

constexpr double kDbSpan = 80.0;

std::string ModelName(const ArisHeader& header) {
  constexpr int kModel[] = {1800, 3000, 1200};
  return fmt::format("ARIS {}{}", kModel[static_cast<int>(header.system)],
                     header.lens == ArisLens::kTelephoto ? ", telephoto lens" : "");
}

double FrequencyHz(const ArisHeader& header) {
  switch (header.system) {
    case ArisSystem::kAris3000:
      return header.high_frequency ? 3.0e6 : 1.8e6;
    case ArisSystem::kAris1800:
      return header.high_frequency ? 1.8e6 : 1.1e6;
    case ArisSystem::kAris1200:
      return header.high_frequency ? 1.2e6 : 0.7e6;
  }
  return 0.0;
}

// Pings that make a frame. Columns go from left to right, the sonar counts its beams from the right.
PingPattern PingsOf(const ArisHeader& header) {
  constexpr std::uint32_t kMinCycleUs = 1802;  // limits of the manufacturer
  constexpr std::uint32_t kMaxCycleUs = 65535;
  PingPattern pings{.of_beam = ArisPingOfBeam(static_cast<int>(header.ping_mode))};
  std::ranges::reverse(pings.of_beam);
  const bool known = header.cycle_period_us >= kMinCycleUs && header.cycle_period_us <= kMaxCycleUs;
  if (known) pings.period_s = header.cycle_period_us * 1e-6;
  return pings;
}

std::string PingsText(const PingPattern& pings) {
  const std::string period =
      pings.period_s > 0.0 ? fmt::format(", {:.4g} ms apart", pings.period_s * 1e3) : "";
  return fmt::format("{} pings make a frame{}: beam k, counted from 0 at the right, belongs to ping k mod {}",
                     pings.count(), period, pings.count());
}

}  // namespace

PolarAxes ArisAxes(const ArisHeader& header, const std::string& what) {
  const auto centres_deg = ArisBeamCentresDeg(header.system, header.beam_count(), header.lens);
  if (centres_deg.empty()) {
    throw DataError(
        "{}: {} with {} beams (PingMode {}), expected a combination with a beam table of the manufacturer",
        what, ModelName(header), header.beam_count(), header.ping_mode);
  }
  PolarAxes axes{header.range_min_m(), header.range_max_m(), static_cast<int>(header.samples_per_beam),
                 ArisAzimuthsRad(centres_deg)};
  axes.Validate(what);
  return axes;
}

SonarSettings ArisSettings(const ArisHeader& header) {
  SonarSettings settings;
  settings.gain_db = HeaderGainDb(header.gain_db);
  if (kRecordedPulseUs.Contains(header.pulse_width_us)) settings.pulse_length_us = header.pulse_width_us;
  settings.compression = Compression::kLogarithm;
  return settings;
}

void DescribeAris(const ArisHeader& header, const std::string& what, RecordingInfo& info) {
  info.sonar.name = ModelName(header);
  info.sonar.frequency_hz = FrequencyHz(header);
  info.sonar.axes = ArisAxes(header, what);
  info.sonar.beam_forming = BeamForming::kLens;
  info.sonar.sound_speed_m_per_s = header.sound_speed_m_per_s;
  info.sonar.pings = PingsOf(header);
  info.scale.full_scale = 255.0;
  info.scale.db_span = kDbSpan;
  if (header.lens == ArisLens::kTelephoto) {
    info.notes.emplace_back("The elevation beam width is not recorded, and not known with a telephoto lens.");
  } else {
    info.sonar.elevation_beam_width_deg = header.system == ArisSystem::kAris3000 ? 15.0 : 14.0;
    info.notes.emplace_back(
        "The elevation beam width is not recorded; the manufacturer's nominal value is used.");
  }
  if (header.water_temperature_c >= -3.0f && header.water_temperature_c <= 45.0f &&
      header.salinity_ppt <= 50) {
    info.water = Water{.temperature_c = header.water_temperature_c,
                       .salinity_ppt = static_cast<double>(header.salinity_ppt)};
    info.notes.emplace_back("Acidity and depth of the water are not recorded; defaults are used.");
  } else {
    info.notes.push_back(
        fmt::format("Water temperature {} C and salinity {} ppt are impossible and were omitted.",
                    header.water_temperature_c, header.salinity_ppt));
  }
  info.settings = ArisSettings(header);
  NoteHeaderGain(header.gain_db, info);
  if (!info.settings.pulse_length_us) {
    info.notes.push_back(
        fmt::format("Pulse width {} us is impossible and was omitted.", header.pulse_width_us));
  }
  info.details = {{"frame rate", fmt::format("{:.3f} Hz", header.frame_rate_hz)},
                  {"receiver gain", fmt::format("{} dB", header.gain_db)},
                  {"pulse width", fmt::format("{} us", header.pulse_width_us)},
                  {"sample period", fmt::format("{} us", header.sample_period_us)},
                  {"ping mode", fmt::format("{} ({} beams)", header.ping_mode, header.beam_count())},
                  {"frequency", header.high_frequency ? "high" : "low"},
                  {"lens", header.lens == ArisLens::kTelephoto ? "telephoto" : "standard"},
                  {"water temperature", fmt::format("{:.1f} C", header.water_temperature_c)},
                  {"salinity", fmt::format("{} ppt", header.salinity_ppt)}};
  if (!info.sonar.pings.of_beam.empty()) info.details.emplace_back("pings", PingsText(info.sonar.pings));
}

void NoteArisWindow(const ArisHeader& header, RecordingInfo& info) {
  const double window_end_m = double{header.window_start_m} + header.window_length_m;
  const double tolerance_m = header.bin_m();
  // Negated so that a NaN in the header is noted too.
  if (!(std::abs(header.window_start_m - header.range_min_m()) <= tolerance_m &&
        std::abs(window_end_m - header.range_max_m()) <= tolerance_m)) {
    info.notes.push_back(fmt::format(
        "WindowStart and WindowLength give {:.4f}..{:.4f} m; the sample timing, which is used, gives "
        "{:.4f}..{:.4f} m.",
        header.window_start_m, window_end_m, header.range_min_m(), header.range_max_m()));
  }
}

}  // namespace sonarcal::data_io
