#include "apps/poses_output.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "core/types/units.h"
#include "data_io/json/json_fields.h"

namespace sonarcal {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kCovarianceMeaning =
    "6 x 6 of (x, y, z, a, b, c): error of the position along the world's axes in metres, then of the "
    "rotation "
    "about the sonar's own axes in radians; true = (position + (x, y, z), rotation * Exp(a, b, c))";

Json MatrixJson(const Matrix6d& matrix) {
  Json rows = Json::array();
  for (int r = 0; r < 6; ++r) {
    Json row = Json::array();
    for (int c = 0; c < 6; ++c) row.push_back(matrix(r, c));
    rows.push_back(std::move(row));
  }
  return rows;
}

Json FrameJson(const CameraImageFile& file, const MarkerImage& image, const MarkerFramePose& frame) {
  Json json = {{"image", file.file.filename().string()}, {"time_s", *file.time_s}};
  if (!frame.refused.empty()) {
    json["refused"] = frame.refused;
  } else {
    json["world_from_sonar"] = PoseJson(frame.world_from_sonar);
    json["covariance"] = MatrixJson(frame.sonar_covariance);
    json["sigma_position_m"] = SigmaPositionM(frame.sonar_covariance);
    json["sigma_angle_deg"] = DegFromRad(SigmaAngleRad(frame.sonar_covariance));
    json["world_from_camera"] = PoseJson(frame.world_from_camera);
    json["reprojection_rms_px"] = frame.rms_px;
    Json markers = Json::array();
    for (const MarkerResidual& marker : frame.markers) {
      Json one = {{"id", marker.id}, {"rms_px", marker.rms_px}};
      if (marker.left_out) one["left_out"] = true;
      markers.push_back(std::move(one));
    }
    json["markers"] = std::move(markers);
    if (frame.other) {
      json["other_pose"] = {{"world_from_sonar", PoseJson(frame.other->world_from_sonar)},
                            {"less_likely_by_nats", frame.other->nats}};
    }
  }
  if (!image.not_in_map.empty()) json["ids_not_in_map"] = image.not_in_map;
  if (!image.seen_twice.empty()) json["ids_seen_twice"] = image.seen_twice;
  if (!image.unclear.empty()) json["ids_unclear"] = image.unclear;
  return json;
}

}  // namespace

std::string RefractionText(const MarkerPosesInputs& inputs) {
  if (!inputs.port) return "no refraction modelled";
  return fmt::format(
      "refraction at a flat port modelled ({:g} mm from the camera, {:g} mm thick, indices {:g} and {:g})",
      1e3 * inputs.port->distance_m, 1e3 * inputs.port->thickness_m, inputs.port->glass_index,
      inputs.port->water_index);
}

double SigmaPositionM(const Matrix6d& covariance) {
  return std::sqrt(covariance.topLeftCorner<3, 3>().trace());
}

double SigmaAngleRad(const Matrix6d& covariance) {
  return std::sqrt(covariance.bottomRightCorner<3, 3>().trace());
}

Json MarkerPosesJson(const TimedImages& timed, const std::vector<MarkerImage>& images,
                     const MarkerPosesInputs& inputs, const MarkerPoses& poses) {
  Json frames = Json::array();
  for (std::size_t i = 0; i < images.size(); ++i)
    frames.push_back(FrameJson(timed.images[i], images[i], poses.frames[i]));
  Json json = {{"format", "sonar-marker-poses/1"},
               {"refraction", RefractionText(inputs)},
               {"times", timed.times},
               {"covariance_meaning", kCovarianceMeaning},
               {"noise_factor", poses.noise_factor},
               {"degrees_of_freedom", poses.degrees_of_freedom},
               {"reprojection_rms_px", poses.rms_px}};
  if (inputs.mount.sigma_position_m > 0.0 || inputs.mount.sigma_angle_rad > 0.0) {
    json["mount_sigma"] = {{"position_m", inputs.mount.sigma_position_m},
                           {"angle_deg", DegFromRad(inputs.mount.sigma_angle_rad)},
                           {"note", "in every covariance; one and the same error in all frames"}};
  }
  if (poses.focal_scale_sigma > 0.0)
    json["focal_scale"] = {{"value", poses.focal_scale}, {"sigma", poses.focal_scale_sigma}};
  json["frames"] = std::move(frames);
  return json;
}

std::string TrajectoryText(const TimedImages& timed, const MarkerPoses& poses) {
  std::string text = "time_s,x_m,y_m,z_m,qw,qx,qy,qz\n";
  for (std::size_t i = 0; i < poses.frames.size(); ++i) {
    if (!poses.frames[i].refused.empty()) continue;
    const Pose& pose = poses.frames[i].world_from_sonar;
    const Eigen::Vector3d& p = pose.position_m;
    const Eigen::Quaterniond& q = pose.rotation;
    text += fmt::format("{},{},{},{},{},{},{},{}\n", *timed.images[i].time_s, p.x(), p.y(), p.z(), q.w(),
                        q.x(), q.y(), q.z());
  }
  return text;
}

}  // namespace sonarcal
