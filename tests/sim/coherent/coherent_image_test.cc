#include "sim/coherent/coherent_image.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/types/error.h"
#include "core/types/units.h"
#include "sim/physics/beam_pattern.h"
#include "sim/physics/line_array.h"
#include "sim/simulator.h"
#include "tests/sim/meshes.h"
#include "tests/sim/slow_paper_model.h"
#include "tests/sim/thread_limit.h"
#include "tests/sim/water.h"

namespace sonarcal::sim {
namespace {

using namespace testing;  // NOLINT: the helpers of tests/sim

constexpr int kBins = 32;
constexpr int kBeams = 28;

// A floor, a plate that stands on it, and their shadow.
class CoherentImage : public ::testing::Test {
 protected:
  static SonarModel TestSonar() {
    SonarModel sonar = MakeSonar(EvenAzimuthsDeg(kBeams, 1.0), 22.0, 2.4, 4.0, kBins);
    sonar.azimuth_beam_width_deg = 2.0;
    return sonar;
  }

  static Scene TestScene() {
    Scene scene;
    AddQuad(scene, {-10, -4, 0}, {20, 0, 0}, {0, 20, 0}, "floor");
    AddQuad(scene, {-0.4, 3.1, 0}, {0.8, 0.15, 0}, {0, 0.1, 1}, "plate");
    return scene;
  }

  CoherentImage() {
    parameters_.model = EchoModel::kCoherent;
    parameters_.source_level_db = 180.0;
    parameters_.materials["default"].gsab = {
        .a = 0.16, .b_deg = 12.0, .c = 4e-3, .d = 2.0, .e = 0.016, .f_deg = 20.0};
    parameters_.beam.azimuth_pattern = AzimuthPattern::kAperture;
    parameters_.pulse.length_m = 0.1;  // two bins
    parameters_.receiver.noise_db = 101.0;
    parameters_.display = {.db_min = 60.0, .db_max = 180.0};
  }

  Grid<float> Draw(std::uint64_t scatterers, std::uint64_t receiver) const {
    return CoherentPower({caster_, fan_, sonar_, kAlphaDbPerM}, pose_, parameters_, {scatterers, receiver})
        .value;
  }

  // By the acoustic model, from rays of its own.
  Grid<float> Expected() const {
    const RayFan fan(sonar_, Fan(12 * kBeams, 600));
    const AcousticGeometry geometry{sonar_, kAlphaDbPerM};
    return ExpectedPower(MakeScatterMap(Trace(caster_, fan, pose_, sonar_.axes), fan, geometry, parameters_),
                         geometry, parameters_)
        .value;
  }

  static RayFanOptions Fan(int cols, int rows) {
    return {.sampling = Sampling::kBeams,
            .cols = cols,
            .rows = rows,
            .elevation_span_deg = 30.0,
            .azimuth_margin_deg = 14.0};
  }

  SonarModel sonar_ = TestSonar();
  RayCaster caster_{TestScene()};
  // Columns are narrow, a ninth of a beam: the plate's sides are as sharp as half of one, and stand out of a
  // floor 25 dB below them.
  RayFan fan_{sonar_, Fan(9 * kBeams, 80)};
  Pose pose_{RotationFromYawPitchRoll(0.05, -0.12, 0.02), {0, 0, 0.5}};
  ParameterSet parameters_;
};

// Kolmogorov's distance of ratios from the exponential law of mean 1, times sqrt(n): beyond 2.47 with a
// probability of 1e-5.
double DistanceFromExponential(std::vector<double> ratios) {
  std::sort(ratios.begin(), ratios.end());
  const auto n = static_cast<double>(ratios.size());
  double distance = 0.0;
  for (std::size_t i = 0; i < ratios.size(); ++i) {
    const double p = 1.0 - std::exp(-ratios[i]);
    distance = std::max({distance, static_cast<double>(i + 1) / n - p, p - static_cast<double>(i) / n});
  }
  return distance * std::sqrt(n);
}

// Pixel by pixel and in all, over 250 draws. At one look a pixel's power has the standard deviation of its
// mean, so z = (mean / expected - 1) sqrt(n) has a mean square of 1: to 5 standard deviations over 600 / 10
// independent pixels (speckle is correlated over 4.6 beams and 2.3 bins), 1 +- 5 sqrt(2 / 60). A bias of
// 10 % (0.4 dB) would add 2.5. The total is then known to 1 / sqrt(250 x 60), 0.8 %.
//
// Left out: four bins at either end, as the acoustic model drops what lies beyond the window while its pulse
// still reaches in.
TEST_F(CoherentImage, MeanOfManySamplesIsTheExpectedImage) {
  constexpr int kDraws = 250;
  const Grid<float> expected = Expected();
  Grid<double> sum(kBins, kBeams);
  std::vector<double> on_plate;
  std::vector<double> in_shadow;
  const double noise = PowerFromDb(101.0);
  for (int draw = 0; draw < kDraws; ++draw) {
    const Grid<float> power = Draw(draw, 10'000 + draw);
    for (std::size_t i = 0; i < sum.size(); ++i) sum.values()[i] += power.values()[i];
    on_plate.push_back(double{power(14, 14)} / double{expected(14, 14)});
    in_shadow.push_back(double{power(26, 14)} / double{expected(26, 14)});
  }
  EXPECT_GT(expected(14, 14), 100.0 * noise);
  EXPECT_LT(expected(26, 14), 1.5 * noise);
  double mean_square = 0.0;
  double total = 0.0;
  int pixels = 0;
  for (int bin = 4; bin < kBins - 4; ++bin) {
    for (int beam = 0; beam < kBeams; ++beam) {
      const double ratio = sum(bin, beam) / kDraws / double{expected(bin, beam)};
      const double z = (ratio - 1.0) * std::sqrt(kDraws);
      EXPECT_LT(std::abs(z), 5.5) << "bin " << bin << ", beam " << beam;
      mean_square += z * z;
      total += ratio;
      ++pixels;
    }
  }
  RecordProperty("mean_square", std::to_string(mean_square / pixels));
  RecordProperty("total_db", std::to_string(DbFromPower(total / pixels)));
  EXPECT_NEAR(mean_square / pixels, 1.0, 5.0 * std::sqrt(2.0 / 60.0));
  EXPECT_NEAR(total / pixels, 1.0, 4.5 / std::sqrt(kDraws * 60.0));
  EXPECT_LT(DistanceFromExponential(on_plate), 2.47);
  EXPECT_LT(DistanceFromExponential(in_shadow), 2.47);
}

// Noise alone: exponential, of the floor's level, correlated as shading and pulse make it.
TEST_F(CoherentImage, NoiseIsThatOfAnArray) {
  parameters_.materials["default"].gsab = {
      .a = 0.0, .b_deg = 1.0, .c = 0.0, .d = 1.0, .e = 0.0, .f_deg = 1.0};
  fan_ = RayFan(sonar_, Fan(kBeams, 1));
  const LineArray array = MakeLineArray(RadFromDeg(2.0), 1.0);
  const double mean_power = PowerFromDb(101.0);
  constexpr int kDraws = 150;
  std::vector<double> apart;  // pixels that share no noise: 9 beams and 7 bins
  double beams = 0.0;
  double bins = 0.0;
  double two_bins = 0.0;
  double count = 0.0;
  for (int draw = 0; draw < kDraws; ++draw) {
    const Grid<float> power = Draw(1, draw);
    const auto at = [&](int bin, int beam) { return double{power(bin, beam)} / mean_power - 1.0; };
    for (int bin = 0; bin < kBins; bin += 7) {
      for (int beam = 0; beam < kBeams; beam += 9) apart.push_back(at(bin, beam) + 1.0);
    }
    for (int bin = 0; bin + 2 < kBins; ++bin) {
      beams += at(bin, 13) * at(bin, 14);
      bins += at(bin, 5) * at(bin + 1, 5) + at(bin, 22) * at(bin + 1, 22);
      two_bins += at(bin, 5) * at(bin + 2, 5) + at(bin, 22) * at(bin + 2, 22);
      ++count;
    }
  }
  EXPECT_LT(DistanceFromExponential(apart), 2.47);
  // Field correlation of two beams: sum of squared weights with the phase between them.
  std::complex<double> between(0.0);
  double squares = 0.0;
  const double sines =
      std::sin(sonar_.axes.beam_azimuth_rad[14]) - std::sin(sonar_.axes.beam_azimuth_rad[13]);
  for (std::size_t i = 0; i < array.shading.size(); ++i) {
    const double square = array.shading[i] * array.shading[i];
    squares += square;
    between += std::polar(square, 2.0 * kPi * array.position_wavelengths[i] * sines);
  }
  // A product of two powers has a standard deviation of up to sqrt(8) + 1; a third of them are independent.
  const double bound = 4.5 * 3.9 / std::sqrt(count / 3.0);
  EXPECT_NEAR(beams / count, std::norm(between) / (squares * squares), bound);
  EXPECT_NEAR(bins / (2.0 * count), 0.5, bound) << "the pulse's response at half its length";
  EXPECT_NEAR(two_bins / (2.0 * count), 1.0 / 16.0, bound);
}

// Behind a lens each beam has noise of its own, of the floor's level.
TEST_F(CoherentImage, NoiseBehindALensIsIndependentFromBeamToBeam) {
  parameters_.materials["default"].gsab = {
      .a = 0.0, .b_deg = 1.0, .c = 0.0, .d = 1.0, .e = 0.0, .f_deg = 1.0};
  fan_ = RayFan(sonar_, Fan(kBeams, 1));
  sonar_.beam_forming = BeamForming::kLens;
  const double mean_power = PowerFromDb(101.0);
  double beside = 0.0;
  double mean = 0.0;
  double count = 0.0;
  for (int draw = 0; draw < 100; ++draw) {
    const Grid<float> power = Draw(1, draw);
    const auto at = [&](int bin, int beam) { return double{power(bin, beam)} / mean_power - 1.0; };
    for (int bin = 0; bin < kBins; ++bin) {
      for (int beam = 0; beam + 1 < kBeams; ++beam) {
        beside += at(bin, beam) * at(bin, beam + 1);
        mean += at(bin, beam);
        count += 1.0;
      }
    }
  }
  // A third of the bins are independent.
  EXPECT_NEAR(beside / count, 0.0, 4.5 / std::sqrt(count / 3.0));
  EXPECT_NEAR(mean / count, 0.0, 4.5 / std::sqrt(count / 3.0));
}

TEST_F(CoherentImage, SensitivityScalesTheEchoesOfABeam) {
  parameters_.receiver.noise_db.reset();
  const Grid<float> even = Draw(1, 2);
  for (int beam = 0; beam < kBeams; ++beam) parameters_.beam.sensitivity_db.push_back(0.25 * beam - 3.0);
  const Grid<float> tapered = Draw(1, 2);
  for (int bin = 0; bin < kBins; ++bin) {
    for (int beam = 0; beam < kBeams; ++beam) {
      const double expected = PowerFromDb(0.25 * beam - 3.0) * even(bin, beam);
      EXPECT_NEAR(tapered(bin, beam), expected, 1e-5 * expected);
    }
  }
}

TEST_F(CoherentImage, PointTargetsGiveEchoesInFrontOfTheSonarOnly) {
  const auto draw = [&](const Eigen::Vector3d& in_sonar_m) {
    CoherentGeometry geometry{caster_, fan_, sonar_, kAlphaDbPerM};
    geometry.point_targets.push_back({.position_m = pose_ * in_sonar_m, .cross_section_m2 = 1.0});
    return CoherentPower(geometry, pose_, parameters_, {1, 2}).value;
  };
  const Grid<float> without = Draw(1, 2);
  EXPECT_NE(draw({0.3, 3.2, 0.1}), without);
  EXPECT_EQ(draw({0.3, -3.2, 0.1}), without) << "behind";
  EXPECT_EQ(draw({0.0, -1e-6, 3.2}), without) << "above";
}

TEST_F(CoherentImage, SameSeedsSameImageOnAnyNumberOfThreads) {
  const Grid<float> one = WithThreads(1, [&] { return Draw(4, 5); });
  EXPECT_EQ(WithThreads(2, [&] { return Draw(4, 5); }), one);
  EXPECT_EQ(WithThreads(4, [&] { return Draw(4, 5); }), one);
  EXPECT_NE(Draw(4, 6), one);
  EXPECT_NE(Draw(3, 5), one);
}

TEST_F(CoherentImage, ScatterersHaveASeedOfTheirOwn) {
  parameters_.receiver.noise_db.reset();
  const Grid<float> one = Draw(4, 5);
  EXPECT_EQ(Draw(4, 6), one);
  EXPECT_NE(Draw(3, 5), one);
}

TEST_F(CoherentImage, LooksDivideTheVariance) {
  parameters_.receiver.looks = 3.0;
  const Grid<float> expected = Expected();
  double sum = 0.0;
  double squares = 0.0;
  double count = 0.0;
  for (int draw = 0; draw < 20; ++draw) {
    const Grid<float> power = Draw(draw, draw);
    for (int bin = 5; bin < kBins - 4; bin += 6) {
      for (int beam = 2; beam < kBeams; beam += 6) {
        const double ratio = double{power(bin, beam)} / double{expected(bin, beam)};
        sum += ratio;
        squares += (ratio - 1.0) * (ratio - 1.0);
        ++count;
      }
    }
  }
  EXPECT_NEAR(sum / count, 1.0, 4.5 * std::sqrt(1.0 / 3.0 / count));
  // Fourth central moment of the mean of three exponentials: 5 / 9.
  EXPECT_NEAR(squares / count, 1.0 / 3.0, 4.5 * std::sqrt((5.0 / 9.0 - 1.0 / 9.0) / count));
  parameters_.receiver.looks = 0.5;
  EXPECT_THROW(Draw(1, 1), DataError);
}

TEST_F(CoherentImage, NeedsABeamWidth) {
  sonar_.azimuth_beam_width_deg = 0.0;
  EXPECT_THROW(Draw(1, 1), DataError);
}

// Speckle frozen: without receiver noise every frame of a static scene is the same; with it they differ, by
// no more than the noise. Both models.
TEST_F(CoherentImage, FrozenSpeckleIsFrozen) {
  SimulationOptions options;
  options.fan = Fan(9 * kBeams, 80);
  options.noise = true;
  options.seed = 7;
  const Simulator moving(TestScene(), sonar_, options);
  options.frozen_speckle = true;
  const Simulator frozen(TestScene(), sonar_, options);
  for (const EchoModel model : {EchoModel::kAcoustic, EchoModel::kCoherent}) {
    ParameterSet silent = parameters_;
    silent.model = model;
    silent.receiver.noise_db.reset();
    const auto frame = [&](const Simulator& simulator, const ParameterSet& parameters, int index) {
      return simulator.Render(pose_, parameters, index).value;
    };
    EXPECT_EQ(frame(frozen, silent, 0), frame(frozen, silent, 3));
    EXPECT_EQ(frame(frozen, silent, 0), frame(moving, silent, 0));
    EXPECT_NE(frame(moving, silent, 0), frame(moving, silent, 3));
    ParameterSet noisy = silent;
    noisy.receiver.noise_db = 101.0;
    const Grid<float> first = frame(frozen, noisy, 0);
    const Grid<float> second = frame(frozen, noisy, 3);
    EXPECT_NE(first, second);
    // On the plate, far over the noise, only deep fades change by more than a few counts of 0.47 dB.
    std::vector<float> changes;
    for (int beam = 12; beam < 17; ++beam) {
      for (int bin = 13; bin < 16; ++bin) changes.push_back(std::abs(first(bin, beam) - second(bin, beam)));
    }
    std::sort(changes.begin(), changes.end());
    EXPECT_LE(changes[changes.size() / 2], 3.0F);
  }
}

// The array forms the beams of every sample, whatever pattern the parameters name.
TEST_F(CoherentImage, ExpectedImageIsThatOfAnArrayForEachAzimuthPattern) {
  SimulationOptions options;
  options.fan = Fan(3 * kBeams, 80);
  const Simulator simulator(TestScene(), sonar_, options);
  const EchoList echoes = simulator.TraceEchoes(pose_);
  const Grid<float> aperture = simulator.RenderExpected(echoes, parameters_).value;
  ParameterSet other = parameters_;
  other.beam.azimuth_pattern = AzimuthPattern::kGaussian;
  EXPECT_EQ(simulator.RenderExpected(echoes, other).value, aperture);
  other.model = EchoModel::kAcoustic;
  EXPECT_NE(simulator.RenderExpected(echoes, other).value, aperture);
  other.model = EchoModel::kCoherent;
  other.beam.azimuth_pattern = AzimuthPattern::kTable;
  other.beam.azimuth_table_db = {-30.0, 0.0, -30.0};
  EXPECT_EQ(simulator.RenderExpected(echoes, other).value, aperture);
}

// The paper model has no beams that reach into a margin, and no coherent image comes from echoes.
TEST_F(CoherentImage, EchoListsAndThePaperModelAreRefused) {
  SimulationOptions options;
  options.fan = Fan(kBeams, 20);
  const Simulator simulator(TestScene(), sonar_, options);
  EXPECT_THROW(simulator.RenderEchoes(simulator.TraceEchoes(pose_), parameters_), std::logic_error);
  ParameterSet paper = parameters_;
  paper.model = EchoModel::kPaper;
  EXPECT_THROW(simulator.Render(pose_, paper), DataError);
}

}  // namespace
}  // namespace sonarcal::sim
