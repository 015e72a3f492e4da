#include "sim/acoustic/beam_noise.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "core/types/error.h"
#include "core/types/units.h"
#include "sim/acoustic/acoustic_image.h"
#include "sim/physics/line_array.h"
#include "sim/scenes/sonar_presets.h"
#include "tests/sim/thread_limit.h"

namespace sonarcal::sim {
namespace {

using namespace testing;  // NOLINT: the helpers of tests/sim

constexpr int kLags = 6;
using Lags = std::array<double, kLags>;

// Correlation of power at 0 .. kLags - 1 beams, over all beams and `bins` bins. The mean power is 1.
Lags PowerCorrelation(const BeamNoise& noise, int beams, int bins) {
  std::vector<std::complex<double>> field(beams);
  Lags sum{};
  Lags count{};
  for (int bin = 0; bin < bins; ++bin) {
    noise.Draw(CounterRandom(3), bin, field);
    for (int lag = 0; lag < kLags; ++lag) {
      for (int beam = 0; beam + lag < beams; ++beam) {
        sum[lag] += (std::norm(field[beam]) - 1.0) * (std::norm(field[beam + lag]) - 1.0);
        count[lag] += 1.0;
      }
    }
  }
  for (int lag = 0; lag < kLags; ++lag) sum[lag] /= count[lag];
  return sum;
}

// Standard error of a correlation: a product of two powers deviates by up to 3.8; `bins` hold 64 independent
// numbers each.
double ErrorOf(int bins) {
  return 3.8 / std::sqrt(64.0 * bins);
}

// Reference: noise alone in the coherent model, with a Hann-tapered array of 160 elements.
TEST(BeamNoise, OfTheP900IsThatOfItsArray) {
  constexpr int kBins = 8000;
  constexpr Lags kCoherent = {1.0, 0.95, 0.82, 0.63, 0.44, 0.27};
  const SonarModel& sonar = FindSonarPreset("p900-45").sonar;
  const Lags found = PowerCorrelation(BeamNoise(sonar, {}), sonar.axes.beam_count(), kBins);
  for (int lag = 0; lag < kLags; ++lag)
    EXPECT_NEAR(found[lag], kCoherent[lag], 0.005 + 4.0 * ErrorOf(kBins)) << lag;
}

// The field correlation of two beams is the sum of the squared shading with the phase between them.
TEST(BeamNoise, IsThatOfElementsAnyShading) {
  constexpr int kBins = 8000;
  for (const double taper : {0.0, 0.5, 1.0}) {
    SonarModel sonar = FindSonarPreset("p900-45").sonar;
    ParameterSet parameters;
    parameters.beam.azimuth_taper = taper;
    const LineArray array = MakeLineArray(RadFromDeg(sonar.azimuth_beam_width_deg), taper);
    const std::vector<double>& azimuth_rad = sonar.axes.beam_azimuth_rad;
    const int beams = sonar.axes.beam_count();
    const Lags found = PowerCorrelation(BeamNoise(sonar, parameters), beams, kBins);
    for (int lag = 1; lag < kLags; ++lag) {
      double expected = 0.0;
      for (int beam = 0; beam + lag < beams; ++beam) {
        const double sines = std::sin(azimuth_rad[beam + lag]) - std::sin(azimuth_rad[beam]);
        std::complex<double> between(0.0);
        double squares = 0.0;
        for (std::size_t i = 0; i < array.shading.size(); ++i) {
          const double square = array.shading[i] * array.shading[i];
          squares += square;
          between += std::polar(square, 2.0 * kPi * array.position_wavelengths[i] * sines);
        }
        expected += std::norm(between) / (squares * squares) / (beams - lag);
      }
      EXPECT_NEAR(found[lag], expected, 0.005 + 4.0 * ErrorOf(kBins)) << "taper " << taper << ", lag " << lag;
    }
  }
}

// Each beam by itself is exponential of mean 1, out to 65 degrees.
TEST(BeamNoise, HasUnitPowerInEveryBeam) {
  constexpr int kBins = 4000;
  for (const char* name : {"p900-45", "oculus-m750d-0.75", "didson-1.8"}) {
    const SonarModel& sonar = FindSonarPreset(name).sonar;
    const int beams = sonar.axes.beam_count();
    const BeamNoise noise(sonar, {});
    std::vector<std::complex<double>> field(beams);
    std::vector<double> mean(beams, 0.0);
    std::vector<double> square(beams, 0.0);
    for (int bin = 0; bin < kBins; ++bin) {
      noise.Draw(CounterRandom(4), bin, field);
      for (int beam = 0; beam < beams; ++beam) {
        mean[beam] += std::norm(field[beam]) / kBins;
        square[beam] += std::norm(field[beam]) * std::norm(field[beam]) / kBins;
      }
    }
    for (int beam = 0; beam < beams; ++beam) {
      EXPECT_NEAR(mean[beam], 1.0, 5.0 / std::sqrt(kBins)) << name << ", beam " << beam;
      EXPECT_NEAR(square[beam], 2.0, 5.0 * std::sqrt(20.0 / kBins)) << name << ", beam " << beam;
    }
  }
}

TEST(BeamNoise, BehindALensIsIndependent) {
  constexpr int kBins = 8000;
  const SonarModel& sonar = FindSonarPreset("didson-1.8").sonar;
  const Lags found = PowerCorrelation(BeamNoise(sonar, {}), sonar.axes.beam_count(), kBins);
  for (int lag = 1; lag < kLags; ++lag) EXPECT_NEAR(found[lag], 0.0, 5.0 / std::sqrt(96.0 * kBins)) << lag;
}

// Widths on both sides of the one below which no directions are drawn. Between beams of 1e-9 degrees there
// would be tens of billions.
TEST(BeamNoise, OfBeamsThatDoNotOverlapIsIndependent) {
  constexpr int kBins = 400;
  const SonarModel& sonar = FindSonarPreset("p900-45").sonar;
  ParameterSet parameters;
  for (const AzimuthPattern pattern : {AzimuthPattern::kAperture, AzimuthPattern::kGaussian}) {
    parameters.beam.azimuth_pattern = pattern;
    for (const double width_deg : {2e-3, 1e-3, 1e-9, 1e-300}) {
      parameters.beam.azimuth_width_deg = width_deg;
      const Lags found = PowerCorrelation(BeamNoise(sonar, parameters), sonar.axes.beam_count(), kBins);
      EXPECT_NEAR(found[0], 1.0, 5.0 * std::sqrt(8.0 / (256.0 * kBins))) << width_deg;
      for (int lag = 1; lag < kLags; ++lag)
        EXPECT_NEAR(found[lag], 0.0, 5.0 / std::sqrt(250.0 * kBins)) << width_deg << " deg, lag " << lag;
    }
  }
}

TEST(BeamNoise, OtherPatternsHaveTheGrainOfTheirBeams) {
  SonarModel sonar = FindSonarPreset("p900-45").sonar;
  ParameterSet parameters;
  parameters.beam.azimuth_pattern = AzimuthPattern::kGaussian;
  constexpr int kBins = 4000;
  const Lags gaussian = PowerCorrelation(BeamNoise(sonar, parameters), sonar.axes.beam_count(), kBins);
  // The field response 2^-(2 x^2 / width^2) overlaps with itself by 2^-(x / width)^2; its square for power.
  for (int lag = 1; lag < kLags; ++lag)
    EXPECT_NEAR(gaussian[lag], std::exp2(-2.0 * std::pow(0.18 * lag, 2)), 0.005 + 4.0 * ErrorOf(kBins))
        << lag;

  sonar.azimuth_beam_width_deg = 0.0;
  parameters.beam.azimuth_pattern = AzimuthPattern::kAperture;
  EXPECT_THROW(BeamNoise(sonar, parameters), DataError);
}

// The acoustic model's draws show it: noise alone, no echo.
TEST(BeamNoise, CovarianceEqualsThatOfSamples) {
  for (const BeamForming forming : {BeamForming::kArray, BeamForming::kUnknown, BeamForming::kLens}) {
    SonarModel sonar = FindSonarPreset("p900-45").sonar;
    sonar.beam_forming = forming;
    ParameterSet parameters;
    parameters.materials["default"];
    parameters.receiver.noise_db = 100.0;
    parameters.display = {.db_min = -100.0, .db_max = 300.0};
    const AcousticGeometry geometry{sonar, 0.2};
    ScatterMap scatter;
    scatter.column_azimuth_rad = sonar.axes.beam_azimuth_rad;
    scatter.power = Grid<double>(4 * sonar.axes.range_bins, sonar.axes.beam_count());
    const auto draw = [&](int seed) {
      return SampleAcousticImage(scatter, geometry, parameters, 1.0, static_cast<std::uint64_t>(seed)).value;
    };
    EXPECT_EQ(WithThreads(1, [&] { return draw(3); }), WithThreads(2, [&] { return draw(3); }));
    double mean = 0.0;
    double beside = 0.0;
    double along = 0.0;
    double count = 0.0;
    for (int seed = 0; seed < 10; ++seed) {
      const Grid<float> image = draw(seed);
      const auto power = [&](int bin, int beam) {
        return PowerFromDb(-200.0 + 400.0 * double{image(bin, beam)});
      };
      for (int bin = 0; bin + 1 < image.rows(); ++bin) {
        for (int beam = 0; beam + 1 < image.cols(); ++beam) {
          mean += power(bin, beam);
          beside += (power(bin, beam) - 1.0) * (power(bin, beam + 1) - 1.0);
          along += (power(bin, beam) - 1.0) * (power(bin + 1, beam) - 1.0);
          count += 1.0;
        }
      }
    }
    const double bound = 4.0 * ErrorOf(3290);
    EXPECT_NEAR(mean / count, 1.0, bound);
    EXPECT_NEAR(beside / count, forming == BeamForming::kLens ? 0.0 : 0.95, 0.005 + bound);
    EXPECT_NEAR(along / count, 0.0, bound);
  }
}

}  // namespace
}  // namespace sonarcal::sim
