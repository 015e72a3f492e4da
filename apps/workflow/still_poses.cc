#include "apps/workflow/still_poses.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "apps/workflow/compare.h"
#include "calib/selection/frame_choice.h"
#include "core/math/pose_groups.h"
#include "core/types/error.h"
#include "core/types/units.h"
#include "sim/physics/receiver.h"

namespace sonarcal::workflow {
namespace {

constexpr double kAgreeSigmas = 3.0;

// Memory for the images of one pose, and number of poses: a long recording has more of both than the levels
// need.
constexpr std::size_t kMaxPixels = 64UL << 20U;
constexpr int kMaxPoses = 8;

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
  std::vector<int> without_pose;
  std::vector<int> with_pose;
  std::vector<Pose> poses;
  for (int frame = 0; frame < recording.frame_count(); ++frame) {
    const std::optional<Pose> pose = recording.frame_info(frame).world_from_sonar;
    (pose ? with_pose : without_pose).push_back(frame);
    if (pose) poses.push_back(*pose);
  }
  std::vector<std::vector<int>> shown_again;
  if (without_pose.size() > 1) shown_again.push_back(std::move(without_pose));
  for (std::vector<int>& group : GroupByPose(poses)) {
    if (group.size() < 2) continue;
    for (int& frame : group) frame = with_pose[frame];
    shown_again.push_back(std::move(group));
  }
  std::ranges::sort(shown_again, {}, [](const std::vector<int>& frames) { return frames.front(); });
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
  const std::vector<std::vector<int>> by_pose = FramesByPose(recording);
  std::vector<int> measured(by_pose.size());
  std::iota(measured.begin(), measured.end(), 0);
  measured = EvenlySpread(measured, kMaxPoses);
  if (measured.size() < by_pose.size()) {
    still.refused.push_back(
        fmt::format("{} of {} repeated poses are measured, evenly spread", measured.size(), by_pose.size()));
  }
  const PolarAxes& axes = recording.info().sonar.axes;
  const std::size_t pixels = std::max<std::size_t>(
      1, static_cast<std::size_t>(axes.range_bins) * static_cast<std::size_t>(axes.beam_count()));
  const int max_frames = static_cast<int>(std::max<std::size_t>(2, kMaxPixels / pixels));
  for (const int pose_index : measured) {
    const std::vector<int> frames = EvenlySpread(by_pose[pose_index], max_frames);
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
