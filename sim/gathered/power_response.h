// Point spread function of a sonar as a linear map in power, from cells of echoes (sim/gathered/echo_power.h)
// to pixels: the pulse along range, the beam pattern along azimuth. It processes an image and its derivatives
// together.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "core/types/parameters.h"
#include "core/types/sonar_model.h"
#include "sim/gathered/echo_power.h"
#include "sim/physics/beam_and_pulse.h"

namespace sonarcal::sim {

// Several images, interleaved: value k of pixel (bin, beam) at ((bin * beams) + beam) * count + k.
struct ImageStack {
  int count = 0;
  std::vector<double> values;
};

// First cell of each row of echoes, rows + 1 values.
std::vector<std::size_t> RowStarts(const EchoPower& echoes);

class PowerResponse {
 public:
  // `azimuth`: weights of each beam for the columns. `pulse`: weights of a bin for the fine rows, counted
  // from the bin's own first row.
  PowerResponse(int bins, int range_steps, std::vector<ResponseWindow> azimuth, ResponseWindow pulse);

  // `cells` holds `count` values for each cell of `echoes`, cell by cell.
  ImageStack Apply(const EchoPower& echoes, std::span<const double> cells, int count) const;

  int bins() const { return bins_; }
  int beams() const { return static_cast<int>(azimuth_.size()); }
  const ResponseWindow& azimuth(int beam) const { return azimuth_[beam]; }
  // Fine rows [first, last) that contribute to a bin, and the weight of one of them.
  std::pair<int, int> RowsOfBin(int bin) const;
  double PulseWeight(int bin, int row) const {
    return pulse_.weight[row - bin * range_steps_ - pulse_.first];
  }

 private:
  int bins_;
  int range_steps_;
  std::vector<ResponseWindow> azimuth_;
  ResponseWindow pulse_;
};

// Response of a sonar to echoes in columns at these azimuths (sim/physics/beam_and_pulse.h). Throws DataError
// if the beam width is unknown.
PowerResponse MakePowerResponse(const SonarModel& sonar, const ParameterSet& parameters,
                                const std::vector<double>& column_azimuth_rad, int range_steps);

}  // namespace sonarcal::sim
