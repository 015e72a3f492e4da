#include "calib/standard_target/standard_target_fit.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "calib/standard_target/target_fit_report.h"
#include "core/math/statistics.h"
#include "core/types/units.h"
#include "sim/physics/beam_and_pulse.h"
#include "sim/physics/receiver.h"

namespace sonarcal::calib {
namespace {

constexpr double kSigmasOfDoubt = 2.0;
constexpr double kStartSpreadDb = 1.0;

class StandardTargetFitter {
 public:
  StandardTargetFitter(const RecordingSource& recording, const ParameterSet& initial, const Water& water,
                       double absorption_db_per_m, const StandardTargetOptions& options)
      : recording_(recording),
        sonar_(recording.info().sonar),
        axes_(sonar_.axes),
        initial_(initial),
        water_(water),
        options_(options) {
    setting_ = {.absorption_db_per_m = absorption_db_per_m,
                .time_varied_gain = initial.receiver.time_varied_gain,
                .azimuth_pattern = initial.beam.azimuth_pattern == AzimuthPattern::kGaussian
                                       ? AzimuthPattern::kGaussian
                                       : AzimuthPattern::kAperture,
                .elevation_pattern = initial.beam.elevation_pattern,
                .elevation_taper = initial.beam.elevation_taper};
  }

  StandardTargetFit Run() {
    Tell("frames read", 0, 1);
    TakeWindows();
    Tell("fits", 0, kFits);
    Start();
    Tell("fits", 1, kFits);
    LeaveOutMisfits();
    if (state_.data.windows.empty()) ThrowNoTarget(recording_, fit_.left_out);
    if (state_.solution.usable) ChooseFree();
    Solve();
    Tell("fits", 2, kFits);
    LeaveOutOddLevels();
    Tell("fits", 3, kFits);
    if (state_.solution.usable && state_.free.range_slope) ChooseGainLaw();
    Tell("fits", kFits, kFits);
    Finish();
    return std::move(fit_);
  }

 private:
  static constexpr int kFits = 4;

  void Tell(const std::string& step, int done, int total) const {
    if (options_.progress) options_.progress(step, done, total);
  }

  void TakeWindows() {
    TargetWindows found =
        FindTargetWindows(recording_, initial_.display, options_.search, options_.frames,
                          [this](int done, int total) { Tell("frames read", done, total); });
    state_.data.windows = std::move(found.windows);
    state_.data.cell_pixels = found.cell_pixels;
    peaks_ = std::move(found.sightings);
    poses_ = std::move(found.poses);
    fit_.left_out = std::move(found.left_out);
    state_.solution.echo.log_pulse = std::log(found.range_extent_m);
    state_.solution.echo.log_azimuth_width = std::log(found.azimuth_extent_rad);
    state_.solution.echo.azimuth_taper = 0.5;
    constexpr double kUnknownElevationWidthDeg = 20.0;  // start only
    const double elevation_width_deg = sim::ElevationWidthDeg(sonar_, initial_.beam);
    state_.solution.echo.log_elevation_width =
        std::log(RadFromDeg(elevation_width_deg > 0.0 ? elevation_width_deg : kUnknownElevationWidthDeg));
  }

  // Values of the frames as the peaks show them.
  void Start() {
    constexpr double kMinNoise = 1e-9;  // of the peak; a soft display may show no noise
    double log_ranges = 0.0;
    for (const TargetSighting& peak : peaks_) log_ranges += std::log(axes_.range_centre_m(peak.bin));
    setting_.reference_range_m = std::exp(log_ranges / static_cast<double>(peaks_.size()));
    state_.data.setting = setting_;
    state_.data.sensitivity_db = initial_.beam.sensitivity_db;
    std::vector<double> levels_db;
    for (std::size_t i = 0; i < peaks_.size(); ++i) {
      state_.solution.frames.push_back(
          {.range_m = axes_.range_centre_m(peaks_[i].bin),
           .azimuth_rad = axes_.beam_azimuth_rad[peaks_[i].beam],
           .log_noise = std::log(std::max(peaks_[i].noise_power, kMinNoise * peaks_[i].peak_power))});
      const std::vector<double> unit =
          EchoPowerOf(state_.data.windows[i], setting_, state_.solution.echo, state_.solution.frames[i],
                      SensitivityOf(state_.data, {}, state_.data.windows[i]));
      levels_db.push_back(DbFromPower(peaks_[i].peak_power / *std::max_element(unit.begin(), unit.end())));
    }
    state_.solution.echo.level_db = Median(levels_db);
    for (std::size_t i = 0; i < levels_db.size(); ++i) {
      state_.solution.frames[i].level_offset_db = levels_db[i] - state_.solution.echo.level_db;
    }
    // Levels may differ by the elevation pattern, the gain with range and the beams.
    constexpr double kAnySpreadDb = 10.0;
    state_.free = {.taper = setting_.azimuth_pattern == AzimuthPattern::kAperture};
    state_.solution.level_spread_db = kAnySpreadDb;
    for (const double shape_error : {0.1, 0.03, 0.01, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 0.0}) {
      state_.data.shape_error = shape_error;
      state_.solution = FitPointEcho(state_.data, state_.free, state_.solution);
      if (!state_.solution.usable) return;
    }
  }

  // Leaves out frames whose brightest echo is not the sphere.
  void LeaveOutMisfits() {
    constexpr double kMaxMisfit = 0.25;
    for (std::size_t i = state_.data.windows.size(); i-- > 0 && state_.solution.usable;) {
      if (state_.solution.misfit[i] > kMaxMisfit) {
        LeaveOut(i, "its echo does not have the shape of a point",
                 fmt::format("{:.0f} % of its energy is left", 100.0 * state_.solution.misfit[i]));
      }
    }
  }

  void LeaveOut(std::size_t index, const std::string& why, const std::string& detail = {}) {
    const auto at = static_cast<std::ptrdiff_t>(index);
    fit_.left_out.push_back({state_.data.windows[index].frame, why, detail});
    state_.data.windows.erase(state_.data.windows.begin() + at);
    poses_.erase(poses_.begin() + at);
    peaks_.erase(peaks_.begin() + at);
    state_.solution.frames.erase(state_.solution.frames.begin() + at);
    state_.solution.misfit.erase(state_.solution.misfit.begin() + at);
    state_.solution.frame_level_sigma_db.erase(state_.solution.frame_level_sigma_db.begin() + at);
    if (fit_.position) {
      fit_.position->elevation_rad.erase(fit_.position->elevation_rad.begin() + at);
      fit_.position->agrees.erase(fit_.position->agrees.begin() + at);
    }
  }

  void ChooseFree() {
    FindElevations();
    double nearest_m = state_.solution.frames.front().range_m;
    double farthest_m = nearest_m;
    for (const FrameEcho& frame : state_.solution.frames) {
      nearest_m = std::min(nearest_m, frame.range_m);
      farthest_m = std::max(farthest_m, frame.range_m);
    }
    constexpr double kRangesDiffer = 1.25;
    state_.free.range_slope = farthest_m > kRangesDiffer * nearest_m;
    FindGroups();
  }

  // Beams whose axis the sphere came near have a sensitivity of their own.
  void FindGroups() {
    const double width_rad = std::exp(state_.solution.echo.log_azimuth_width);
    std::vector<bool> near(axes_.beam_count(), false);
    double left = state_.solution.frames.front().azimuth_rad;
    double right = left;
    for (const FrameEcho& frame : state_.solution.frames) {
      left = std::min(left, frame.azimuth_rad);
      right = std::max(right, frame.azimuth_rad);
      for (int beam = 0; beam < axes_.beam_count(); ++beam) {
        if (std::abs(axes_.beam_azimuth_rad[beam] - frame.azimuth_rad) <= 0.5 * width_rad) near[beam] = true;
      }
    }
    constexpr double kWidthsMoved = 3.0;
    std::vector<int>& determined = fit_.beams_determined;
    for (int beam = 0; beam < axes_.beam_count(); ++beam) {
      if (near[beam]) determined.push_back(beam);
    }
    if (right - left < kWidthsMoved * width_rad || determined.size() < 3) {
      determined.clear();
      return;
    }
    for (int beam = 0; beam < axes_.beam_count(); ++beam) {
      const auto nearest = std::min_element(determined.begin(), determined.end(), [&](int a, int b) {
        return std::abs(a - beam) < std::abs(b - beam);
      });
      state_.data.group_of_beam.push_back(static_cast<int>(nearest - determined.begin()));
    }
    state_.data.groups = static_cast<int>(determined.size());
    for (const int beam : determined) {
      state_.solution.group_db.push_back(
          initial_.beam.sensitivity_db.empty() ? 0.0 : initial_.beam.sensitivity_db[beam]);
    }
  }

  void FindElevations() {
    std::vector<TargetSight> sights;
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      if (!poses_[i]) continue;
      sights.push_back(
          {*poses_[i], state_.solution.frames[i].range_m, state_.solution.frames[i].azimuth_rad});
    }
    if (sights.size() < poses_.size()) {
      fit_.elevation_unknown = sights.empty()
                                   ? "there are no poses"
                                   : fmt::format("{} frames have no pose", poses_.size() - sights.size());
      return;
    }
    constexpr double kExtentsOfError = 3.0;
    const double range_extent_m = std::max(axes_.range_bin_m(), std::exp(state_.solution.echo.log_pulse));
    TargetLocation found =
        LocateTarget(sights, {.range_m = kExtentsOfError * range_extent_m,
                              .azimuth_rad = std::max(axes_.beam_spacing_rad(),
                                                      std::exp(state_.solution.echo.log_azimuth_width))});
    fit_.position = std::move(found.position);
    if (!fit_.position) {
      fit_.elevation_unknown = found.why_not;
      return;
    }
    state_.data.setting.with_elevation = true;
    for (std::size_t i = 0; i < sights.size(); ++i)
      state_.data.windows[i].elevation_rad = fit_.position->elevation_rad[i];
    for (std::size_t i = sights.size(); i-- > 0;) {
      if (fit_.position->agrees[i]) continue;
      LeaveOut(i, "its brightest echo is elsewhere than the sphere of the other frames");
    }
    const auto [lowest, highest] =
        std::minmax_element(fit_.position->elevation_rad.begin(), fit_.position->elevation_rad.end());
    constexpr double kShareMoved = 0.3;
    state_.free.elevation_width =
        *highest - *lowest > kShareMoved * std::exp(state_.solution.echo.log_elevation_width);
    if (!state_.free.elevation_width && !(sim::ElevationWidthDeg(sonar_, initial_.beam) > 0.0)) {
      state_.data.setting.with_elevation = false;
      fit_.elevation_unknown =
          "the elevation beam width is not stated, and the elevations differ too little to tell it";
    }
  }

  void Solve() {
    state_.solution.level_spread_db = kStartSpreadDb;
    for (FrameEcho& frame : state_.solution.frames) frame.level_offset_db = 0.0;
    state_.solution = FitPointEcho(state_.data, state_.free, state_.solution);
  }

  // Fits with a law of gain; its slope then is what the law lacks.
  PointEchoSolution WithLaw(TimeVariedGain law) {
    const double range_m = setting_.reference_range_m;
    const auto gain_db = [&](TimeVariedGain of) {
      return sim::TimeVariedGainDb(of, range_m, setting_.absorption_db_per_m);
    };
    PointEchoSolution start = state_.solution;
    // The gain of the other law at the reference range was in the level.
    start.echo.level_db += gain_db(state_.data.setting.time_varied_gain) - gain_db(law);
    state_.data.setting.time_varied_gain = law;
    return FitPointEcho(state_.data, state_.free, start);
  }

  // Keeps the given law unless the ranges refuse it. Takes another if it is the only one that they allow, and
  // if elevations are known: else levels may change with range because the elevation does.
  void ChooseGainLaw() {
    constexpr int kSlope = 4;
    const auto allowed = [&](const PointEchoSolution& solution) {
      return solution.usable && std::abs(solution.echo.range_slope_db_per_decade) <=
                                    kSigmasOfDoubt * std::sqrt(solution.covariance(kSlope, kSlope));
    };
    const TimeVariedGain given = setting_.time_varied_gain;
    std::vector<std::pair<TimeVariedGain, PointEchoSolution>> fitting;
    if (!allowed(state_.solution)) {
      for (const auto& [word, law] : WordsOf(std::type_identity<TimeVariedGain>{})) {
        if (law == given) continue;
        PointEchoSolution solution = WithLaw(law);
        state_.data.setting.time_varied_gain = given;
        if (allowed(solution)) fitting.emplace_back(law, std::move(solution));
      }
    }
    if (fitting.size() == 1 && fit_.position) {
      state_.solution = std::move(fitting.front().second);
      setting_.time_varied_gain = fitting.front().first;
      state_.data.setting.time_varied_gain = fitting.front().first;
    }
    state_.slope_db = state_.solution.echo.range_slope_db_per_decade;
    state_.slope_sigma_db = state_.Sigma(kSlope);
    if (!allowed(state_.solution)) {
      std::vector<std::string> words;
      for (const auto& [law, solution] : fitting) words.emplace_back(ToString(law));
      fit_.report.warnings.push_back(fmt::format(
          "the levels change with range by {:.1f} +- {:.1f} dB per decade more than the gain with range {} "
          "explains, so the level holds at {:.2f} m; {}",
          state_.slope_db, state_.slope_sigma_db, ToString(given), setting_.reference_range_m,
          !fit_.position  ? "the elevation is not known, and may cause it"
          : words.empty() ? "no known law explains it"
                          : fmt::format("several laws explain it: {}", fmt::join(words, ", "))));
      return;
    }
    state_.free.range_slope = false;
    state_.solution.echo.range_slope_db_per_decade = 0.0;
    state_.solution = FitPointEcho(state_.data, state_.free, state_.solution);
  }

  // Leaves out frames whose brightest echo is another object.
  void LeaveOutOddLevels() {
    constexpr double kDeviations = 5.0;
    constexpr double kAtLeastDb = 1.0;
    constexpr double kNormalOverMedian = 1.4826;
    if (!(state_.solution.level_spread_db > 0.0) || !state_.solution.usable) return;
    std::vector<double> offsets_db;
    for (std::size_t i = 0; i < state_.data.windows.size(); ++i) offsets_db.push_back(LevelOffsetDb(i));
    const double median_db = Median(offsets_db);
    std::vector<double> deviations_db;
    for (const double offset_db : offsets_db) deviations_db.push_back(std::abs(offset_db - median_db));
    const double limit_db = std::max(kAtLeastDb, kDeviations * kNormalOverMedian * Median(deviations_db));
    bool any = false;
    for (std::size_t i = offsets_db.size(); i-- > 0;) {
      if (deviations_db[i] <= limit_db) continue;
      LeaveOut(i, "its level is off the median of all frames",
               fmt::format("{:+.1f} dB", offsets_db[i] - median_db));
      any = true;
    }
    if (any) Solve();
  }

  void Finish() {
    FitReport& report = fit_.report;
    report.termination = state_.solution.termination;
    report.iterations = state_.solution.iterations;
    report.cost_initial = state_.solution.cost_initial;
    report.cost_final = state_.solution.cost_final;
    fit_.usable = state_.solution.usable;
    for (const EchoWindow& window : state_.data.windows) report.frames_used.push_back(window.frame);
    std::sort(fit_.left_out.begin(), fit_.left_out.end(),
              [](const FrameLeftOut& a, const FrameLeftOut& b) { return a.frame < b.frame; });
    if (!fit_.usable) return;
    report.whitened = {.mean = 0.0, .spread = std::sqrt(state_.solution.chi_square_per_pixel)};
    fit_.strength =
        StrengthOfSphere(options_.sphere, sonar_, water_, std::exp(state_.solution.echo.log_pulse));
    fit_.level_db = state_.solution.echo.level_db - fit_.strength.db;
    fit_.level_sigma_db = std::hypot(state_.Sigma(0), fit_.strength.sigma_db);
    fit_.level_spread_db = state_.solution.level_spread_db;
    fit_.reference_range_m = setting_.reference_range_m;
    if (initial_.display.law == DisplayLaw::kLog) {
      fit_.grey_levels_per_db =
          recording_.info().scale.full_scale / (initial_.display.db_max - initial_.display.db_min);
    }
    FillFrames();
    fit_.level_sigma_db = std::hypot(
        fit_.level_sigma_db, options_.display_sigma_share * (fit_.received_db - initial_.display.db_min));
    FillTargetReport(state_, sonar_, initial_, fit_);
  }

  void FillFrames() {
    std::vector<std::pair<double, std::size_t>> by_level;
    for (std::size_t i = 0; i < state_.data.windows.size(); ++i) {
      const FrameEcho& frame = state_.solution.frames[i];
      TargetFrame shown{.frame = state_.data.windows[i].frame,
                        .range_m = frame.range_m,
                        .azimuth_rad = frame.azimuth_rad,
                        .level_db = fit_.level_db + LevelOffsetDb(i),
                        .level_sigma_db = state_.solution.frame_level_sigma_db[i],
                        .noise_db = DbFromPower(std::exp(frame.log_noise))};
      if (fit_.position) shown.elevation_rad = fit_.position->elevation_rad[i];
      fit_.frames.push_back(shown);
      by_level.emplace_back(shown.level_db, i);
    }
    std::sort(by_level.begin(), by_level.end());
    const std::size_t median = by_level[by_level.size() / 2].second;
    fit_.shown = state_.data.windows[median];
    fit_.shown_model =
        EchoPowerOf(fit_.shown, state_.data.setting, state_.solution.echo, state_.solution.frames[median],
                    SensitivityOf(state_.data, state_.solution.group_db, fit_.shown));
    fit_.received_db = DbFromPower(*std::max_element(fit_.shown_model.begin(), fit_.shown_model.end())) +
                       fit_.level_db - fit_.frames[median].level_db;
    for (double& power : fit_.shown_model) power += std::exp(state_.solution.frames[median].log_noise);
  }

  // Level of the frame alone. Undoes that the spread of levels draws the estimate to the mean.
  double LevelOffsetDb(std::size_t i) const {
    const double spread = state_.solution.level_spread_db;
    if (!(spread > 0.0)) return 0.0;
    const double noise = state_.solution.frame_level_sigma_db[i];
    const double kept = spread * spread / (spread * spread + noise * noise);
    return state_.solution.frames[i].level_offset_db / kept;
  }

  const RecordingSource& recording_;
  const SonarModel& sonar_;
  const PolarAxes& axes_;
  const ParameterSet& initial_;
  Water water_;
  const StandardTargetOptions& options_;
  std::vector<std::optional<Pose>> poses_;
  std::vector<TargetSighting> peaks_;
  PointEchoSetting setting_;
  FittedPointEcho state_;
  StandardTargetFit fit_;
};

}  // namespace

StandardTargetFit FitStandardTarget(const RecordingSource& recording, const ParameterSet& initial,
                                    const Water& water, double absorption_db_per_m,
                                    const StandardTargetOptions& options) {
  return StandardTargetFitter(recording, initial, water, absorption_db_per_m, options).Run();
}

}  // namespace sonarcal::calib
