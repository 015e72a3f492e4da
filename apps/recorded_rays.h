// Sampling of a recording that the paper's model simulated. The paper gives each ray the same weight, so the
// two samplings have different images (docs/guide/rays.md), and a fit with the other sampling is biased.
#pragma once

#include <string>

#include "apps/ray_options.h"
#include "core/types/recording.h"

namespace sonarcal {

struct RaysForFit {
  RayOptions rays;      // as they are to be cast
  std::string note;     // what was taken from the recording; empty: nothing
  std::string warning;  // how the requested rays differ from the recording's; empty: they agree
};

// Returns the rays for a fit of `model`. The recording gives what the caller does not.
RaysForFit ChooseRays(const RayOptions& asked, const RecordingInfo& info, EchoModel model);

}  // namespace sonarcal
