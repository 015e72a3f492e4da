// The bomb with the outline and poses that were in use before those of cases/bomb: 29 radii and a pose, found
// outside the project by least squares of images to frame 0, and a start on the other picture. They are no
// measurement of the object. They remain as test data, so that the bounds that were set on them stay tested.
#pragma once

#include <utility>
#include <vector>

#include "apps/reproduce/target_comparison.h"
#include "core/types/units.h"
#include "sim/scenes/scene_primitives.h"

namespace sonarcal::testing {

inline reproduce::CasePlan FittedBomb() {
  struct Knot {
    double position;  // in parts of the length
    double radius_mm;
  };
  const std::vector<Knot> knots = {
      {0.000, 44.8}, {0.015, 20.3},  {0.030, 41.6},  {0.045, 53.4},  {0.060, 57.9}, {0.080, 67.7},
      {0.100, 75.8}, {0.125, 85.9},  {0.150, 80.6},  {0.180, 85.9},  {0.210, 89.1}, {0.240, 91.7},
      {0.270, 98.2}, {0.300, 103.3}, {0.340, 104.0}, {0.400, 103.2}, {0.460, 98.3}, {0.520, 94.2},
      {0.570, 88.3}, {0.620, 83.5},  {0.660, 73.3},  {0.700, 73.1},  {0.740, 74.9}, {0.780, 69.4},
      {0.830, 69.3}, {0.880, 61.4},  {0.930, 50.4},  {0.970, 30.4},  {1.000, 15.9}};
  constexpr double kLengthM = 0.737;
  constexpr double kMaxEdgeM = 0.01;
  std::vector<sim::ProfilePoint> outline;
  outline.reserve(knots.size());
  for (const Knot& knot : knots) outline.push_back({(knot.position - 0.5) * kLengthM, 1e-3 * knot.radius_mm});

  reproduce::CasePlan plan = reproduce::FindCase("bomb");
  auto target = reproduce::TargetOf(plan);
  target.scene = sim::MakeTurnedSolid(outline, kMaxEdgeM, "body");
  target.pose.range_m = 1.267;
  target.pose.azimuth_rad = RadFromDeg(-5.118);
  target.pose.elevation_rad = RadFromDeg(0.738);
  target.pose.yaw_rad = RadFromDeg(130.832);
  target.pose.pitch_rad = RadFromDeg(30.320);
  calib::TargetPose& start = target.other.value().start;
  start.range_m = 1.569;
  start.azimuth_rad = RadFromDeg(1.74);
  start.elevation_rad = RadFromDeg(-9.0);
  start.yaw_rad = RadFromDeg(32.4);
  start.pitch_rad = RadFromDeg(30.6);
  plan.study = std::move(target);
  return plan;
}

}  // namespace sonarcal::testing
