// The files that `sonarcal poses` reads, of a made-up field, and the truth beside them. SYNTHETIC.
#pragma once

#include <filesystem>

#include "tests/support/marker_field.h"

namespace sonarcal::testing {

struct FieldFiles {
  MarkerMap map;
  Camera camera = FieldCamera();
  FlatPort port{.distance_m = 0.03, .thickness_m = 0.01};
  CameraMount mount;                    // the sonar 25 cm beside the camera, looking ahead along the floor
  std::vector<Pose> world_from_camera;  // one a picture

  FieldFiles();
};

// camera.yaml, markers.json, mount.json, port.json and true_poses.json (sonar-poses/1) in `folder`, and
// images/<microseconds>.png, ten a second, seen through the port where `with_port`.
void WriteFieldFiles(const std::filesystem::path& folder, const FieldFiles& files, bool with_port,
                     const PictureOptions& options = {}, int supersampling = 3);

// As OpenCV's calibration writes it.
std::string CameraYaml(const Camera& camera);

}  // namespace sonarcal::testing
