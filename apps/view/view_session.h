// What `sonarcal view` shows: a scene, a sonar, poses, and a recording beside them where there is one. Images
// are those of `sonarcal simulate --expected`, or with noise those of `sonarcal simulate --noise`: of the
// paper's model to the bit, of the acoustic one within a grey level. Figures are those of `sonarcal compare
// --as-displayed` of these images.
//
// A scene is built once. Echoes are traced when pose, sonar or rays change, and shaded again when only
// parameters do; the paper's model casts and shades in one pass (sim/paper/paper_frame.h), which takes less
// time than shading stored echoes would. `simulate` does so for the acoustic model, too
// (sim/acoustic/acoustic_frame.h), in single precision: a value next to the edge of a grey level may round to
// the other side.
//
// Any thread may call any function.
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
#include "apps/workflow/ray_options.h"
#include "apps/workflow/scene_geometry.h"
#include "core/types/recording.h"
#include "data_io/pose_io.h"
#include "sim/simulator.h"

namespace sonarcal::view {

struct ViewSetup {
  Scene scene;
  std::string scene_path;
  std::string scene_words;     // " --scene-unit mm", where the scene needs such
  std::string sonar_argument;  // of the command line; the recording where that was silent
  SonarModel sonar;
  Water water;
  ParameterSet parameters;
  std::vector<data_io::TimedPose> poses;  // one a frame
  bool poses_given = true;                // false: one that the program chose
  workflow::RayOptions rays;
  std::optional<double> margin_deg;
  int ghost_order = 1;
  std::shared_ptr<const RecordingSource> real;  // read by any thread; as many frames as poses; null for none
  metrics::CompareOptions compare;
};

struct ViewImage {
  PolarImage image;
  bool traced = false;   // rays were cast for it
  double trace_s = 0.0;  // paper's model: with shading, 0 where only that was done
  double shade_s = 0.0;
};

struct ViewComparison {
  metrics::FrameMetrics metrics;  // with masks
  std::vector<std::string> notes;
};

class ViewSession {
 public:
  // Throws DataError where the scene cannot be used.
  explicit ViewSession(ViewSetup setup);
  ~ViewSession();

  const ViewSetup& setup() const { return setup_; }
  const Scene& scene() const { return caster_->scene(); }
  int frame_count() const { return static_cast<int>(setup_.poses.size()); }
  int bits() const { return bits_; }
  std::int64_t rays_cast() const { return caster_->rays_cast(); }

  // The image that the state asks for; nothing where the same client has asked for a newer one meanwhile.
  // Throws DataError or UsageError where there can be none.
  std::optional<ViewImage> Render(const ViewState& state);

  // Frame of the recording. There must be one.
  Frame Recorded(int frame) const;

  // The state's image against the recorded frame. There must be a recording.
  ViewComparison Compare(const ViewState& state);

  // Poses of all frames, some moved by the state.
  std::vector<data_io::TimedPose> Poses(const ViewState& state) const;

  // The recording with these poses; a frame of which nobody said where it was taken has none. There must be a
  // recording.
  std::shared_ptr<const RecordingSource> RecordingOf(const ViewState& state) const;

 private:
  struct Traced;
  std::shared_ptr<const sim::Simulator> SimulatorFor(const ViewState& state);
  const Traced& TraceFor(const sim::Simulator& simulator, const ViewState& state, const Pose& pose,
                         ViewImage& image);
  bool IsOvertaken(const ViewState& state);
  ViewImage RenderNow(const ViewState& state);

  ViewSetup setup_;
  int bits_ = 8;
  std::shared_ptr<const sim::RayCaster> caster_;
  std::optional<workflow::SceneGeometry> geometry_;  // with an object to search

  std::mutex newest_mutex_;
  std::map<std::string, std::int64_t> newest_;  // sequence, by client

  std::mutex render_mutex_;  // guards what follows
  std::string simulator_key_;
  std::shared_ptr<const sim::Simulator> simulator_;
  std::unique_ptr<Traced> traced_;
  std::optional<ViewState> last_state_;  // and its image, for the comparison that follows
  ViewImage last_;
};

}  // namespace sonarcal::view
