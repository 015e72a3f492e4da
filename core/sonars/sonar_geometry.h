// Corrections of a sonar's declared image geometry: what a camera calibration calls intrinsics.
//
//   true range   = range_offset_m + range_scale x declared range
//   true azimuth = azimuth_offset_deg + (azimuth_scale + azimuth_cubic (a / a_edge)^2) a,
//                  with a the declared azimuth and a_edge the largest of them
//
// The tilt turns the array against the mount whose pose was recorded: about the sonar's X, positive looks up.
#pragma once

#include "core/types/image.h"
#include "core/types/pose.h"

namespace sonarcal {

struct SonarGeometry {
  double range_offset_m = 0.0;  // such as a delay of the start
  double range_scale = 1.0;     // such as the speed of sound over the assumed one
  double azimuth_offset_deg = 0.0;
  double azimuth_scale = 1.0;
  double azimuth_cubic = 0.0;  // change of the scale at the outermost beam
  double tilt_deg = 0.0;

  bool operator==(const SonarGeometry&) const = default;
};

// Axes with the true ranges and azimuths. Throws DataError if the corrected beams are no longer in order or
// the window has no positive size.
PolarAxes Corrected(const PolarAxes& declared, const SonarGeometry& geometry);

// Pose of the array when the mount has this pose.
Pose Tilted(const Pose& world_from_mount, const SonarGeometry& geometry);

}  // namespace sonarcal
