// `sonarcal poses`: where the sonar was, from pictures that a camera beside it took of markers
// (calib/markers/marker_poses.h; docs/guide/markers.md).
//
// Written: poses.json, world_from_sonar of the frames that have a pose, for `simulate --poses`;
// trajectory.csv, the same over time, for `convert --trajectory`; marker_poses.json, every frame with its
// markers, residuals and covariance, or why it has no pose; markers.json, the map as refined, where it has
// sigmas; with `pictures` markers_NNNN.png, each image with the markers' outlines as the pose projects them,
// and residuals enlarged.
//
// An image that can't be read, or shows no marker, is reported and passed over; where none gives a pose
// nothing is written and the command fails.
#pragma once

#include <filesystem>
#include <optional>

#include "apps/command.h"
#include "data_io/images/camera_image.h"

namespace sonarcal {

struct PosesOptions {
  CommonOptions common;
  std::filesystem::path images;
  std::filesystem::path camera;
  std::filesystem::path markers;
  std::filesystem::path mount;
  std::filesystem::path port;  // empty: no refraction modelled
  std::filesystem::path out;
  std::optional<NameTimes> time_unit;  // absent: by the names' digits
  std::optional<double> rate_hz;       // absent: names, or else one image a second
  double max_rms_px = 2.0;
  bool refine_focal = false;
  bool pictures = false;
};

ExitStatus RunPoses(const PosesOptions& options);

}  // namespace sonarcal
