// Frames of a long recording that are fitted and evaluated. The expected information decides
// (calib/selection/frame_choice.h); no image is read.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/parameters/fit_config.h"
#include "core/types/option.h"
#include "core/types/parameters.h"
#include "core/types/scene.h"
#include "core/types/sonar_model.h"
#include "data_io/pose_io.h"
#include "sim/physics/absorption.h"

namespace sonarcal::workflow {

// Limits memory. A calibration of this many pixels peaked at 2.3 GB with all poses free, at 1.4 GB without.
inline constexpr double kMaxFittedPixels = 8e6;

// Frames of a long recording that are used. Fewer of large frames: those that are fitted together hold max
// kMaxFittedPixels.
struct FrameLimits {
  int max_frames = 24;    // fitted
  int max_held_out = 12;  // evaluated

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor&& visit) {
    visit(OptionInfo{.name = "max_frames",
                     .help = "Max number of frames fitted of a long recording",
                     .min = 1,
                     .max = 100000},
          self.max_frames);
    visit(OptionInfo{.name = "max_held_out",
                     .help = "Max number of frames held out of a long recording",
                     .min = 0,
                     .max = 100000},
          self.max_held_out);
  }
};

struct FrameChoiceOptions {
  FrameLimits limits = {};
  bool fits_held_out = false;  // a last fit takes all of these together
  bool geometry = true;        // the geometry of the sonar is fitted
  bool poses = true;           // the poses are fitted
  calib::PosePrior pose_prior = {};
  // Frames that are evaluated, whatever lies away from the fitted ones. Absent: those that do.
  std::optional<std::vector<int>> held_out = {};
};

// Scene, sonar and parameters before the fit.
struct FrameChoiceScene {
  const Scene& scene;
  const SonarModel& sonar;
  Water water = {};
  sim::AbsorptionFormula absorption = sim::AbsorptionFormula::kAuto;
  const ParameterSet& parameters;  // of any model; widths and a material for each part must be known
};

struct ChosenFrames {
  std::vector<int> used;      // in the order of the recording
  std::vector<int> held_out;  // as above
  std::string choice;         // phrase, such as "24 of 10000 frames are fitted, 12 are held out"
  std::string reason;         // phrase
};

// Returns true for a recording with so many frames that a fit chooses among them.
bool NeedsFrameChoice(int frame_count, const FrameChoiceOptions& options);

// Chooses frames. If the parameters expect no echo from any pose, it spreads them evenly and says so.
ChosenFrames ChooseFrames(const FrameChoiceScene& known, const std::vector<data_io::TimedPose>& timed_poses,
                          const FrameChoiceOptions& options = {});

}  // namespace sonarcal::workflow
