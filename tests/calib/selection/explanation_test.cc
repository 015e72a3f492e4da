// What each part of the model is worth, on SYNTHETIC frames whose parts are known.
#include "calib/selection/explanation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "calib/problem_builder.h"
#include "core/types/error.h"
#include "core/types/units.h"
#include "tests/calib/small_tank.h"

namespace sonarcal::calib {
namespace {

class ExplanationTest : public ::testing::Test {
 protected:
  static ParameterSet Truth(bool ghosts) {
    ParameterSet truth = testing::SmallTankAcousticTruth();
    truth.receiver.noise_db = 112.0;
    truth.display = {.db_min = 95.0, .db_max = 160.0};
    truth.pulse.length_m = 0.05;
    truth.materials["wall"].gsab = {.a = 0.3, .b_deg = 4.0, .c = 0.005, .d = 1.2, .e = 0.05, .f_deg = 12.0};
    truth.materials["board"] = truth.materials["wall"];
    if (ghosts) {
      truth.mirrors["floor"].loss_db = 3.0;
      truth.mirrors["wall"].loss_db = 4.0;
    }
    truth.beam.transmit_even_deg = 15.0;
    truth.beam.transmit_end_deg = 25.0;
    return truth;
  }

  static sim::SimulationOptions Options(int seed = 11) {
    sim::SimulationOptions options = testing::SmallTankOptions();
    options.bits = 8;
    options.noise = true;
    options.seed = seed;
    options.fan.elevation_span_deg = 100.0;
    return options;
  }

  struct Frames {
    std::vector<GreyFrame> used;
    std::vector<GreyFrame> held_out;
  };
  // Each pose. Held out: two of them, moved to the side. The frames used have 4,000 speckle cells. That is
  // enough, because ghosts gain nine of their standard errors, noise twelve.
  static Frames MakeFrames(const ParameterSet& truth, int seed = 11) {
    const sim::Simulator simulator(testing::SmallTankWithWall(), testing::SmallSonar(), Options(seed));
    Frames frames;
    int index = 0;
    for (const Pose& pose : testing::SmallTankPoses()) {
      for (const double aside_m : {0.0, 0.15}) {
        Pose at = pose;
        at.position_m.x() += aside_m;
        const bool held_out = index % 4 == 1;
        if (held_out || aside_m == 0.0) {
          (held_out ? frames.held_out : frames.used)
              .push_back(
                  {.index = index, .world_from_sonar = at, .image = simulator.Render(at, truth, index)});
        }
        ++index;
      }
    }
    return frames;
  }

  // What a user gives: mirrors by name with a loss that is anybody's guess.
  static ParameterSet Given() {
    ParameterSet given = Truth(true);
    for (auto& [name, mirror] : given.mirrors) mirror.loss_db = 8.0;
    for (auto& [name, material] : given.materials) material.gsab.c *= 2.0;
    return given;
  }

  static double ErrorOf(const ExplainedStep& step, const std::vector<GreyFrame>& held_out) {
    double sum = 0.0;
    const std::vector<PolarImage> expected = ExpectedGrey(step, held_out);
    for (std::size_t f = 0; f < held_out.size(); ++f) {
      for (std::size_t i = 0; i < expected[f].value.size(); ++i)
        sum += std::abs(expected[f].value.values()[i] - held_out[f].image.value.values()[i]);
    }
    return sum;
  }

  static const ExplainedStep& StepOf(const Explanation& explanation, ExplainedPart part) {
    return *std::find_if(explanation.steps.begin(), explanation.steps.end(),
                         [part](const ExplainedStep& step) { return step.part == part; });
  }

  static Scene OfOneMaterial() {
    Scene scene = testing::SmallTankWithWall();
    scene.material_names = {"wall"};
    std::fill(scene.triangle_material.begin(), scene.triangle_material.end(), std::uint16_t{0});
    return scene;
  }

  static ExplainOptions Explaining() {
    ExplainOptions options{.simulation = Options()};
    options.fit.max_iterations = 30;
    return options;
  }
};

TEST_F(ExplanationTest, GhostsAreSignificantIfTheTankHasThem) {
  const Frames frames = MakeFrames(Truth(true));
  const Explanation explanation = Explain(testing::SmallTankWithWall(), testing::SmallSonar(), frames.used,
                                          frames.held_out, Given(), Explaining());
  ASSERT_EQ(explanation.steps.size(), 7U);
  EXPECT_TRUE(explanation.left_out.empty());
  const ExplainedStep& before = StepOf(explanation, ExplainedPart::kMaterials);
  const ExplainedStep& ghosts = StepOf(explanation, ExplainedPart::kGhosts);
  EXPECT_EQ(ghosts.verdict, Verdict::kSignificant);
  EXPECT_GT(ghosts.gain.mean, 2.0 * ghosts.gain.sigma);
  EXPECT_LT(ghosts.bic_change, 0.0);
  EXPECT_LT(ErrorOf(ghosts, frames.held_out), ErrorOf(before, frames.held_out));
  EXPECT_EQ(StepOf(explanation, ExplainedPart::kNoise).verdict, Verdict::kSignificant);
  EXPECT_EQ(StepOf(explanation, ExplainedPart::kSpeckle).verdict, Verdict::kSignificant);
  EXPECT_TRUE(StepOf(explanation, ExplainedPart::kSpeckle).knows_speckle);
  EXPECT_LT(ErrorOf(explanation.steps.back(), frames.held_out),
            ErrorOf(explanation.steps.front(), frames.held_out));
  // By hand: the error of the image of which half of each pixel's law lies below. Before speckle that is what
  // is expected, by medians; with a single look ln 2 of the mean power.
  for (const ExplainedPart part : {ExplainedPart::kMaterials, ExplainedPart::kGhosts}) {
    const ExplainedStep& step = StepOf(explanation, part);
    const double pixels = step.error_held_out.Pixels();
    EXPECT_NEAR(255.0 * pixels * step.error_held_out.PerPixel(), ErrorOf(step, frames.held_out),
                0.01 * pixels);
  }
  EXPECT_LT(ghosts.error_change.mean, 0.0);
  const ExplainedStep& speckle = StepOf(explanation, ExplainedPart::kSpeckle);
  EXPECT_LT(speckle.error_held_out.PerPixel(),
            ErrorOf(speckle, frames.held_out) / 255.0 / speckle.error_held_out.Pixels())
      << "no image has a lower mean absolute error than the median";
  // By hand: the criteria are twice the nats of independent cells, and what values cost. The nats are those
  // of speckle about the images with and without ghosts.
  const sim::Simulator simulator(testing::SmallTankWithWall(), testing::SmallSonar(), Options());
  const auto nats_per_pixel = [&](const ExplainedStep& step) {
    ParameterSet with = step.parameters;
    const std::vector<AcousticFrame> recorded = FramesFor(frames.used, with.display);
    const std::vector<std::vector<double>> mean = MeanPowers(AcousticFrameModel(simulator, recorded, with));
    with.receiver.looks = BestLooks(frames.used, mean, with);
    return GreyLikelihood(frames.used, mean, with, 16, 8).PerPixel();
  };
  // Standard errors contain what neighbouring blocks share at their edges.
  const std::vector<AcousticFrame> held_out = FramesFor(frames.held_out, ghosts.parameters.display);
  const double at_edges =
      BlockSize(AcousticFrameModel(simulator, held_out, ghosts.parameters), Explaining().fit).variance_factor;
  EXPECT_GT(at_edges, 1.01);
  for (const ExplainedStep& step : explanation.steps) {
    EXPECT_DOUBLE_EQ(step.held_out.variance_factor, at_edges);
    EXPECT_DOUBLE_EQ(step.error_held_out.variance_factor, at_edges);
    EXPECT_DOUBLE_EQ(step.by_frame.front().likelihood.variance_factor, at_edges);
  }
  const double cells = explanation.pixels_used / explanation.pixels_per_cell;
  const double nats = cells * (nats_per_pixel(ghosts) - nats_per_pixel(before));
  const int values = ghosts.determined - before.determined;
  EXPECT_EQ(values, 2) << "the losses of floor and wall";
  EXPECT_NEAR(ghosts.aic_change, 2.0 * (values - nats), 1e-9);
  EXPECT_NEAR(ghosts.bic_change, values * std::log(cells) - 2.0 * nats, 1e-9);
}

// Under the normal law of grey values, ghosts are significant in one of six tanks without mirrors.
TEST_F(ExplanationTest, GhostsAreNotSignificantIfTheTankHasNone) {
  for (const int seed : {11, 12, 13, 14}) {
    const Frames frames = MakeFrames(Truth(false), seed);
    const Explanation explanation = Explain(testing::SmallTankWithWall(), testing::SmallSonar(), frames.used,
                                            frames.held_out, Given(), Explaining());
    EXPECT_NE(StepOf(explanation, ExplainedPart::kGhosts).verdict, Verdict::kSignificant) << "seed " << seed;
  }
}

// Pixels without an echo do not change a curve: before there is a noise floor its level is about the same as
// after.
TEST_F(ExplanationTest, WithoutMirrorsGhostsAreLeftOutAndCurvesAreNotBentByTheDark) {
  const Frames frames = MakeFrames(Truth(false));
  ParameterSet given = Given();
  given.mirrors.clear();
  const Explanation explanation = Explain(testing::SmallTankWithWall(), testing::SmallSonar(), frames.used,
                                          frames.held_out, given, Explaining());
  EXPECT_EQ(explanation.steps.size(), 6U);
  EXPECT_EQ(explanation.left_out.size(), 1U);
  EXPECT_THROW(
      Explain(testing::SmallTankWithWall(), testing::SmallSonar(), frames.used, {}, given, Explaining()),
      DataError);
  const ExplainedStep& before = StepOf(explanation, ExplainedPart::kElevation);
  const ExplainedStep& after = StepOf(explanation, ExplainedPart::kNoise);
  const auto level_db = [](const ExplainedStep& step) {
    return DbFromPower(step.parameters.materials.at("scene").gsab.c);
  };
  EXPECT_NEAR(level_db(before), level_db(after), 1.0);
  // Its own image has none all the same, and counts none as fitted.
  EXPECT_LT(*before.parameters.receiver.noise_db, *after.parameters.receiver.noise_db - 20.0);
  for (const FittedParameter& fitted : before.fitted) EXPECT_NE(fitted.name, "receiver.noise_db");
  EXPECT_GT(after.gain.mean, 2.0 * after.gain.sigma);
}

// Of a scene with a single material the step that gives each its own would be the one before it once more.
TEST_F(ExplanationTest, ASingleMaterialMakesNoStep) {
  Frames frames = MakeFrames(Truth(false));
  frames.used.resize(2);
  ParameterSet given = Given();
  given.mirrors.clear();
  const Explanation explanation =
      Explain(OfOneMaterial(), testing::SmallSonar(), frames.used, frames.held_out, given, Explaining());
  EXPECT_EQ(explanation.steps.size(), 5U);
  EXPECT_EQ(explanation.left_out.size(), 2U);
  EXPECT_TRUE(explanation.steps.back().parameters.materials.contains("wall"));
}

// The pulse keeps the value that the step before fitted, so it still counts. Both steps have one curve.
TEST_F(ExplanationTest, APulseCountsInStepsThatKeepItsFittedValue) {
  Frames frames = MakeFrames(Truth(false));
  frames.used.resize(2);
  ParameterSet given = Given();
  given.mirrors.clear();
  given.pulse.length_m = 0.0;
  const Explanation explanation =
      Explain(OfOneMaterial(), testing::SmallSonar(), frames.used, frames.held_out, given, Explaining());
  const ExplainedStep& response = StepOf(explanation, ExplainedPart::kResponse);
  const auto pulse = std::ranges::find(response.fitted, "pulse.length_m", &FittedParameter::name);
  ASSERT_NE(pulse, response.fitted.end());
  ASSERT_NE(pulse->status, ParameterStatus::kUnidentifiable);
  EXPECT_EQ(response.determined, explanation.steps.front().determined + 1);
  const ExplainedStep& elevation = StepOf(explanation, ExplainedPart::kElevation);
  EXPECT_EQ(elevation.determined, response.determined);
  EXPECT_EQ(elevation.parameters.pulse.length_m, response.parameters.pulse.length_m);
}

TEST(VerdictOnAStep, AStepIsSignificantOnlyIfLikelihoodAndErrorAgree) {
  const auto verdict = [](double gain, double bic, double error) {
    return VerdictOn({.mean = gain, .sigma = 0.1}, bic, {.mean = error, .sigma = 0.01}, 2.0);
  };
  EXPECT_EQ(verdict(0.3, -10.0, -0.05), Verdict::kSignificant);
  EXPECT_EQ(verdict(0.3, -10.0, 0.0), Verdict::kSignificant);
  EXPECT_EQ(verdict(0.3, -10.0, 0.019), Verdict::kSignificant) << "less than two standard errors";
  EXPECT_EQ(verdict(0.3, -10.0, 0.021), Verdict::kContradicted);
  EXPECT_EQ(verdict(0.3, 10.0, 0.021), Verdict::kNotSignificant) << "the criterion on the frames used rises";
  EXPECT_EQ(verdict(0.1, -10.0, -0.05), Verdict::kNotSignificant);
  EXPECT_EQ(verdict(-0.3, -10.0, 0.05), Verdict::kWorse);
  EXPECT_EQ(verdict(-0.3, -10.0, -0.021), Verdict::kContradicted);
}

// The plain law against its closed form: a normal law's mean log-likelihood about its own mean and spread.
TEST(NormalGreyLaw, IsFoundByMediansAndHasItsEntropy) {
  GreyFrame frame{
      .index = 0,
      .world_from_sonar = {},
      .image = PolarImage{
          testing::SmallSonar().axes,
          {.quantity = Quantity::kGrey, .full_scale = 255.0, .db_min = {}, .db_max = {}, .db_span = {}},
          Grid<float>(160, 48)}};
  std::vector<std::vector<double>> expected(1);
  constexpr double kSigma = 9.0;
  const std::size_t count = frame.image.value.size();
  for (std::size_t i = 0; i < count; ++i) {
    // Quantiles of a normal law by its inverse: erf(x) = 2 p - 1, by bisection.
    const double p = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    double low = -6.0;
    double high = 6.0;
    for (int k = 0; k < 60; ++k) {
      const double middle = 0.5 * (low + high);
      (0.5 * std::erfc(-middle / std::sqrt(2.0)) < p ? low : high) = middle;
    }
    expected[0].push_back(100.0);
    frame.image.value.values()[i] = static_cast<float>(std::lround(120.0 + kSigma * low));
  }
  const NormalGreyLaw law = FindNormalGreyLaw({frame}, expected);
  EXPECT_NEAR(law.offset, 20.0, 0.5);
  EXPECT_NEAR(law.sigma, kSigma, 0.6) << "medians of whole levels";
  const double entropy = 0.5 * std::log(2.0 * kPi * std::exp(1.0) * kSigma * kSigma);
  EXPECT_NEAR(-GreyLikelihood({frame}, expected, {.offset = 20.0, .sigma = kSigma}, 8, 8).PerPixel(), entropy,
              0.02);
}

}  // namespace
}  // namespace sonarcal::calib
