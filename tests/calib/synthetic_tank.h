// A SYNTHETIC recording of a tank made by another kind of simulation (complex point scatterers, an array of
// elements): what a user would know of it, and its truth.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "calib/fit_report.h"
#include "calib/models/acoustic_frame_model.h"
#include "core/types/recording.h"
#include "sim/simulator.h"

namespace sonarcal::testing {

struct SyntheticTank {
  explicit SyntheticTank(const std::filesystem::path& folder);

  // As recorded, at recorded poses.
  std::vector<calib::AcousticFrame> Frames(const std::vector<int>& indices) const;

  Pose TruePose(int frame) const;
  GsabParameters<double> TrueCurve(const std::string& material) const;
  double TrueNoiseDb() const { return truth["noise_level_db"]; }
  // With the true curves, floor, beam and pulse, and mirrors where the recording has ghosts.
  ParameterSet TrueParameters() const;

  std::unique_ptr<RecordingSource> recording;
  nlohmann::json truth;
  // What a user of that sonar knows: its display, beam and pulse, and that materials are neither mirrors nor
  // black. No noise level.
  ParameterSet known;
  sim::Simulator simulator;
};

// A fitted curve beside the true one, at the angles that the truth says are covered.
struct CurveAgreement {
  int covered = 0;             // angles, a degree apart
  double share_known = 0.0;    // of them: the fitted curve's 95 % band is narrower than kMostOffDb
  double share_in_band = 0.0;  // of them: the true curve lies in the fitted one's 95 % band
};

// What a curve may be off by where it is known: sigmas do not cover all that the model lacks
// (docs/studies/ghosts.md).
inline constexpr double kMostOffDb = 1.5;

// Expects that the curve is off by at most kMostOffDb, or by the fit's own 95 % band where that is wider.
CurveAgreement ExpectCurve(const SyntheticTank& tank, const calib::FitReport& report,
                           const std::string& material);

// What the level shown differs by on average from its mean, single-look speckle about this power, 0..1.
double SpeckleFloorOf(double power, const DisplayParameters<double>& display);

}  // namespace sonarcal::testing
