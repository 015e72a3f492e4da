#include "sim/acoustic/acoustic_image.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/types/error.h"
#include "tests/sim/meshes.h"
#include "tests/sim/slow_acoustic_model.h"
#include "tests/sim/slow_paper_model.h"
#include "tests/sim/thread_limit.h"
#include "tests/sim/water.h"

namespace sonarcal::sim {
namespace {

using namespace testing;  // NOLINT: the helpers of tests/sim

constexpr double kAzimuthWidthDeg = 1.2;
constexpr double kElevationWidthDeg = 22.0;

// 30 beams of 0.8 degrees; 40 bins of 5 cm.
SonarModel TestSonar() {
  SonarModel sonar = MakeSonar(EvenAzimuthsDeg(30, 0.8), kElevationWidthDeg, 2.5, 4.5, 40);
  sonar.azimuth_beam_width_deg = kAzimuthWidthDeg;
  return sonar;
}

ParameterSet TestParameters() {
  ParameterSet p = ClosedFormParameters(6.0);
  p.display = {.db_min = -200.0, .db_max = 400.0};  // clips nothing, and can be undone
  return p;
}

// The echo of a patch of one square metre on the axis of elevation `elevation`, as the model is written.
double SlowPower(const ParameterSet& p, double range_m, double incidence_rad, double elevation_rad) {
  const double cosine = std::cos(incidence_rad);
  const double sigma = SlowSigma(p.materials.at("default").gsab, cosine, cosine, incidence_rad);
  const double level_db =
      p.source_level_db + p.receiver.gain_db - 40.0 * std::log10(range_m) - 2.0 * kAlphaDbPerM * range_m;
  return std::pow(10.0, level_db / 10.0) * sigma *
         SlowResponse(elevation_rad, kElevationWidthDeg * kPi / 180.0);
}

struct Acoustics {
  SonarModel sonar = TestSonar();
  ParameterSet parameters = TestParameters();

  AcousticGeometry geometry() const { return {sonar, kAlphaDbPerM}; }

  ScatterMap Scatter(const Scene& scene, const Pose& pose, int cols, int rows,
                     Sampling sampling = Sampling::kBeams) const {
    const RayFan fan(sonar, {.sampling = sampling, .cols = cols, .rows = rows});
    return MakeScatterMap(Trace(RayCaster(scene), fan, pose, sonar.axes), fan, geometry(), parameters);
  }

  Grid<float> Power(const ScatterMap& scatter) const {
    return ExpectedPower(scatter, geometry(), parameters).value;
  }

  // The power of one draw: the display undone.
  Grid<double> SampledPower(const ScatterMap& scatter, std::uint64_t seed) const {
    const PolarImage image = SampleAcousticImage(scatter, geometry(), parameters, 1.0, seed);
    Grid<double> power(image.value.rows(), image.value.cols());
    for (std::size_t i = 0; i < power.size(); ++i) {
      power.values()[i] = std::pow(10.0, (double{image.value.values()[i]} * 600.0 - 200.0) / 10.0);
    }
    return power;
  }
};

Scene Floor() {
  Scene scene;
  AddQuad(scene, {-10, -4, 0}, {20, 0, 0}, {0, 20, 0}, "floor");
  return scene;
}

const Pose kAboveFloor{Eigen::Quaterniond::Identity(), {0, 0, 0.5}};

Scene Nothing() {
  Scene scene;
  AddQuad(scene, {-10, -4, -10}, {20, 0, 0}, {0, 0, 20}, "behind");
  return scene;
}

double Db(double ratio) {
  return 10.0 * std::log10(ratio);
}

// A sonar at height h above a floor, looking level: the floor at range R is at elevation -asin(h / R), its
// incidence is acos(h / R), and its area is dA = rho drho dtheta = R dR dtheta (rho^2 = R^2 - h^2). Hence
//   P = width_theta x integral of P1(R') R' pulse(R' - R) dR',  width_theta = integral of the azimuth
//   response.
//
// Tolerance: rays 0.014 degrees apart in elevation sample the pulse (s = 2.1 cm) every d = R^2 / h x 0.00024
// rad, 0.4 to 0.9 cm: no ripple of their own. But they beat with the fine rows, step = 1.25 cm apart, between
// which power is shared: where step / d = m + e the ripple is 2 exp(-2 pi^2 (e s / step)^2) (sin(pi e) / (pi
// m))^2, at most 0.12 / (pi m)^2, and m >= 2 here: 0.3 %, 0.013 dB. A forgotten factor 2 in absorption shows
// as 1 dB, R for R^2 as 5 dB.
//
// With an eighth of the rows, rays lie up to d = 7 cm apart in range, more than a bin. Each patch is spread
// evenly over the range that it covers. Echoes without depth would leave a ripple of 2 exp(-2 pi^2 (s / d)^2)
// = 34 %, 1.5 dB. What is left, up to 0.15 dB, is that power and spacing change within a patch.
TEST(ExpectedPower, FloorInClosedForm) {
  const Acoustics acoustics;
  const double height = kAboveFloor.position_m.z();
  struct Rays {
    Sampling sampling;
    int rows;
    double limit_db;
  };
  for (const auto& [sampling, rows, limit_db] :
       {Rays{Sampling::kBeams, 1600, 0.015}, Rays{Sampling::kFrustum, 1600, 0.015},
        Rays{Sampling::kBeams, 200, 0.2}}) {
    const Grid<float> power = acoustics.Power(acoustics.Scatter(Floor(), kAboveFloor, 120, rows, sampling));
    const double azimuth_width = RadFromDeg(kAzimuthWidthDeg) * std::sqrt(kPi / (4.0 * std::log(2.0)));
    // The pulse reaches 3 bins; the elevation span ends at 11 degrees, 2.62 m.
    for (int bin = 6; bin < 36; ++bin) {
      const double centre = 2.5 + (bin + 0.5) * 0.05;
      double expected = 0.0;
      for (int i = -150; i <= 150; ++i) {
        const double range_m = centre + i * 1e-3;
        expected += SlowPower(acoustics.parameters, range_m, std::acos(height / range_m),
                              -std::asin(height / range_m)) *
                    range_m * SlowResponse(i * 1e-3, 0.05) * 1e-3;
      }
      expected *= azimuth_width;
      for (int beam = 5; beam < 25; ++beam) {  // clear of the fan's edges
        ASSERT_NEAR(Db(power(bin, beam) / expected), 0.0, limit_db)
            << rows << " rows, bin " << bin << ", beam " << beam;
      }
    }
  }
}

// What the cell's area makes of the level, in figures: P = P1 x R x width_R x width_theta.
TEST(ExpectedPower, FloorLevelIsThatOfTheResolutionCell) {
  const Acoustics acoustics;
  const Grid<float> power = acoustics.Power(acoustics.Scatter(Floor(), kAboveFloor, 120, 480));
  const double range_m = 2.5 + 20.5 * 0.05;
  const double area = range_m * (1.0645 * 0.05) * (1.0645 * RadFromDeg(kAzimuthWidthDeg));
  const double one_square_metre =
      SlowPower(acoustics.parameters, range_m, std::acos(0.5 / range_m), -std::asin(0.5 / range_m));
  // Over a bin of pulse the echo falls by 0.5 dB either way: to second order 0.01 dB.
  EXPECT_NEAR(Db(power(20, 15) / (one_square_metre * area)), 0.0, 0.03);
}

// A plate that faces the sonar, y = D, by quadrature over directions: dA = R^2 dOmega / cos(delta). Ranges
// run from D on only, so that the pulse is seen at its full slope: power shared between two fine rows a
// quarter of a bin apart interpolates the pulse linearly, off by up to 0.25^2 / 8 x 8 ln 2 (bin / pulse)^2 of
// its peak, 4.3 % for a pulse of one bin.
TEST(ExpectedPower, AFacingPlateEqualsTheQuadratureOverDirections) {
  constexpr double kDistance = 3.33;
  Scene plate;
  AddQuad(plate, {-5, kDistance, -5}, {10, 0, 0}, {0, 0, 10}, "plate");
  for (const double pulse_m : {0.05, 0.1, 0.02}) {
    Acoustics acoustics;
    acoustics.parameters.pulse.length_m = pulse_m;
    const Grid<float> power = acoustics.Power(acoustics.Scatter(plate, Pose{}, 240, 400));
    const double steps_a_pulse = std::max(4.0, 4.0 * pulse_m / 0.05);
    const double interpolation = 8.0 * std::log(2.0) / (8.0 * steps_a_pulse * steps_a_pulse);
    for (const int beam : {8, 15, 20}) {
      std::vector<double> expected(40, 0.0);
      const double beam_azimuth = RadFromDeg(0.8 * (beam - 14.5));
      constexpr double kStep = 0.001;
      for (double azimuth = beam_azimuth - 0.06; azimuth < beam_azimuth + 0.06; azimuth += kStep) {
        for (double elevation = -0.19198621772 + kStep / 2; elevation < 0.19198621772; elevation += kStep) {
          const double cosine = std::cos(azimuth) * std::cos(elevation);
          const double range_m = kDistance / cosine;
          const double at_patch = SlowPower(acoustics.parameters, range_m, std::acos(cosine), elevation) *
                                  range_m * range_m * std::cos(elevation) * kStep * kStep / cosine *
                                  SlowResponse(azimuth - beam_azimuth, RadFromDeg(kAzimuthWidthDeg));
          for (int bin = 0; bin < 40; ++bin) {
            expected[bin] += at_patch * SlowResponse(range_m - (2.5 + (bin + 0.5) * 0.05), pulse_m);
          }
        }
      }
      const double peak = *std::max_element(expected.begin(), expected.end());
      for (int bin = 0; bin < 40; ++bin) {
        ASSERT_NEAR(power(bin, beam), expected[bin], (interpolation + 0.005) * peak)
            << "pulse " << pulse_m << " m, bin " << bin << ", beam " << beam;
      }
    }
  }
}

TEST(ExpectedPower, DoesNotDependOnTheNumberOfRays) {
  const Acoustics acoustics;
  const Pose pose{RotationFromYawPitchRoll(0.2, -0.1, 0.1), {0, 0, 0.5}};
  const Grid<float> few = acoustics.Power(acoustics.Scatter(Floor(), pose, 120, 400));
  const Grid<float> many = acoustics.Power(acoustics.Scatter(Floor(), pose, 240, 800));
  const double faintest = 1e-4 * *std::max_element(few.values().begin(), few.values().end());
  int lit = 0;
  for (int bin = 6; bin < 36; ++bin) {
    for (int beam = 0; beam < 30; ++beam) {
      if (few(bin, beam) < faintest) continue;
      EXPECT_LT(std::abs(Db(many(bin, beam) / few(bin, beam))), 0.1) << "bin " << bin << ", beam " << beam;
      ++lit;
    }
  }
  EXPECT_GT(lit, 600);
}

TEST(ExpectedPower, NoiseAloneIsTheNoise) {
  Acoustics acoustics;
  acoustics.parameters.receiver.noise_db = 23.0;
  const Grid<float> power = acoustics.Power(acoustics.Scatter(Nothing(), Pose{}, 60, 40));
  EXPECT_THAT(power.values(), ::testing::Each(::testing::FloatEq(std::pow(10.0F, 2.3F))));
  acoustics.parameters.receiver.noise_db.reset();
  EXPECT_THAT(acoustics.Power(acoustics.Scatter(Nothing(), Pose{}, 60, 40)).values(), ::testing::Each(0.0F));
}

TEST(ExpectedPower, NoiseAddsInPower) {
  Acoustics acoustics;
  const ScatterMap scatter = acoustics.Scatter(Floor(), kAboveFloor, 60, 100);
  const Grid<float> without = acoustics.Power(scatter);
  acoustics.parameters.receiver.noise_db = 130.0;
  const Grid<float> with = acoustics.Power(scatter);
  for (std::size_t i = 0; i < with.size(); ++i) {
    EXPECT_NEAR(with.values()[i], double{without.values()[i]} + 1e13, 3e-7 * with.values()[i]);
  }
}

// Both floors with everything that shapes them, beside the echoes with the gain that raises them.
TEST(ExpectedPower, IsTheEchoPowerWithItsGainAndTheNoiseFloorAsWritten) {
  Acoustics acoustics;
  const ScatterMap scatter = acoustics.Scatter(Floor(), kAboveFloor, 60, 100);
  const Grid<double> without_gain = EchoPowerImage(scatter, acoustics.geometry(), acoustics.parameters);
  ReceiverParameters& receiver = acoustics.parameters.receiver;
  receiver.time_varied_gain = TimeVariedGain::k40LogRAndAbsorption;
  receiver.noise_db = 110.0;
  receiver.noise_slope_db_per_m = 1.5;
  receiver.noise_after_gain_db = 128.0;
  for (int beam = 0; beam < 30; ++beam) {
    receiver.noise_taper_db.push_back(0.1 * beam);
    receiver.noise_after_gain_taper_db.push_back(2.0 - 0.2 * beam);
  }
  const Grid<double> echoes = EchoPowerImage(scatter, acoustics.geometry(), acoustics.parameters);
  Grid<double> sum = echoes;
  AddNoiseFloor(acoustics.geometry(), acoustics.parameters, sum);
  const Grid<float> power = acoustics.Power(scatter);
  for (int bin = 0; bin < 40; ++bin) {
    const double range_m = 2.5 + (bin + 0.5) * 0.05;
    const double gain_db = 40.0 * std::log10(range_m) + 2.0 * kAlphaDbPerM * range_m;
    for (int beam = 0; beam < 30; ++beam) {
      const double echo = without_gain(bin, beam) * std::pow(10.0, gain_db / 10.0);
      const double floors = std::pow(10.0, (110.0 + 1.5 * range_m + 0.1 * beam + gain_db) / 10.0) +
                            std::pow(10.0, (128.0 + 2.0 - 0.2 * beam) / 10.0);
      ASSERT_NEAR(echoes(bin, beam), echo, 1e-12 * echo);
      ASSERT_NEAR(sum(bin, beam), echo + floors, 1e-12 * (echo + floors));
      ASSERT_NEAR(power(bin, beam), echo + floors, 1e-6 * (echo + floors));
    }
  }
}

// Beam by beam, echoes alone: the noise floor stays.
TEST(ExpectedPower, SensitivityScalesTheEchoesOfABeam) {
  Acoustics acoustics;
  acoustics.parameters.receiver.noise_db = 95.0;
  const ScatterMap scatter = acoustics.Scatter(Floor(), kAboveFloor, 60, 100);
  const Grid<double> even = EchoPowerImage(scatter, acoustics.geometry(), acoustics.parameters);
  std::vector<double>& sensitivity_db = acoustics.parameters.beam.sensitivity_db;
  for (int beam = 0; beam < 30; ++beam) sensitivity_db.push_back(0.2 * beam - 4.0);
  const Grid<double> tapered = EchoPowerImage(scatter, acoustics.geometry(), acoustics.parameters);
  const Grid<float> whole = acoustics.Power(scatter);
  for (int bin = 0; bin < even.rows(); ++bin) {
    for (int beam = 0; beam < even.cols(); ++beam) {
      const double expected = std::pow(10.0, 0.1 * sensitivity_db[beam]) * even(bin, beam);
      EXPECT_NEAR(tapered(bin, beam), expected, 1e-12 * expected);
      EXPECT_NEAR(whole(bin, beam), expected + std::pow(10.0, 9.5), 1e-6 * whole(bin, beam));
    }
  }
  sensitivity_db.pop_back();
  EXPECT_THROW(acoustics.Power(scatter), DataError);
}

TEST(ExpectedDisplay, ShowsTheMeanOfTheLogarithm) {
  Acoustics acoustics;
  acoustics.parameters.display = {.db_min = 100.0, .db_max = 180.0};
  PolarImage power{acoustics.sonar.axes, {}, Grid<float>(40, 30, 1e14F)};
  power.value(0, 0) = 1e9F;
  power.value(0, 1) = 1e19F;
  power.value(0, 2) = 0.0F;
  const PolarImage image = ExpectedDisplay(power, acoustics.parameters, 255.0);
  // What speckle carries beyond a clip is lost: with c = 10 / ln 10 dB, at 40 dB above db_min the clipped
  // tail adds c 1e-4; at 10 dB below it c E1(10) is left; at 10 dB above db_max c Ein(0.1) is missing.
  const double grey_per_db = 255.0 / 80.0;
  const double c = 10.0 / std::log(10.0);
  EXPECT_NEAR(image.value(5, 5), grey_per_db * (140.0 - 2.50682 - 100.0 + c * 1e-4), 3e-4);
  EXPECT_NEAR(image.value(0, 0), grey_per_db * c * 4.15697e-6, 1e-6);
  EXPECT_NEAR(image.value(0, 1), 255.0 - grey_per_db * c * 0.0975545, 1e-3);
  EXPECT_EQ(image.value(0, 2), 0.0F);
}

// --- Draws
// ---------------------------------------------------------------------------------------------------

class SampledImage : public ::testing::Test {
 protected:
  // Floor with a plate standing on it; noise that matters in the shadow.
  SampledImage() {
    Scene scene = Floor();
    AddQuad(scene, {-0.3, 3.4, 0}, {0.6, 0, 0}, {0, 0, 1}, "plate");
    acoustics_.parameters.receiver.noise_db = 100.0;
    scatter_ = acoustics_.Scatter(scene, kAboveFloor, 60, 100);
    expected_ = acoustics_.Power(scatter_);
  }

  // Power over its expectation at pixels that share no scatterer to speak of: 5 beams (4 degrees, 3.3 widths
  // of the amplitude response) and 7 bins apart.
  std::vector<double> IndependentRatios(int draws) const {
    std::vector<double> ratios;
    for (int draw = 0; draw < draws; ++draw) {
      const Grid<double> power = acoustics_.SampledPower(scatter_, 50'000 + draw);
      for (int bin = 3; bin < 40; bin += 7) {
        for (int beam = 2; beam < 30; beam += 5) {
          ratios.push_back(power(bin, beam) / double{expected_(bin, beam)});
        }
      }
    }
    return ratios;
  }

  Acoustics acoustics_;
  ScatterMap scatter_;
  Grid<float> expected_;
};

TEST_F(SampledImage, SameSeedSameImageOnAnyNumberOfThreads) {
  const auto draw = [&](std::uint64_t seed, int threads) {
    return WithThreads(threads, [&] {
      return SampleAcousticImage(scatter_, acoustics_.geometry(), acoustics_.parameters, 255.0, seed).value;
    });
  };
  const Grid<float> one = draw(9, 1);
  EXPECT_EQ(draw(9, 2), one);
  EXPECT_EQ(draw(9, 4), one);
  EXPECT_NE(draw(10, 2), one);
}

// At one look a pixel's power has the standard deviation of its mean: over n draws z = (mean - 1) sqrt(n).
// One of 1200 pixels beyond 5 has a chance of 7e-4.
TEST_F(SampledImage, MeanPowerIsTheExpectation) {
  constexpr int kDraws = 600;
  Grid<double> sum(40, 30);
  for (int draw = 0; draw < kDraws; ++draw) {
    const Grid<double> power = acoustics_.SampledPower(scatter_, draw);
    for (std::size_t i = 0; i < sum.size(); ++i) sum.values()[i] += power.values()[i];
  }
  double all = 0.0;
  for (std::size_t i = 0; i < sum.size(); ++i) {
    const double ratio = sum.values()[i] / kDraws / double{expected_.values()[i]};
    ASSERT_LT(std::abs(ratio - 1.0), 5.0 / std::sqrt(kDraws)) << "pixel " << i;
    all += ratio / static_cast<double>(sum.size());
  }
  // Neighbours within a beam width and a pulse go together: at least 1200 / 8 independent ones.
  EXPECT_NEAR(all, 1.0, 4.5 / std::sqrt(kDraws * 150.0));
}

// Two samples of one seed differ only by the factor of each beam.
TEST_F(SampledImage, SensitivityScalesTheEchoesOfABeam) {
  acoustics_.parameters.receiver.noise_db.reset();
  const Grid<double> even = acoustics_.SampledPower(scatter_, 5);
  for (int beam = 0; beam < 30; ++beam) acoustics_.parameters.beam.sensitivity_db.push_back(3.0 - 0.3 * beam);
  const Grid<double> tapered = acoustics_.SampledPower(scatter_, 5);
  int compared = 0;
  for (int bin = 0; bin < 40; ++bin) {
    for (int beam = 0; beam < 30; ++beam) {
      if (even(bin, beam) < 1.0) continue;  // no echo at all
      EXPECT_NEAR(Db(tapered(bin, beam)) - Db(even(bin, beam)), 3.0 - 0.3 * beam, 1e-3);
      ++compared;
    }
  }
  EXPECT_GT(compared, 600);
}

// Kolmogorov and Smirnov: the distance exceeds c / sqrt(n) with probability 2 exp(-2 c^2), 1e-5 at c = 2.47.
TEST_F(SampledImage, OneLookIsExponential) {
  std::vector<double> ratios = IndependentRatios(120);
  std::sort(ratios.begin(), ratios.end());
  const auto n = static_cast<double>(ratios.size());
  ASSERT_GT(n, 4000);
  double distance = 0.0;
  double mean_db = 0.0;
  double mean_square_db = 0.0;
  for (std::size_t i = 0; i < ratios.size(); ++i) {
    const double p = 1.0 - std::exp(-ratios[i]);
    distance = std::max({distance, static_cast<double>(i + 1) / n - p, p - static_cast<double>(i) / n});
    mean_db += Db(ratios[i]) / n;
    mean_square_db += Db(ratios[i]) * Db(ratios[i]) / n;
  }
  EXPECT_LT(distance, 2.47 / std::sqrt(n));
  // Standard errors: 5.57 / sqrt(n), and of the deviation 5.57 / 2 x sqrt((kappa - 1) / n), kappa = 5.4.
  const double deviation_db = std::sqrt(mean_square_db - mean_db * mean_db);
  EXPECT_NEAR(mean_db, -2.507, 4.5 * 5.57 / std::sqrt(n));
  EXPECT_NEAR(deviation_db, 5.57, 4.5 * 5.57 / 2.0 * std::sqrt(4.4 / n));
}

// Two draws differ by 20 log10 2 on average, one and its mean by 4.27 dB: the floor under every comparison.
TEST_F(SampledImage, DifferencesAreThoseOfSpeckle) {
  const std::vector<double> ratios = IndependentRatios(120);
  const std::size_t pairs = ratios.size() / 2;
  double between = 0.0;
  double from_mean = 0.0;
  for (std::size_t i = 0; i < pairs; ++i) {
    between += std::abs(Db(ratios[2 * i]) - Db(ratios[2 * i + 1])) / static_cast<double>(pairs);
    from_mean += std::abs(Db(ratios[2 * i]) + 2.507) / static_cast<double>(pairs);
  }
  // Standard deviation of each difference below 5.57 sqrt(2).
  EXPECT_NEAR(between, 6.02, 4.5 * 5.57 * std::sqrt(2.0) / std::sqrt(static_cast<double>(pairs)));
  EXPECT_NEAR(from_mean, 4.27, 4.5 * 5.57 / std::sqrt(static_cast<double>(pairs)));
}

// A sum of weighted exponentials, weights w of sum 1: variance sum w^2 = 1 / L, fourth central moment
// 6 sum w^4 + 3 / L^2.
TEST_F(SampledImage, LooksDivideTheVariance) {
  const struct {
    double looks;
    double sum_of_fourth_powers;
  } cases[] = {{1.5, std::pow(0.788675, 4) + std::pow(0.211325, 4)}, {3.0, 3.0 / 81.0}};
  for (const auto& c : cases) {
    acoustics_.parameters.receiver.looks = c.looks;
    const std::vector<double> ratios = IndependentRatios(100);
    const auto n = static_cast<double>(ratios.size());
    double mean = 0.0;
    for (const double ratio : ratios) mean += ratio / n;
    double variance = 0.0;
    for (const double ratio : ratios) variance += (ratio - mean) * (ratio - mean) / n;
    const double expected = 1.0 / c.looks;
    const double fourth = 6.0 * c.sum_of_fourth_powers + 3.0 * expected * expected;
    EXPECT_NEAR(mean, 1.0, 4.5 * std::sqrt(expected / n)) << c.looks << " looks";
    EXPECT_NEAR(variance, expected, 4.5 * std::sqrt((fourth - expected * expected) / n))
        << c.looks << " looks";
  }
}

TEST_F(SampledImage, FewerThanOneLookIsRefused) {
  acoustics_.parameters.receiver.looks = 0.5;
  EXPECT_THROW(SampleAcousticImage(scatter_, acoustics_.geometry(), acoustics_.parameters, 255.0, 1),
               DataError);
}

TEST(ScatterMap, NeedsABeamWidth) {
  Acoustics acoustics;
  const ScatterMap scatter = acoustics.Scatter(Floor(), kAboveFloor, 60, 40);
  acoustics.sonar.azimuth_beam_width_deg = 0.0;
  EXPECT_THROW(acoustics.Power(scatter), DataError);
  acoustics.parameters.beam.azimuth_width_deg = 1.0;
  EXPECT_NO_THROW(acoustics.Power(scatter));
}

}  // namespace
}  // namespace sonarcal::sim
