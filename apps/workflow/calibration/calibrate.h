// Calibrates a simulator to a recording and a scene, without further knowledge: decides in stages what the
// recording shows, then fits it.
//
//   const Calibration calibration = Calibrate(*recording, scene);
//
// Stages (calibration_plan.h): frames to fit and to hold out; water; display and noise law; placement, that
// is poses, geometry of the sonar and objects that stand elsewhere; beam, pulse and looks; mirrors. A stage
// is evaluated by the likelihood of held-out frames, and what does not raise it stays as declared. Two fits
// end the calibration: one that does not see the held-out frames, for figures, and one to all frames, for
// values.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "apps/workflow/calibration/calibration_plan.h"
#include "apps/workflow/fit.h"
#include "apps/workflow/frame_choice.h"
#include "apps/workflow/listener.h"
#include "apps/workflow/materials/material_options.h"
#include "core/types/frame_list.h"
#include "core/types/option.h"

namespace sonarcal::workflow {

struct CalibrateOptions {
  std::string target = {};
  FrameList frames = {};
  FrameLimits limits = {};
  MaterialOptions materials = {};
  PingUse pings = PingUse::kUse;
  RayOptions rays = {};

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor&& visit) {
    visit(OptionInfo{.name = "target",
                     .help = "Node or material of the scene that is scored, and that may stand elsewhere",
                     .by_default = "objects that stand inside the scene may stand elsewhere",
                     .type = "NODE"},
          self.target);
    visit(
        OptionInfo{.name = "frames",
                   .help =
                       "Frames to use, counted from 0, of which every third is held out; also ranges A:B, "
                       "up to, but not including, B, A: up to the last frame, and :B; 'all' for every "
                       "frame",
                   .by_default = "all; of a recording with more than max-frames, those that are expected to "
                                 "determine the parameters best"},
        self.frames);
    FrameLimits::Visit(self.limits, visit);
    MaterialOptions::Visit(self.materials, visit);
    visit(OptionInfo{.name = "pings", .help = kPingUseHelp}, self.pings);
    RayOptions::Visit(self.rays, visit);
  }
};

struct Calibration {
  CalibrationPlan plan;           // complete
  RecordingFit evaluation;        // did not see the held-out frames; the same as `fit` if none is held out
  RecordingFit fit;               // to all frames used
  std::vector<std::string> open;  // what the recording could not determine, one sentence each
};

// Input besides recording and scene.
struct CalibrationInput {
  const RecordingSource* background = nullptr;  // pings without targets; null: none
  CalibrationPlan plan = {};                    // stages that are decided; empty: none
};

// `on_stage` gets the plan after each stage, for a run that goes on where it stopped. Each frame needs a
// rough pose. Throws DataError if the recording or the scene cannot be used, or if a fit of a stage has no
// usable solution; and calib::FitStopped if the listener stops it. The last two fits may have no usable
// solution.
Calibration Calibrate(const RecordingSource& recording, const Scene& scene,
                      const CalibrateOptions& options = {}, const CalibrationInput& input = {},
                      const Listener& listener = {},
                      const std::function<void(const CalibrationPlan&)>& on_stage = {});

// Names of the parts of a scene that may stand elsewhere: nodes, or else materials, that stand inside it, no
// wider than half of it and not flat. Largest first, at most three.
std::vector<std::string> MovableObjects(const Scene& scene);

}  // namespace sonarcal::workflow
