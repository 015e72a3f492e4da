#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "apps/reproduce/prepared_recording.h"
#include "apps/reproduce/target_comparison.h"
#include "apps/workflow/locate.h"
#include "core/types/error.h"
#include "data_io/pictures/picture_frames.h"
#include "data_io/pictures/picture_geometry.h"
#include "sim/physics/display.h"

namespace sonarcal::reproduce {
namespace {

// An image's powers above its own background's noise, as another display shows them: whole grey levels of
// that display's scale.
PolarImage Reshown(const PolarImage& image, const DisplayParameters<double>& own,
                   const DisplayParameters<double>& shown, const ImageScale& scale) {
  PolarImage result = image;
  result.scale = scale;
  for (float& value : result.value.values()) {
    const double power = sim::PowerFromDisplay(own, value / image.scale.full_scale);
    value = static_cast<float>(
        std::lround(std::clamp(sim::DisplayValue(shown, power), 0.0, 1.0) * scale.full_scale));
  }
  return result;
}

// The picture of the other view, resampled to the beams and range bins of the recording.
Frame ReadOtherView(const TargetCase::OtherView& other, const RecordingInfo& info,
                    const std::filesystem::path& images) {
  const std::filesystem::path file = images / other.picture;
  Frame frame;
  frame.info.name = file.filename().string();
  frame.info.settings = info.settings;
  frame.image.axes = info.sonar.axes;
  frame.image.scale.db_span = other.db_span;  // full scale: 255, that of a picture
  frame.image.value =
      data_io::SampleFan(data_io::OpenPictures(file)->Read(0), other.fan, info.sonar.axes, file.string());
  return frame;
}

calib::TargetFit Fit(const TargetCase& target, const RecordingInfo& info, const PolarImage& image,
                     const calib::TargetPose& pose, const ParameterSet& initial, calib::TargetFitOptions fit,
                     const PrepareOptions& options) {
  fit.threads = options.threads;
  if (options.quick) {
    fit.ray_height_deg = 0.2;
    fit.fit.max_iterations = 15;
  }
  calib::TargetFit result =
      calib::FitTarget(target.scene, info.sonar, info.water.value_or(Water{}), image, pose, initial, fit);
  if (!result.fit.usable) {
    throw DataError("{}: the fit of the target ended without a usable solution ({})", info.source,
                    result.fit.report.termination);
  }
  return result;
}

// The sonar's pose in the target's own frame, from that in the world of a fit to `near`.
Pose InTargetFrame(const Pose& world_from_sonar, const calib::TargetPose& near) {
  const Pose target_from_world = Pose{near.SonarFromTarget().rotation, Eigen::Vector3d::Zero()}.Inverse();
  return target_from_world * world_from_sonar;
}

}  // namespace

PreparedRecording PrepareTarget(const CasePlan& plan, const std::filesystem::path& images,
                                const PrepareOptions& options) {
  const auto say = [&](const std::string& line) {
    if (options.on_note) options.on_note(line);
  };
  const TargetCase& target = TargetOf(plan);
  const auto recorded = OpenTarget(plan, images);
  RecordingInfo info = InfoOf(target, *recorded);
  std::vector<Frame> frames = {recorded->ReadFrame(target.fitted_frame),
                               recorded->ReadFrame(target.held_out_frame)};
  if (target.other) frames.push_back(ReadOtherView(*target.other, info, images));

  say("fitting beam, pulse and curve to the target in frame 0");
  const ParameterSet start = TargetStart(target, frames[0].image);
  const calib::TargetFit model = Fit(target, info, frames[0].image, target.pose, start, target.fit, options);
  frames[0].info.world_from_sonar = target.pose.WorldFromSonar();
  frames[1].info.world_from_sonar = frames[0].info.world_from_sonar;
  std::vector<int> held_out = {1};
  if (target.other) {
    frames[2].image =
        Reshown(frames[2].image, workflow::DisplayOfBackground(frames[2].image, target.segmentation),
                start.display, frames[0].image.scale);
    say("finding the other pose, the model held");
    calib::TargetFitOptions pose_only = target.fit;
    pose_only.free_model = false;
    pose_only.free_pose = true;
    const calib::TargetFit pose =
        Fit(target, info, frames[2].image, target.other->start, model.fit.parameters, pose_only, options);
    frames[2].info.world_from_sonar = InTargetFrame(pose.fit.world_from_sonar[0], target.other->start);
    info.notes.push_back(
        fmt::format("Frame 2 is {}, its powers shown by the display of frame 0.", target.other->picture));
    held_out.push_back(2);
  }
  info.notes.emplace_back("Poses were found by fits to the frames themselves; none is recorded.");
  return {.title = plan.title,
          .recording = std::make_unique<MemoryRecording>(info, std::move(frames)),
          .scene = target.scene,
          .parameters = model.fit.parameters,
          .held_out = std::move(held_out),
          .apart = true,
          .caveats = {},
          .inputs = {images, plan.folder}};
}

}  // namespace sonarcal::reproduce
