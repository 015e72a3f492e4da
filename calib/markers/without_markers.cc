// Takes the place of marker_detector.cc and marker_start.cc in a build without SONARCAL_WITH_MARKERS.
#include "calib/markers/marker_detector.h"
#include "calib/markers/marker_start.h"
#include "core/types/error.h"

namespace sonarcal::calib {
namespace {

[[noreturn]] void Refuse() {
  throw UsageError("this sonarcal was built without poses from markers (SONARCAL_WITH_MARKERS)");
}

}  // namespace

MarkerDetector::MarkerDetector(const std::string&) : opencv_code_(0) {
  Refuse();
}

MarkersSeen MarkerDetector::Detect(const Grid<std::uint8_t>&) const {
  Refuse();
}

std::vector<MarkerPoseCandidate> FindPoseCandidates(const std::vector<MarkerObservation>&, const MarkerMap&,
                                                    const Camera&, const FlatPort*) {
  Refuse();
}

std::vector<double> MarkerMisfits(const std::vector<MarkerObservation>&, const MarkerMap&, const Camera&,
                                  const FlatPort*, const Pose&) {
  Refuse();
}

}  // namespace sonarcal::calib
