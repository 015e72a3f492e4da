#include "calib/noise/noise_fit.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>

#include "calib/models/held_out_frames.h"
#include "calib/noise/noise_background.h"
#include "calib/noise/noise_fit_report.h"
#include "calib/noise/noise_form.h"
#include "calib/noise/noise_solver.h"
#include "data_io/parameters/parameters_io.h"

namespace sonarcal::calib {
namespace {

constexpr int kMinBandsToSplit = 4;
constexpr int kPingsForDrift = 5;  // min number of pings for a covariance that includes their drift
// min number of held-out pings to select and evaluate on different ones
constexpr std::size_t kHeldOutToSplit = 4;

struct Pings {
  std::vector<NoiseCounts> each;
  NoiseCounts all;
};

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

// Evaluates on the later held-out frames, apart from those that select, because pings near in time are alike.
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

// Weights of the background cells in even bands (0) or odd ones (1). All of them if no bands are held out.
std::vector<double> OfBands(const NoiseFit& fit, int odd) {
  std::vector<double> weight = fit.weight;
  if (!fit.bands_held_out) return weight;
  for (int i = 0; i < fit.cells.count(); ++i) {
    if (i / fit.cells.beams() % 2 != odd) weight[i] = 0.0;
  }
  return weight;
}

class Fitter {
 public:
  // `weight` per cell: 1 if fitted, else 0.
  Fitter(const Pings& used, const NoiseCells& cells, const NoiseFitOptions& options,
         std::vector<double> weight)
      : used_(used), cells_(cells), options_(options), weight_(std::move(weight)) {}

  struct Fitted {
    NoiseLaw start;
    NoiseSolution solution;
    std::vector<double> start_costs;  // cost at the end of each start
  };

  // Returns the best of several starts. Prefers one that converged.
  Fitted Fit(const NoiseForm& form) const {
    Fitted best;
    std::vector<double> costs;
    for (const NoiseLaw& start : StartsOf(form, used_.all, cells_, options_.absorption_db_per_m)) {
      NoiseSolution solution = SolveNoise(start, form.fit_span, used_.all, cells_, weight_, options_);
      costs.push_back(solution.cost);
      const NoiseSolution& least = best.solution;
      if (least.value.size() == 0 || (solution.converged && !least.converged) ||
          (solution.converged == least.converged && solution.cost < least.cost)) {
        best = {start, std::move(solution), {}};
      }
    }
    best.start_costs = std::move(costs);
    return best;
  }

  // Sandwich over pings, or over range bands of pings if there are few.
  Eigen::MatrixXd Covariance(const NoiseSolution& solution) const {
    const int count = solution.layout.count;
    Eigen::MatrixXd bread = solution.information.ldlt().solve(Eigen::MatrixXd::Identity(count, count));
    Eigen::MatrixXd meat = Eigen::MatrixXd::Zero(count, count);
    std::vector<Eigen::VectorXd> scores;
    for (const NoiseCounts& ping : used_.each) {
      if (static_cast<int>(used_.each.size()) >= kPingsForDrift) {
        scores.push_back(NoiseScore(solution, ping, cells_, weight_, options_.absorption_db_per_m));
        continue;
      }
      for (int band = 0; band < cells_.bands(); ++band) {
        const auto first = weight_.begin() + band * cells_.beams();
        if (std::none_of(first, first + cells_.beams(), [](double weight) { return weight > 0.0; })) continue;
        NoiseCounts alone(cells_.count());
        std::copy_n(ping.begin() + band * cells_.beams(), cells_.beams(),
                    alone.begin() + band * cells_.beams());
        scores.push_back(NoiseScore(solution, alone, cells_, weight_, options_.absorption_db_per_m));
      }
    }
    const auto blocks = static_cast<double>(scores.size());
    if (blocks < 2.0) return bread;
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(count);
    for (const Eigen::VectorXd& score : scores) mean += score / blocks;
    for (const Eigen::VectorXd& score : scores) meat += (score - mean) * (score - mean).transpose();
    return bread * meat * bread * (blocks / (blocks - 1.0));
  }

 private:
  const Pings& used_;
  const NoiseCells& cells_;
  const NoiseFitOptions& options_;
  std::vector<double> weight_;
};

double Seconds(std::chrono::steady_clock::time_point since) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - since).count();
}

}  // namespace

NoiseFit FitNoise(const RecordingSource& recording, const NoiseFitOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  NoiseFit fit;
  fit.cells = NoiseCellsOf(recording.info(), {.range_min_m = options.range_min_m,
                                              .range_max_m = options.range_max_m,
                                              .skip_bins = options.skip_bins,
                                              .band_bins = options.band_bins});
  const std::vector<int> held_out = HeldOut(recording, options);
  std::vector<int> frames_used;
  for (int frame = 0; frame < recording.frame_count(); ++frame) {
    if (!std::binary_search(held_out.begin(), held_out.end(), frame)) frames_used.push_back(frame);
  }
  CheckHeldOut(recording, {.used = frames_used, .held_out = held_out});
  SetJudges(held_out, frames_used, fit);
  std::vector<int> frames_all(recording.frame_count());
  std::iota(frames_all.begin(), frames_all.end(), 0);
  const std::vector<FrameSaturation> saturation = FindSaturation(recording, frames_all);
  Pings used = ReadPings(recording, frames_used, fit.cells);
  const std::vector<NoiseForm> forms = DisplayForms(recording.info(), options);
  if (options.find_background) {
    const BackgroundWindow window = FindBackground(forms.front(), used.all, fit.cells, options);
    fit.cells.first_bin = window.first_bin;
    fit.cells.last_bin = window.last_bin;
    fit.window_found = true;
    used = ReadPings(recording, frames_used, fit.cells);
  }
  const Pings choosing = ReadPings(recording, fit.frames_chosen_on, fit.cells);
  fit.weight = KeepBackground(forms.front(), used.all, fit.cells, options.reject_beyond, options);
  for (std::size_t i = 0; i < fit.weight.size(); ++i) {
    if (used.all[i].empty()) fit.weight[i] = 0.0;
  }
  fit.bands_held_out = fit.cells.bands() >= kMinBandsToSplit &&
                       (options.hold_out_bands || (options.choose_held_out && recording.frame_count() == 1));
  fit.judged_on_held_out = fit.judged_on_held_out || fit.bands_held_out;
  const std::vector<double> judging_weight = OfBands(fit, 1);
  const Fitter fitter(used, fit.cells, options, OfBands(fit, 0));
  Fitter::Fitted best;
  NoiseForm best_form;
  int chosen = -1;
  double best_score = 0.0;
  const auto try_form = [&](const NoiseForm& form) {
    Fitter::Fitted fitted = fitter.Fit(form);
    const NoiseAgreement agreement =
        Agreement(fitted.solution.law, choosing.all, fit.cells, judging_weight, options.absorption_db_per_m);
    fit.choices.push_back({form.display.law, form.speckle, form.time_varied_gain, form.floor_after_gain,
                           agreement.nats_per_pixel, fitted.solution.converged});
    if (options.progress) {
      options.progress(
          fmt::format("{}, {} speckle, gain {}, {}: {:.5f} nats per pixel{}", ToString(form.display.law),
                      ToString(form.speckle), ToString(form.time_varied_gain),
                      form.floor_after_gain ? "two floors" : "one floor", agreement.nats_per_pixel,
                      fitted.solution.converged ? "" : ", not converged and so not selected"));
    }
    double score = agreement.nats_per_pixel + kRelevantNats * Richness(form);
    if (form.speckle == sim::SpeckleLaw::kKDiffuse)
      score += std::max(0.0, kDiffuseNats / agreement.pixels - kRelevantNats);
    if (!fitted.solution.converged || !std::isfinite(score)) return;
    if (chosen >= 0 && score >= best_score) return;
    chosen = static_cast<int>(fit.choices.size()) - 1;
    best_score = score;
    best = std::move(fitted);
    best_form = form;
  };
  for (NoiseForm form : forms) {
    form.floor_after_gain = false;  // many times faster, and equally informative on the display
    try_form(form);
  }
  const NoiseForm display_chosen = chosen < 0 ? forms.front() : best_form;
  for (const TimeVariedGain gain :
       {TimeVariedGain::kNone, TimeVariedGain::k20LogR, TimeVariedGain::k40LogR}) {
    for (const bool floor_after_gain : {true, false}) {
      if (gain == TimeVariedGain::kNone && !floor_after_gain) continue;  // already tried
      NoiseForm form = display_chosen;
      form.time_varied_gain = gain;
      form.floor_after_gain = floor_after_gain;
      try_form(form);
    }
  }
  if (best_form.floor_after_gain) {  // a softened display may have stood for the second floor
    const NoiseForm floors_chosen = best_form;
    for (NoiseForm form : forms) {
      if (form.display.law == display_chosen.display.law && form.speckle == display_chosen.speckle) continue;
      form.time_varied_gain = floors_chosen.time_varied_gain;
      try_form(form);
    }
  }
  if (best.solution.looks_at_bound) {  // tails heavier than those of one look: texture may explain them
    NoiseForm form = best_form;
    const double without_texture = fit.choices[chosen].nats_per_pixel;
    form.speckle = sim::SpeckleLaw::kK;
    try_form(form);
    const NoiseModelChoice& textured = fit.choices.back();
    if (textured.converged && textured.nats_per_pixel < without_texture) {  // part may have no texture
      form.speckle = sim::SpeckleLaw::kKDiffuse;
      try_form(form);
    }
  }
  if (chosen < 0) {
    fit.report.termination = "ended before any candidate converged";
    fit.report.frames_used = frames_used;
    fit.report.frames_held_out = held_out;
    fit.report.saturation = saturation;
    return fit;
  }
  fit.choices[chosen].chosen = true;

  fit.evaluated_law = best.solution.law;
  fit.used = Agreement(fit.evaluated_law, used.all, fit.cells, OfBands(fit, 0), options.absorption_db_per_m);
  const Pings judging = ReadPings(recording, fit.frames_judged_on, fit.cells);
  fit.judged =
      Agreement(fit.evaluated_law, judging.all, fit.cells, judging_weight, options.absorption_db_per_m);

  const Pings all = ReadPings(recording, frames_all, fit.cells);
  const Fitter fitter_all(all, fit.cells, options, fit.weight);
  if (fit.judged_on_held_out) {
    Fitter::Fitted again = fitter_all.Fit(best_form);
    fit.refitted = again.solution.converged && again.solution.value.allFinite();
    if (fit.refitted) best = std::move(again);
  }
  const NoiseSolution& solution = best.solution;
  const Fitter& last = fit.refitted ? fitter_all : fitter;
  fit.law = solution.law;
  fit.usable = solution.converged && solution.value.allFinite();
  fit.report = NoiseReport(solution, best.start, last.Covariance(solution), best_form.fit_span,
                           static_cast<int>((fit.refitted ? all : used).each.size()), fit.cells);
  fit.report.start_costs = best.start_costs;
  fit.report.frames_used = frames_used;
  fit.report.frames_held_out = held_out;
  fit.report.saturation = saturation;
  fit.all = JudgeNoise(fit.law, recording, frames_all, fit.cells, fit.weight, options.absorption_db_per_m);
  fit.report.raw = fit.used.raw;
  fit.report.whitened = fit.used.whitened;
  fit.report.solve_s = Seconds(begin);
  return fit;
}

}  // namespace sonarcal::calib
