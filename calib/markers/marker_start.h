// The pose of a camera from the markers in one image, without a guess.
//
// A flat square, or a field of squares on a floor, looks nearly the same from two places (the planar
// ambiguity). Tried are: both solutions of IPPE (Collins and Bartoli 2014, as OpenCV has it) for all corners
// together where the markers lie in one plane, SQPnP where they do not, and both of each of the four largest
// markers by itself, which a single wrong marker cannot spoil. Each is refined on the measured corners
// through the whole camera, port included, with a robust loss; what comes out is listed by cost.
#pragma once

#include <vector>

#include "calib/markers/marker_corners.h"
#include "core/types/camera.h"
#include "core/types/marker_map.h"

namespace sonarcal::calib {

struct MarkerPoseCandidate {
  Pose world_from_camera;
  double cost = 0.0;  // half the sum of squared whitened residuals, large ones counting less
};

// Best first, different by more than a centimetre or half a degree. Every observation is of a marker of the
// map, once. Empty where no pose puts all markers before the camera.
std::vector<MarkerPoseCandidate> FindPoseCandidates(const std::vector<MarkerObservation>& seen,
                                                    const MarkerMap& map, const Camera& camera,
                                                    const FlatPort* port);

// The squared length of each marker's whitened residual at a pose; infinite where it is not seen.
std::vector<double> MarkerMisfits(const std::vector<MarkerObservation>& seen, const MarkerMap& map,
                                  const Camera& camera, const FlatPort* port, const Pose& world_from_camera);

}  // namespace sonarcal::calib
