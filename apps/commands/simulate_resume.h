// Going on with a `simulate` that was interrupted or killed: what its frames were made of, as provenance.json
// says beside them ("made_of"), and which of them are there.
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

// Of a scene as it was read, whatever files it came from.
std::string SceneDigest(const Scene& scene);

// Everything that decides the bytes of the frames and of what lies beside them: contents as digests; options
// and seed as `provenance` has them. Not the number of threads, nor any path.
nlohmann::ordered_json FramesMadeOf(const workflow::SimulatedRecording& recording,
                                    const std::string& scene_digest, const ParameterSet& parameters,
                                    const cli::Provenance& provenance);

// The frames that an earlier run of the same command left: aside, where it was killed, or in the folder
// itself, where it ended in good order.
class FinishedFrames {
 public:
  FinishedFrames() = default;  // none

  // `output` is of Aside::kFound. Throws DataError, naming what differs, where frames were made of anything
  // but `made_of`.
  FinishedFrames(const cli::RunOutput& output, const nlohmann::ordered_json& made_of);

  // Whether frames are in the folder itself, which the run goes on with.
  bool in_folder() const { return !folder_.empty(); }

  // Whether the image of a frame and all files beside it are there.
  bool Has(const std::string& image, const std::vector<std::string>& beside) const;

 private:
  std::filesystem::path aside_;   // empty for none
  std::filesystem::path folder_;  // the same
  std::set<std::string> images_in_folder_;
};

}  // namespace sonarcal::commands
