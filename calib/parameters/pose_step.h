// Small moves of a pose in a refinement: metres along the axes of the sonar (right, ahead, up), then degrees
// about them (roll about Y, pitch about X, yaw about Z). Such a move changes an image equally for every
// heading of the sonar. Also converts a pose to and from its named parameters.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <numbers>

#include "core/types/image.h"
#include "core/types/pose.h"
#include "core/types/rotation.h"
#include "core/types/units.h"

namespace sonarcal::calib {

inline constexpr int kPoseSteps = 6;
using PoseStep = Eigen::Matrix<double, kPoseSteps, 1>;  // m, m, m, deg, deg, deg

// Component of a step that turns the sonar about its own Z, to the left.
inline constexpr int kTurnOfSonar = 5;

// Names as in parameters.
inline constexpr std::array<const char*, kPoseSteps> kPoseNames = {"x_m",      "y_m",       "z_m",
                                                                   "roll_deg", "pitch_deg", "yaw_deg"};

// Half the step of the differences of images along one component of a pose, m or deg. It is wide enough to
// average over rays at the edges of an object, and narrow compared with bins and beams.
inline double PoseDifference(const PolarAxes& axes, int component) {
  constexpr double kLeastDeg = 0.1;
  return component < 3 ? 0.5 * axes.range_bin_m() : std::max(kLeastDeg, DegFromRad(axes.beam_spacing_rad()));
}

// Rotation vector of a step's angles in the sonar frame, rad.
inline Eigen::Vector3d RotationVectorRad(const PoseStep& step) {
  return {RadFromDeg(step(4)), RadFromDeg(step(3)), RadFromDeg(step(5))};
}

inline Pose MovePose(const Pose& pose, const PoseStep& step) {
  return {Turned(pose.rotation, RotationVectorRad(step)), pose * Eigen::Vector3d(step.head<3>())};
}

// Returns the step from `from` to `to`.
inline PoseStep StepBetween(const Pose& from, const Pose& to) {
  const Eigen::AngleAxisd turn(from.rotation.conjugate() * to.rotation);
  double angle = turn.angle();
  if (angle > std::numbers::pi) angle -= 2.0 * std::numbers::pi;
  const Eigen::Vector3d vector = angle * turn.axis();
  PoseStep step;
  step << from.rotation.conjugate() * (to.position_m - from.position_m), DegFromRad(vector.y()),
      DegFromRad(vector.x()), DegFromRad(vector.z());
  return step;
}

// Returns a pose as its named parameters: position, then roll, pitch and yaw.
inline PoseStep NamedValues(const Pose& pose) {
  const Eigen::Vector3d yaw_pitch_roll = YawPitchRollFromRotation(pose.rotation);
  PoseStep values;
  values << pose.position_m, DegFromRad(yaw_pitch_roll(2)), DegFromRad(yaw_pitch_roll(1)),
      DegFromRad(yaw_pitch_roll(0));
  return values;
}

inline Pose PoseFromNamedValues(const PoseStep& values) {
  return {RotationFromYawPitchRoll(RadFromDeg(values(5)), RadFromDeg(values(4)), RadFromDeg(values(3))),
          values.head<3>()};
}

}  // namespace sonarcal::calib
