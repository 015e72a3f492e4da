// Recordings of case studies that can be explained (apps/commands/explain_command.cc) although they came
// without scene, pose or parameters: with what the plan of the case knows or assumes in place of these.
// Recordings lie in the user's folder and never in the project. What is made of them is written where the
// user says.
//
// The recording of a TargetCase has two or three frames: 0 the fitted one, 1 the held-out one, 2 the other
// view. Beam, pulse and curve are fitted to frame 0; the pose of frame 2 is fitted to frame 2 with all else
// held.
//
// The recording of a MarkedSurfaceCase has the marked pings. The scene is a strip of surface through the
// marks of each ping (apps/reproduce/marked_surface.h), the noise is that of the target-free pings. The lean
// of the strips is chosen by the likelihood of the pings used.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "apps/reproduce/case_plan.h"
#include "apps/workflow/compare.h"
#include "core/types/parameters.h"
#include "core/types/recording.h"
#include "core/types/scene.h"

namespace sonarcal::reproduce {

struct PreparedRecording {
  std::string title;                           // said wherever its pictures are shown
  std::unique_ptr<MemoryRecording> recording;  // a pose with every frame
  Scene scene;
  ParameterSet parameters;
  metrics::CompareOptions comparison = {};  // how its object is found
  std::vector<int> held_out;
  bool apart = false;       // held-out frames tell different things, so that they are judged one by one
  bool hold_noise = false;  // the floor of the parameters was found where there is nothing else
  std::vector<std::string> warnings = {};  // a search that ended at the end of its range, a sentence each
  // Assumptions and limits of the figures, one sentence each.
  std::vector<std::string> caveats;
  std::vector<std::filesystem::path> inputs;
};

struct PrepareOptions {
  int threads = 0;
  bool quick = false;  // few rays: to try the way, not for figures
  std::function<void(const std::string& line)> on_note = {};
};

// Folder of the images of the case, below `recordings`. Throws DataError if it is not there.
std::filesystem::path ImagesOf(const CasePlan& plan, const std::filesystem::path& recordings);

// `recordings` is the folder of all recordings. Throws UsageError for a case that brings all that explain
// needs, DataError if the recording is absent or damaged, or if a fit ends without a usable solution.
PreparedRecording PrepareCase(const CasePlan& plan, const std::filesystem::path& recordings,
                              const PrepareOptions& options = {});

// As PrepareCase, for the folder of the images and one kind of case. Without the caveats of the plan.
PreparedRecording PrepareTarget(const CasePlan& plan, const std::filesystem::path& images,
                                const PrepareOptions& options);
PreparedRecording PrepareMarkedSurface(const CasePlan& plan, const std::filesystem::path& images,
                                       const PrepareOptions& options);

// As a recording folder with its scene.gltf and params.json beside the frames, for every other command.
// `folder` must not be there.
void WritePrepared(const PreparedRecording& prepared, const std::filesystem::path& folder);

}  // namespace sonarcal::reproduce
