// Choice of the model by held-out likelihood: on small SYNTHETIC data whose beam, looks, trend and display
// are known, drawn from the acoustic model or made by point scatterers and an array.
#include "calib/selection/model_choice.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/types/units.h"
#include "sim/physics/speckle.h"
#include "tests/calib/small_tank.h"

namespace sonarcal::calib {
namespace {

using testing::SmallSonar;
using testing::SmallTank;
using testing::SmallTankAcousticTruth;
using testing::SmallTankOptions;
using testing::SmallTankPoses;

ParameterSet Truth() {
  ParameterSet truth = SmallTankAcousticTruth();
  truth.display = {.db_min = 105.0, .db_max = 170.0};
  truth.beam.elevation_pattern = ElevationPattern::kGaussian;
  truth.pulse.length_m = 1.5 * SmallSonar().axes.range_bin_m();
  return truth;
}

// The poses of the small tank, and the same a little aside.
std::vector<Pose> Poses(bool held_out, std::size_t count) {
  std::vector<Pose> poses = SmallTankPoses();
  poses.resize(count);
  for (Pose& pose : poses) {
    if (held_out) {
      pose.position_m += Eigen::Vector3d(0.15, 0.1, 0.05);
      pose.rotation = pose.rotation * RotationFromYawPitchRoll(RadFromDeg(5.0), RadFromDeg(2.0), 0.0);
    }
  }
  return poses;
}

// `elevation_span_deg`: 0 for the sonar's own beam width.
sim::SimulationOptions Noisy(double elevation_span_deg = 0.0) {
  sim::SimulationOptions options = SmallTankOptions();
  options.bits = 8;
  options.noise = true;
  options.seed = 11;
  options.fan.elevation_span_deg = elevation_span_deg;
  return options;
}

class ModelChoiceTest : public ::testing::Test {
 protected:
  explicit ModelChoiceTest(double elevation_span_deg = 0.0)
      : simulator_(SmallTank(), SmallSonar(), Noisy(elevation_span_deg)) {}

  std::vector<GreyFrame> Record(const ParameterSet& truth, bool held_out, std::size_t count = 2) const {
    std::vector<GreyFrame> frames;
    for (const Pose& pose : Poses(held_out, count)) {
      const int index = static_cast<int>(frames.size()) + (held_out ? 4 : 0);
      frames.push_back(
          {.index = index, .world_from_sonar = pose, .image = simulator_.Render(pose, truth, index)});
    }
    return frames;
  }

  // Starts from the curves of the truth: a fit of them is tested elsewhere. Two frames are enough for axes
  // whose variants differ in many pixels. Azimuth patterns differ in few, and need all four.
  ModelChoice Choose(const ParameterSet& truth, const ParameterSet& start,
                     const std::vector<ChoiceAxis>& axes, std::size_t frames = 2) const {
    ModelChoiceOptions options{.axes = axes};
    options.fit.starts = 1;
    FitConfig config;
    config.free = {"materials", "receiver.noise_db"};
    return ChooseModel(simulator_, Record(truth, false, frames), Record(truth, true, frames), start, config,
                       options);
  }

  static const JudgedVariant& Find(const JudgedAxis& axis, const std::string& name) {
    const auto found = std::find_if(axis.variants.begin(), axis.variants.end(),
                                    [&](const JudgedVariant& variant) { return variant.name == name; });
    if (found == axis.variants.end()) throw std::runtime_error("no variant " + name);
    return *found;
  }

  static std::string Describe(const ModelChoice& choice) {
    std::string text;
    for (const JudgedAxis& axis : choice.axes) {
      for (const JudgedVariant& variant : axis.variants) {
        text += fmt::format("{} {}: {:.5f}, behind {:.5f} +- {:.5f}{}\n", ToString(axis.axis), variant.name,
                            variant.nats_per_pixel, variant.behind.mean, variant.behind.sigma,
                            variant.chosen ? ", chosen" : "");
      }
    }
    return text;
  }

  static void ExpectWorse(const JudgedVariant& variant) {
    EXPECT_FALSE(variant.tied) << variant.name;
    EXPECT_GT(variant.behind.mean, variant.behind.sigma) << variant.name;
    EXPECT_GT(variant.behind.sigma, 0.0) << variant.name;
    EXPECT_FALSE(variant.chosen) << variant.name;
  }

  sim::Simulator simulator_;
};

// With rays where a beam of 20 degrees has its side lobes.
class WideModelChoiceTest : public ModelChoiceTest {
 protected:
  WideModelChoiceTest() : ModelChoiceTest(120.0) {}
};

TEST_F(ModelChoiceTest, AnUnshadedArrayWithTwoLooksIsFound) {
  ParameterSet truth = Truth();
  truth.beam.azimuth_taper = 0.0;
  truth.receiver.looks = 2.0;
  const ModelChoice choice =
      Choose(truth, Truth(), {ChoiceAxis::kPattern, ChoiceAxis::kLooks, ChoiceAxis::kTrend}, 4);
  SCOPED_TRACE(Describe(choice));
  ASSERT_EQ(choice.axes.size(), 3U);
  const JudgedAxis& pattern = choice.axes[0];
  ASSERT_EQ(pattern.variants.size(), 4U);
  EXPECT_TRUE(Find(pattern, "aperture, taper 0").chosen);
  ExpectWorse(Find(pattern, "Gaussian"));
  ExpectWorse(Find(pattern, "aperture, taper 1"));
  EXPECT_EQ(choice.parameters.beam.azimuth_pattern, AzimuthPattern::kAperture);
  EXPECT_EQ(choice.parameters.beam.azimuth_taper, 0.0);

  ExpectWorse(Find(choice.axes[1], "1"));
  EXPECT_NEAR(choice.parameters.receiver.looks, 2.0, 0.15);

  // There is no trend: freeing it gains nothing, and is not chosen.
  EXPECT_TRUE(Find(choice.axes[2], "none").chosen);
  EXPECT_TRUE(Find(choice.axes[2], "none").tied);
  EXPECT_LT(
      std::abs(Find(choice.axes[2], "free").nats_per_pixel - Find(choice.axes[2], "none").nats_per_pixel),
      1e-3);
  EXPECT_EQ(choice.frames_chosen_on, (std::vector<int>{4, 5, 6, 7}));
}

TEST_F(ModelChoiceTest, ATrendOfTheNoiseIsFoundWhereThereIsOne) {
  ParameterSet truth = Truth();
  truth.receiver.noise_slope_db_per_m = 0.8;
  const ModelChoice choice = Choose(truth, Truth(), {ChoiceAxis::kTrend, ChoiceAxis::kLooks});
  SCOPED_TRACE(Describe(choice));
  EXPECT_TRUE(Find(choice.axes[0], "free").chosen);
  ExpectWorse(Find(choice.axes[0], "none"));
  EXPECT_THAT(*choice.config.free, ::testing::Contains("receiver.noise_slope_db_per_m"));
  // One look is one look.
  EXPECT_TRUE(Find(choice.axes[1], "1").chosen);
  EXPECT_EQ(choice.parameters.receiver.looks, 1.0);
}

TEST_F(WideModelChoiceTest, AnElevationPatternIsFound) {
  ParameterSet truth = Truth();
  truth.beam.elevation_width_deg = 20.0;
  ParameterSet start = truth;
  truth.beam.elevation_pattern = ElevationPattern::kAperture;
  truth.beam.elevation_taper = 0.0;
  const ModelChoice choice = Choose(truth, start, {ChoiceAxis::kElevation});
  SCOPED_TRACE(Describe(choice));
  ASSERT_EQ(choice.axes[0].variants.size(), 4U);
  EXPECT_TRUE(Find(choice.axes[0], "aperture, taper 0").chosen);
  ExpectWorse(Find(choice.axes[0], "Gaussian"));
  EXPECT_EQ(choice.parameters.beam.elevation_pattern, ElevationPattern::kAperture);
  EXPECT_EQ(choice.parameters.beam.elevation_taper, 0.0);
}

TEST_F(ModelChoiceTest, ASoftenedDisplayIsFound) {
  ParameterSet truth = Truth();
  truth.display.law = DisplayLaw::kSoftAmplitude;
  truth.display.soft_db = 122.0;
  truth.display.db_min = 112.0;
  ParameterSet start = truth;
  start.display.law = DisplayLaw::kLog;
  const ModelChoice choice = Choose(truth, start, {ChoiceAxis::kDisplay});
  const JudgedAxis& axis = choice.axes[0];
  SCOPED_TRACE(Describe(choice));
  ExpectWorse(Find(axis, "logarithm"));
  EXPECT_EQ(choice.parameters.display.law, DisplayLaw::kSoftAmplitude);
  EXPECT_NEAR(choice.parameters.display.soft_db, 122.0, 1.0);
  EXPECT_EQ(choice.parameters.display.db_min, truth.display.db_min);

  const ModelChoice plain = Choose(Truth(), Truth(), {ChoiceAxis::kDisplay});
  EXPECT_EQ(plain.parameters.display, Truth().display) << "a plain logarithm stays one";
}

// An array of elements with a Hann taper, which knows nothing of the model that is chosen.
TEST_F(ModelChoiceTest, TheTaperOfAnArrayOfElementsIsFound) {
  ParameterSet truth = Truth();
  truth.model = EchoModel::kCoherent;
  ParameterSet start = Truth();
  start.beam.azimuth_taper = 0.0;
  const ModelChoice choice =
      Choose(truth, start, {ChoiceAxis::kPattern, ChoiceAxis::kLooks, ChoiceAxis::kTrend}, 4);
  const JudgedAxis& pattern = choice.axes[0];
  SCOPED_TRACE(Describe(choice));
  EXPECT_TRUE(Find(pattern, "aperture, taper 1").tied);
  ExpectWorse(Find(pattern, "aperture, taper 0"));
  EXPECT_TRUE(Find(choice.axes[1], "1").chosen);
  EXPECT_TRUE(Find(choice.axes[2], "none").chosen);
}

TEST_F(ModelChoiceTest, AxesThatDoNotApplyAreRefused) {
  const std::vector<GreyFrame> frames = Record(Truth(), false);
  EXPECT_THROW(ChooseModel(simulator_, frames, {}, Truth(), {}, {.axes = {ChoiceAxis::kLooks}}), DataError);
  ParameterSet power = Truth();
  power.display = {.db_min = 0.0, .db_max = 165.0, .law = DisplayLaw::kPower, .exponent = 0.5};
  FitConfig config;
  config.free = {"receiver.noise_db"};
  EXPECT_THROW(
      ChooseModel(simulator_, frames, Record(Truth(), true), power, config, {.axes = {ChoiceAxis::kDisplay}}),
      DataError);
  EXPECT_THROW(ChooseModel(simulator_, frames, Record(Truth(), true), Truth(), config,
                           {.axes = {ChoiceAxis::kMirrors}}),
               DataError)
      << "there is no mirror";
}

GreyFrame Flat(int bins, int beams, float grey) {
  PolarImage image{
      {0.0, 1.0, bins, {}},
      {.quantity = Quantity::kGrey, .full_scale = 15.0, .db_min = {}, .db_max = {}, .db_span = {}},
      Grid<float>(bins, beams, grey)};
  for (int beam = 0; beam < beams; ++beam) image.axes.beam_azimuth_rad.push_back(0.01 * beam);
  return {.index = 0, .world_from_sonar = {}, .image = std::move(image)};
}

TEST(GreyLikelihoodTest, ChancesAreThoseOfTheDisplayAndAddUpToOne) {
  ParameterSet parameters;
  parameters.display = {.db_min = -20.0, .db_max = 20.0};
  for (const double looks : {1.0, 1.7}) {
    parameters.receiver.looks = looks;
    double sum = 0.0;
    for (int level = 0; level <= 15; ++level) {
      const BlockedLikelihood of =
          GreyLikelihood({Flat(1, 1, static_cast<float>(level))}, {{3.0}}, parameters, 1, 1);
      const double upper =
          level == 15 ? 1.0 : sim::DisplayedCdf(parameters.display, looks, 3.0, (level + 0.5) / 15.0);
      const double lower =
          level == 0 ? 0.0 : sim::DisplayedCdf(parameters.display, looks, 3.0, (level - 0.5) / 15.0);
      EXPECT_NEAR(std::exp(of.PerPixel()),
                  (1.0 - kOutlierFraction) * (upper - lower) + kOutlierFraction / 16.0, 1e-12)
          << level;
      sum += std::exp(of.PerPixel());
    }
    EXPECT_NEAR(sum, 1.0, 1e-12);
  }
}

TEST(GreyLikelihoodTest, FramesOfOnePoseShareTheirBlocks) {
  ParameterSet parameters;
  parameters.display = {.db_min = -20.0, .db_max = 20.0};
  GreyFrame moved = Flat(4, 6, 7.0F);
  moved.world_from_sonar.position_m.x() = 1.0;
  const std::vector<double> mean(24, 1.0);
  const BlockedLikelihood of =
      GreyLikelihood({Flat(4, 6, 7.0F), moved, Flat(4, 6, 7.0F)}, {mean, mean, mean}, parameters, 3, 4);
  // 2 x 2 blocks of each of two poses, the first of which is seen twice.
  ASSERT_EQ(of.pixels.size(), 8U);
  EXPECT_EQ(of.pixels[0], 2.0 * 12.0);
  EXPECT_EQ(of.pixels[3], 2.0 * 2.0);
  EXPECT_EQ(of.pixels[4], 12.0);
  EXPECT_EQ(of.Pixels(), 72.0);
}

TEST(LikelihoodDifferenceTest, StandardErrorIsThatOfAMeanOfBlocks) {
  const BlockedLikelihood a{.nats = {10.0, 14.0, 9.0, 15.0}, .pixels = {2.0, 2.0, 2.0, 2.0}};
  const BlockedLikelihood b{.nats = {8.0, 8.0, 8.0, 8.0}, .pixels = {2.0, 2.0, 2.0, 2.0}};
  const LikelihoodDifference difference = Difference(a, b);
  // Differences a pixel: 1, 3, 0.5, 3.5; mean 2, standard deviation sqrt((1 + 1 + 2.25 + 2.25) / 3).
  EXPECT_NEAR(difference.mean, 2.0, 1e-12);
  EXPECT_NEAR(difference.sigma, std::sqrt(6.5 / 3.0 / 4.0), 1e-12);
  EXPECT_NEAR(Difference(b, a).mean, -2.0, 1e-12);
}

TEST_F(ModelChoiceTest, TheChosenNumberOfLooksIsThatOfTheSamples) {
  ParameterSet truth = Truth();
  for (const double looks : {1.0, 4.0}) {
    truth.receiver.looks = looks;
    const std::vector<GreyFrame> frames = Record(truth, false, 4);
    std::vector<AcousticFrame> acoustic;
    for (const GreyFrame& frame : frames) {
      acoustic.push_back({.index = frame.index,
                          .world_from_sonar = frame.world_from_sonar,
                          .recorded = RecordedPowers(frame.image, truth.display)});
    }
    const AcousticFrameModel model(simulator_, acoustic, truth);
    std::vector<std::vector<double>> means;
    for (int frame = 0; frame < model.frame_count(); ++frame)
      means.push_back(model.MeanPower(frame, model.initial_values()));
    EXPECT_NEAR(BestLooks(frames, means, truth), looks, 0.05 * looks);
  }
}

}  // namespace
}  // namespace sonarcal::calib
