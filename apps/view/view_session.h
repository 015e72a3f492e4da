// Contents of `sonarcal view`: a scene, a sonar, poses, and optionally a recording. Images equal those of
// `sonarcal simulate --expected`, or with noise those of `sonarcal simulate --noise`. Figures equal those of
// `sonarcal compare --as-displayed` of these images.
//
// A scene is built once. Rays are cast and shaded in one pass, which is faster than shading stored echoes.
// The expected image of the paper's model has no such pass: its echoes are traced if pose, sonar or rays
// change, and only shaded again if parameters change.
//
// All functions are thread-safe.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "apps/view/view_state.h"
#include "apps/workflow/compare.h"
#include "apps/workflow/materials/material_options.h"
#include "apps/workflow/rays/ray_options.h"
#include "apps/workflow/scene_geometry.h"
#include "core/types/recording.h"
#include "data_io/pose_io.h"
#include "sim/simulator.h"

namespace sonarcal::view {

struct ViewSetup {
  Scene scene;
  std::string scene_path;
  std::string scene_words;     // such as " --scene-unit mm", if the scene needs it
  std::string sonar_argument;  // from the command line; by default the recording
  SonarModel sonar;
  Water water;
  ParameterSet parameters;
  std::vector<data_io::TimedPose> poses;  // one per frame
  bool poses_given = true;                // false: a default pose of the program
  workflow::RayOptions rays;
  std::optional<double> margin_deg;
  int ghost_order = 1;
  std::shared_ptr<const RecordingSource> real;  // thread-safe; as many frames as poses; null: none
  metrics::CompareOptions compare;
  workflow::MaterialOptions materials = {};        // priors of a fit
  std::vector<std::filesystem::path> inputs = {};  // files that were read
};

struct ViewImage {
  PolarImage image;
  bool traced = false;   // rays were cast for this image
  double trace_s = 0.0;  // includes shading where both are one pass; 0 if only shading was done
  double shade_s = 0.0;
};

struct ViewComparison {
  metrics::FrameMetrics metrics;  // with masks
  // Mean log-likelihood of a recorded pixel, nats, by which fits of the acoustic model are judged on held-out
  // frames. Absent for the paper's model, for a recording that does not have the sonar's pixels or grey
  // levels, and without noise.
  std::optional<double> nats_per_pixel;
  std::vector<std::string> notes;
};

class ViewSession {
 public:
  // Throws DataError if the scene cannot be used.
  explicit ViewSession(ViewSetup setup);
  ~ViewSession();
  ViewSession(const ViewSession&) = delete;
  ViewSession& operator=(const ViewSession&) = delete;

  const ViewSetup& setup() const { return setup_; }
  const Scene& scene() const { return caster_->scene(); }
  int frame_count() const { return static_cast<int>(setup_.poses.size()); }
  int bits() const { return bits_; }
  std::int64_t rays_cast() const { return caster_->rays_cast(); }

  // Returns the image of a state; nullopt if the same client has sent a newer request meanwhile. Throws
  // DataError or UsageError if it cannot be made.
  std::optional<ViewImage> Render(const ViewState& state);

  // Returns a frame of the recording. There must be a recording.
  Frame Recorded(int frame) const;

  // Compares the image of a state with the recorded frame. There must be a recording.
  ViewComparison Compare(const ViewState& state);

  // Poses of all frames, with those that the state changes.
  std::vector<data_io::TimedPose> Poses(const ViewState& state) const;

  // Returns the recording with these poses. A frame without a known pose has none. There must be a recording.
  std::shared_ptr<const RecordingSource> RecordingOf(const ViewState& state) const;

 private:
  struct Traced;
  std::shared_ptr<const sim::Simulator> SimulatorFor(const ViewState& state);
  const sim::EchoList& EchoesFor(const sim::Simulator& simulator, const Pose& pose, ViewImage& image);
  bool IsOvertaken(const ViewState& state);
  ViewImage RenderNow(const ViewState& state);

  ViewSetup setup_;
  int bits_ = 8;
  std::shared_ptr<const sim::RayCaster> caster_;
  std::optional<workflow::SceneGeometry> geometry_;  // with an object to search

  std::mutex newest_mutex_;
  std::map<std::string, std::int64_t> newest_;  // sequence number per client

  std::mutex render_mutex_;  // guards the members below
  std::string simulator_key_;
  std::shared_ptr<const sim::Simulator> simulator_;
  std::unique_ptr<Traced> traced_;
  std::optional<ViewState> last_state_;  // latest state; last_ is its image, for the comparison that follows
  ViewImage last_;
};

}  // namespace sonarcal::view
