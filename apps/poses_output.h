// What `poses` writes of the poses that it found: marker_poses.json and trajectory.csv.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "apps/marker_images.h"
#include "calib/markers/marker_poses.h"
#include "core/types/camera.h"
#include "core/types/marker_map.h"
#include "data_io/images/camera_image.h"

namespace sonarcal {

struct MarkerPosesInputs {
  Camera camera;
  MarkerMap map;
  CameraMount mount;
  std::optional<FlatPort> port;

  const FlatPort* port_or_null() const { return port ? &*port : nullptr; }
};

// The pictures with a time each, and where it came from.
struct TimedImages {
  std::vector<CameraImageFile> images;
  std::string times;
};

// In words, for people.
std::string RefractionText(const MarkerPosesInputs& inputs);

// One number each of a pose's covariance (calib/markers/marker_poses.h): the root of the sum of three
// variances.
double SigmaPositionM(const Matrix6d& covariance);
double SigmaAngleRad(const Matrix6d& covariance);

// marker_poses.json; `images` and the poses' frames go with `timed.images`.
nlohmann::ordered_json MarkerPosesJson(const TimedImages& timed, const std::vector<MarkerImage>& images,
                                       const MarkerPosesInputs& inputs, const MarkerPoses& poses);

// trajectory.csv: the frames that have a pose.
std::string TrajectoryText(const TimedImages& timed, const MarkerPoses& poses);

}  // namespace sonarcal
