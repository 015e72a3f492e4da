#include "data_io/bag_writers/sonar_info_message.h"

#include <cmath>

#include "core/types/units.h"
#include "data_io/bag_writers/message_builder.h"
#include "data_io/bag_writers/recording_messages.h"

namespace sonarcal::data_io {
namespace {

void AddFloats(MessageBuilder& message, const std::vector<float>& values) {
  message.Count(values.size());
  for (const float value : values) message.Number(value);
}

template <typename Enum>
void AddEnum(MessageBuilder& message, Enum value) {
  message.Number(static_cast<std::uint8_t>(value));
}

void SetTvg(const SonarSettings& settings, const std::optional<SonarCalibration>& calibration,
            SonarInfo& sonar) {
  if (!calibration) {
    if (settings.time_varied_gain)
      sonar.tvg = *settings.time_varied_gain ? TvgModel::kCustom : TvgModel::kNone;
    return;
  }
  switch (calibration->parameters.receiver.time_varied_gain) {
    case TimeVariedGain::kNone:
      sonar.tvg = TvgModel::kNone;
      return;
    case TimeVariedGain::k20LogR:
      sonar.tvg = TvgModel::k20LogR;
      sonar.tvg_absorption_db_per_km = 0.0F;
      return;
    case TimeVariedGain::k40LogR:
      sonar.tvg = TvgModel::k40LogR;
      sonar.tvg_absorption_db_per_km = 0.0F;
      return;
    case TimeVariedGain::k40LogRAndAbsorption:
      sonar.tvg = TvgModel::k40LogR;
      sonar.tvg_absorption_db_per_km = static_cast<float>(1000.0 * calibration->absorption_db_per_m);
      return;
  }
}

// Levels of grey 0 and of full scale.
struct Levels {
  double min_db = 0.0;
  double max_db = 0.0;
  bool is_absolute = false;
};

std::optional<Levels> LevelsOf(const RecordingInfo& info, const std::optional<SonarCalibration>& calibration,
                               bool has_source_level) {
  if (calibration) {
    const ParameterSet& parameters = calibration->parameters;
    if (parameters.display.law != DisplayLaw::kLog) return std::nullopt;
    // The display shows levels behind the receiver's gain. Those of SonarInfo are in the water.
    const double gain_db = parameters.receiver.gain_db;
    return Levels{parameters.display.db_min - gain_db, parameters.display.db_max - gain_db, true};
  }
  const ImageScale& scale = info.scale;
  if (scale.db_min && scale.db_max) return Levels{*scale.db_min, *scale.db_max, has_source_level};
  if (scale.db_span) return Levels{0.0, *scale.db_span, false};
  return std::nullopt;
}

void SetScale(const RecordingInfo& info, const SonarSettings& settings,
              const std::optional<SonarCalibration>& calibration, SonarInfo& sonar) {
  if (info.scale.quantity == Quantity::kPower) {
    sonar.quantity = IntensityQuantity::kPower;
    sonar.intensity_scale = IntensityScale::kLinear;
    return;
  }
  if (const auto levels = LevelsOf(info, calibration, std::isfinite(sonar.source_level_db))) {
    sonar.quantity = IntensityQuantity::kPower;
    sonar.intensity_scale = IntensityScale::kDecibel;
    sonar.reference = levels->is_absolute ? IntensityReference::kAbsolute : IntensityReference::kRelative;
    sonar.scale = static_cast<float>((levels->max_db - levels->min_db) / info.scale.full_scale);
    sonar.offset = static_cast<float>(levels->min_db);
  } else if (settings.compression == Compression::kLogarithm) {
    sonar.quantity = IntensityQuantity::kPower;
    sonar.intensity_scale = IntensityScale::kDecibel;
    sonar.reference = IntensityReference::kRelative;
  } else if (settings.compression == Compression::kPower && info.display_gamma == 1.0) {
    sonar.quantity = IntensityQuantity::kAmplitude;
    sonar.intensity_scale = IntensityScale::kLinear;
    sonar.reference = IntensityReference::kRelative;
  }
}

void SetPulse(const RecordingInfo& info, const SonarSettings& settings,
              const std::optional<SonarCalibration>& calibration, SonarInfo& sonar) {
  const double length_m = calibration ? calibration->parameters.pulse.length_m : 0.0;
  const double speed_m_per_s = info.sonar.sound_speed_m_per_s;
  if (settings.pulse_length_us) {
    sonar.pulse_length_s = {static_cast<float>(1e-6 * *settings.pulse_length_us)};
  } else if (length_m > 0.0 && speed_m_per_s > 0.0) {
    sonar.pulse_length_s = {static_cast<float>(2.0 * length_m / speed_m_per_s)};
  }
}

}  // namespace

SonarInfo SonarInfoOf(const RecordingInfo& info, const SonarSettings& settings,
                      const std::optional<SonarCalibration>& calibration) {
  SonarInfo sonar;
  sonar.frame_id = kSonarFrame;
  sonar.sonar_model = info.sonar.name;
  if (info.source_level_db) sonar.source_level_db = static_cast<float>(*info.source_level_db);
  if (calibration) {
    sonar.calibration_ref = calibration->reference;
    sonar.calibration_time_ns = calibration->time_ns;
    sonar.source_level_db = static_cast<float>(calibration->parameters.source_level_db);
    const std::vector<double>& gain_db = calibration->parameters.beam.sensitivity_db;
    const std::vector<double>& azimuth_rad = info.sonar.axes.beam_azimuth_rad;
    for (std::size_t i = 0; i < gain_db.size() && gain_db.size() == azimuth_rad.size(); ++i) {
      sonar.beam_pattern_angle_deg.push_back(static_cast<float>(DegFromRad(azimuth_rad[i])));
      sonar.beam_pattern_gain_db.push_back(static_cast<float>(gain_db[i]));
    }
  }
  SetPulse(info, settings, calibration, sonar);
  SetTvg(settings, calibration, sonar);
  SetScale(info, settings, calibration, sonar);
  return sonar;
}

std::string SonarInfoMessage(MessageEncoding encoding, const SonarInfo& sonar) {
  MessageBuilder message(encoding);
  message.Header(0, sonar.stamp_ns, sonar.frame_id).Text(sonar.sonar_model).Text(sonar.calibration_ref);
  message.Time(sonar.calibration_time_ns);
  AddFloats(message, sonar.pulse_length_s);
  AddFloats(message, sonar.bandwidth_hz);
  message.Bytes({reinterpret_cast<const char*>(sonar.signal_type.data()), sonar.signal_type.size()});
  AddEnum(message, sonar.quantity);
  AddEnum(message, sonar.intensity_scale);
  AddEnum(message, sonar.reference);
  message.Number(sonar.scale).Number(sonar.offset);
  AddEnum(message, sonar.tvg);
  message.Number(sonar.tvg_absorption_db_per_km).Number(sonar.source_level_db);
  message.Number(sonar.angular_normalization);
  AddFloats(message, sonar.angular_response_angle_deg);
  AddFloats(message, sonar.angular_response_db);
  message.Number(sonar.angular_response_loss).Number(sonar.angular_response_absorption_db_per_m);
  AddFloats(message, sonar.beam_pattern_angle_deg);
  AddFloats(message, sonar.beam_pattern_gain_db);
  return message.Take();
}

}  // namespace sonarcal::data_io
