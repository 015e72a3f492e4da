// Simulates the images of a sonar in a scene from given poses.
//
//   const auto recording = Simulate(scene, ChooseSonar("p900-45"), parameters, poses);
//
// SimulateRecording is the inner part, for callers that have a simulator. `simulate` writes its result, other
// commands compare it or fit it in memory.
//
//   const SonarChoice choice = ChooseSonar("p900-45");
//   const WaterChoice water = ChooseWater(parameters, choice.water);
//   const Simulator simulator(scene, choice.sonar, rays.For(choice.sonar, water.water));
//   const auto recording = SimulateRecording(simulator, poses, parameters, "tank.gltf");
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/workflow/listener.h"
#include "apps/workflow/rays/ray_options.h"
#include "core/types/option.h"
#include "core/types/parameters.h"
#include "core/types/recording.h"
#include "core/types/scene.h"
#include "data_io/pose_io.h"
#include "sim/simulator.h"

namespace sonarcal::workflow {

struct SonarChoice {
  SonarModel sonar;
  std::optional<Water> water;                  // as the preset or the file states it
  std::optional<std::filesystem::path> input;  // the file; absent for a preset
};

// Accepts the name of a preset (sim/scenes/sonar_presets.h), a recording of any format, or a JSON file with a
// `sonar` object. Throws UsageError if it is neither a preset nor an existing file, DataError if the file is
// damaged.
SonarChoice ChooseSonar(const std::string& name_or_file);

// Water in words, such as "15 C, 0 ppt, pH 7, 1 m deep".
std::string WaterText(const Water& water);

// Opens a recording. `sonar`: replaces its description of the sonar, as in ChooseSonar; empty: as recorded.
// Throws DataError if the sonar has another number of range bins or beams.
std::unique_ptr<RecordingSource> OpenRecordingWith(const std::filesystem::path& path,
                                                   const std::string& sonar);

struct WaterChoice {
  Water water;
  std::string note;  // a sentence if the user should know of the choice; else empty
};

// The water of the parameters takes precedence over that of the sonar, with a note. Default: fresh water at
// 15 C.
WaterChoice ChooseWater(const ParameterSet& parameters, const std::optional<Water>& of_sonar);

// Returns one warning per mirror in `parameters` that has no effect: its name is no material of the scene, or
// the paper's model is used, which has no mirrors.
std::vector<std::string> MirrorCaveats(const ParameterSet& parameters,
                                       const std::vector<std::string>& material_names);

// Returns the description of a recording that `simulator` makes: synthetic, model, rays and noise.
// `scene_path` as in RecordingInfo; empty: none. `expected`: its frames are those of ExpectedFrame.
RecordingInfo SimulatedRecordingInfo(const sim::Simulator& simulator, const ParameterSet& parameters,
                                     const std::string& scene_path, bool expected = false);

// Expected image of traced echoes and of ghosts (except in the paper's model). Rounded to whole grey levels,
// as fits and comparisons evaluate it.
PolarImage ExpectedFrame(const sim::Simulator& simulator, const sim::EchoList& echoes,
                         const ParameterSet& parameters, const sim::GhostList& ghosts = {});

// For each pose, the first frame with this pose, whose speckle it has while nothing moves.
std::vector<int> SpeckleFrames(const std::vector<data_io::TimedPose>& poses);

// A recording that renders each frame when it is read, so that writing needs constant memory. Frame i has
// pose i and noise of seed + i. If the pings of the sonar are timed and a pose has a motion, each beam has
// the pose of its ping. With frozen speckle, frames of one pose have the scatterers of the first of them,
// and frames of different poses have different ones. A frame is the same each time, in any order of reading.
// With `first_frame` it is a part of a longer recording: frame i has noise of seed + first_frame + i.
class SimulatedRecording final : public RecordingSource {
 public:
  // Receives each frame after it is rendered, for outputs beside the image.
  using OnFrame = std::function<void(int index, const Pose& world_from_sonar, const PolarImage& image)>;

  // `simulator` must outlive the recording. `speckle_frames`: as SpeckleFrames returns them for these poses;
  // empty: SpeckleFrames(poses).
  SimulatedRecording(const sim::Simulator& simulator, std::vector<data_io::TimedPose> poses,
                     ParameterSet parameters, const std::string& scene_path, OnFrame on_frame = {},
                     bool expected = false, int first_frame = 0, std::vector<int> speckle_frames = {});

  const RecordingInfo& info() const override { return info_; }
  int frame_count() const override { return static_cast<int>(poses_.size()); }
  FrameInfo frame_info(int index) const override;
  Frame ReadFrame(int index) const override;

 private:
  const sim::Simulator& simulator_;
  std::vector<data_io::TimedPose> poses_;
  ParameterSet parameters_;
  RecordingInfo info_;
  OnFrame on_frame_;
  bool expected_;
  int first_frame_;
  std::vector<int> speckle_frames_;
};

// Renders all frames at once, as SimulatedRecording would. Calls `progress` after each frame.
std::unique_ptr<MemoryRecording> SimulateRecording(const sim::Simulator& simulator,
                                                   const std::vector<data_io::TimedPose>& poses,
                                                   const ParameterSet& parameters,
                                                   const std::string& scene_path,
                                                   const std::function<void(int frames_done)>& progress = {},
                                                   bool expected = false);

// Range along each ray of the fan in metres, rows x columns of rays; 0 for a ray without echo.
Grid<float> RangeAlongRays(const sim::EchoList& echoes, const sim::RayFan& fan);

struct SimulateOptions {
  std::optional<EchoModel> model = {};  // absent: as in the parameters
  RayOptions rays = {};
  int bits = 8;        // 8, 12 or 16
  bool noise = false;  // the coherent model has noise unless `expected`
  bool expected = false;
  bool frozen_speckle = false;
  int ghost_order = 1;  // 1 or 2
  std::optional<double> margin_deg = {};
  std::optional<std::uint64_t> seed = {};
  std::vector<std::string> point_target = {};  // "X:Y:Z:TS": place in the world in m, target strength in dB

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor&& visit) {
    visit(OptionInfo{.name = "model", .help = "Image model", .by_default = "that of the parameters"},
          self.model);
    RayOptions::Visit(self.rays, visit);
    visit(OptionInfo{.name = "bits", .help = "Bits of a grey value: 8, 12 or 16", .type = "BITS"}, self.bits);
    visit(OptionInfo{.name = "noise",
                     .help = "Adds noise: range and azimuth errors (paper), speckle and receiver noise "
                             "(acoustic; the coherent model always has them)"},
          self.noise);
    visit(
        OptionInfo{.name = "expected",
                   .help =
                       "Writes the expected image, which fit and reproduce evaluate: the mean over range "
                       "and azimuth errors (paper) or over speckle and receiver noise (acoustic, coherent)"},
        self.expected);
    visit(
        OptionInfo{.name = "frozen_speckle",
                   .help = "Speckle from the seed alone, the same in all frames of one pose, because nothing "
                           "moves; receiver noise differs from frame to frame (acoustic, coherent)"},
        self.frozen_speckle);
    VisitReach(self.ghost_order, self.margin_deg, visit);
    visit(OptionInfo{.name = "seed",
                     .help = "Seed of the noise; frame i uses seed + i",
                     .by_default = std::to_string(sim::SimulationOptions().seed)},
          self.seed);
    visit(
        OptionInfo{.name = "point_target",
                   .help = "Adds a target of fixed strength, such as a calibration sphere: its place in the "
                           "world in m and its target strength in dB re 1 m^2 (coherent)",
                   .by_default = "none",
                   .type = "X:Y:Z:TS"},
        self.point_target);
  }
};

// Parameters and options of the simulator for one sonar.
struct PreparedSimulation {
  ParameterSet parameters;  // with the model of the options, if they name one
  sim::SimulationOptions simulation;
  std::string water_note;  // a sentence about the choice of water, or empty
};

// Throws UsageError for options that contradict each other or have no effect.
PreparedSimulation PrepareSimulation(const SimulateOptions& options, const SonarChoice& sonar,
                                     ParameterSet parameters);

// Returns true if images of this model contain random numbers.
bool IsRandom(const SimulateOptions& options, EchoModel model);

// Sentences that a user should read before the images.
std::vector<std::string> SimulationMessages(const SimulateOptions& options, const sim::Simulator& simulator,
                                            const PreparedSimulation& prepared);

// Renders one frame per pose, with its motion as data_io::WithMotion finds it. The recording states
// `scene_path`, see RecordingInfo. Throws UsageError as PrepareSimulation, DataError without poses or if the
// scene cannot be used.
std::unique_ptr<MemoryRecording> Simulate(const Scene& scene, const SonarChoice& sonar,
                                          const ParameterSet& parameters,
                                          const std::vector<data_io::TimedPose>& poses,
                                          const SimulateOptions& options = {}, const Listener& listener = {},
                                          const std::string& scene_path = {});

}  // namespace sonarcal::workflow
