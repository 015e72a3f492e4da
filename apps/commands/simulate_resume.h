// Resumes an interrupted or killed `simulate`: the data that determine its frames, as stored beside them in
// provenance.json ("made_of"), and the existing frames.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "apps/cli/provenance.h"
#include "apps/cli/run_output.h"
#include "apps/workflow/simulate.h"

namespace sonarcal::commands {

// Digest of a scene as read, independent of its files.
std::string SceneDigest(const Scene& scene);

// Returns all data that determine the bytes of the frames and of the files beside them: contents as digests;
// options and seed as in `provenance`. Excludes the number of threads and paths.
nlohmann::ordered_json FramesMadeOf(const workflow::SimulatedRecording& recording,
                                    const std::string& scene_digest, const ParameterSet& parameters,
                                    const cli::Provenance& provenance);

// Frames that an earlier run of the same command left: in the staging folder if it was killed, in the folder
// itself if it was interrupted.
class FinishedFrames {
 public:
  FinishedFrames() = default;  // none

  // `output` has Aside::kFound. Throws DataError with the differences if frames were made of anything other
  // than `made_of`.
  FinishedFrames(const cli::RunOutput& output, const nlohmann::ordered_json& made_of);

  // Returns true if frames are in the folder itself, which the run continues.
  bool in_folder() const { return !folder_.empty(); }

  // Returns true if the image of a frame and all files beside it exist.
  bool Has(const std::string& image, const std::vector<std::string>& beside) const;

 private:
  std::filesystem::path aside_;   // empty: none
  std::filesystem::path folder_;  // empty: none
  std::set<std::string> images_in_folder_;
};

}  // namespace sonarcal::commands
