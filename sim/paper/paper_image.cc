#include "sim/paper/paper_image.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "core/math/random.h"
#include "sim/physics/display.h"
#include "sim/physics/jitter.h"

namespace sonarcal::sim {
namespace {

// Fixed-point scale of the sums of normalised echoes: steps of 2^-40. Integers give the same sum in any
// order. Even the largest echoes of all rays of 512 beams in one pixel fit into 64 bits.
constexpr double kFixedPoint = 0x1p40;

}  // namespace

PolarImage PaperImageOfSums(const Grid<std::int64_t>& sums, double steps_of_one, const PolarAxes& axes,
                            const DisplayParameters<double>& display, double full_scale) {
  PolarImage image{axes, GreyScale(display, full_scale), Grid<float>(sums.rows(), sums.cols())};
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const double value = static_cast<double>(sums.values()[i]) / steps_of_one;
    image.value.values()[i] = static_cast<float>(std::clamp(value, 0.0, 1.0) * full_scale);
  }
  return image;
}

PolarImage RenderPaperImage(const EchoList& echoes, const SonarModel& sonar,
                            const PaperParameters<double>& parameters, double absorption_db_per_m,
                            const PaperImageOptions& options) {
  SONARCAL_CHECK(parameters.materials.size() == echoes.material_names.size(),
                 "{} materials, {} parameter sets", echoes.material_names.size(),
                 parameters.materials.size());
  const PolarAxes& axes = sonar.axes;
  const int bins = axes.range_bins;
  const int beams = axes.beam_count();
  const bool noisy = options.noise_seed.has_value();
  const std::uint64_t seed = options.noise_seed.value_or(0);

  tbb::enumerable_thread_specific<Grid<std::int64_t>> partial_sums(Grid<std::int64_t>(bins, beams));
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, echoes.size(), 4096), [&](const auto& range) {
    Grid<std::int64_t>& sums = partial_sums.local();
    for (std::size_t echo = range.begin(); echo != range.end(); ++echo) {
      const double range_m = echoes.range_m[echo];
      double noisy_range_m = range_m;
      int beam = echoes.Beam(echo);
      const int rays = echoes.rays_per_beam[beam];
      if (noisy) {
        const auto [range_error, azimuth_error] =
            NormalPairOfRay(seed, static_cast<std::uint32_t>(echoes.ray[echo]));
        noisy_range_m += range_error * JitterSigmaRangeM(parameters.jitter, range_m, sonar.frequency_hz);
        const double azimuth_rad =
            echoes.azimuth_rad[echo] +
            azimuth_error * JitterSigmaAzimuthRad(parameters.jitter, range_m, sonar.frequency_hz);
        beam = axes.BeamAt(azimuth_rad);
        if (beam < 0 || beam >= beams) continue;
      }
      const int bin = axes.BinAt(noisy_range_m);
      if (bin < 0 || bin >= bins) continue;
      const double loss_db = 2.0 * TransmissionLossDb(range_m, absorption_db_per_m);
      const double strength_db =
          GsabDb(parameters.materials[echoes.material[echo]], DegFromRad<double>(echoes.incidence_rad[echo]));
      const double echo_value = std::clamp(NormalisedPaperEcho(parameters, loss_db, strength_db),
                                           -kLargestPaperEcho, kLargestPaperEcho);
      sums(bin, beam) +=
          static_cast<std::int64_t>(std::llrint(echo_value * echoes.Weight(echo) / rays * kFixedPoint));
    }
  });

  Grid<std::int64_t> total(bins, beams);
  for (const Grid<std::int64_t>& sums : partial_sums) {
    for (std::size_t i = 0; i < total.size(); ++i) total.values()[i] += sums.values()[i];
  }
  return PaperImageOfSums(total, kFixedPoint, axes, parameters.display, options.full_scale);
}

void QuantiseImage(PolarImage& image) {
  // std::round for values of at least 0, in a form that the compiler turns into vector instructions.
  for (float& value : image.value.values())
    value = static_cast<float>(
        static_cast<std::int32_t>(double{value} + 0.5));  // NOLINT(bugprone-incorrect-roundings)
}

}  // namespace sonarcal::sim
