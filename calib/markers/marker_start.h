// Pose of a camera from the markers in one image, without a guess.
//
// A flat square, or a field of squares on a floor, looks nearly the same from two places (the planar
// ambiguity). Guesses come from all corners together: both solutions of IPPE (Collins and Bartoli 2014, in
// OpenCV) if the markers lie in one plane, otherwise SQPnP. They also come from both solutions of each of the
// four largest markers alone, which a single wrong marker cannot spoil. Each guess is refined on the measured
// corners through the complete camera, including the port, with a robust loss. The results are sorted by
// cost.
#pragma once

#include <vector>

#include "calib/markers/marker_corners.h"
#include "core/types/camera.h"
#include "core/types/marker_map.h"

namespace sonarcal::calib {

struct MarkerPoseCandidate {
  Pose world_from_camera;
  double cost = 0.0;  // half the sum of squared whitened residuals, with reduced weight of large ones
};

// Returns candidates, best first, that differ by more than 1 cm or 0.5 degrees. Each observation is of a
// marker of the map, once. Empty if no pose puts all markers in front of the camera.
std::vector<MarkerPoseCandidate> FindPoseCandidates(const std::vector<MarkerObservation>& seen,
                                                    const MarkerMap& map, const Camera& camera,
                                                    const FlatPort* port);

// Returns the squared length of each marker's whitened residual at a pose; infinite if it is not visible.
std::vector<double> MarkerMisfits(const std::vector<MarkerObservation>& seen, const MarkerMap& map,
                                  const Camera& camera, const FlatPort* port, const Pose& world_from_camera);

}  // namespace sonarcal::calib
