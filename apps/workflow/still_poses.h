// Poses that a recording shows more than once, the scene standing still: noise told from speckle there
// (calib/noise/still_frames.h), and both set beside what a fit of the scene says.
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
  // Of the fitted scene, where there is one.
  std::optional<double> fitted_noise_db = {};
  std::optional<double> fitted_noise_sigma_db = {};
  std::optional<calib::SceneEchoes> scene = {};

  // Fitted less told, in sigmas of both; absent without a fit.
  std::optional<double> NoiseDeviation() const;
  bool NoiseAgrees() const;  // within three
};

struct StillPoses {
  std::vector<StillPose> poses;
  std::vector<std::string> refused;  // of poses that are shown more than once, why nothing was told

  bool empty() const { return poses.empty() && refused.empty(); }
};

// Frames by pose, poses with two frames or more. Frames without a pose are taken for one.
std::vector<std::vector<int>> FramesByPose(const RecordingSource& recording);

// What the fitted scene says of a frame: expected echo power by pixel, without noise.
using ExpectedEchoes = std::function<std::vector<double>(int frame)>;

// By the display, looks and floors of `parameters`. With `report` and `expected` the fitted scene is
// compared.
StillPoses TellStillPoses(const RecordingSource& recording, const ParameterSet& parameters,
                          double absorption_db_per_m, const std::vector<std::uint8_t>& use,
                          const calib::FitReport* report = nullptr, const ExpectedEchoes& expected = {});

}  // namespace sonarcal::workflow
