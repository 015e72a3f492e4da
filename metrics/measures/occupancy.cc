#include "metrics/measures/occupancy.h"

namespace sonarcal::metrics {

Occupancy CountOccupancy(const Mask& real, const Mask& simulated) {
  SONARCAL_CHECK(real.rows() == simulated.rows() && real.cols() == simulated.cols(),
                 "real mask {} x {}, simulated mask {} x {}", real.rows(), real.cols(), simulated.rows(),
                 simulated.cols());
  Occupancy counts;
  for (std::size_t i = 0; i < real.size(); ++i) {
    const bool in_real = real.values()[i] != 0;
    const bool in_simulated = simulated.values()[i] != 0;
    counts.nr += in_real;
    counts.ns += in_simulated;
    counts.na += in_real && in_simulated;
  }
  return counts;
}

}  // namespace sonarcal::metrics
