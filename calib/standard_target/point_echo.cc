#include "calib/standard_target/point_echo.h"

#include <cmath>

#include "core/types/units.h"
#include "sim/physics/propagation.h"
#include "sim/physics/receiver.h"

namespace sonarcal::calib {

sim::AzimuthResponse<double> AzimuthResponseOf(const PointEchoSetting& setting, const PointEcho& echo) {
  return sim::AzimuthResponse<double>({.pattern = setting.azimuth_pattern,
                                       .width_rad = std::exp(echo.log_azimuth_width),
                                       .taper = echo.azimuth_taper});
}

std::vector<double> EchoPowerOf(const EchoWindow& window, const PointEchoSetting& setting,
                                const PointEcho& echo, const FrameEcho& frame,
                                const std::vector<double>& sensitivity_db) {
  return EchoPowerOf(window, setting, echo, AzimuthResponseOf(setting, echo), frame, sensitivity_db);
}

std::vector<double> EchoPowerOf(const EchoWindow& window, const PointEchoSetting& setting,
                                const PointEcho& echo, const sim::AzimuthResponse<double>& azimuth,
                                const FrameEcho& frame, const std::vector<double>& sensitivity_db) {
  const double range_m = frame.range_m;
  double level_db = echo.level_db + frame.level_offset_db -
                    2.0 * sim::TransmissionLossDb(range_m, setting.absorption_db_per_m) +
                    echo.range_slope_db_per_decade * std::log10(range_m / setting.reference_range_m);
  if (setting.with_elevation) {
    const sim::ElevationResponse elevation(setting.elevation_pattern, std::exp(echo.log_elevation_width),
                                           setting.elevation_taper);
    level_db += DbFromPower(elevation.Power(window.elevation_rad));
  }
  std::vector<double> of_beam;
  for (std::size_t i = 0; i < window.beam_azimuth_rad.size(); ++i) {
    of_beam.push_back(PowerFromDb(sensitivity_db[i]) *
                      azimuth.Power(frame.azimuth_rad, window.beam_azimuth_rad[i]));
  }
  std::vector<double> power;
  power.reserve(window.power.size());
  for (const double bin_m : window.bin_range_m) {
    const double gain_db =
        sim::TimeVariedGainDb(setting.time_varied_gain, bin_m, setting.absorption_db_per_m);
    const double of_bin =
        PowerFromDb(level_db + gain_db) * sim::GaussianResponse(bin_m - range_m, std::exp(echo.log_pulse));
    for (const double response : of_beam) power.push_back(of_bin * response);
  }
  return power;
}

std::vector<double> VarianceOf(const EchoWindow& window, const std::vector<double>& echo_power,
                               double noise) {
  std::vector<double> variance;
  variance.reserve(echo_power.size());
  for (std::size_t i = 0; i < echo_power.size(); ++i) {
    variance.push_back(noise * (noise + 2.0 * echo_power[i]) + window.rounding_variance[i]);
  }
  return variance;
}

}  // namespace sonarcal::calib
