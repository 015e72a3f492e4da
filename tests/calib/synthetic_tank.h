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

// A fitted curve against the true one, at the incidence angles that enough pixels of the recording show.
struct CurveAgreement {
  int angles = 0;              // their number; they are one degree apart
  double share_in_band = 0.0;  // share of them where the true curve lies in the fit's 95 % band
  double largest_error_db = 0.0;
};

// Largest allowed error of a fitted curve. Standard errors do not contain what the model lacks
// (docs/studies/ghosts.md), so a smaller one is no reason to fail.
inline constexpr double kMaxCurveErrorDb = 1.5;

// Expects at each of these angles that the error is at most kMaxCurveErrorDb, or within the fit's 95 % band
// if that is wider. `report` is that of the fit.
CurveAgreement ExpectCurve(const SyntheticTank& tank, const calib::FitReport& report,
                           const std::string& material);

// What the level shown differs by on average from its mean, single-look speckle about this power, 0..1.
double SpeckleFloorOf(double power, const DisplayParameters<double>& display);

}  // namespace sonarcal::testing
