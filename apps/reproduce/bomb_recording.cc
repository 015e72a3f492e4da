#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "apps/reproduce/bomb_comparison.h"
#include "apps/reproduce/known_recording.h"
#include "calib/bomb_fit.h"
#include "calib/models/held_out_frames.h"
#include "core/types/error.h"
#include "data_io/sonars/aris3000_frames_io.h"
#include "sim/physics/display.h"
#include "sim/scenes/bomb.h"

namespace sonarcal::reproduce {
namespace {

constexpr const char* kOtherPose = "other_pose_fan.png";

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

calib::TargetFit FitBomb(const RecordingInfo& info, const PolarImage& image, const calib::TargetPose& pose,
                         const ParameterSet& initial, calib::TargetFitOptions fit,
                         const PrepareOptions& options) {
  fit.threads = options.threads;
  if (options.quick) {
    fit.ray_height_deg = 0.2;
    fit.fit.max_iterations = 15;
  }
  calib::TargetFit result =
      calib::FitTarget(sim::MakeBomb(), info.sonar, info.water.value_or(Water{}), image, pose, initial, fit);
  if (!result.fit.usable) {
    throw DataError("{}: the fit of the bomb ended without a usable solution ({})", info.source,
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

PreparedRecording PrepareBombRecording(const std::filesystem::path& folder, const PrepareOptions& options) {
  const auto say = [&](const std::string& line) {
    if (options.on_note) options.on_note(line);
  };
  const auto recorded = data_io::OpenAris3000Frames(folder);
  if (recorded->frame_count() < 2) {
    throw DataError("{}: {} frame, expected two of the bomb", folder.string(), recorded->frame_count());
  }
  calib::CheckHeldOut(*recorded, {.used = {0}, .held_out = {1}});
  const auto other = data_io::OpenAris3000FanPicture(folder / kOtherPose, calib::BombOtherPoseFan());
  RecordingInfo info = recorded->info();
  std::vector<Frame> frames = {recorded->ReadFrame(0), recorded->ReadFrame(1), other->ReadFrame(0)};

  say("fitting beam, pulse and curve to frame 0 of the bomb");
  const DisplayParameters<double> display = DisplayOfBackground(frames[0].image, {});
  const calib::TargetFit model =
      FitBomb(info, frames[0].image, calib::BombPose(), calib::BombInitial(display, info.sonar),
              calib::BombFitOptions(), options);
  frames[2].image =
      Reshown(frames[2].image, DisplayOfBackground(frames[2].image, {}), display, frames[0].image.scale);
  say("finding the other pose, the model held");
  calib::TargetFitOptions of_pose = calib::BombFitOptions();
  of_pose.free_model = false;
  of_pose.free_pose = true;
  const calib::TargetFit pose =
      FitBomb(info, frames[2].image, calib::BombOtherPose(), model.fit.parameters, of_pose, options);

  frames[0].info.world_from_sonar = calib::BombPose().WorldFromSonar();
  frames[1].info.world_from_sonar = frames[0].info.world_from_sonar;
  frames[2].info.world_from_sonar = InTargetFrame(pose.fit.world_from_sonar[0], calib::BombOtherPose());
  info.notes.emplace_back("Frame 2 is other_pose_fan.png, its powers shown by the display of frame 0.");
  info.notes.emplace_back("Poses were found by fits to the frames themselves; none is recorded.");
  PreparedRecording prepared{
      .title = "a bomb, ARIS 3000 (recorded)",
      .recording = std::make_unique<MemoryRecording>(info, std::move(frames)),
      .scene = sim::MakeBomb(),
      .parameters = model.fit.parameters,
      .held_out = {1, 2},
      .apart = true,
      .caveats =
          {"Frame 1 shows the still scene of frame 0, which is fitted, with the same speckle: it tests "
           "receiver noise only, and a model that had learnt frame 0's speckle would look good on it.",
           "Frame 2, the same object from another pose, is independent of frame 0. It is the one to read.",
           "Outline and poses of frames 0 and 1 were fitted to frame 0 beforehand; the pose of frame 2, five "
           "numbers that matter, to frame 2 itself, with outline and model held. What a frame gains by its "
           "own pose is in all steps alike.",
           "Beam, pulse and elevation pattern are those of a fit to frame 0. They stand in part for an "
           "outline that is not quite right, and are no measurement of the sonar.",
           fmt::format("Full scale is {:.0f} counts of 80/255 dB, to which the frames are stretched. Frame 2 "
                       "had 80 dB of its own; it is shown here on the display of frame 0, its powers counted "
                       "from its own noise.",
                       info.scale.db_span.value_or(0.0) * 255.0 / 80.0)},
      .inputs = {folder}};
  return prepared;
}

}  // namespace sonarcal::reproduce
