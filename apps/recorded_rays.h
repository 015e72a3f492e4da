// How a recording that the paper's model simulated was sampled. The paper counts each ray alike, so the two
// samplings have different images (docs/rays.md), and a fit by the other sampling is biased.
#pragma once

#include <string>

#include "apps/ray_options.h"
#include "core/types/recording.h"

namespace sonarcal {

struct RaysForFit {
  RayOptions rays;      // as they are to be cast
  std::string note;     // what was taken from the recording; empty: nothing
  std::string warning;  // in what the rays asked for contradict the recording's; empty: in nothing
};

// Returns the rays for a fit of `model`. What the caller leaves open is taken from the recording.
RaysForFit ChooseRays(const RayOptions& asked, const RecordingInfo& info, EchoModel model);

}  // namespace sonarcal
