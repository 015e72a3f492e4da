// Properties of a frame that the expected image needs besides its echoes.
#pragma once

#include <cmath>
#include <vector>

#include "core/types/sonar_model.h"

namespace sonarcal::sim {

struct ImageGeometry {
  ImageGeometry(const SonarModel& sonar, double absorption_db_per_m_)
      : axes(sonar.axes),
        beam_edges_rad(sonar.axes.BeamEdgesRad()),
        frequency_hz(sonar.frequency_hz),
        absorption_db_per_m(absorption_db_per_m_) {
    const double width = beam_edges_rad[1] - beam_edges_rad[0];
    for (std::size_t i = 1; i < beam_edges_rad.size(); ++i) {
      beams_are_even =
          beams_are_even && std::abs(beam_edges_rad[i] - beam_edges_rad[i - 1] - width) < 1e-6 * width;
    }
  }

  PolarAxes axes;
  std::vector<double> beam_edges_rad;
  double frequency_hz;
  double absorption_db_per_m;
  bool beams_are_even = true;  // one blur kernel serves every beam of a row
};

}  // namespace sonarcal::sim
