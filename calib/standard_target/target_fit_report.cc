#include "calib/standard_target/target_fit_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "core/math/statistics.h"
#include "core/types/units.h"
#include "sim/physics/beam_and_pulse.h"
#include "sim/physics/receiver.h"

namespace sonarcal::calib {
namespace {

void FillParameters(const FittedPointEcho& state, const PolarAxes& axes, const ParameterSet& initial,
                    StandardTargetFit& fit) {
  ParameterSet& parameters = fit.parameters;
  parameters = initial;
  parameters.model = EchoModel::kAcoustic;
  parameters.source_level_db = fit.level_db - initial.receiver.gain_db;
  parameters.source_level_sigma_db = fit.level_sigma_db;
  parameters.receiver.time_varied_gain = state.data.setting.time_varied_gain;
  parameters.beam.azimuth_pattern = state.data.setting.azimuth_pattern;
  parameters.beam.azimuth_width_deg = DegFromRad(std::exp(state.solution.echo.log_azimuth_width));
  parameters.beam.azimuth_taper = state.solution.echo.azimuth_taper;
  parameters.beam.azimuth_table_db.clear();
  parameters.pulse.length_m = std::exp(state.solution.echo.log_pulse);
  if (state.free.elevation_width)
    parameters.beam.elevation_width_deg = DegFromRad(std::exp(state.solution.echo.log_elevation_width));
  if (state.data.groups > 0) {
    parameters.beam.sensitivity_db.clear();
    for (int beam = 0; beam < axes.beam_count(); ++beam)
      parameters.beam.sensitivity_db.push_back(state.solution.group_db[state.data.group_of_beam[beam]]);
  }
  std::vector<double> noise_db;
  for (const TargetFrame& frame : fit.frames) {
    noise_db.push_back(frame.noise_db - sim::TimeVariedGainDb(state.data.setting.time_varied_gain,
                                                              frame.range_m,
                                                              state.data.setting.absorption_db_per_m));
  }
  parameters.receiver.noise_db = Median(std::move(noise_db));
  parameters.receiver.noise_slope_db_per_m = 0.0;
  parameters.receiver.noise_taper_db.clear();
}

void Add(FitReport& report, const std::string& name, const std::string& unit, double value, double sigma,
         double initial, double lower, double upper, bool free, bool at_bound = false) {
  const ParameterStatus status = !free      ? ParameterStatus::kFixed
                                 : at_bound ? ParameterStatus::kAtBound
                                            : ParameterStatus::kFree;
  report.parameters.push_back(
      {.name = name,
       .unit = unit,
       .value = value,
       .sigma = status == ParameterStatus::kFree ? std::optional(sigma) : std::nullopt,
       .initial = initial,
       .lower = lower,
       .upper = upper,
       .status = status});
  if (status == ParameterStatus::kFree && name.find("sensitivity") == std::string::npos)
    report.correlation_names.push_back(name);
}

void FillSentences(const FittedPointEcho& state, StandardTargetFit& fit) {
  FitReport& report = fit.report;
  report.gauge.emplace_back(
      "receiver.gain_db as given: a target shows source level and gain only as their sum");
  if (!fit.elevation_unknown.empty()) {
    report.gauge.push_back(fmt::format(
        "the sphere is taken to be on the axis in elevation, because {}; if it was not, the level is "
        "too low by the elevation response there",
        fit.elevation_unknown));
  }
  if (fit.position && fit.position->mirror_m) {
    const Eigen::Vector3d& at_m = fit.position->position_m;
    const Eigen::Vector3d& mirror_m = *fit.position->mirror_m;
    report.gauge.push_back(fmt::format(
        "the sphere is taken to be at ({:.3f}, {:.3f}, {:.3f}) m in the world: its mirror image in the plane "
        "of the beams, at ({:.3f}, {:.3f}, {:.3f}) m, agrees with the poses as well, so the elevations are "
        "known except for their sign",
        at_m.x(), at_m.y(), at_m.z(), mirror_m.x(), mirror_m.y(), mirror_m.z()));
  }
  if (state.data.groups == 0)
    report.gauge.emplace_back(
        "sensitivity of the beams as given: the sphere did not move over three beam widths");
  if (state.slope_sigma_db == 0.0) {
    report.gauge.push_back(
        fmt::format("gain with range {} as given: the ranges of the sphere differ by less than a quarter",
                    ToString(state.data.setting.time_varied_gain)));
  } else if (!state.free.range_slope) {
    report.gauge.push_back(
        fmt::format("gain with range {}: with it, levels change by {:.1f} +- {:.1f} dB per decade of range",
                    ToString(state.data.setting.time_varied_gain), state.slope_db, state.slope_sigma_db));
  }
  if (fit.strength.doubtful) {
    report.warnings.push_back(
        fmt::format("the pulse of {:.1f} mm is within a factor of two of the first internal echo of the "
                    "sphere, {:.1f} mm "
                    "behind its front face, so the target strength by the {} may be off by decibels",
                    1e3 * fit.parameters.pulse.length_m, 1e3 * fit.strength.first_internal_echo_m,
                    fit.strength.front_face ? "front face alone" : "whole sphere"));
  }
  if (static_cast<int>(fit.frames.size()) < kFramesForScatter) {
    report.warnings.push_back(fmt::format(
        "only {} frames show the sphere: standard errors assume that resolution cells are independent, and "
        "the level contains what moves the sphere or the water between frames",
        fit.frames.size()));
  }
  if (state.solution.pulse_at_bound)
    report.warnings.emplace_back(
        "the pulse is shorter than the range bins show, so the level may be too low");
}

void FillReport(const FittedPointEcho& state, const SonarModel& sonar, const ParameterSet& initial,
                StandardTargetFit& fit) {
  const PointEcho& echo = state.solution.echo;
  const ParameterSet& fitted = fit.parameters;
  const double width_deg = fitted.beam.azimuth_width_deg;
  std::vector<int> entries = {0, 1};
  Add(fit.report, "source_level_db", "dB", fitted.source_level_db, fit.level_sigma_db,
      initial.source_level_db, -300.0, 300.0, true);
  Add(fit.report, "beam.azimuth_width_deg", "deg", width_deg, width_deg * state.Sigma(1),
      sonar.azimuth_beam_width_deg, 0.0, 180.0, true);
  if (state.data.setting.azimuth_pattern == AzimuthPattern::kAperture) {
    Add(fit.report, "beam.azimuth_taper", "", echo.azimuth_taper, state.Sigma(2), initial.beam.azimuth_taper,
        0.0, 1.0, true, state.solution.taper_at_bound);
    if (!state.solution.taper_at_bound) entries.push_back(2);
  }
  Add(fit.report, "pulse.length_m", "m", fitted.pulse.length_m, fitted.pulse.length_m * state.Sigma(3),
      sim::PulseLengthM(sonar, initial), 0.3 * sonar.axes.range_bin_m(), sonar.axes.range_max_m, true,
      state.solution.pulse_at_bound);
  if (!state.solution.pulse_at_bound) entries.push_back(3);
  if (state.free.range_slope) {
    Add(fit.report, "range_slope_db_per_decade", "dB", echo.range_slope_db_per_decade, state.Sigma(4), 0.0,
        -100.0, 100.0, true);
    entries.push_back(4);
  }
  if (state.data.setting.with_elevation) {
    const double elevation_deg = DegFromRad(std::exp(echo.log_elevation_width));
    Add(fit.report, "beam.elevation_width_deg", "deg", elevation_deg, elevation_deg * state.Sigma(5),
        sim::ElevationWidthDeg(sonar, initial.beam), 0.0, 180.0, state.free.elevation_width);
    if (state.free.elevation_width) entries.push_back(5);
  }
  for (int group = 0; group < state.data.groups; ++group) {
    Add(fit.report, fmt::format("beam.sensitivity_db.{}", fit.beams_determined[group]), "dB",
        state.solution.group_db[group], state.Sigma(PointEcho::kSize + group), 0.0, -100.0, 100.0, true);
  }
  const auto count = static_cast<Eigen::Index>(entries.size());
  fit.report.correlation.resize(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = 0; j < count; ++j) {
      const auto sigma = [&](int entry) { return entry == 0 ? fit.level_sigma_db : state.Sigma(entry); };
      fit.report.correlation(i, j) = i == j ? 1.0
                                            : state.solution.covariance(entries[i], entries[j]) /
                                                  (sigma(entries[i]) * sigma(entries[j]));
    }
  }
  FillSentences(state, fit);
}

}  // namespace

double FittedPointEcho::Sigma(int entry) const {
  return std::sqrt(solution.covariance(entry, entry));
}

void FillTargetReport(const FittedPointEcho& state, const SonarModel& sonar, const ParameterSet& initial,
                      StandardTargetFit& fit) {
  FillParameters(state, sonar.axes, initial, fit);
  FillReport(state, sonar, initial, fit);
}

}  // namespace sonarcal::calib
