// The noise law alone, from target-free pings: maximum likelihood of the speckle law carried through the
// display, with both clips as censored values (calib/noise/noise_likelihood.h). No scene, no pose, no ray.
//
// Free: both floors of types/parameters.h (ReceiverParameters), the slope with range, a taper for each floor,
// soft_db where the display law has it, and ONE of looks and display span: on background alone the two are
// one number. Where the recording tells the span (or the exponent of a power law), the looks are fitted;
// where it doesn't, the looks are held at 1 and the span is fitted.
//
// The display law, the time-varied gain and whether there is a floor behind it are chosen by the likelihood
// of held-out pings among candidates that converged; the table is kept. Display and speckle are tried with
// one floor first, then gains and floors with the best of them; where two floors win, the other displays are
// tried with two as well. Of four held-out pings or more the earlier half chooses and the later half judges,
// so that the agreement reported was not chosen for; two or three do both. Of a single frame every second
// band is held out in place of pings.
// Solved by Fisher scoring with Levenberg's damping (calib/noise/noise_solver.h) on counts of grey by cell.
//
// Sigmas are those of a sandwich over pings, which drift as wholes; with fewer than five pings, over range
// bands of each ping. What the pings tell less about than half of what was assumed beforehand
// (NoiseFitOptions), or to no better than 20 dB, is called unidentifiable, gets no sigma, and is named in
// words.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calib/fit_report.h"
#include "calib/noise/noise_likelihood.h"
#include "core/types/recording.h"

namespace sonarcal::calib {

struct NoiseFitOptions {
  std::vector<int> held_out;          // frames, counted from 0; empty: the last third, none of a single frame
  bool choose_held_out = true;        // false: hold out just what `held_out` says
  int skip_bins = 1;                  // nearest range bins left out: no echo there
  std::optional<double> range_min_m;  // window that is free of targets; absent: all
  std::optional<double> range_max_m;
  int band_bins = 8;  // range bins that share a cell
  // Cells that lie further from the plainest law than this many robust standard deviations of all cells are
  // left out (calib/noise/noise_background.h): for pings with a few targets. 0: none is.
  double reject_beyond = 0.0;
  // The window is found by rule, within range_min_m..range_max_m: the longest that the plainest law describes
  // about as well as any (FindBackground). For recordings without target-free pings.
  bool find_background = false;
  // Every second band is not fitted, and the pings are judged on it alone: where held-out pings show the
  // same frozen speckle as those fitted. Of a single frame it is done unasked.
  bool hold_out_bands = false;
  // Where set, the display is taken from here rather than from the recording and its candidates.
  std::optional<DisplayParameters<double>> display;
  double absorption_db_per_m = 0.0;
  double taper_spread_db = 10.0;  // assumed beforehand of each beam's taper
  double level_spread_db = 60.0;  // and of the floors' levels, about where a first look puts them
  double slope_spread_db_per_m = 10.0;
  int max_iterations = 200;
  std::function<void(const std::string& line)> progress;
};

// What each step to a richer law (another display, speckle, a gain, a second floor) has to gain.
inline constexpr double kRelevantNats = 2e-5;  // a pixel

struct NoiseModelChoice {
  DisplayLaw display = DisplayLaw::kLog;
  sim::SpeckleLaw speckle = sim::SpeckleLaw::kGamma;
  TimeVariedGain time_varied_gain = TimeVariedGain::kNone;
  bool floor_after_gain = false;
  double nats_per_pixel = 0.0;  // -log likelihood of the pings of frames_chosen_on
  bool converged = false;       // else it is never chosen
  bool chosen = false;
};

struct NoiseFit {
  bool usable = false;
  NoiseLaw law;
  FitReport report;  // receiver.* and display.*
  std::vector<NoiseModelChoice> choices;
  NoiseCells cells;
  bool window_found = false;    // by rule: cells.first_bin and cells.last_bin
  std::vector<double> weight;   // by cell, 0 or 1: what counts as background
  bool bands_held_out = false;  // odd bands, counted from 0: not fitted, and alone judged on
  // Frames of which the likelihood chose, and of which agreement is reported. Where none is held out, both
  // are the frames fitted.
  std::vector<int> frames_chosen_on;
  std::vector<int> frames_judged_on;
  bool judged_on_held_out = false;  // pings or bands
  bool judged_apart_from_choice = false;
  NoiseAgreement used;    // pings fitted
  NoiseAgreement judged;  // pings of frames_judged_on
};

// Throws DataError where the frames can't be used together; an end without a usable law is `usable` = false.
NoiseFit FitNoise(const RecordingSource& recording, const NoiseFitOptions& options);

}  // namespace sonarcal::calib
