// The paper's model a second time, slowly and from the printed equations, to hold sim/ against. Shares no
// formula with it.
#pragma once

#include <cmath>
#include <vector>

#include "data_io/types/units.h"
#include "sim/physics/paper_echo.h"
#include "sim/trace.h"

namespace sonarcal::testing {

inline SonarModel MakeSonar(std::vector<double> azimuth_deg, double elevation_width_deg, double range_min_m,
                            double range_max_m, int range_bins) {
  SonarModel sonar{.name = "test sonar",
                   .frequency_hz = 1.2e6,
                   .axes = {range_min_m, range_max_m, range_bins, {}},
                   .azimuth_beam_width_deg = 1.0,
                   .elevation_beam_width_deg = elevation_width_deg,
                   .sound_speed_m_per_s = 1466.0};
  for (const double azimuth : azimuth_deg) sonar.axes.beam_azimuth_rad.push_back(RadFromDeg(azimuth));
  return sonar;
}

inline std::vector<double> EvenAzimuthsDeg(int beams, double spacing_deg) {
  std::vector<double> azimuth_deg;
  for (int beam = 0; beam < beams; ++beam) azimuth_deg.push_back((beam - 0.5 * (beams - 1)) * spacing_deg);
  return azimuth_deg;
}

// Eqs. 11 to 21.
inline double SlowNormalisedEcho(const PaperParameters<double>& p, int material, double range_m,
                                 double incidence_rad, double alpha_db_per_m) {
  const GsabParameters<double>& g = p.materials[material];
  const double delta = incidence_rad * 180.0 / kPi;
  const double gsab = g.a * std::exp(-delta * delta / (2.0 * g.b_deg * g.b_deg)) +
                      g.c * std::pow(std::cos(incidence_rad), g.d) +
                      g.e * std::exp(-delta * delta / (2.0 * g.f_deg * g.f_deg));
  const double loss_db = 20.0 * std::log10(range_m) + alpha_db_per_m * range_m;
  const double snr_db =
      p.source_level_db - 2.0 * loss_db + 10.0 * std::log10(gsab) - p.noise_level_db + p.array_gain_db;
  return (snr_db - p.display.db_min) / (p.display.db_max - p.display.db_min);
}

// Eqs. 27 and 28.
inline double SlowJitterGrowth(const JitterParameters<double>& j, double range_m, double frequency_hz) {
  const double square = range_m * range_m / (j.reference_range_m * j.reference_range_m);
  const double growth = j.growth == JitterGrowth::kRoot ? std::sqrt(1.0 + square) : 1.0 + square;
  return growth * std::sqrt(j.reference_frequency_hz / frequency_hz);
}

// Probability of each interval between `edges` for a normal variable; a sharp one where sigma is 0.
inline std::vector<double> IntervalProbabilities(const std::vector<double>& edges, double mean,
                                                 double sigma) {
  std::vector<double> below;
  for (const double edge : edges) {
    below.push_back(sigma > 0.0 ? 0.5 * std::erfc((mean - edge) / sigma / std::sqrt(2.0))
                                : (mean < edge ? 1.0 : 0.0));
  }
  std::vector<double> within;
  for (std::size_t i = 1; i < edges.size(); ++i) within.push_back(below[i] - below[i - 1]);
  return within;
}

struct SlowImage {
  Grid<double> mean;      // of full scale, not clamped
  Grid<double> variance;  // of one noisy image
  Grid<double> rays;      // expected number in each pixel
};

// Mean and variance of the noisy image over all seeds, ray by ray.
inline SlowImage SlowExpectation(const EchoList& echoes, const SonarModel& sonar,
                                 const PaperParameters<double>& p, double alpha_db_per_m) {
  const int bins = sonar.axes.range_bins;
  const int beams = sonar.axes.beam_count();
  std::vector<double> range_edges;
  for (int bin = 0; bin <= bins; ++bin) {
    range_edges.push_back(sonar.axes.range_min_m + bin * sonar.axes.range_bin_m());
  }
  const std::vector<double> beam_edges = sonar.axes.BeamEdgesRad();
  SlowImage image{Grid<double>(bins, beams), Grid<double>(bins, beams), Grid<double>(bins, beams)};
  for (std::size_t echo = 0; echo < echoes.size(); ++echo) {
    const double range_m = echoes.range_m[echo];
    const double growth = SlowJitterGrowth(p.jitter, range_m, sonar.frequency_hz);
    const double value =
        SlowNormalisedEcho(p, echoes.material[echo], range_m, echoes.incidence_rad[echo], alpha_db_per_m) /
        echoes.rays_per_beam[echoes.beam_of_column[echoes.ray[echo] % echoes.cols]];
    const auto in_bin = IntervalProbabilities(range_edges, range_m, p.jitter.sigma_range_m * growth);
    const auto in_beam = IntervalProbabilities(beam_edges, echoes.azimuth_rad[echo],
                                               p.jitter.sigma_azimuth_deg * kPi / 180.0 * growth);
    for (int bin = 0; bin < bins; ++bin) {
      if (in_bin[bin] == 0.0) continue;
      for (int beam = 0; beam < beams; ++beam) {
        const double probability = in_bin[bin] * in_beam[beam];
        image.mean(bin, beam) += value * probability;
        image.variance(bin, beam) += value * value * probability * (1.0 - probability);
        image.rays(bin, beam) += probability;
      }
    }
  }
  return image;
}

}  // namespace sonarcal::testing
