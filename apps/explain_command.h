// `sonarcal explain`: what each part of the acoustic model is worth for a recording, and what its bright
// cells come from (apps/explain_recording.h).
//
// Written: explain.json ("format": "sonar-explanation/1": "steps", each with its figures on the frames held
// out, "gain_nats_per_pixel", "aic_change", "bic_change" and "verdict"; "causes" with "names", and by frame
// the shares of its bright cells); causes_0006.png, an index into the names for each pixel of frame 6, range
// bins by beams; lobes_0006.png, 16 bits: where the cause is a side lobe in azimuth, the beam whose direction
// it comes from, counted from 1, else 0; causes_0006_picture.png, the map with its legend; params.json of the
// last step; report.html. Each step has its figures by frame, too ("by_frame"). With --known also recording/:
// the recording with its poses, scene.gltf and params.json, as any other command takes them.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "apps/command.h"
#include "apps/comparison_options.h"
#include "apps/ray_options.h"
#include "apps/reproduce/known_recording.h"
#include "apps/scene_option.h"

namespace sonarcal {

struct ExplainCommandOptions {
  CommonOptions common;
  std::optional<KnownRecording> known;  // in place of real, scene and params
  std::filesystem::path recordings;     // where it is; empty: DefaultRecordingsFolder()
  std::filesystem::path real;
  std::filesystem::path scene;
  SceneFormat scene_format;
  std::filesystem::path params;
  std::filesystem::path out;
  std::vector<int> held_out;  // empty: the last third
  bool apart = false;         // held-out frames judge one by one
  bool hold_noise = false;    // take the noise floor as given
  bool poses = false;         // refine every frame's pose as the last step
  int max_iterations = 60;
  RayOptions rays{Sampling::kBeams};
  ComparisonOptions comparison;
};

ExitStatus RunExplain(const ExplainCommandOptions& options);

}  // namespace sonarcal
