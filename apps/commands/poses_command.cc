#include "apps/commands/poses_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/cli/choice_option.h"
#include "apps/cli/progress.h"
#include "apps/cli/provenance.h"
#include "apps/cli/run_output.h"
#include "apps/commands/commands.h"
#include "apps/report/pictures/marker_picture.h"
#include "calib/markers/marker_images.h"
#include "core/math/statistics.h"
#include "core/types/units.h"
#include "data_io/files/atomic_output.h"
#include "data_io/images/image_io.h"
#include "data_io/json/json_fields.h"
#include "data_io/json/json_writer.h"
#include "data_io/parameters/camera_io.h"
#include "data_io/parameters/marker_map_io.h"
#include "data_io/pose_io.h"

namespace sonarcal::commands {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kCovarianceMeaning =
    "6 x 6 of (x, y, z, a, b, c): error of the position along the world's axes in metres, then of the "
    "rotation "
    "about the sonar's own axes in radians; true = (position + (x, y, z), rotation * Exp(a, b, c))";

Json MatrixJson(const calib::Matrix6d& matrix) {
  Json rows = Json::array();
  for (int r = 0; r < 6; ++r) {
    Json row = Json::array();
    for (int c = 0; c < 6; ++c) row.push_back(matrix(r, c));
    rows.push_back(std::move(row));
  }
  return rows;
}

Json FrameJson(const data_io::CameraImageFile& file, const calib::MarkerImage& image,
               const calib::MarkerFramePose& frame) {
  Json json = {{"image", file.file.filename().string()}, {"time_s", *file.time_s}};
  if (!frame.refused.empty()) {
    json["refused"] = frame.refused;
  } else {
    json["world_from_sonar"] = data_io::PoseJson(frame.world_from_sonar);
    json["covariance"] = MatrixJson(frame.sonar_covariance);
    json["sigma_position_m"] = SigmaPositionM(frame.sonar_covariance);
    json["sigma_angle_deg"] = DegFromRad(SigmaAngleRad(frame.sonar_covariance));
    json["world_from_camera"] = data_io::PoseJson(frame.world_from_camera);
    json["reprojection_rms_px"] = frame.rms_px;
    Json markers = Json::array();
    for (const calib::MarkerResidual& marker : frame.markers) {
      Json one = {{"id", marker.id}, {"rms_px", marker.rms_px}};
      if (marker.left_out) one["left_out"] = true;
      markers.push_back(std::move(one));
    }
    json["markers"] = std::move(markers);
    if (frame.other) {
      json["other_pose"] = {{"world_from_sonar", data_io::PoseJson(frame.other->world_from_sonar)},
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

double SigmaPositionM(const calib::Matrix6d& covariance) {
  return std::sqrt(covariance.topLeftCorner<3, 3>().trace());
}

double SigmaAngleRad(const calib::Matrix6d& covariance) {
  return std::sqrt(covariance.bottomRightCorner<3, 3>().trace());
}

Json MarkerPosesJson(const TimedImages& timed, const std::vector<calib::MarkerImage>& images,
                     const MarkerPosesInputs& inputs, const calib::MarkerPoses& poses) {
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

std::string TrajectoryText(const TimedImages& timed, const calib::MarkerPoses& poses) {
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

namespace {

using Json = nlohmann::ordered_json;

MarkerPosesInputs ReadInputs(const PosesOptions& options) {
  MarkerPosesInputs inputs{.camera = data_io::ReadCamera(options.camera),
                           .map = data_io::ReadMarkerMap(options.markers),
                           .mount = data_io::ReadCameraMount(options.mount),
                           .port = {}};
  if (!options.port.empty()) inputs.port = data_io::ReadFlatPort(options.port);
  return inputs;
}

TimedImages ListImages(const PosesOptions& options) {
  if (options.rate_hz && options.time_unit && *options.time_unit != data_io::NameTimes::kNone)
    throw UsageError("--rate and --time-unit are given, expected one: times by the rate or by the names");
  const auto unit = options.rate_hz ? std::optional(data_io::NameTimes::kNone) : options.time_unit;
  data_io::CameraImageFolder folder = data_io::ListCameraImages(options.images, unit);
  TimedImages timed{std::move(folder.images), {}};
  if (folder.times != data_io::NameTimes::kNone) {
    timed.times = fmt::format("file names, in {}", ToString(folder.times));
    return timed;
  }
  timed.times = options.rate_hz ? fmt::format("{:g} images a second, the first at 0", *options.rate_hz)
                                : "the number of the image, from 0, because times are unknown";
  for (std::size_t i = 0; i < timed.images.size(); ++i)
    timed.images[i].time_s = static_cast<double>(i) / options.rate_hz.value_or(1.0);
  return timed;
}

void WriteOutputs(const PosesOptions& options, cli::RunOutput& output, const TimedImages& timed,
                  const std::vector<calib::MarkerImage>& images, const MarkerPosesInputs& inputs,
                  const calib::MarkerPoses& poses) {
  std::vector<data_io::TimedPose> list;
  for (std::size_t i = 0; i < poses.frames.size(); ++i) {
    if (poses.frames[i].refused.empty())
      list.push_back({timed.images[i].time_s, poses.frames[i].world_from_sonar});
  }
  data_io::WritePoses(output / "poses.json", list);
  data_io::WriteFileWhole(output / "trajectory.csv", TrajectoryText(timed, poses));
  data_io::WriteJson(output / "marker_poses.json", MarkerPosesJson(timed, images, inputs, poses));
  if (poses.map.sigma) data_io::WriteMarkerMap(output / "markers.json", poses.map);
  if (options.pictures) {
    cli::Progress progress("Drawing", static_cast<int>(timed.images.size()), options.common, "images");
    for (std::size_t i = 0; i < poses.frames.size(); ++i) {
      if (poses.frames[i].refused.empty()) {
        data_io::WritePng(
            output / fmt::format("markers_{:04}.png", i),
            report::MarkerPicture(data_io::ReadCameraImage(timed.images[i].file), poses.frames[i]));
      }
      progress.Advance();
    }
  }
  std::vector<std::filesystem::path> read = {options.images, options.camera, options.markers, options.mount};
  if (!options.port.empty()) read.push_back(options.port);
  cli::WriteProvenance(output.staging(), {.command = "poses",
                                          .configuration = {{"images", options.images.string()},
                                                            {"camera", options.camera.string()},
                                                            {"markers", options.markers.string()},
                                                            {"mount", options.mount.string()},
                                                            {"port", options.port.string()},
                                                            {"out", options.out.string()},
                                                            {"times", timed.times},
                                                            {"max_rms_px", options.max_rms_px},
                                                            {"refine_focal", options.refine_focal},
                                                            {"pictures", options.pictures}},
                                          .inputs = read});
  output.Commit();
}

// Median over the frames with a pose.
template <typename Value>
double Median(const calib::MarkerPoses& poses, const Value& value) {
  std::vector<double> values;
  for (const calib::MarkerFramePose& frame : poses.frames) {
    if (frame.refused.empty()) values.push_back(value(frame));
  }
  return UpperMedian(std::move(values));
}

// Prints messages for the user.
void PrintNotes(const PosesOptions& options, const TimedImages& timed, const calib::MarkerPoses& poses) {
  constexpr int kMaxNamed = 5;
  int refused = 0;
  for (std::size_t i = 0; i < poses.frames.size(); ++i) {
    const std::string& why = poses.frames[i].refused;
    const std::string name = timed.images[i].file.filename().string();
    if (!why.empty() && ++refused <= kMaxNamed)
      cli::PrintNote(options.common, fmt::format("{}: no pose: {}", name, why));
    if (poses.frames[i].other) {
      cli::PrintNote(options.common,
                     fmt::format("{}: another pose is only {:.1f} nats less likely (other_pose)", name,
                                 poses.frames[i].other->nats));
    }
  }
  if (refused > kMaxNamed)
    cli::PrintNote(options.common,
                   fmt::format("{} more images without a pose: marker_poses.json", refused - kMaxNamed));
  constexpr double kFewFreedoms = 20.0;
  if (poses.degrees_of_freedom < kFewFreedoms) {
    cli::PrintNote(
        options.common,
        fmt::format("warning: only {:.0f} degrees of freedom determine the noise, covariances may be far off",
                    poses.degrees_of_freedom));
  }
  constexpr double kBadFit = 5.0;
  if (poses.noise_factor > kBadFit) {
    cli::PrintNote(
        options.common,
        fmt::format("warning: residuals are {:.1f} times as large as the edges in the images allow: map, "
                    "camera or port are wrong, and covariances do not include errors common to all frames",
                    poses.noise_factor));
  }
}

}  // namespace

cli::ExitStatus RunPoses(const PosesOptions& options) {
  const MarkerPosesInputs inputs = ReadInputs(options);
  const TimedImages timed = ListImages(options);
  cli::RunOutput output(options.out, "poses", options.common.force);
  std::vector<calib::MarkerImage> images;
  {
    cli::Progress progress("Finding markers", static_cast<int>(timed.images.size()), options.common,
                           "images");
    const calib::MarkerFinder finder(inputs.map, inputs.camera, inputs.port_or_null());
    for (const data_io::CameraImageFile& image : timed.images) {
      images.push_back(finder.Find(image.file));
      progress.Advance();
    }
  }
  std::vector<std::vector<calib::MarkerObservation>> seen;
  for (const calib::MarkerImage& image : images) seen.push_back(image.seen);
  calib::MarkerPoses poses =
      calib::FindMarkerPoses(seen, inputs.map, inputs.camera, inputs.port_or_null(), inputs.mount,
                             {.most_rms_px = options.max_rms_px, .refine_focal = options.refine_focal});
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (!images[i].unreadable.empty()) poses.frames[i].refused = images[i].unreadable;
  }
  const auto posed =
      std::ranges::count_if(poses.frames, [](const auto& frame) { return frame.refused.empty(); });
  if (posed == 0) {
    throw DataError("{}: none of {} images gives a pose; first image: {}", options.images.string(),
                    images.size(), poses.frames.front().refused);
  }
  WriteOutputs(options, output, timed, images, inputs, poses);
  PrintNotes(options, timed, poses);

  const double sigma_m = Median(poses, [](const auto& f) { return SigmaPositionM(f.sonar_covariance); });
  const double sigma_deg =
      DegFromRad(Median(poses, [](const auto& f) { return SigmaAngleRad(f.sonar_covariance); }));
  if (options.common.json) {
    cli::PrintJson(
        {{"poses", std::filesystem::absolute(options.out / "poses.json").lexically_normal().string()},
         {"images", images.size()},
         {"frames_with_pose", posed},
         {"reprojection_rms_px", poses.rms_px},
         {"noise_factor", poses.noise_factor},
         {"median_sigma_position_m", sigma_m},
         {"median_sigma_angle_deg", sigma_deg},
         {"refraction", RefractionText(inputs)},
         {"times", timed.times}});
  } else {
    cli::PrintResult(
        fmt::format("{}: {} of {} images have a pose; reprojection {:.3f} px rms, sigma {:.2g} mm and {:.2g} "
                    "deg (medians)\n"
                    "  {}; times: {}\n",
                    options.out.string(), posed, images.size(), poses.rms_px, 1e3 * sigma_m, sigma_deg,
                    RefractionText(inputs), timed.times));
  }
  return cli::ExitStatus::kDone;
}

void SetupPoses(CLI::App& app) {
  auto options = std::make_shared<PosesOptions>();
  CLI::App* command = cli::AddCommand(app, "poses", "Finds the poses of the sonar from pictures of markers");
  command->add_option("--images", options->images, "Folder of pictures: PNG, JPEG or grey TIFF")
      ->type_name("DIR")
      ->required();
  command->add_option("--camera", options->camera, "Camera calibration as OpenCV writes it, in pixels")
      ->type_name("YAML")
      ->required();
  command
      ->add_option("--markers", options->markers,
                   "Map of the ArUco or AprilTag markers, in metres (sonar-markers/1)")
      ->type_name("JSON")
      ->required();
  command
      ->add_option("--mount", options->mount,
                   "Mount of the camera beside the sonar: camera_from_sonar, in metres (sonar-mount/1)")
      ->type_name("JSON")
      ->required();
  command
      ->add_option(
          "--port", options->port,
          "Flat window before a camera calibrated in air (sonar-port/1); no refraction is modelled if not "
          "given, which is right for a camera in air, and nearly right for one calibrated under water at its "
          "working distance")
      ->type_name("JSON");
  cli::AddOutFolder(*command, options->out, options->common, "Folder to write")->required();
  cli::AddChoice(*command, "--time-unit", options->time_unit,
                 "Unit of the times in the names of the pictures (default: from their number of digits: 10 "
                 "s, 13 ms, 16 us, 19 ns)");
  command
      ->add_option(
          "--rate", options->rate_hz,
          "Pictures per second, in place of times from names; without either, times are image numbers")
      ->type_name("HZ")
      ->check(CLI::PositiveNumber.description(""));
  command
      ->add_option("--max-rms", options->max_rms_px,
                   "Max reprojection error of a frame, pixels (rms of the corners' distances)")
      ->type_name("PX")
      ->capture_default_str()
      ->check(CLI::PositiveNumber.description(""));
  command->add_flag("--refine-focal", options->refine_focal,
                    "Also find one factor of both focal lengths, from all pictures together");
  command->add_flag(
      "--pictures", options->pictures,
      "Also write every picture with the outlines of its markers and, enlarged 200 times, residuals");
  cli::OnRun(command, options->common, [options] { return RunPoses(*options); });
}

}  // namespace sonarcal::commands
