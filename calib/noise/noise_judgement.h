// Judgement of a noise law on pings, without a fit: agreement over all pixels, per cell and per ping, and the
// drift of the level from ping to ping.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "calib/noise/noise_likelihood.h"
#include "core/types/recording.h"

namespace sonarcal::calib {

// Largest KS that independent pixels of the law itself exceed in 1 % of all cases, at most: 1.63 / sqrt(n).
double ChanceKs(double pixels);

struct NoisePing {
  int frame = 0;
  double ks = 0.0;
  double wasserstein_grey = 0.0;
  ResidualSummary whitened;
  double level_db = 0.0;        // level of the ping's noise relative to the law
  double level_sigma_db = 0.0;  // by speckle of independent pixels alone
  double pixels = 0.0;
};

// Drift of the level of pings. Their levels are a straight line over the ping number and a residual that may
// be correlated from ping to ping (first-order autoregression); the standard errors include that.
struct NoiseDrift {
  struct Part {
    int first_frame = 0;
    int last_frame = 0;
    double level_db = 0.0;  // mean
    double sigma_db = 0.0;
  };
  double spread_db = 0.0;  // standard deviation of the residuals
  double lag_one = 0.0;    // correlation of the residuals of neighbouring pings
  double trend_db_per_ping = 0.0;
  double trend_sigma = 0.0;  // standard error, dB per ping
  bool significant = false;  // the trend differs from 0 by more than 1.96 standard errors
  int first_frame = 0;
  int last_frame = 0;
  std::vector<Part> parts = {};  // of equally many pings, two to four

  double change_db() const { return trend_db_per_ping * (last_frame - first_frame); }
  double change_sigma_db() const { return trend_sigma * (last_frame - first_frame); }
};

inline constexpr int kMinPingsForDrift = 8;

// `frame` rises. Absent with fewer than kMinPingsForDrift pings.
std::optional<NoiseDrift> DriftOf(std::span<const int> frame, std::span<const double> level_db);

struct NoiseJudgement {
  NoiseCells cells;
  std::vector<double> weight;
  std::vector<int> frames;
  NoiseAgreement agreement = {};  // of all pings together
  std::vector<NoisePing> pings = {};
  std::optional<NoiseDrift> drift = {};

  int pings_beyond_chance() const;  // pings whose KS exceeds ChanceKs
  int cells_beyond_chance() const;
};

// Part of an image on which a law is judged.
struct NoiseWindow {
  std::optional<double> range_min_m = {};  // absent: all ranges
  std::optional<double> range_max_m = {};
  int skip_bins = 1;  // nearest range bins left out, without echoes
  int band_bins = 8;  // range bins per cell
};

// Throws DataError if images of `info` are not grey or if the window holds less than one band.
NoiseCells NoiseCellsOf(const RecordingInfo& info, const NoiseWindow& window);

// `weight`: per cell, 0 or 1; empty: all 1. `progress` gets the pings done and the pings in all after each of
// them. Throws DataError if law and recording do not fit together.
NoiseJudgement JudgeNoise(const NoiseLaw& law, const RecordingSource& recording,
                          const std::vector<int>& frames, const NoiseCells& cells,
                          const std::vector<double>& weight, double absorption_db_per_m = 0.0,
                          const std::function<void(int done, int total)>& progress = {});

}  // namespace sonarcal::calib
