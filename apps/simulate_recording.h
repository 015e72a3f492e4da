// A simulation as a recording: what `simulate` writes, and what other commands compare or fit in memory.
//
//   const SonarChoice choice = ChooseSonar("p900-45");
//   const WaterChoice water = ChooseWater(parameters, choice.water);
//   const Simulator simulator(scene, choice.sonar, rays.For(choice.sonar, water.water));
//   const auto recording = SimulateRecording(simulator, poses, parameters, "tank.gltf");
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/types/recording.h"
#include "data_io/pose_io.h"
#include "sim/simulator.h"

namespace sonarcal {

struct SonarChoice {
  SonarModel sonar;
  std::optional<Water> water;                  // that the preset or file gives
  std::optional<std::filesystem::path> input;  // the file, where it is one
};

// A preset's name (sim/scenes/sonar_presets.h), a recording of any format, or a JSON file with a `sonar`
// object. Throws UsageError where it is neither a name nor there, DataError where the file is damaged.
SonarChoice ChooseSonar(const std::string& name_or_file);

struct WaterChoice {
  Water water;
  std::string note;  // a sentence where the choice needs saying; else empty
};

// The parameters' water wins over the sonar's, and that is said; where neither gives one, fresh water at 15
// C.
WaterChoice ChooseWater(const ParameterSet& parameters, const std::optional<Water>& of_sonar);

// What should not be missed of the parameters' mirrors, a sentence each: those that are no material of the
// scene, or that the paper's model has none.
std::vector<std::string> MirrorCaveats(const ParameterSet& parameters,
                                       const std::vector<std::string>& material_names);

// What a recording says of itself that `simulator` makes: synthetic, by which model, rays and noise.
// `scene_path` as in RecordingInfo; empty for none. `expected`: its frames are those of ExpectedFrame.
RecordingInfo SimulatedRecordingInfo(const Simulator& simulator, const ParameterSet& parameters,
                                     const std::string& scene_path, bool expected = false);

// The expected image of echoes that were traced before, and of ghosts (not of the paper's model), in whole
// grey levels, as fits and comparisons score it.
PolarImage ExpectedFrame(const Simulator& simulator, const EchoList& echoes, const ParameterSet& parameters,
                         const GhostList& ghosts);

// Frames that are rendered when they are read, so that a recording of any length is written in constant
// memory. Frame i is of pose i, its noise of seed + i: the same frame each time, in any order.
class SimulatedRecording final : public RecordingSource {
 public:
  // Told of each frame as it is made: for outputs beside the image.
  using OnFrame = std::function<void(int index, const Pose& world_from_sonar, const PolarImage& image)>;

  // `simulator` must outlive the recording.
  SimulatedRecording(const Simulator& simulator, std::vector<TimedPose> poses, ParameterSet parameters,
                     const std::string& scene_path, OnFrame on_frame = {}, bool expected = false);

  const RecordingInfo& info() const override { return info_; }
  int frame_count() const override { return static_cast<int>(poses_.size()); }
  FrameInfo frame_info(int index) const override;
  Frame ReadFrame(int index) const override;

 private:
  const Simulator& simulator_;
  std::vector<TimedPose> poses_;
  ParameterSet parameters_;
  RecordingInfo info_;
  OnFrame on_frame_;
  bool expected_;
};

// The same, all of it made at once. `progress` is told after each frame.
std::unique_ptr<MemoryRecording> SimulateRecording(const Simulator& simulator,
                                                   const std::vector<TimedPose>& poses,
                                                   const ParameterSet& parameters,
                                                   const std::string& scene_path,
                                                   const std::function<void(int frames_done)>& progress = {},
                                                   bool expected = false);

// Range along each ray of the fan in metres, rows x columns of rays; 0 where a ray gives no echo.
Grid<float> RangeAlongRays(const EchoList& echoes, const RayFan& fan);

}  // namespace sonarcal
