#include "apps/workflow/still_poses.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/types/error.h"
#include "core/types/units.h"
#include "sim/physics/receiver.h"

namespace sonarcal::workflow {
namespace {

constexpr double kAgreeSigmas = 3.0;

// Empty without a noise level: the shape is then constant.
std::vector<double> NoiseShapeDb(const ReceiverParameters& receiver, const PolarAxes& axes,
                                 double absorption_db_per_m) {
  if (!receiver.noise_db) return {};
  const sim::ReceiverNoise noise(receiver, axes, absorption_db_per_m);
  std::vector<double> shape_db;
  for (int bin = 0; bin < axes.range_bins; ++bin) {
    for (int beam = 0; beam < axes.beam_count(); ++beam)
      shape_db.push_back(DbFromPower(noise.Power(bin, beam)) - *receiver.noise_db);
  }
  return shape_db;
}

}  // namespace

std::optional<double> StillPose::NoiseDeviation() const {
  if (!fitted_noise_db) return std::nullopt;
  return (*fitted_noise_db - levels.noise_db) /
         std::hypot(levels.noise_sigma_db, fitted_noise_sigma_db.value_or(0.0));
}

bool StillPose::NoiseAgrees() const {
  const std::optional<double> deviation = NoiseDeviation();
  return deviation && std::abs(*deviation) <= kAgreeSigmas;
}

std::vector<std::vector<int>> FramesByPose(const RecordingSource& recording) {
  std::vector<std::pair<std::optional<Pose>, std::vector<int>>> groups;
  for (int frame = 0; frame < recording.frame_count(); ++frame) {
    const std::optional<Pose> pose = recording.frame_info(frame).world_from_sonar;
    const auto same = std::find_if(groups.begin(), groups.end(), [&](const auto& group) {
      return group.first.has_value() == pose.has_value() && (!pose || IsSamePose(*group.first, *pose));
    });
    if (same == groups.end()) {
      groups.push_back({pose, {frame}});
    } else {
      same->second.push_back(frame);
    }
  }
  std::vector<std::vector<int>> shown_again;
  for (auto& [pose, frames] : groups) {
    if (frames.size() > 1) shown_again.push_back(std::move(frames));
  }
  return shown_again;
}

StillPoses MeasureStillPoses(const RecordingSource& recording, const ParameterSet& parameters,
                             double absorption_db_per_m, const std::vector<std::uint8_t>& use,
                             const calib::FitReport* report, const ExpectedEchoes& expected) {
  const calib::StillOptions options{
      .display = parameters.display,
      .looks = parameters.receiver.looks,
      .noise_shape_db = NoiseShapeDb(parameters.receiver, recording.info().sonar.axes, absorption_db_per_m),
      .use = use};
  StillPoses still;
  for (const std::vector<int>& frames : FramesByPose(recording)) {
    std::vector<PolarImage> images;
    for (const int frame : frames) images.push_back(recording.ReadFrame(frame).image);
    StillPose pose;
    try {
      pose.levels = calib::SeparateSpeckleFromNoise(images, frames, options);
    } catch (const DataError& error) {
      still.refused.emplace_back(error.what());
      continue;
    }
    if (report != nullptr && parameters.receiver.noise_db) {
      pose.fitted_noise_db = parameters.receiver.noise_db;
      const calib::FittedParameter* noise = report->Find("receiver.noise_db");
      if (noise != nullptr) pose.fitted_noise_sigma_db = noise->sigma;
    }
    if (expected) {
      try {
        pose.scene = calib::CompareSceneEchoes(pose.levels, expected(frames.front()), options);
      } catch (const DataError& error) {
        still.refused.emplace_back(error.what());
      }
    }
    still.poses.push_back(std::move(pose));
  }
  return still;
}

}  // namespace sonarcal::workflow
