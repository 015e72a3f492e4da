#include "data_io/ros/sonar_info.h"

#include <algorithm>
#include <cmath>

#include "core/types/error.h"
#include "core/types/printable.h"
#include "data_io/json/recording_limits.h"
#include "data_io/ros/projected_sonar_image.h"
#include "data_io/ros/ros_messages.h"

namespace sonarcal::data_io {
namespace {

// Versions of the definition, the newest first.
enum class Layout {
  kWithLoss,        // transmission loss of the angular response
  kWithBandwidths,  // bandwidths of the pulses
  kFirst,
};

template <typename Enum>
Enum Value(MessageStream& stream, std::string_view field, Enum last) {
  const std::string where = stream.Where(field);
  const std::uint8_t value = stream.U8(field);
  if (value > static_cast<std::uint8_t>(last)) {
    throw DataError("{}: {}, expected 0..{}", where, value, static_cast<std::uint8_t>(last));
  }
  return static_cast<Enum>(value);
}

std::uint8_t UpTo(MessageStream& stream, std::string_view field, std::uint8_t last) {
  return Value<std::uint8_t>(stream, field, last);
}

SonarInfo ReadAs(MessageStream stream, Layout layout) {
  SonarInfo sonar;
  sonar.stamp_ns = ReadStampNs(stream);
  sonar.frame_id = stream.String("header.frame_id");
  sonar.sonar_model = stream.String("sonar_model");
  sonar.calibration_ref = stream.String("calibration_ref");
  sonar.calibration_time_ns = std::int64_t{stream.U32("calibration_time.sec")} * kNsPerS;
  sonar.calibration_time_ns += stream.U32("calibration_time.nanosec");
  sonar.pulse_length_s = stream.F32s("pulse_lengths");
  if (layout != Layout::kFirst) sonar.bandwidth_hz = stream.F32s("bandwidths");
  for (const std::byte type : stream.Bytes("tx_signal_types"))
    sonar.signal_type.push_back(std::to_integer<std::uint8_t>(type));
  sonar.quantity = Value(stream, "intensity_quantity", IntensityQuantity::kPower);
  sonar.intensity_scale = Value(stream, "intensity_scale", IntensityScale::kDecibel);
  sonar.reference = Value(stream, "intensity_reference", IntensityReference::kAbsolute);
  sonar.scale = stream.F32("scale");
  sonar.offset = stream.F32("offset");
  sonar.tvg = Value(stream, "tvg_model", TvgModel::kCustom);
  sonar.tvg_absorption_db_per_km = stream.F32("tvg_absorption_db_per_km");
  sonar.source_level_db = stream.F32("source_level_db");
  if (layout == Layout::kFirst) {
    // The first version had a bool, whose false did not exclude a normalization.
    sonar.angular_normalization = UpTo(stream, "backscatter_angle_normalized", 1) == 1 ? 2 : 0;
  } else {
    sonar.angular_normalization = UpTo(stream, "angular_normalization", 2);
  }
  sonar.angular_response_angle_deg = stream.F32s("angular_response_angle_deg");
  sonar.angular_response_db = stream.F32s("angular_response_db_rel_nadir");
  if (layout == Layout::kWithLoss) {
    sonar.angular_response_loss = UpTo(stream, "angular_response_tl", 2);
    sonar.angular_response_absorption_db_per_m = stream.F32("angular_response_absorption_db_per_m");
  }
  sonar.beam_pattern_angle_deg = stream.F32s("beam_pattern_angle_deg");
  sonar.beam_pattern_gain_db = stream.F32s("beam_pattern_gain_db");
  stream.Finish();
  return sonar;
}

void CheckParallel(std::size_t a, std::size_t b, const char* names, const std::string& where) {
  if (a != 0 && b != 0 && a != b) {
    throw DataError("{}: {} have {} and {} elements, expected equal numbers", where, names, a, b);
  }
}

const char* Name(TvgModel tvg) {
  switch (tvg) {
    case TvgModel::kNone:
      return "none";
    case TvgModel::k20LogR:
      return "20logR";
    case TvgModel::k40LogR:
      return "40logR";
    case TvgModel::kCustom:
      return "another law";
    case TvgModel::kUnknown:
      break;
  }
  return "unknown";
}

// True if the samples can be converted to levels.
bool StatesLevels(const SonarInfo& sonar) {
  return sonar.intensity_scale == IntensityScale::kDecibel && std::isfinite(sonar.scale) &&
         sonar.scale > 0.0F && std::isfinite(sonar.offset);
}

// Levels of grey 0 and of full scale. Relative levels begin at 0.
struct GreyLevels {
  double min_db = 0.0;
  double max_db = 0.0;

  // True if recording.json can hold them.
  bool are_plausible() const {
    return max_db > min_db && kRecordedLevelDb.Contains(min_db) && kRecordedLevelDb.Contains(max_db);
  }
};

// Levels of grey values, if the message states them.
std::optional<GreyLevels> GreyLevelsOf(const SonarInfo& sonar, const ImageScale& scale) {
  if (scale.quantity != Quantity::kGrey || !StatesLevels(sonar)) return std::nullopt;
  const double min_db = sonar.reference == IntensityReference::kAbsolute ? sonar.offset : 0.0;
  return GreyLevels{min_db, min_db + scale.full_scale * sonar.scale};
}

bool IsPlausiblePulse(float pulse_s) {
  return kRecordedPulseUs.Contains(1e6 * static_cast<double>(pulse_s));
}

bool HoldsAmplitude(const SonarInfo& sonar, const ImageScale& scale) {
  return scale.quantity == Quantity::kPower && sonar.intensity_scale == IntensityScale::kLinear &&
         sonar.quantity == IntensityQuantity::kAmplitude;
}

bool HoldsLevels(const SonarInfo& sonar, const ImageScale& scale) {
  return scale.quantity == Quantity::kPower && sonar.intensity_scale == IntensityScale::kDecibel;
}

// Notes values that a recording cannot hold, and which are left out.
void NoteImplausible(const SonarInfo& sonar, RecordingInfo& info) {
  const auto note = [&info](const std::string& what) {
    info.notes.push_back(fmt::format("{} of SonarInfo is invalid and was omitted.", what));
  };
  if (const auto levels = GreyLevelsOf(sonar, info.scale); levels && !levels->are_plausible())
    note(fmt::format("The dB scale {:g} .. {:g} dB", levels->min_db, levels->max_db));
  if (!std::isnan(sonar.source_level_db) && !kRecordedLevelDb.Contains(sonar.source_level_db))
    note(fmt::format("The source level {:g} dB", sonar.source_level_db));
  for (const float pulse_s : sonar.pulse_length_s) {
    if (pulse_s > 0.0F && !IsPlausiblePulse(pulse_s))
      return note(fmt::format("The pulse length {:g} s", pulse_s));
  }
}

}  // namespace

SonarInfo ReadSonarInfo(std::span<const std::byte> bytes, MessageEncoding encoding,
                        const std::string& where) {
  std::string of_first;
  for (const Layout layout : {Layout::kWithLoss, Layout::kWithBandwidths, Layout::kFirst}) {
    try {
      SonarInfo sonar = ReadAs({bytes, encoding, where}, layout);
      CheckParallel(sonar.pulse_length_s.size(), sonar.bandwidth_hz.size(), "pulse_lengths and bandwidths",
                    where);
      CheckParallel(sonar.pulse_length_s.size(), sonar.signal_type.size(),
                    "pulse_lengths and tx_signal_types", where);
      CheckParallel(sonar.angular_response_angle_deg.size(), sonar.angular_response_db.size(),
                    "angles and levels of the angular response", where);
      CheckParallel(sonar.beam_pattern_angle_deg.size(), sonar.beam_pattern_gain_db.size(),
                    "angles and gains of the beam pattern", where);
      return sonar;
    } catch (const DataError& error) {
      if (of_first.empty()) of_first = error.what();
    }
  }
  throw DataError("{}", of_first);
}

bool HasSameContent(const SonarInfo& a, const SonarInfo& b) {
  // NaN, which means "unknown", equals itself here.
  const auto same = [](float x, float y) { return x == y || (std::isnan(x) && std::isnan(y)); };
  return a.frame_id == b.frame_id && a.sonar_model == b.sonar_model &&
         a.calibration_ref == b.calibration_ref && a.calibration_time_ns == b.calibration_time_ns &&
         std::ranges::equal(a.pulse_length_s, b.pulse_length_s, same) &&
         std::ranges::equal(a.bandwidth_hz, b.bandwidth_hz, same) && a.signal_type == b.signal_type &&
         a.quantity == b.quantity && a.intensity_scale == b.intensity_scale && a.reference == b.reference &&
         same(a.scale, b.scale) && same(a.offset, b.offset) && a.tvg == b.tvg &&
         same(a.tvg_absorption_db_per_km, b.tvg_absorption_db_per_km) &&
         same(a.source_level_db, b.source_level_db) && a.angular_normalization == b.angular_normalization &&
         std::ranges::equal(a.angular_response_angle_deg, b.angular_response_angle_deg, same) &&
         std::ranges::equal(a.angular_response_db, b.angular_response_db, same) &&
         a.angular_response_loss == b.angular_response_loss &&
         same(a.angular_response_absorption_db_per_m, b.angular_response_absorption_db_per_m) &&
         std::ranges::equal(a.beam_pattern_angle_deg, b.beam_pattern_angle_deg, same) &&
         std::ranges::equal(a.beam_pattern_gain_db, b.beam_pattern_gain_db, same);
}

ImageScale ScaleWith(const SonarInfo& sonar, const ImageScale& scale) {
  ImageScale with = scale;
  if (HoldsLevels(sonar, scale)) {
    with.quantity = Quantity::kDecibel;
  } else if (const auto levels = GreyLevelsOf(sonar, scale); levels && levels->are_plausible()) {
    if (sonar.reference == IntensityReference::kAbsolute) {
      with.db_min = levels->min_db;
      with.db_max = levels->max_db;
      with.db_span.reset();
    } else {
      with.db_span = levels->max_db;
    }
  }
  return with;
}

void Apply(const SonarInfo& sonar, PolarImage& image) {
  if (HoldsLevels(sonar, image.scale) && StatesLevels(sonar)) {
    for (float& value : image.value.values()) value = value * sonar.scale + sonar.offset;
  } else if (HoldsAmplitude(sonar, image.scale)) {
    for (float& value : image.value.values()) value *= value;
  }
  image.scale = ScaleWith(sonar, image.scale);
}

SonarSettings SettingsWith(const SonarInfo& sonar, const ImageScale& scale, SonarSettings settings) {
  const std::vector<float>& pulses_s = sonar.pulse_length_s;
  const bool is_one_pulse = !pulses_s.empty() && std::ranges::all_of(pulses_s, [&](float pulse_s) {
    return pulse_s == pulses_s[0];
  });
  if (is_one_pulse && IsPlausiblePulse(pulses_s[0]))
    settings.pulse_length_us = 1e6 * static_cast<double>(pulses_s[0]);
  if (sonar.tvg != TvgModel::kUnknown) settings.time_varied_gain = sonar.tvg != TvgModel::kNone;
  if (scale.quantity != Quantity::kGrey) return settings;
  if (sonar.intensity_scale == IntensityScale::kDecibel) settings.compression = Compression::kLogarithm;
  if (sonar.intensity_scale == IntensityScale::kLinear) settings.compression = Compression::kPower;
  return settings;
}

void Describe(const SonarInfo& sonar, RecordingInfo& info) {
  NoteImplausible(sonar, info);
  if (!sonar.sonar_model.empty()) info.sonar.name = Printable(sonar.sonar_model);
  if (HoldsLevels(sonar, info.scale)) std::erase(info.notes, kFloatsAreTakenAsPower);
  if (HoldsAmplitude(sonar, info.scale))
    info.notes.emplace_back("Samples are amplitudes; their squares are read as power.");
  info.settings = SettingsWith(sonar, info.scale, info.settings);
  info.scale = ScaleWith(sonar, info.scale);
  if (info.settings.compression == Compression::kPower) {
    if (sonar.quantity == IntensityQuantity::kAmplitude) info.display_gamma = 1.0;
    if (sonar.quantity == IntensityQuantity::kPower) info.display_gamma = 2.0;
  }
  if (kRecordedLevelDb.Contains(sonar.source_level_db)) info.source_level_db = sonar.source_level_db;
  // Messages without this note state a gain, or have a note of their own.
  if (std::erase(info.notes, kNoSettingsRecorded) > 0)
    info.notes.emplace_back("Neither gain nor water is recorded.");
  info.notes.emplace_back("Pulse, time-varied gain and scale are those of SonarInfo.");
  std::string tvg = Name(sonar.tvg);
  if (std::isfinite(sonar.tvg_absorption_db_per_km))
    tvg += fmt::format(", absorption {:g} dB/km", sonar.tvg_absorption_db_per_km);
  info.details.emplace_back("time-varied gain", tvg);
  if (!sonar.calibration_ref.empty())
    info.details.emplace_back("calibration", Printable(sonar.calibration_ref));
  if (!sonar.bandwidth_hz.empty())
    info.details.emplace_back("bandwidth", fmt::format("{:g} kHz", 1e-3 * sonar.bandwidth_hz[0]));
  if (!sonar.beam_pattern_gain_db.empty())
    info.details.emplace_back("beam pattern", fmt::format("{} points", sonar.beam_pattern_gain_db.size()));
  if (!sonar.angular_response_db.empty())
    info.details.emplace_back("angular response", fmt::format("{} points", sonar.angular_response_db.size()));
  if (sonar.angular_normalization == 2)
    info.notes.emplace_back("Levels are normalized by the angular response: materials cannot be fitted.");
}

}  // namespace sonarcal::data_io
