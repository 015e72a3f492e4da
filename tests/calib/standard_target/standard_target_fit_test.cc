#include "calib/standard_target/standard_target_fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "calib/identifiability.h"
#include "core/types/error.h"
#include "core/types/units.h"
#include "sim/physics/absorption.h"
#include "sim/physics/beam_pattern.h"
#include "tests/sim/slow_paper_model.h"
#include "tests/support/sphere_recording.h"

namespace sonarcal::calib {
namespace {

using ::testing::HasSubstr;

constexpr int kBeams = 96;
constexpr double kSpacingDeg = 0.3;
constexpr double kDiameterM = 0.02;

// A sphere of tungsten carbide before an array, recorded by the coherent simulator. Fits start from the
// defaults of the parameters and from a data sheet that is wrong by half.
class StandardTargetFitTest : public ::testing::Test {
 protected:
  StandardTargetFitTest() {
    recording_.sonar = testing::MakeSonar(testing::EvenAzimuthsDeg(kBeams, kSpacingDeg), 14.0, 2.0, 5.5, 700);
    recording_.sonar.frequency_hz = 1.8e6;
    recording_.sonar.azimuth_beam_width_deg = 0.75;
    recording_.absorption_db_per_m =
        sim::AbsorptionDbPerM(sim::AbsorptionFormula::kAuto, recording_.sonar.frequency_hz, water_);
    ParameterSet& truth = recording_.truth;
    truth.model = EchoModel::kCoherent;
    truth.source_level_db = 203.0;
    truth.receiver.gain_db = 4.0;
    truth.receiver.noise_db = 105.0;
    truth.materials["default"] = {};
    truth.beam.azimuth_width_deg = 0.5;
    truth.beam.azimuth_taper = 0.35;
    truth.beam.elevation_width_deg = 11.0;
    truth.pulse.length_m = 0.015;
    truth.display = {.db_min = 100.0, .db_max = 175.0};
    initial_.model = EchoModel::kAcoustic;
    initial_.display = truth.display;
    initial_.receiver.gain_db = truth.receiver.gain_db;
    options_.sphere = {.material = "wc", .diameter_m = kDiameterM};
    recording_.cross_section_m2 = PowerFromDb(TruthStrengthDb());
  }

  // A fifth of the ranges, for spheres near 3 m.
  void RecordShortRanges() {
    PolarAxes& axes = recording_.sonar.axes;
    axes.range_min_m = 2.8;
    axes.range_max_m = 3.5;
    axes.range_bins = 140;
  }

  double TruthStrengthDb() const {
    return StrengthOfSphere(options_.sphere, recording_.sonar, water_, recording_.truth.pulse.length_m).db;
  }

  double TruthLevelDb() const { return recording_.truth.source_level_db + recording_.truth.receiver.gain_db; }

  // Places spread evenly over these limits, in an order without pattern.
  void PlaceSphere(int count, double nearest_m, double farthest_m, double azimuth_deg, double elevation_deg) {
    std::mt19937_64 random(7);
    const auto spread = [&](double low, double high) {
      std::vector<double> values;
      for (int i = 0; i < count; ++i) values.push_back(low + (high - low) * (i + 0.5) / count);
      std::shuffle(values.begin(), values.end(), random);
      return values;
    };
    const std::vector<double> range_m = spread(nearest_m, farthest_m);
    const std::vector<double> azimuth = spread(-azimuth_deg, azimuth_deg);
    const std::vector<double> elevation = spread(-elevation_deg, elevation_deg);
    recording_.places.clear();
    for (int i = 0; i < count; ++i)
      recording_.places.push_back({range_m[i], RadFromDeg(azimuth[i]), RadFromDeg(elevation[i])});
  }

  StandardTargetFit Fit() const {
    return FitStandardTarget(testing::SphereRecording(recording_), initial_, water_,
                             recording_.absorption_db_per_m, options_);
  }

  // Largest difference in dB of two responses where the true one is above -20 dB.
  static double PatternErrorDb(const ParameterSet& fitted, const ParameterSet& truth) {
    const auto response = [](const ParameterSet& parameters) {
      return sim::AzimuthResponse<double>({.pattern = AzimuthPattern::kAperture,
                                           .width_rad = RadFromDeg(parameters.beam.azimuth_width_deg),
                                           .taper = parameters.beam.azimuth_taper});
    };
    const auto of_truth = response(truth);
    const auto of_fit = response(fitted);
    double worst = 0.0;
    for (double deg = 0.0; deg < 0.6; deg += 0.01) {
      const double power = of_truth.Power(RadFromDeg(deg), 0.0);
      if (power < 0.01) continue;
      worst = std::max(worst, std::abs(DbFromPower(of_fit.Power(RadFromDeg(deg), 0.0) / power)));
    }
    return worst;
  }

  static const FittedParameter& Find(const StandardTargetFit& fit, const std::string& name) {
    const FittedParameter* found = fit.report.Find(name);
    if (found == nullptr) throw std::runtime_error("no " + name);
    return *found;
  }

  static void ExpectWithin(const FittedParameter& fitted, double truth, double sigmas) {
    ASSERT_TRUE(fitted.sigma.has_value()) << fitted.name;
    EXPECT_NEAR(fitted.value, truth, sigmas * *fitted.sigma) << fitted.name;
  }

  Water water_;
  testing::SphereRecordingOptions recording_;
  ParameterSet initial_;
  StandardTargetOptions options_;
};

TEST_F(StandardTargetFitTest, FixedSphereGivesLevelAndResponses) {
  RecordShortRanges();
  PlaceSphere(20, 3.0, 3.3, 0.5, 0.0);
  const StandardTargetFit fit = Fit();
  ASSERT_TRUE(fit.usable);
  EXPECT_EQ(fit.frames.size(), 20U);
  EXPECT_NEAR(fit.level_db, TruthLevelDb(), 0.1);
  EXPECT_LT(PatternErrorDb(fit.parameters, recording_.truth), 0.3);
  ExpectWithin(Find(fit, "beam.azimuth_width_deg"), 0.5, 3.5);
  ExpectWithin(Find(fit, "pulse.length_m"), 0.015, 3.5);
  EXPECT_NEAR(fit.parameters.pulse.length_m, 0.015, 0.0002);
  EXPECT_TRUE(fit.beams_determined.empty());
  EXPECT_NEAR(fit.parameters.receiver.noise_db.value(), 105.0, 0.3);
  for (std::size_t i = 0; i < fit.frames.size(); ++i) {
    EXPECT_NEAR(fit.frames[i].range_m, recording_.places[i].range_m, 0.001);
    EXPECT_NEAR(fit.frames[i].azimuth_rad, recording_.places[i].azimuth_rad, RadFromDeg(0.02));
  }
}

TEST_F(StandardTargetFitTest, MovedSphereGivesBeamsElevationAndGainWithRange) {
  PlaceSphere(120, 2.3, 5.2, 12.0, 5.0);
  recording_.with_poses = true;
  recording_.truth.receiver.time_varied_gain = TimeVariedGain::k40LogRAndAbsorption;
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (int beam = 0; beam < kBeams; ++beam)
    recording_.truth.beam.sensitivity_db.push_back(0.8 * normal(random));
  const StandardTargetFit fit = Fit();
  ASSERT_TRUE(fit.usable);
  EXPECT_EQ(fit.parameters.receiver.time_varied_gain, TimeVariedGain::k40LogRAndAbsorption);
  ASSERT_TRUE(fit.position.has_value());
  EXPECT_LT(fit.position->position_m.norm(), 0.02);
  EXPECT_LT(PatternErrorDb(fit.parameters, recording_.truth), 0.3);

  const sim::ElevationResponse truth(ElevationPattern::kCosine, RadFromDeg(11.0), 1.0);
  const sim::ElevationResponse fitted(ElevationPattern::kCosine,
                                      RadFromDeg(fit.parameters.beam.elevation_width_deg), 1.0);
  EXPECT_NEAR(DbFromPower(fitted.Power(RadFromDeg(5.0)) / truth.Power(RadFromDeg(5.0))), 0.0, 0.3);
  ExpectWithin(Find(fit, "beam.elevation_width_deg"), 11.0, 3.5);

  // Level and sensitivities: their mean is counted in the level.
  ASSERT_GT(fit.beams_determined.size(), 60U);
  double mean_db = 0.0;
  for (const int beam : fit.beams_determined) mean_db += recording_.truth.beam.sensitivity_db[beam];
  mean_db /= static_cast<double>(fit.beams_determined.size());
  EXPECT_NEAR(fit.level_db, TruthLevelDb() + mean_db, 0.1);
  double squares = 0.0;
  double in_sigmas = 0.0;
  for (const int beam : fit.beams_determined) {
    const std::string name = "beam.sensitivity_db." + std::to_string(beam);
    const FittedParameter& of_beam = Find(fit, name);
    const double error_db = of_beam.value - (recording_.truth.beam.sensitivity_db[beam] - mean_db);
    squares += error_db * error_db;
    in_sigmas += error_db * error_db / (*of_beam.sigma * *of_beam.sigma);
  }
  const auto count = static_cast<double>(fit.beams_determined.size());
  EXPECT_LT(std::sqrt(squares / count), 0.3);
  EXPECT_GT(std::sqrt(in_sigmas / count), 0.6);
  EXPECT_LT(std::sqrt(in_sigmas / count), 1.5);
}

// Rolls tell the elevation of the sphere. It stays near one elevation, and so does not tell the width. No
// width is made up then.
TEST_F(StandardTargetFitTest, AnUnknownElevationWidthIsNotTakenForKnown) {
  RecordShortRanges();
  PlaceSphere(20, 3.0, 3.3, 3.0, 0.5);
  for (std::size_t i = 0; i < recording_.places.size(); ++i)
    recording_.places[i].roll_rad = RadFromDeg(i % 2 == 0 ? 30.0 : -30.0);
  recording_.with_poses = true;
  recording_.sonar.elevation_beam_width_deg = 0.0;
  const StandardTargetFit fit = Fit();
  ASSERT_TRUE(fit.usable);
  EXPECT_THAT(fit.elevation_unknown, ::testing::HasSubstr("the elevation beam width is not stated"));
  EXPECT_NEAR(fit.level_db, TruthLevelDb(), 0.1);
  const FittedParameter* width = fit.report.Find("beam.elevation_width_deg");
  EXPECT_TRUE(width == nullptr || !width->sigma);
}

// Over many recordings, errors are as large as their standard errors say.
TEST_F(StandardTargetFitTest, StandardErrorsHold) {
  RecordShortRanges();
  std::vector<double> level;
  std::vector<double> width;
  std::vector<double> pulse;
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  constexpr int kRecordings = 24;
  recording_.truth.receiver.noise_db = 120.0;
  for (int i = 0; i < kRecordings; ++i) {
    PlaceSphere(12, 3.0, 3.3, 0.5, 0.0);
    recording_.seed = 1000 * (i + 1);
    recording_.level_change_db.clear();
    for (int frame = 0; frame < 12; ++frame) recording_.level_change_db.push_back(0.5 * normal(random));
    const StandardTargetFit fit = Fit();
    ASSERT_TRUE(fit.usable);
    const double without_strength_db =
        std::sqrt(fit.level_sigma_db * fit.level_sigma_db - fit.strength.sigma_db * fit.strength.sigma_db);
    const auto add = [&](std::vector<double>& of, const std::string& name, double truth) {
      const FittedParameter& fitted = Find(fit, name);
      of.push_back((fitted.value - truth) / *fitted.sigma);
    };
    level.push_back((fit.level_db - TruthLevelDb()) / without_strength_db);
    add(width, "beam.azimuth_width_deg", 0.5);
    add(pulse, "pulse.length_m", 0.015);
  }
  for (const std::vector<double>* of : {&level, &width, &pulse}) {
    double squares = 0.0;
    for (const double value : *of) squares += value * value;
    const double rms = std::sqrt(squares / kRecordings);
    // RMS of 24 normal values: 1 +- .14.
    EXPECT_GT(rms, 0.6);
    EXPECT_LT(rms, 1.5);
  }
}

// About their own mean, four levels have three degrees of freedom. The variance by which each is measured
// counts for little.
TEST_F(StandardTargetFitTest, FewFramesGiveTheSpreadOfTheirLevelsAndAWideError) {
  RecordShortRanges();
  PlaceSphere(4, 3.0, 3.3, 0.5, 0.0);
  recording_.level_change_db = {-1.5, -0.5, 0.5, 1.5};
  const StandardTargetFit fit = Fit();
  ASSERT_TRUE(fit.usable);
  ASSERT_EQ(fit.frames.size(), 4U);
  double mean = 0.0, squares = 0.0;
  for (const TargetFrame& frame : fit.frames) mean += frame.level_db / 4.0;
  for (const TargetFrame& frame : fit.frames) squares += std::pow(frame.level_db - mean, 2);
  EXPECT_NEAR(fit.level_spread_db, std::sqrt(squares / 3.0), 0.05);
  const double without_strength_db =
      std::sqrt(fit.level_sigma_db * fit.level_sigma_db - fit.strength.sigma_db * fit.strength.sigma_db);
  EXPECT_NEAR(without_strength_db, StudentFactor(3.0) * fit.level_spread_db / std::sqrt(4.0), 0.1);
}

TEST_F(StandardTargetFitTest, ClippedMissingAndOddSpheresAreLeftOutAndSaidSo) {
  RecordShortRanges();
  PlaceSphere(12, 3.0, 3.3, 0.5, 0.0);
  recording_.level_change_db = std::vector<double>(12, 0.0);
  recording_.level_change_db[2] = 50.0;
  recording_.level_change_db[5] = -60.0;
  recording_.level_change_db[7] = 12.0;
  const StandardTargetFit fit = Fit();
  ASSERT_EQ(fit.left_out.size(), 3U);
  EXPECT_EQ(fit.left_out[0].frame, 2);
  EXPECT_THAT(fit.left_out[0].why, HasSubstr("clipped"));
  EXPECT_EQ(fit.left_out[1].frame, 5);
  EXPECT_THAT(fit.left_out[1].why, HasSubstr("above the noise"));
  EXPECT_EQ(fit.left_out[2].frame, 7);
  EXPECT_THAT(fit.left_out[2].why, HasSubstr("off the median"));
  EXPECT_NEAR(fit.level_db, TruthLevelDb(), 0.25);  // 3.5 standard errors of nine frames
}

// The fits believe in 60 dB from black to white; there are 75.
TEST_F(StandardTargetFitTest, TwoSpheresGiveTheSlopeOfTheDisplay) {
  RecordShortRanges();
  PlaceSphere(12, 3.0, 3.3, 0.5, 0.0);
  const auto fit_sphere = [&](double diameter_m) {
    options_.sphere.diameter_m = diameter_m;
    recording_.cross_section_m2 = PowerFromDb(TruthStrengthDb());
    return Fit();
  };
  const auto level = [](const StandardTargetFit& fit) {
    return TargetLevel{fit.level_db, fit.level_sigma_db, fit.received_db};
  };
  initial_.display.db_max = 160.0;
  const StandardTargetFit small = fit_sphere(kDiameterM);
  const StandardTargetFit large = fit_sphere(5.0 * kDiameterM);
  EXPECT_GT(std::abs(large.level_db - small.level_db), 2.0) << "the wrong display shows";
  const DisplaySlope slope = SlopeOfTwoTargets(level(large), level(small));
  EXPECT_NEAR(slope.db_per_shown_db, 1.25, 0.03);
  // The standard error contains those of the strengths, which are exact here.
  EXPECT_LT(std::abs(slope.db_per_shown_db - 1.25), 2.0 * slope.sigma);

  initial_.display.db_max = 100.0 + 60.0 * slope.db_per_shown_db;
  options_.display_sigma_share = slope.sigma / slope.db_per_shown_db;
  const StandardTargetFit again = Fit();
  EXPECT_NEAR(again.level_db, TruthLevelDb(), 1.0);
  EXPECT_NEAR(again.level_sigma_db,
              std::hypot(large.level_sigma_db, options_.display_sigma_share * (again.received_db - 100.0)),
              0.1);
  EXPECT_THROW(SlopeOfTwoTargets(level(large), level(large)), DataError);
}

TEST_F(StandardTargetFitTest, RecordingWithoutSphereIsRefused) {
  PlaceSphere(3, 3.0, 3.3, 0.5, 0.0);
  recording_.cross_section_m2 = 1e-20;
  try {
    Fit();
    FAIL();
  } catch (const DataError& error) {
    EXPECT_THAT(error.what(), HasSubstr("found in none of 3 frames"));
  }
}

// model.md, section 7: averaged over the band of the pulse, fresh water of 15 C.
TEST(SphereStrengthTest, PulseBandAndFrontFace) {
  SonarModel sonar = testing::MakeSonar(testing::EvenAzimuthsDeg(8, 0.3), 14.0, 1.0, 5.0, 100);
  sonar.frequency_hz = 1.8e6;
  sonar.sound_speed_m_per_s = 1465.94;
  const Water water{.temperature_c = 15.0, .salinity_ppt = 0.0};
  const StandardSphere sphere{.material = "wc", .diameter_m = 0.0254};
  // Half-power length of a pulse with 100 kHz.
  const double pulse_m = 0.886 * 1465.94 / (2.0 * 100e3);
  const SphereStrength whole = StrengthOfSphere(sphere, sonar, water, pulse_m);
  EXPECT_FALSE(whole.front_face);
  EXPECT_NEAR(whole.bandwidth_hz, 100e3, 1.0);
  EXPECT_NEAR(whole.db, -42.12, 0.35);
  EXPECT_GT(whole.sigma_db, 0.05);
  const SphereStrength front = StrengthOfSphere(sphere, sonar, water, 0.002);
  EXPECT_TRUE(front.front_face);
  // 20 log10(a / 2) + 20 log10(.972)
  EXPECT_NEAR(front.db, 20.0 * std::log10(0.0127 / 2.0) + 20.0 * std::log10(0.972), 0.01);
  EXPECT_LT(front.sigma_db, 0.01);
}

// Kell 1975 and the equation of state of seawater (UNESCO 1981).
TEST(SphereStrengthTest, DensityOfWater) {
  EXPECT_NEAR(WaterDensityKgPerM3({.temperature_c = 15.0, .salinity_ppt = 0.0}), 999.10, 1.0);
  EXPECT_NEAR(WaterDensityKgPerM3({.temperature_c = 30.0, .salinity_ppt = 0.0}), 995.65, 1.0);
  EXPECT_NEAR(WaterDensityKgPerM3({.temperature_c = 10.0, .salinity_ppt = 35.0}), 1026.95, 1.0);
  EXPECT_NEAR(WaterDensityKgPerM3({.temperature_c = 25.0, .salinity_ppt = 35.0}), 1023.34, 1.0);
  // The largest error within 0..30 C and 0..40 ppt.
  EXPECT_NEAR(WaterDensityKgPerM3({.temperature_c = 0.0, .salinity_ppt = 40.0}), 1032.15, 1.3);
}

}  // namespace
}  // namespace sonarcal::calib
