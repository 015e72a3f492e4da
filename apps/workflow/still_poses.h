// Repeated poses of a recording with a static scene. Separates noise from speckle there
// (calib/noise/still_frames.h) and compares both with a fit of the scene.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calib/fit_report.h"
#include "calib/noise/still_frames.h"
#include "core/types/recording.h"

namespace sonarcal::workflow {

struct StillPose {
  calib::StillLevels levels;
  // Values of the fitted scene, if there is one.
  std::optional<double> fitted_noise_db = {};
  std::optional<double> fitted_noise_sigma_db = {};
  std::optional<calib::SceneEchoes> scene = {};

  // Fitted noise level minus the level measured here, in standard deviations of both. Absent without a fit.
  std::optional<double> NoiseDeviation() const;
  bool NoiseAgrees() const;  // within three standard deviations
};

struct StillPoses {
  std::vector<StillPose> poses;
  std::vector<std::string> refused;  // repeated poses that could not be measured, with the reason

  bool empty() const { return poses.empty() && refused.empty(); }
};

// Frames grouped by pose, for poses with two frames or more. Frames without a pose form one group.
std::vector<std::vector<int>> FramesByPose(const RecordingSource& recording);

// Returns the echo power that the fitted scene expects in a frame, per pixel, without noise.
using ExpectedEchoes = std::function<std::vector<double>(int frame)>;

// Uses display, looks and noise floor of `parameters`. Compares with the fitted scene if `report` and
// `expected` are given.
StillPoses MeasureStillPoses(const RecordingSource& recording, const ParameterSet& parameters,
                             double absorption_db_per_m, const std::vector<std::uint8_t>& use,
                             const calib::FitReport* report = nullptr, const ExpectedEchoes& expected = {});

}  // namespace sonarcal::workflow
