#include "apps/poses_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/choice_option.h"
#include "apps/commands.h"
#include "apps/marker_images.h"
#include "apps/marker_picture.h"
#include "apps/poses_output.h"
#include "apps/progress.h"
#include "apps/provenance.h"
#include "apps/run_output.h"
#include "core/types/units.h"
#include "data_io/files/atomic_output.h"
#include "data_io/images/image_io.h"
#include "data_io/json/json_writer.h"
#include "data_io/parameters/camera_io.h"
#include "data_io/parameters/marker_map_io.h"
#include "data_io/pose_io.h"

namespace sonarcal {
namespace {

using Json = nlohmann::ordered_json;

constexpr JsonWords<NameTimes, 5> kTimeUnits = {{{"none", NameTimes::kNone},
                                                 {"s", NameTimes::kSeconds},
                                                 {"ms", NameTimes::kMilliseconds},
                                                 {"us", NameTimes::kMicroseconds},
                                                 {"ns", NameTimes::kNanoseconds}}};

MarkerPosesInputs ReadInputs(const PosesOptions& options) {
  MarkerPosesInputs inputs{.camera = ReadCamera(options.camera),
                           .map = ReadMarkerMap(options.markers),
                           .mount = ReadCameraMount(options.mount),
                           .port = {}};
  if (!options.port.empty()) inputs.port = ReadFlatPort(options.port);
  return inputs;
}

TimedImages ListImages(const PosesOptions& options) {
  if (options.rate_hz && options.time_unit && *options.time_unit != NameTimes::kNone)
    throw UsageError("--rate and --time-unit are given, expected one: times by the rate or by the names");
  const auto unit = options.rate_hz ? std::optional(NameTimes::kNone) : options.time_unit;
  CameraImageFolder folder = ListCameraImages(options.images, unit);
  TimedImages timed{std::move(folder.images), {}};
  if (folder.times != NameTimes::kNone) {
    timed.times = fmt::format("file names, in {}", ToString(folder.times));
    return timed;
  }
  timed.times = options.rate_hz ? fmt::format("{:g} images a second, the first at 0", *options.rate_hz)
                                : "the image's number, from 0, for want of times: no seconds";
  for (std::size_t i = 0; i < timed.images.size(); ++i)
    timed.images[i].time_s = static_cast<double>(i) / options.rate_hz.value_or(1.0);
  return timed;
}

void WriteOutputs(const PosesOptions& options, RunOutput& output, const TimedImages& timed,
                  const std::vector<MarkerImage>& images, const MarkerPosesInputs& inputs,
                  const MarkerPoses& poses) {
  std::vector<TimedPose> list;
  for (std::size_t i = 0; i < poses.frames.size(); ++i) {
    if (poses.frames[i].refused.empty())
      list.push_back({timed.images[i].time_s, poses.frames[i].world_from_sonar});
  }
  WritePoses(output / "poses.json", list);
  WriteFileWhole(output / "trajectory.csv", TrajectoryText(timed, poses));
  WriteJson(output / "marker_poses.json", MarkerPosesJson(timed, images, inputs, poses));
  if (poses.map.sigma) WriteMarkerMap(output / "markers.json", poses.map);
  if (options.pictures) {
    Progress progress("Drawing", static_cast<int>(timed.images.size()), options.common, "images");
    for (std::size_t i = 0; i < poses.frames.size(); ++i) {
      if (poses.frames[i].refused.empty()) {
        WritePng(output / fmt::format("markers_{:04}.png", i),
                 MarkerPicture(ReadCameraImage(timed.images[i].file), poses.frames[i]));
      }
      progress.Advance();
    }
  }
  std::vector<std::filesystem::path> read = {options.images, options.camera, options.markers, options.mount};
  if (!options.port.empty()) read.push_back(options.port);
  WriteProvenance(output.staging(), {.command = "poses",
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

// The middle one of the frames with a pose.
template <typename Value>
double Median(const MarkerPoses& poses, const Value& value) {
  std::vector<double> values;
  for (const MarkerFramePose& frame : poses.frames) {
    if (frame.refused.empty()) values.push_back(value(frame));
  }
  std::ranges::nth_element(values, values.begin() + values.size() / 2);
  return values[values.size() / 2];
}

// What a user should not miss.
void PrintNotes(const PosesOptions& options, const TimedImages& timed, const MarkerPoses& poses) {
  constexpr int kMostNamed = 5;
  int refused = 0;
  for (std::size_t i = 0; i < poses.frames.size(); ++i) {
    const std::string& why = poses.frames[i].refused;
    const std::string name = timed.images[i].file.filename().string();
    if (!why.empty() && ++refused <= kMostNamed)
      PrintNote(options.common, fmt::format("{}: no pose: {}", name, why));
    if (poses.frames[i].other) {
      PrintNote(options.common, fmt::format("{}: another pose is only {:.1f} nats less likely (other_pose)",
                                            name, poses.frames[i].other->nats));
    }
  }
  if (refused > kMostNamed)
    PrintNote(options.common,
              fmt::format("{} more images without a pose: marker_poses.json", refused - kMostNamed));
  constexpr double kFewFreedoms = 20.0;
  if (poses.degrees_of_freedom < kFewFreedoms) {
    PrintNote(options.common,
              fmt::format(
                  "warning: the noise is told by {:.0f} degrees of freedom alone, covariances may be far off",
                  poses.degrees_of_freedom));
  }
  constexpr double kBadFit = 5.0;
  if (poses.noise_factor > kBadFit) {
    PrintNote(
        options.common,
        fmt::format(
            "warning: residuals are {:.1f} times what the edges in the images allow: map, camera or port "
            "are not what they are said to be, and covariances leave out what is wrong in all frames",
            poses.noise_factor));
  }
}

}  // namespace

ExitStatus RunPoses(const PosesOptions& options) {
  const MarkerPosesInputs inputs = ReadInputs(options);
  const TimedImages timed = ListImages(options);
  RunOutput output(options.out, "poses", options.common.force);
  std::vector<MarkerImage> images;
  {
    Progress progress("Finding markers", static_cast<int>(timed.images.size()), options.common, "images");
    const MarkerFinder finder(inputs.map, inputs.camera, inputs.port_or_null());
    for (const CameraImageFile& image : timed.images) {
      images.push_back(finder.Find(image.file));
      progress.Advance();
    }
  }
  std::vector<std::vector<MarkerObservation>> seen;
  for (const MarkerImage& image : images) seen.push_back(image.seen);
  MarkerPoses poses =
      FindMarkerPoses(seen, inputs.map, inputs.camera, inputs.port_or_null(), inputs.mount,
                      {.most_rms_px = options.max_rms_px, .refine_focal = options.refine_focal});
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (!images[i].unreadable.empty()) poses.frames[i].refused = images[i].unreadable;
  }
  const auto posed =
      std::ranges::count_if(poses.frames, [](const auto& frame) { return frame.refused.empty(); });
  if (posed == 0) {
    throw DataError("{}: none of {} images gives a pose; of the first: {}", options.images.string(),
                    images.size(), poses.frames.front().refused);
  }
  WriteOutputs(options, output, timed, images, inputs, poses);
  PrintNotes(options, timed, poses);

  const double sigma_m = Median(poses, [](const auto& f) { return SigmaPositionM(f.sonar_covariance); });
  const double sigma_deg =
      DegFromRad(Median(poses, [](const auto& f) { return SigmaAngleRad(f.sonar_covariance); }));
  if (options.common.json) {
    PrintJson({{"poses", std::filesystem::absolute(options.out / "poses.json").lexically_normal().string()},
               {"images", images.size()},
               {"frames_with_pose", posed},
               {"reprojection_rms_px", poses.rms_px},
               {"noise_factor", poses.noise_factor},
               {"median_sigma_position_m", sigma_m},
               {"median_sigma_angle_deg", sigma_deg},
               {"refraction", RefractionText(inputs)},
               {"times", timed.times}});
  } else {
    PrintResult(
        fmt::format("{}: {} of {} images have a pose; reprojection {:.3f} px rms, sigma {:.2g} mm and {:.2g} "
                    "deg (medians)\n"
                    "  {}; times: {}\n",
                    options.out.string(), posed, images.size(), poses.rms_px, 1e3 * sigma_m, sigma_deg,
                    RefractionText(inputs), timed.times));
  }
  return ExitStatus::kDone;
}

void SetupPoses(CLI::App& app) {
  auto options = std::make_shared<PosesOptions>();
  CLI::App* command =
      AddCommand(app, "poses", "Finds where the sonar was, from pictures of markers by a camera beside it");
  command->add_option("--images", options->images, "Folder of pictures: PNG, JPEG or grey TIFF")
      ->type_name("DIR")
      ->required();
  command->add_option("--camera", options->camera, "Camera calibration as OpenCV writes it, in pixels")
      ->type_name("YAML")
      ->required();
  command
      ->add_option("--markers", options->markers,
                   "Where the ArUco or AprilTag markers are, in metres (sonar-markers/1)")
      ->type_name("JSON")
      ->required();
  command
      ->add_option("--mount", options->mount,
                   "How the camera sits beside the sonar: camera_from_sonar, in metres (sonar-mount/1)")
      ->type_name("JSON")
      ->required();
  command
      ->add_option(
          "--port", options->port,
          "Flat window before a camera calibrated in air (sonar-port/1); no refraction is modelled if not "
          "given, which is right for a camera calibrated under water")
      ->type_name("JSON");
  AddOutFolder(*command, options->out, options->common, "Folder to write")->required();
  AddChoice(
      *command, "--time-unit", options->time_unit, kTimeUnits,
      "Unit of the times that the pictures' names are (default: by their digits: 10 s, 13 ms, 16 us, 19 ns)");
  command
      ->add_option("--rate", options->rate_hz,
                   "Pictures a second, in place of times by name; where neither is known, times are numbers")
      ->type_name("HZ")
      ->check(CLI::PositiveNumber.description(""));
  command
      ->add_option(
          "--max-rms", options->max_rms_px,
          "Reprojection error, pixels (rms of the corners' distances), beyond which a frame is refused")
      ->type_name("PX")
      ->capture_default_str()
      ->check(CLI::PositiveNumber.description(""));
  command->add_flag("--refine-focal", options->refine_focal,
                    "Also find one factor of both focal lengths, from all pictures together");
  command->add_flag(
      "--pictures", options->pictures,
      "Also write every picture with the outlines of its markers and, enlarged 200 times, residuals");
  OnRun(command, options->common, [options] { return RunPoses(*options); });
}

}  // namespace sonarcal
