// Fit of the noise law alone, from target-free pings: maximum likelihood of the speckle law through the
// display, with both clips as censored values (calib/noise/noise_likelihood.h). Uses no scene, no pose, no
// ray.
//
// Free parameters: both floors of types/parameters.h (ReceiverParameters), the slope with range, a taper for
// each floor, soft_db of the law kSoftLog, and ONE of looks and display span, because background alone
// determines only one number for the two. If the recording states the span (or the exponent of a power law),
// the looks are fitted. If not, the looks are fixed at 1 and the span is fitted. A display that the caller
// gives is kept whole, and the looks are fitted.
//
// Selection: the likelihood of held-out pings selects the display law, the time-varied gain and whether there
// is a floor behind it, among candidates that converged. The table is kept. Display and speckle are tried
// with one floor first, then gains and floors with the best of them. If two floors win, the other displays
// are tried with two as well. Looks at their bound of 1 mean tails heavier than those of one look: then the K
// law of reverberation with texture is tried. If that converges and gains anything, texture beside a diffuse
// component is tried, too (receiver.diffuse_share, free in that law alone).
//
// With four or more held-out pings, the earlier half selects and the later half evaluates, so that the
// selection does not bias the reported agreement. One to three held-out pings do both. For a single frame,
// every second band is held out instead. The chosen form is then fitted again, to all pings and bands: that
// law is the result, and the figures on held-out pings are those of the law before (NoiseFit::evaluated_law).
// Solved by Fisher scoring with Levenberg's damping (calib/noise/noise_solver.h) on counts of grey per cell.
//
// Standard errors come from a sandwich over pings, which drift as a whole. With fewer than five pings, it is
// over range bands of each ping. A parameter is unidentifiable if the pings determine it to no better than
// half of its prior standard deviation (NoiseFitOptions) or to no better than 20 dB. It then gets no sigma,
// and a sentence names it.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calib/fit_report.h"
#include "calib/noise/noise_judgement.h"
#include "calib/noise/noise_likelihood.h"
#include "core/types/recording.h"

namespace sonarcal::calib {

struct NoiseFitOptions {
  std::vector<int> held_out;          // frames, counted from 0; empty: the last third; of one or two none
  bool choose_held_out = true;        // false: hold out only the frames of `held_out`
  int skip_bins = 1;                  // nearest range bins left out, without echoes
  std::optional<double> range_min_m;  // window without targets; absent: all
  std::optional<double> range_max_m;
  int band_bins = 8;  // range bins per cell
  // Leaves out cells that differ from the plainest law by more than this many robust standard deviations of
  // all cells (calib/noise/noise_background.h). For pings with a few targets. 0: leaves out none.
  double reject_beyond = 0.0;
  // Finds the window by rule, within range_min_m..range_max_m: the longest one that the plainest law
  // describes about as well as any (FindBackground). For recordings without target-free pings.
  bool find_background = false;
  // Does not fit every second band, and evaluates only on these. For held-out pings that show the same frozen
  // speckle as the fitted ones. Always done for a single frame.
  bool hold_out_bands = false;
  // If set, replaces the display of the recording and its candidates, and is not fitted.
  std::optional<DisplayParameters<double>> display;
  double absorption_db_per_m = 0.0;
  double taper_spread_db = 10.0;  // prior standard deviation of each beam's taper
  double level_spread_db = 60.0;  // prior standard deviation of the floors' levels, about their start values
  double slope_spread_db_per_m = 10.0;
  int max_iterations = 200;
  std::function<void(const std::string& line)> progress;
};

// Returns whether the fit changes soft_db: only in the law kSoftLog, and only if the caller gives no display.
inline bool FitsSoftDb(const DisplayParameters<double>& display, const NoiseFitOptions& options) {
  return display.law == DisplayLaw::kSoftLog && !options.display;
}

// Min gain of each step to a richer law (another display, speckle, a gain, a second floor).
inline constexpr double kRelevantNats = 2e-5;  // per pixel
// Min gain of a diffuse component beside texture over all pixels that select. With fewer than 100000 pixels,
// chance alone may gain kRelevantNats.
inline constexpr double kDiffuseNats = 2.0;

struct NoiseModelChoice {
  DisplayLaw display = DisplayLaw::kLog;
  sim::SpeckleLaw speckle = sim::SpeckleLaw::kGamma;
  TimeVariedGain time_varied_gain = TimeVariedGain::kNone;
  bool floor_after_gain = false;
  double nats_per_pixel = 0.0;  // -log likelihood of the pings of frames_chosen_on
  bool converged = false;       // otherwise it is never chosen
  bool chosen = false;
};

struct NoiseFit {
  bool usable = false;
  NoiseLaw law;            // the result: fitted to all pings if `refitted`, else to report.frames_used
  NoiseLaw evaluated_law;  // fitted to report.frames_used; that of `used` and `judged`
  bool refitted = false;
  FitReport report;  // receiver.* and display.* of `law`; frames_used are those of `evaluated_law`
  std::vector<NoiseModelChoice> choices;
  NoiseCells cells;
  bool window_found = false;    // by rule: cells.first_bin and cells.last_bin
  std::vector<double> weight;   // per cell, 0 or 1: 1 for background
  bool bands_held_out = false;  // odd bands, counted from 0, are not fitted and alone evaluated
  // Frames that selected the law, and frames of the reported agreement. If none is held out, both are the
  // fitted frames.
  std::vector<int> frames_chosen_on;
  std::vector<int> frames_judged_on;
  bool judged_on_held_out = false;  // pings or bands
  bool judged_apart_from_choice = false;
  NoiseAgreement used;    // on the pings of report.frames_used
  NoiseAgreement judged;  // on the pings of frames_judged_on
  // Judgement of `law` on all pings, with the drift. Says nothing about other pings: `law` was fitted to
  // these.
  NoiseJudgement all;
};

// Throws DataError if the frames cannot be used together. Without a usable law, `usable` is false.
NoiseFit FitNoise(const RecordingSource& recording, const NoiseFitOptions& options);

}  // namespace sonarcal::calib
