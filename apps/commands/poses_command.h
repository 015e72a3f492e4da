// `sonarcal poses`: poses of the sonar from pictures of markers by a camera mounted beside it
// (calib/markers/marker_poses.h; docs/guide/markers.md).
//
// Writes:
//
//   poses.json              world_from_sonar of the frames with a pose, for `simulate --poses`
//   trajectory.csv          these poses over time, for `convert --trajectory`
//   marker_poses.json       every frame with its markers, residuals and covariance, or the reason for no pose
//   markers.json            the refined map, if it has sigmas
//   markers_NNNN.png        with `pictures`: each image with the projected outlines of the markers and
//                           enlarged residuals
//
// An image that cannot be read, or shows no marker, is reported and skipped. If no image gives a pose,
// nothing is written and the command fails.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "apps/cli/command.h"
#include "calib/markers/marker_images.h"
#include "calib/markers/marker_poses.h"
#include "core/types/camera.h"
#include "core/types/marker_map.h"
#include "data_io/images/camera_image.h"

namespace sonarcal::commands {

struct MarkerPosesInputs {
  Camera camera;
  MarkerMap map;
  CameraMount mount;
  std::optional<FlatPort> port;

  const FlatPort* port_or_null() const { return port ? &*port : nullptr; }
};

// Pictures with their times, and the source of the times.
struct TimedImages {
  std::vector<data_io::CameraImageFile> images;
  std::string times;
};

// Text for display.
std::string RefractionText(const MarkerPosesInputs& inputs);

// Return one number for a pose's covariance (calib/markers/marker_poses.h): the root of the sum of three
// variances.
double SigmaPositionM(const calib::Matrix6d& covariance);
double SigmaAngleRad(const calib::Matrix6d& covariance);

// Makes marker_poses.json. `images` and the frames of the poses correspond to `timed.images`.
nlohmann::ordered_json MarkerPosesJson(const TimedImages& timed,
                                       const std::vector<calib::MarkerImage>& images,
                                       const MarkerPosesInputs& inputs, const calib::MarkerPoses& poses);

// Makes trajectory.csv with the frames that have a pose.
std::string TrajectoryText(const TimedImages& timed, const calib::MarkerPoses& poses);

struct PosesOptions {
  cli::CommonOptions common;
  std::filesystem::path images;
  std::filesystem::path camera;
  std::filesystem::path markers;
  std::filesystem::path mount;
  std::filesystem::path port;  // empty: no refraction modelled
  std::filesystem::path out;
  std::optional<data_io::NameTimes> time_unit;  // absent: from the number of digits in the names
  std::optional<double> rate_hz;                // absent: times from the names, or else one image per second
  double max_rms_px = 2.0;
  bool refine_focal = false;
  bool pictures = false;
};

cli::ExitStatus RunPoses(const PosesOptions& options);

}  // namespace sonarcal::commands
