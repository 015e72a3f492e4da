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
//
// What `poses` writes of the poses that it found: marker_poses.json and trajectory.csv.
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

// The pictures with a time each, and where it came from.
struct TimedImages {
  std::vector<data_io::CameraImageFile> images;
  std::string times;
};

// In words, for people.
std::string RefractionText(const MarkerPosesInputs& inputs);

// One number each of a pose's covariance (calib/markers/marker_poses.h): the root of the sum of three
// variances.
double SigmaPositionM(const calib::Matrix6d& covariance);
double SigmaAngleRad(const calib::Matrix6d& covariance);

// marker_poses.json; `images` and the poses' frames go with `timed.images`.
nlohmann::ordered_json MarkerPosesJson(const TimedImages& timed,
                                       const std::vector<calib::MarkerImage>& images,
                                       const MarkerPosesInputs& inputs, const calib::MarkerPoses& poses);

// trajectory.csv: the frames that have a pose.
std::string TrajectoryText(const TimedImages& timed, const calib::MarkerPoses& poses);

struct PosesOptions {
  cli::CommonOptions common;
  std::filesystem::path images;
  std::filesystem::path camera;
  std::filesystem::path markers;
  std::filesystem::path mount;
  std::filesystem::path port;  // empty: no refraction modelled
  std::filesystem::path out;
  std::optional<data_io::NameTimes> time_unit;  // absent: by the names' digits
  std::optional<double> rate_hz;                // absent: names, or else one image a second
  double max_rms_px = 2.0;
  bool refine_focal = false;
  bool pictures = false;
};

cli::ExitStatus RunPoses(const PosesOptions& options);

}  // namespace sonarcal::commands
