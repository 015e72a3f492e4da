#include "tests/support/marker_field_files.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "data_io/images/image_io.h"
#include "data_io/parameters/marker_map_io.h"
#include "data_io/pose_io.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::testing {

FieldFiles::FieldFiles() : map(MarkerField()) {
  // Camera axes (right, down, ahead = down to the floor) against the sonar's (right, ahead, up): the sonar's
  // ahead is the camera's up in the image, its up the camera's back.
  Eigen::Matrix3d axes;
  axes << 1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, -1.0;
  mount.camera_from_sonar = {Eigen::Quaterniond(axes), {0.25, -0.05, 0.02}};
  for (int i = 0; i < 6; ++i) {
    world_from_camera.push_back(
        LookingDown(1.3 + 0.05 * i, {-0.4 + 0.15 * i, 0.2 - 0.1 * i}, {0.05 * i - 0.1, 0.1}, 0.3 + 0.2 * i));
  }
}

std::string CameraYaml(const Camera& camera) {
  return fmt::format(
      "%YAML:1.0\n---\ncalibration_time: \"synthetic\"\nimage_width: {}\nimage_height: {}\n"
      "camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ {}, 0., {}, 0.,\n       "
      "{}, {}, 0., "
      "0., 1. ]\ndistortion_coefficients: !!opencv-matrix\n   rows: {}\n   cols: 1\n   dt: d\n   data: [ {} "
      "]\n"
      "avg_reprojection_error: 0.1\n",
      camera.cols, camera.rows, camera.fx_px, camera.cx_px, camera.fy_px, camera.cy_px,
      camera.distortion.size(), fmt::join(camera.distortion, ", "));
}

void WriteFieldFiles(const std::filesystem::path& folder, const FieldFiles& files, bool with_port,
                     const PictureOptions& options, int supersampling) {
  std::filesystem::create_directories(folder / "images");
  WriteFile(folder / "camera.yaml", CameraYaml(files.camera));
  data_io::WriteMarkerMap(folder / "markers.json", files.map);
  const Pose& m = files.mount.camera_from_sonar;
  WriteFile(
      folder / "mount.json",
      fmt::format("{{\"format\": \"sonar-mount/1\", \"camera_from_sonar\": {{\"position_m\": [{}, {}, {}], "
                  "\"quaternion_wxyz\": [{}, {}, {}, {}]}}}}\n",
                  m.position_m.x(), m.position_m.y(), m.position_m.z(), m.rotation.w(), m.rotation.x(),
                  m.rotation.y(), m.rotation.z()));
  WriteFile(
      folder / "port.json",
      fmt::format(
          "{{\"format\": \"sonar-port/1\", \"distance_m\": {}, \"thickness_m\": {}, \"glass_index\": {}, "
          "\"water_index\": {}}}\n",
          files.port.distance_m, files.port.thickness_m, files.port.glass_index, files.port.water_index));
  const FieldRenderer renderer(files.map, files.camera, with_port ? &files.port : nullptr, supersampling);
  std::vector<data_io::TimedPose> truth;
  for (std::size_t i = 0; i < files.world_from_camera.size(); ++i) {
    const std::int64_t time_us = 1'700'000'000'000'000 + 100'000 * static_cast<std::int64_t>(i);
    PictureOptions picture = options;
    picture.seed += static_cast<unsigned>(i);
    data_io::WritePng(folder / "images" / fmt::format("{}.png", time_us),
                      renderer.Render(files.world_from_camera[i], picture));
    truth.push_back({1e-6 * static_cast<double>(time_us), files.world_from_camera[i] * m});
  }
  data_io::WritePoses(folder / "true_poses.json", truth);
}

}  // namespace sonarcal::testing
