// The paper's model a second time, slowly and from the printed equations, to hold sim/ against. Shares no
// formula with it.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/types/units.h"
#include "sim/physics/paper_echo.h"
#include "sim/rays/trace.h"

namespace sonarcal::testing {

inline SonarModel MakeSonar(const std::vector<double>& azimuth_deg, double elevation_width_deg,
                            double range_min_m, double range_max_m, int range_bins) {
  SonarModel sonar{.name = "test sonar",
                   .frequency_hz = 1.2e6,
                   .axes = {range_min_m, range_max_m, range_bins, {}},
                   .azimuth_beam_width_deg = 1.0,
                   .elevation_beam_width_deg = elevation_width_deg,
                   .sound_speed_m_per_s = 1466.0};
  sonar.axes.beam_azimuth_rad.reserve(azimuth_deg.size());
  for (const double azimuth : azimuth_deg) sonar.axes.beam_azimuth_rad.push_back(RadFromDeg(azimuth));
  return sonar;
}

inline std::vector<double> EvenAzimuthsDeg(int beams, double spacing_deg) {
  std::vector<double> azimuth_deg;
  azimuth_deg.reserve(beams);
  for (int beam = 0; beam < beams; ++beam) azimuth_deg.push_back((beam - 0.5 * (beams - 1)) * spacing_deg);
  return azimuth_deg;
}

// Eqs. 11 to 21.
inline double SlowNormalisedEcho(const sim::PaperParameters<double>& p, int material, double range_m,
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

// Probability of each interval between `edges` for a normal variable; a sharp one where sigma is 0. `first`
// counts the intervals left out before those of the answer, as others are behind: what lies more than 8
// standard deviations away has less than 1e-15.
struct Intervals {
  int first = 0;
  std::vector<double> probability;
};

inline Intervals IntervalProbabilities(const std::vector<double>& edges, double mean, double sigma) {
  const auto begin = std::upper_bound(edges.begin(), edges.end(), mean - 8.0 * sigma);
  const auto end = std::lower_bound(edges.begin(), edges.end(), mean + 8.0 * sigma);
  const int first = std::max(0, static_cast<int>(begin - edges.begin()) - 1);
  const int last = std::min(static_cast<int>(edges.size()) - 1, static_cast<int>(end - edges.begin()));
  const auto below = [&](double edge) {
    if (!(sigma > 0.0)) return mean < edge ? 1.0 : 0.0;
    return 0.5 * std::erfc((mean - edge) / sigma / std::sqrt(2.0));
  };
  Intervals within{first, {}};
  for (int i = first; i < last; ++i) within.probability.push_back(below(edges[i + 1]) - below(edges[i]));
  return within;
}

struct SlowImage {
  Grid<double> mean;      // of full scale, not clamped
  Grid<double> variance;  // of one noisy image
  Grid<double> rays;      // expected number in each pixel
  Grid<double> fourth;    // fourth cumulant of one noisy image
};

// Moments of the noisy image over all seeds, ray by ray: rays err independently, so the cumulants of a pixel
// are the sums of those of its rays, each of which gives its value with probability p and nothing else.
inline SlowImage SlowExpectation(const sim::EchoList& echoes, const SonarModel& sonar,
                                 const sim::PaperParameters<double>& p, double alpha_db_per_m) {
  const int bins = sonar.axes.range_bins;
  const int beams = sonar.axes.beam_count();
  std::vector<double> range_edges;
  range_edges.reserve(bins + 1);
  for (int bin = 0; bin <= bins; ++bin) {
    range_edges.push_back(sonar.axes.range_min_m + bin * sonar.axes.range_bin_m());
  }
  const std::vector<double> beam_edges = sonar.axes.BeamEdgesRad();
  SlowImage image{Grid<double>(bins, beams), Grid<double>(bins, beams), Grid<double>(bins, beams),
                  Grid<double>(bins, beams)};
  for (std::size_t echo = 0; echo < echoes.size(); ++echo) {
    const double range_m = echoes.range_m[echo];
    const double growth = SlowJitterGrowth(p.jitter, range_m, sonar.frequency_hz);
    const double value =
        SlowNormalisedEcho(p, echoes.material[echo], range_m, echoes.incidence_rad[echo], alpha_db_per_m) *
        (echoes.weight.empty() ? 1.0 : echoes.weight[echo]) /
        echoes.rays_per_beam[echoes.beam_of_column[echoes.ray[echo] % echoes.cols]];
    const auto in_bin = IntervalProbabilities(range_edges, range_m, p.jitter.sigma_range_m * growth);
    const auto in_beam = IntervalProbabilities(beam_edges, echoes.azimuth_rad[echo],
                                               p.jitter.sigma_azimuth_deg * kPi / 180.0 * growth);
    for (std::size_t i = 0; i < in_bin.probability.size(); ++i) {
      for (std::size_t j = 0; j < in_beam.probability.size(); ++j) {
        const int bin = in_bin.first + static_cast<int>(i);
        const int beam = in_beam.first + static_cast<int>(j);
        const double probability = in_bin.probability[i] * in_beam.probability[j];
        const double spread = probability * (1.0 - probability);
        image.mean(bin, beam) += value * probability;
        image.variance(bin, beam) += value * value * spread;
        image.rays(bin, beam) += probability;
        image.fourth(bin, beam) += std::pow(value, 4) * spread * (1.0 - 6.0 * spread);
      }
    }
  }
  return image;
}

}  // namespace sonarcal::testing
