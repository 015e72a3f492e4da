#include "calib/noise_fit.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>

#include "calib/noise_fit_report.h"
#include "calib/noise_solver.h"
#include "data_io/parameters_io.h"

namespace sonarcal {
namespace {

constexpr int kPingsForDrift = 5;  // from here on sigmas see how pings drift
constexpr double kUnknownSpanDb = 60.0;
constexpr int kRejections = 6;
constexpr std::size_t kHeldOutToSplit = 4;  // from here on some choose and others judge

struct Pings {
  std::vector<NoiseCounts> each;
  NoiseCounts all;
};

NoiseCells CellsOf(const RecordingInfo& info, const NoiseFitOptions& options) {
  NoiseCells cells{.axes = info.sonar.axes};
  if (info.scale.quantity != Quantity::kGrey || !(info.scale.full_scale <= 4095.0)) {
    throw DataError("{}: {} images of full scale {}; a noise law is fitted to grey images of up to 12 bits",
                    info.source, ToString(info.scale.quantity), info.scale.full_scale);
  }
  cells.full_scale = static_cast<int>(info.scale.full_scale);
  const auto bin_of = [&](double range_m) {
    return static_cast<int>(std::lround((range_m - cells.axes.range_min_m) / cells.axes.range_bin_m()));
  };
  cells.first_bin = options.skip_bins;
  cells.last_bin = cells.axes.range_bins;
  if (options.range_min_m) cells.first_bin = std::max(cells.first_bin, bin_of(*options.range_min_m));
  if (options.range_max_m) cells.last_bin = std::min(cells.last_bin, bin_of(*options.range_max_m));
  cells.band_bins = options.band_bins;
  if (cells.last_bin - cells.first_bin < cells.band_bins) {
    throw DataError("{}: {} range bins in the window, expected at least {}", info.source,
                    std::max(0, cells.last_bin - cells.first_bin), cells.band_bins);
  }
  return cells;
}

std::vector<int> HeldOut(const RecordingSource& recording, const NoiseFitOptions& options) {
  std::vector<int> held_out = options.held_out;
  const int frames = recording.frame_count();
  if (held_out.empty() && options.choose_held_out) {
    for (int frame = frames - frames / 3; frame < frames; ++frame) held_out.push_back(frame);
  }
  std::sort(held_out.begin(), held_out.end());
  held_out.erase(std::unique(held_out.begin(), held_out.end()), held_out.end());
  if (!held_out.empty() && (held_out.front() < 0 || held_out.back() >= frames)) {
    throw DataError("{}: frame {} is held out, but there are frames 0 to {}", recording.info().source,
                    held_out.front() < 0 ? held_out.front() : held_out.back(), frames - 1);
  }
  if (static_cast<int>(held_out.size()) == frames) {
    throw DataError("{}: all of its {} frames are held out, none is left to fit to", recording.info().source,
                    frames);
  }
  return held_out;
}

Pings ReadPings(const RecordingSource& recording, const std::vector<int>& frames, const NoiseCells& cells) {
  Pings pings;
  for (const int frame : frames) pings.each.push_back(CountGrey(recording.ReadFrame(frame).image, cells));
  pings.all = AddCounts(pings.each, cells);
  return pings;
}

// The later of the held-out frames judge, apart from those that chose, as pings near in time are alike.
void SetJudges(const std::vector<int>& held_out, const std::vector<int>& frames_used, NoiseFit& fit) {
  fit.judged_on_held_out = !held_out.empty();
  fit.judged_apart_from_choice = held_out.size() >= kHeldOutToSplit;
  fit.frames_chosen_on = fit.judged_on_held_out ? held_out : frames_used;
  fit.frames_judged_on = fit.frames_chosen_on;
  if (!fit.judged_apart_from_choice) return;
  const auto half = static_cast<std::ptrdiff_t>(held_out.size() / 2);
  fit.frames_chosen_on.assign(held_out.begin(), held_out.begin() + half);
  fit.frames_judged_on.assign(held_out.begin() + half, held_out.end());
}

double MeanRangeM(const NoiseCells& cells) {
  return 0.5 * (cells.RangeM(0) + cells.RangeM(cells.bands() - 1));
}

// The mean power that puts a high quantile of the grey values where it is: clipped zeros do not matter.
double RoughNoisePower(const NoiseCounts& counts, const NoiseCells& cells,
                       const DisplayParameters<double>& display) {
  std::vector<double> histogram(cells.full_scale + 1);
  double all = 0.0;
  for (const auto& cell : counts) {
    for (const auto& [level, count] : cell) {
      histogram[level] += count;
      all += count;
    }
  }
  double below = 0.0;
  for (int level = 0; level < cells.full_scale; ++level) {
    below += histogram[level];
    if (below >= 0.8 * all && below < all) {
      const double power = PowerFromDisplay(display, (level + 0.5) / cells.full_scale);
      return std::max(power, 1e-12) / -std::log1p(-below / all);
    }
  }
  return PowerFromDisplay(display, 0.5);
}

struct Form {
  DisplayParameters<double> display;
  bool fit_span = false;
  SpeckleLaw speckle = SpeckleLaw::kGamma;
  TimeVariedGain time_varied_gain = TimeVariedGain::kNone;
  bool floor_after_gain = true;
};

// Steps from the plainest form.
int Richness(const Form& form) {
  return (form.display.law == DisplayLaw::kSoftLog) + (form.speckle != SpeckleLaw::kGamma) +
         (form.time_varied_gain != TimeVariedGain::kNone) + form.floor_after_gain;
}

// Starting values of a form; `net_db`: change of the floor before the gain over the window, as displayed.
NoiseLaw StartOf(const Form& form, const NoiseCounts& counts, const NoiseCells& cells, double net_db,
                 double absorption_db_per_m) {
  NoiseLaw law{.display = form.display, .receiver = {}, .speckle = form.speckle};
  const double level_db = LevelOfPower(RoughNoisePower(counts, cells, form.display));
  if (form.display.law == DisplayLaw::kSoftLog && form.display.soft_db == 0.0) {
    law.display.soft_db = std::max(form.display.db_min - 1.5, level_db - 12.0);
  }
  ReceiverParameters& receiver = law.receiver;
  receiver.looks = form.fit_span ? 1.0 : 1.3;
  receiver.time_varied_gain = form.time_varied_gain;
  const double near_m = cells.RangeM(0);
  const double far_m = cells.RangeM(cells.bands() - 1);
  const auto gain_db = [&](double range_m) {
    return TimeVariedGainDb(form.time_varied_gain, range_m, absorption_db_per_m);
  };
  receiver.noise_slope_db_per_m =
      (net_db - (gain_db(far_m) - gain_db(near_m))) / std::max(1e-3, far_m - near_m);
  const double middle_m = MeanRangeM(cells);
  const double shared_db = form.floor_after_gain ? 3.0 : 0.0;
  receiver.noise_db = level_db - shared_db - gain_db(middle_m) - receiver.noise_slope_db_per_m * middle_m;
  if (form.floor_after_gain) receiver.noise_after_gain_db = level_db - shared_db;
  return law;
}

class Fitter {
 public:
  Fitter(const Pings& used, const NoiseCells& cells, const NoiseFitOptions& options)
      : used_(used), cells_(cells), options_(options) {}

  struct Fitted {
    NoiseLaw start;
    NoiseSolution solution;
    std::vector<double> start_costs;  // where each start ended
  };

  // The best of several starts: a floor that falls with range, and one that rises.
  Fitted Fit(const Form& form) const {
    Fitted best;
    std::vector<double> costs;
    for (const double net_db :
         form.floor_after_gain ? std::vector<double>{-8.0, 8.0} : std::vector<double>{0.0}) {
      const NoiseLaw start = StartOf(form, used_.all, cells_, net_db, options_.absorption_db_per_m);
      NoiseSolution solution = SolveNoise(start, form.fit_span, used_.all, cells_, weight_, options_);
      costs.push_back(solution.cost);
      if (best.solution.value.size() == 0 || solution.cost < best.solution.cost) {
        best = {start, std::move(solution), {}};
      }
    }
    best.start_costs = std::move(costs);
    return best;
  }

  // Leaves out cells that the law does not explain, and fits again, until the same cells stay.
  void Reject(const Form& form) {
    weight_.assign(cells_.count(), 1.0);
    if (!(options_.reject_beyond > 0.0)) return;
    for (int round = 0; round < kRejections; ++round) {
      const Fitted fitted = Fit(form);
      const NoiseAgreement fit =
          Agreement(fitted.solution.law, used_.all, cells_, {}, options_.absorption_db_per_m);
      std::vector<double> off;
      for (std::size_t i = 0; i < fit.recorded_mean.size(); ++i) {
        off.push_back(fit.recorded_mean.values()[i] - fit.predicted_mean.values()[i]);
      }
      const auto median = [](std::vector<double> values) {
        std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
        return values[values.size() / 2];
      };
      const double middle = median(off);
      std::vector<double> distance;
      for (const double value : off) distance.push_back(std::abs(value - middle));
      const double limit = options_.reject_beyond * 1.4826 * median(distance);
      std::vector<double> next;
      for (const double value : distance) next.push_back(value <= limit ? 1.0 : 0.0);
      if (next == weight_) break;
      weight_ = std::move(next);
    }
  }

  // Sandwich over pings, or over range bands of pings where there are few.
  Eigen::MatrixXd Covariance(const NoiseSolution& solution) const {
    const int count = solution.layout.count;
    const Eigen::MatrixXd bread = solution.information.ldlt().solve(Eigen::MatrixXd::Identity(count, count));
    Eigen::MatrixXd meat = Eigen::MatrixXd::Zero(count, count);
    std::vector<Eigen::VectorXd> scores;
    for (const NoiseCounts& ping : used_.each) {
      if (static_cast<int>(used_.each.size()) >= kPingsForDrift) {
        scores.push_back(NoiseScore(solution, ping, cells_, weight_, options_.absorption_db_per_m));
        continue;
      }
      for (int band = 0; band < cells_.bands(); ++band) {
        NoiseCounts alone(cells_.count());
        std::copy_n(ping.begin() + band * cells_.beams(), cells_.beams(),
                    alone.begin() + band * cells_.beams());
        scores.push_back(NoiseScore(solution, alone, cells_, weight_, options_.absorption_db_per_m));
      }
    }
    const double blocks = static_cast<double>(scores.size());
    if (blocks < 2.0) return bread;
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(count);
    for (const Eigen::VectorXd& score : scores) mean += score / blocks;
    for (const Eigen::VectorXd& score : scores) meat += (score - mean) * (score - mean).transpose();
    return bread * meat * bread * (blocks / (blocks - 1.0));
  }

  const std::vector<double>& weight() const { return weight_; }

 private:
  const Pings& used_;
  const NoiseCells& cells_;
  const NoiseFitOptions& options_;
  std::vector<double> weight_;
};

std::vector<Form> DisplayForms(const RecordingInfo& info, const NoiseFitOptions& options) {
  if (options.display) {
    std::vector<Form> forms = {{.display = *options.display}};
    forms.push_back({.display = *options.display, .speckle = SpeckleLaw::kWeighted});
    return forms;
  }
  if (info.display_gamma) {
    const DisplayParameters<double> power{
        .db_min = -100.0, .db_max = 0.0, .law = DisplayLaw::kPower, .exponent = *info.display_gamma};
    return {{.display = power}, {.display = power, .speckle = SpeckleLaw::kWeighted}};
  }
  DisplayParameters<double> display{.db_min = 0.0, .db_max = kUnknownSpanDb};
  std::optional<double> span = info.scale.db_span;
  if (info.scale.db_min && info.scale.db_max) {
    display.db_min = *info.scale.db_min;
    span = *info.scale.db_max - *info.scale.db_min;
  }
  if (span) display.db_max = display.db_min + *span;
  std::vector<Form> forms;
  for (const DisplayLaw law : {DisplayLaw::kLog, DisplayLaw::kSoftLog}) {
    display.law = law;
    forms.push_back({.display = display, .fit_span = !span});
    if (span) forms.push_back({.display = display, .speckle = SpeckleLaw::kWeighted});
  }
  return forms;
}

double Seconds(std::chrono::steady_clock::time_point since) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - since).count();
}

}  // namespace

NoiseFit FitNoise(const RecordingSource& recording, const NoiseFitOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  NoiseFit fit;
  fit.cells = CellsOf(recording.info(), options);
  const std::vector<int> held_out = HeldOut(recording, options);
  std::vector<int> frames_used;
  for (int frame = 0; frame < recording.frame_count(); ++frame) {
    if (!std::binary_search(held_out.begin(), held_out.end(), frame)) frames_used.push_back(frame);
  }
  SetJudges(held_out, frames_used, fit);
  const Pings used = ReadPings(recording, frames_used, fit.cells);
  const Pings choosing = ReadPings(recording, fit.frames_chosen_on, fit.cells);

  Fitter fitter(used, fit.cells, options);
  const std::vector<Form> forms = DisplayForms(recording.info(), options);
  fitter.Reject(forms.front());
  fit.weight = fitter.weight();
  Fitter::Fitted best;
  Form best_form;
  int chosen = -1;
  double best_score = 0.0;
  const auto try_form = [&](const Form& form) {
    Fitter::Fitted fitted = fitter.Fit(form);
    const NoiseAgreement agreement =
        Agreement(fitted.solution.law, choosing.all, fit.cells, fit.weight, options.absorption_db_per_m);
    fit.choices.push_back({form.display.law, form.speckle, form.time_varied_gain, form.floor_after_gain,
                           agreement.nats_per_pixel});
    if (options.progress) {
      options.progress(
          fmt::format("{}, {} speckle, gain {}, {}: {:.5f} nats a pixel", ToString(form.display.law),
                      ToString(form.speckle), ToString(form.time_varied_gain),
                      form.floor_after_gain ? "two floors" : "one floor", agreement.nats_per_pixel));
    }
    const double score = agreement.nats_per_pixel + kRelevantNats * Richness(form);
    if (chosen >= 0 && score >= best_score) return;
    chosen = static_cast<int>(fit.choices.size()) - 1;
    best_score = score;
    best = std::move(fitted);
    best_form = form;
  };
  for (const Form& form : forms) try_form(form);
  const Form display_chosen = best_form;
  for (const TimeVariedGain gain :
       {TimeVariedGain::kNone, TimeVariedGain::k20LogR, TimeVariedGain::k40LogR}) {
    for (const bool floor_after_gain : {true, false}) {
      if (gain == TimeVariedGain::kNone && floor_after_gain) continue;  // tried
      Form form = display_chosen;
      form.time_varied_gain = gain;
      form.floor_after_gain = floor_after_gain;
      try_form(form);
    }
  }
  fit.choices[chosen].chosen = true;

  const NoiseSolution& solution = best.solution;
  fit.law = solution.law;
  fit.usable = solution.converged && solution.value.allFinite();
  fit.report = NoiseReport(solution, best.start, fitter.Covariance(solution), best_form.fit_span,
                           static_cast<int>(used.each.size()), fit.cells);
  fit.report.start_costs = best.start_costs;
  fit.report.frames_used = frames_used;
  fit.report.frames_held_out = held_out;
  fit.used = Agreement(fit.law, used.all, fit.cells, fit.weight, options.absorption_db_per_m);
  const Pings judging = ReadPings(recording, fit.frames_judged_on, fit.cells);
  fit.judged = Agreement(fit.law, judging.all, fit.cells, fit.weight, options.absorption_db_per_m);
  fit.report.raw = fit.used.raw;
  fit.report.whitened = fit.used.whitened;
  fit.report.solve_s = Seconds(begin);
  return fit;
}

std::string_view ToString(SpeckleLaw law) {
  return law == SpeckleLaw::kGamma ? "gamma" : "weighted";
}

}  // namespace sonarcal
