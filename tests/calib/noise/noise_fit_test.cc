#include "calib/noise/noise_fit.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>

#include "calib/noise/background_display.h"
#include "calib/noise/noise_form.h"
#include "calib/noise/noise_information.h"
#include "calib/noise/noise_solver.h"
#include "calib/noise/quantile_residual.h"
#include "core/math/random.h"
#include "core/types/error.h"
#include "core/types/units.h"
#include "sim/physics/display.h"

namespace sonarcal::calib {
namespace {

constexpr int kBeams = 6;

// Synthetic pings, drawn from a law itself: independent pixels, no drift.
struct Source {
  NoiseLaw law;
  RecordingInfo info;

  explicit Source(NoiseLaw of, int bins = 128) : law(std::move(of)) {
    info.source = "synthetic pings";
    info.synthetic = true;
    info.sonar.axes.range_min_m = 2.0;
    info.sonar.axes.range_max_m = 10.0;
    info.sonar.axes.range_bins = bins;
    for (int beam = 0; beam < kBeams; ++beam) info.sonar.axes.beam_azimuth_rad.push_back(0.01 * beam);
    info.scale.full_scale = 255.0;
  }

  MemoryRecording Draw(int pings, std::uint64_t seed) const {
    const PolarAxes& axes = info.sonar.axes;
    std::vector<Frame> frames;
    std::mt19937_64 textures(seed);
    const double textured = 1.0 - law.receiver.diffuse_share;
    const double shape = 2.0 * textured * textured * law.receiver.looks / (1.0 - law.receiver.looks);
    for (int ping = 0; ping < pings; ++ping) {
      const CounterRandom random(seed, static_cast<std::uint32_t>(ping));
      Frame frame{{}, {axes, info.scale, Grid<float>(axes.range_bins, kBeams)}};
      for (std::size_t i = 0; i < frame.image.value.size(); ++i) {
        const int bin = static_cast<int>(i) / kBeams;
        const double mean =
            sim::NoisePower(law.receiver, axes.range_centre_m(bin), static_cast<int>(i) % kBeams, 0.0);
        const auto [u, v] = random.Uniform2(i);
        double power = mean * -std::log(u);
        if (law.receiver.looks < 1.0) {
          power *= textured * std::gamma_distribution<double>(shape, 1.0 / shape)(textures) +
                   law.receiver.diffuse_share;
        } else {
          const auto [whole, last] = sim::LooksAsWeights(law.receiver.looks);
          power = mean * (-std::log(u) - last * std::log(v)) / (1.0 + last);
        }
        const double value = std::clamp(sim::DisplayValue(law.display, power), 0.0, 1.0);
        frame.image.value.values()[i] = static_cast<float>(std::round(255.0 * value));
      }
      frames.push_back(std::move(frame));
    }
    return {info, std::move(frames)};
  }
};

NoiseLaw TwoFloors() {
  NoiseLaw law;
  law.display = {.db_min = 0.0, .db_max = 60.0, .law = DisplayLaw::kSoftLog, .soft_db = -1.7};
  law.receiver.noise_db = 6.0;
  law.receiver.noise_slope_db_per_m = -1.5;
  law.receiver.noise_taper_db = {-4.0, -1.0, 2.0, 3.0, 1.0, -1.0};
  law.receiver.noise_after_gain_db = -3.0;
  law.receiver.noise_after_gain_taper_db = {0.5, -0.5, 0.0, 0.2, -0.2, 0.0};
  return law;
}

NoiseLaw Logarithm(double looks) {
  NoiseLaw law;
  law.display = {.db_min = 0.0, .db_max = 80.0};
  law.receiver.noise_db = 22.0;
  law.receiver.noise_slope_db_per_m = 0.5;
  law.receiver.noise_taper_db = {-2.0, 0.0, 1.0, 1.0, 0.0, 0.0};
  law.receiver.looks = looks;
  return law;
}

NoiseLaw TextureAndDiffuse(double looks, double diffuse_share) {
  NoiseLaw law = Logarithm(looks);
  law.receiver.diffuse_share = diffuse_share;
  law.speckle = sim::SpeckleLaw::kKDiffuse;
  return law;
}

NoiseCells CellsOf(const Source& source) {
  return {.axes = source.info.sonar.axes, .first_bin = 0, .last_bin = 128, .band_bins = 8, .full_scale = 255};
}

NoiseCounts CountsOf(const MemoryRecording& recording, const NoiseCells& cells) {
  std::vector<NoiseCounts> pings;
  pings.reserve(recording.frame_count());
  for (int i = 0; i < recording.frame_count(); ++i) {
    pings.push_back(CountGrey(recording.ReadFrame(i).image, cells));
  }
  return AddCounts(pings, cells);
}

TEST(NoiseLikelihoodTest, ChancesAddUpToOneAndDerivativesAreTheirs) {
  for (NoiseLaw law : {TwoFloors(), Logarithm(1.4)}) {
    for (const sim::SpeckleLaw speckle : {sim::SpeckleLaw::kGamma, sim::SpeckleLaw::kWeighted,
                                          sim::SpeckleLaw::kK, sim::SpeckleLaw::kKDiffuse}) {
      law.speckle = speckle;
      if (speckle == sim::SpeckleLaw::kK) law.receiver.looks = 0.6;
      if (speckle == sim::SpeckleLaw::kKDiffuse) law.receiver.diffuse_share = 0.3;
      const GreyLevels grey(law, 255);
      const double power = 3.0;
      double sum = 0.0;
      for (int level = 0; level < 256; ++level) sum += grey.OfLevel(level, power).value;
      EXPECT_NEAR(sum, 1.0, 1e-9);

      NoiseLaw moved = law;
      constexpr double kStep = 1e-4;
      for (const int level : {0, 9, 40}) {
        const GreyLevels::Chance chance = grey.OfLevel(level, power);
        const double by_noise = (grey.OfLevel(level, power * std::exp(kStep)).value -
                                 grey.OfLevel(level, power * std::exp(-kStep)).value) /
                                (2.0 * kStep);
        EXPECT_NEAR(chance.derivative[0], by_noise, 1e-6);
        moved = law;
        moved.display.db_max += kStep;
        EXPECT_NEAR(chance.derivative[2],
                    (GreyLevels(moved, 255).OfLevel(level, power).value - chance.value) / kStep, 1e-5);
        moved = law;
        moved.display.soft_db += kStep;
        EXPECT_NEAR(chance.derivative[3],
                    (GreyLevels(moved, 255).OfLevel(level, power).value - chance.value) / kStep, 1e-5);
        moved = law;
        moved.receiver.looks *= std::exp(kStep);
        EXPECT_NEAR(chance.derivative[1],
                    (GreyLevels(moved, 255).OfLevel(level, power).value - chance.value) / kStep, 1e-4);
        moved = law;
        const double odds = law.receiver.diffuse_share / (1.0 - law.receiver.diffuse_share) * std::exp(kStep);
        moved.receiver.diffuse_share = odds / (1.0 + odds);
        EXPECT_NEAR(chance.derivative[4],
                    (GreyLevels(moved, 255).OfLevel(level, power).value - chance.value) / kStep, 1e-4);
        EXPECT_EQ(chance.derivative[4] != 0.0, speckle == sim::SpeckleLaw::kKDiffuse);
      }
    }
  }
}

// By numbers: the place in the interval drawn, its quantile found by bisection.
TEST(QuantileResidualTest, AveragesOverTheInterval) {
  const auto quantile = [](double chance) {
    double low = -40.0;
    double high = 40.0;
    for (int i = 0; i < 100; ++i) {
      const double middle = 0.5 * (low + high);
      (0.5 * std::erfc(-middle / std::numbers::sqrt2) < chance ? low : high) = middle;
    }
    return low;
  };
  for (const auto& [from, to] : {std::pair{0.0, 0.3}, {0.2, 0.7}, {0.45, 0.451}, {0.6, 1.0}}) {
    const QuantileMoments moments = QuantileResidual({from, 1.0 - from}, {to, 1.0 - to});
    double mean = 0.0;
    double square = 0.0;
    constexpr int kSteps = 20000;
    for (int i = 0; i < kSteps; ++i) {
      const double z = quantile(from + (to - from) * (i + 0.5) / kSteps);
      mean += z / kSteps;
      square += z * z / kSteps;
    }
    EXPECT_NEAR(moments.mean, mean, 2e-4);
    EXPECT_NEAR(moments.square, square, 1e-3);
  }
  // Far in a tail, and where the law gives the interval no chance, still numbers.
  EXPECT_NEAR(QuantileResidual({1.0, 1e-20}, {1.0, 1e-21}).mean, 9.3, 0.1);
  EXPECT_NEAR(QuantileResidual({1.0, 0.0}, {1.0, 0.0}).mean, 37.0, 0.1);
  EXPECT_NEAR(QuantileResidual({0.0, 1.0}, {0.0, 1.0}).mean, -37.0, 0.1);
}

TEST(NoiseLikelihoodTest, WhitenedResidualsAreStandardUnderTheTrueLawOnly) {
  for (const NoiseLaw& law : {TwoFloors(), Logarithm(1.0)}) {
    const Source source(law);
    const NoiseCells cells = CellsOf(source);
    const NoiseCounts counts = CountsOf(source.Draw(20, 8), cells);
    // 15360 pixels: one standard deviation of the mean is 0.008, of the spread 0.006. A cell takes the level
    // of its middle for its 8 bins, which adds 0.01 or so to the spread.
    const NoiseAgreement truth = Agreement(law, counts, cells, {}, 0.0);
    EXPECT_NEAR(truth.whitened.mean, 0.0, 0.03);
    EXPECT_NEAR(truth.whitened.spread, 1.0, 0.03);
    EXPECT_NEAR(truth.raw.mean, 0.0, 0.003);
    NoiseLaw quieter = law;
    *quieter.receiver.noise_db -= 2.0;
    EXPECT_GT(Agreement(quieter, counts, cells, {}, 0.0).whitened.mean, 0.15);
    NoiseLaw narrower = law;
    narrower.display.db_max += 15.0;
    EXPECT_GT(Agreement(narrower, counts, cells, {}, 0.0).whitened.spread, 1.1);
  }
}

TEST(NoiseSolverTest, ScoreIsTheDerivativeOfTheLikelihood) {
  const Source source(TwoFloors());
  const NoiseCells cells = CellsOf(source);
  const NoiseCounts counts = CountsOf(source.Draw(3, 5), cells);
  NoiseFitOptions options;
  options.max_iterations = 0;  // stay at the start, away from the optimum
  const NoiseSolution at = SolveNoise(TwoFloors(), true, counts, cells, {}, options);
  const Eigen::VectorXd score = NoiseScore(at, counts, cells, {}, 0.0);
  double pixels = 3.0 * 128 * kBeams;
  const auto log_likelihood = [&](const NoiseLaw& law) {
    return -pixels * Agreement(law, counts, cells, {}, 0.0).nats_per_pixel;
  };
  const auto check = [&](int place, double& number, NoiseLaw& law) {
    const double kept = number;
    number = kept + 1e-4;
    const double up = log_likelihood(law);
    number = kept - 1e-4;
    const double down = log_likelihood(law);
    number = kept;
    EXPECT_NEAR(score[place], (up - down) / 2e-4, 2e-3 * (1.0 + std::abs(score[place]))) << place;
  };
  NoiseLaw law = at.law;
  check(at.layout.noise_db, *law.receiver.noise_db, law);
  check(at.layout.slope, law.receiver.noise_slope_db_per_m, law);
  check(at.layout.after_db, *law.receiver.noise_after_gain_db, law);
  check(at.layout.span_db, law.display.db_max, law);
  check(at.layout.soft_db, law.display.soft_db, law);
  check(at.layout.taper + 2, law.receiver.noise_taper_db[2], law);
  check(at.layout.after_taper + 4, law.receiver.noise_after_gain_taper_db[4], law);
}

TEST(NoiseSolverTest, ScoreByLooksAndDiffuseShareIsTheDerivativeOfTheLikelihood) {
  const Source source(TextureAndDiffuse(0.4, 0.5));
  const NoiseCells cells = CellsOf(source);
  const NoiseCounts counts = CountsOf(source.Draw(3, 5), cells);
  NoiseFitOptions options;
  options.max_iterations = 0;
  const NoiseSolution at = SolveNoise(TextureAndDiffuse(0.7, 0.2), false, counts, cells, {}, options);
  const Eigen::VectorXd score = NoiseScore(at, counts, cells, {}, 0.0);
  ASSERT_GE(at.layout.logit_diffuse, 0);
  const auto log_likelihood = [&](double log_looks, double logit_share) {
    NoiseLaw law = at.law;
    const double odds =
        law.receiver.diffuse_share / (1.0 - law.receiver.diffuse_share) * std::exp(logit_share);
    law.receiver.looks *= std::exp(log_looks);
    law.receiver.diffuse_share = odds / (1.0 + odds);
    return -3.0 * 128 * kBeams * Agreement(law, counts, cells, {}, 0.0).nats_per_pixel;
  };
  constexpr double kStep = 1e-4;
  EXPECT_NEAR(score[at.layout.log_looks],
              (log_likelihood(kStep, 0.0) - log_likelihood(-kStep, 0.0)) / (2.0 * kStep), 0.01);
  EXPECT_NEAR(score[at.layout.logit_diffuse],
              (log_likelihood(0.0, kStep) - log_likelihood(0.0, -kStep)) / (2.0 * kStep), 0.01);
}

// x = power / N is exponential: its score in ln N is x - 1, of variance 1. Quantisation takes a little.
TEST(NoiseInformationTest, OfAnExponentialPixelIsOne) {
  const NoiseLaw law = Logarithm(1.0);
  const GreyLevels grey(law, 255);
  const double power = PowerFromDb(35.0);  // neither clip is near
  const PixelInformation information = ExpectedInformation(grey, 255, power);
  EXPECT_NEAR(information(0, 0), 1.0, 0.01);
  const InformationTable table(grey, 255, 0.01 * power, 100.0 * power);
  for (const double ratio : {0.01, 0.037, 0.9, 1.0, 100.0}) {
    const PixelInformation at = ExpectedInformation(grey, 255, ratio * power);
    for (int i : {0, 2}) EXPECT_NEAR(table(ratio * power)(i, i), at(i, i), 0.01 * at(i, i)) << ratio;
  }
}

TEST(NoiseSolverTest, FindsTheOptimumFromFarAway) {
  for (const NoiseLaw& law : {Logarithm(1.0), TwoFloors()}) {
    const Source source(law);
    const NoiseCells cells = CellsOf(source);
    const NoiseCounts counts = CountsOf(source.Draw(12, 6), cells);
    const bool fit_span = law.display.law == DisplayLaw::kSoftLog;
    NoiseFitOptions options;
    options.level_spread_db = 1e4;  // the prior is about the start: it must not tell the two apart
    options.max_iterations = 60;
    const NoiseSolution near = SolveNoise(law, fit_span, counts, cells, {}, options);
    NoiseLaw start = law;
    *start.receiver.noise_db -= 30.0;
    const NoiseSolution far = SolveNoise(start, fit_span, counts, cells, {}, options);
    EXPECT_TRUE(near.converged);
    EXPECT_TRUE(far.converged);
    EXPECT_NEAR(far.cost, near.cost, 0.5);
    EXPECT_TRUE(far.value.allFinite());
  }
}

// Targets stay in. The outer product of a target's scores is thousands of times its information, and steps
// by it as much too small: one floor took 300 of them, and two floors ended at a damping of 1e146.
TEST(NoiseSolverTest, ConvergesWhereSomePixelsAreFarTooBright) {
  Source source(Logarithm(1.0));
  const NoiseCells cells = CellsOf(source);
  Frame frame = source.Draw(1, 3).ReadFrame(0);
  for (int bin = 60; bin < 75; ++bin) {
    for (int beam = 2; beam < 4; ++beam) frame.image.value(bin, beam) += 60.0f;
  }
  const NoiseCounts counts = CountGrey(frame.image, cells);
  NoiseForm form{.display = source.law.display, .floor_after_gain = false};
  NoiseFitOptions options;
  options.max_iterations = 40;
  const NoiseSolution one =
      SolveNoise(StartOf(form, counts, cells, 0.0, 0.0), false, counts, cells, {}, options);
  EXPECT_TRUE(one.converged);
  form.floor_after_gain = true;
  options.max_iterations = 200;
  const NoiseSolution two =
      SolveNoise(StartOf(form, counts, cells, 8.0, 0.0), false, counts, cells, {}, options);
  EXPECT_TRUE(two.converged);
  EXPECT_LE(two.cost, one.cost + 3.0);  // two floors can do what one does, but for what priors take
}

// The same pixels on displays that begin far below 0 dB, at it and above: the start moves with the display.
TEST(NoiseFitTest, TheStartFollowsTheDisplay) {
  const Source source(Logarithm(1.0));
  const Frame frame = source.Draw(1, 3).ReadFrame(0);
  const NoiseCells cells = CellsOf(source);
  const NoiseCounts counts = CountGrey(frame.image, cells);
  const auto start_at = [&](double db_min) {
    NoiseForm form{.display = source.law.display, .fit_soft_db = true};
    form.display.law = DisplayLaw::kSoftLog;
    form.display.db_max = db_min + source.law.display.db_max - source.law.display.db_min;
    form.display.db_min = db_min;
    return StartOf(form, counts, cells, 0.0, 0.0);
  };
  const NoiseLaw at_zero = start_at(0.0);
  ASSERT_TRUE(std::isfinite(*at_zero.receiver.noise_db));
  for (const double db_min : {-200.0, -60.0, 90.0}) {
    EXPECT_NEAR(*start_at(db_min).receiver.noise_db, *at_zero.receiver.noise_db + db_min, 1e-6) << db_min;
    EXPECT_NEAR(start_at(db_min).display.soft_db, at_zero.display.soft_db + db_min, 1e-6) << db_min;
  }
}

// A still picture that is repeated: its pings do not differ, and tell no more than one of them.
TEST(NoiseFitTest, EqualPingsAreNotTakenForCertain) {
  const Source source(Logarithm(1.0));
  const Frame frame = source.Draw(1, 7).ReadFrame(0);
  NoiseFitOptions options;
  options.choose_held_out = false;
  options.hold_out_bands = true;
  const NoiseFit fit = FitNoise(MemoryRecording(source.info, std::vector<Frame>(6, frame)), options);
  const FittedParameter* noise = fit.report.Find("receiver.noise_db");
  ASSERT_NE(noise, nullptr);
  ASSERT_TRUE(noise->sigma.has_value());
  EXPECT_GT(*noise->sigma, 0.01);
}

TEST(NoiseFitTest, NoCandidateIsChosenThatHasNotConverged) {
  Source source(Logarithm(1.0));
  source.info.scale.db_span = 80.0;
  NoiseFitOptions options;
  options.max_iterations = 1;
  const NoiseFit fit = FitNoise(source.Draw(6, 7), options);
  EXPECT_FALSE(fit.usable);
  ASSERT_FALSE(fit.choices.empty());
  for (const NoiseModelChoice& choice : fit.choices) {
    EXPECT_FALSE(choice.converged);
    EXPECT_FALSE(choice.chosen);
  }
  EXPECT_EQ(fit.report.termination, "ended before any candidate converged");
}

TEST(NoiseFitTest, FindsTheWindowWithoutStructure) {
  Source source(Logarithm(1.0), 512);
  source.info.scale.db_span = 80.0;
  const MemoryRecording clean = source.Draw(3, 9);
  std::vector<Frame> frames;
  for (int i = 0; i < clean.frame_count(); ++i) {
    frames.push_back(clean.ReadFrame(i));
    // Objects on the near half, each over 12 bins and two beams.
    for (int bin = 0; bin < 256; ++bin) {
      for (int beam = 0; beam < kBeams; ++beam) {
        if ((bin / 12 + beam / 2) % 3 == 0) frames.back().image.value(bin, beam) += 40.0f;
      }
    }
  }
  NoiseFitOptions options;
  options.find_background = true;
  const NoiseFit fit = FitNoise(MemoryRecording(source.info, frames), options);
  ASSERT_TRUE(fit.usable);
  EXPECT_TRUE(fit.window_found);
  EXPECT_GE(fit.cells.first_bin, 256);
  EXPECT_GE(fit.cells.last_bin - fit.cells.first_bin, 100);
}

TEST(NoiseFitTest, FindsTheLawThatSyntheticPingsWereDrawnFrom) {
  const Source source(TwoFloors());
  const NoiseFit fit = FitNoise(source.Draw(300, 1), {});
  ASSERT_TRUE(fit.usable);
  EXPECT_EQ(fit.law.display.law, DisplayLaw::kSoftLog);
  EXPECT_TRUE(fit.law.receiver.noise_after_gain_db.has_value());
  EXPECT_EQ(fit.report.frames_held_out.size(), 100u);
  EXPECT_EQ(fit.frames_judged_on.size(), 50u);  // chance alone gives a KS of 0.007 at most, 19 times of 20
  EXPECT_LT(fit.judged.ks, 0.01);
  EXPECT_LT(fit.judged.wasserstein_grey, 0.1);
  EXPECT_NEAR(fit.report.whitened.mean, 0.0, 0.01);
  EXPECT_NEAR(fit.report.whitened.spread, 1.0, 0.03);
  EXPECT_NEAR(*fit.law.receiver.noise_after_gain_db, -3.0, 0.6);
  EXPECT_NEAR(fit.law.display.db_max, 60.0, 2.0);
  int chosen = 0;
  for (const NoiseModelChoice& choice : fit.choices) chosen += choice.chosen;
  EXPECT_EQ(chosen, 1);
}

TEST(NoiseFitTest, LooksAreDeterminedIfTheSpanIsKnown) {
  Source source(Logarithm(1.35));
  source.info.scale.db_span = 80.0;
  const NoiseFit fit = FitNoise(source.Draw(66, 2), {});  // judged on 11: KS of 0.015 by chance, at most
  ASSERT_TRUE(fit.usable);
  EXPECT_EQ(fit.law.speckle, sim::SpeckleLaw::kWeighted);  // that is how they were drawn
  EXPECT_NEAR(fit.law.receiver.looks, 1.35, 0.05);
  EXPECT_EQ(fit.law.display.db_max, 80.0);
  EXPECT_LT(fit.judged.ks, 0.015);
  const FittedParameter* looks = fit.report.Find("receiver.looks");
  ASSERT_TRUE(looks && looks->sigma);
  EXPECT_LT(std::abs(looks->value - 1.35), 4.0 * *looks->sigma);
}

TEST(NoiseFitTest, AGivenDisplayIsKept) {
  for (const DisplayLaw law : {DisplayLaw::kSoftLog, DisplayLaw::kSoftAmplitude}) {
    NoiseLaw truth = Logarithm(1.0);
    truth.display.law = law;
    truth.display.soft_db = 0.0;
    NoiseFitOptions options;
    options.display = truth.display;
    const NoiseFit fit = FitNoise(Source(truth).Draw(9, 6), options);
    ASSERT_TRUE(fit.usable) << ToString(law);
    EXPECT_EQ(fit.law.display, truth.display) << ToString(law);
    const FittedParameter* soft = fit.report.Find("display.soft_db");
    ASSERT_TRUE(soft) << ToString(law);
    EXPECT_EQ(soft->status, ParameterStatus::kFixed);
    EXPECT_EQ(soft->value, 0.0);
    EXPECT_EQ(soft->initial, 0.0);
  }
}

TEST(NoiseFitTest, TextureOfReverberationIsFound) {
  Source source(Logarithm(0.6));
  source.info.scale.db_span = 80.0;
  const NoiseFit fit = FitNoise(source.Draw(66, 2), {});
  ASSERT_TRUE(fit.usable);
  EXPECT_EQ(fit.law.speckle, sim::SpeckleLaw::kK);
  EXPECT_LT(fit.judged.ks, 0.015);
  const FittedParameter* looks = fit.report.Find("receiver.looks");
  ASSERT_TRUE(looks && looks->sigma);
  EXPECT_NEAR(looks->value, 0.6, 4.0 * *looks->sigma);
  EXPECT_LT(*looks->sigma, 0.02);
}

TEST(NoiseFitTest, ADiffuseComponentBesideTextureIsFound) {
  for (const auto& [looks, share] : {std::pair{0.4, 0.5}, {0.25, 0.2}, {0.5, 0.75}}) {
    Source source(TextureAndDiffuse(looks, share));
    source.info.scale.db_span = 80.0;
    const NoiseFit fit = FitNoise(source.Draw(66, 2), {});
    ASSERT_TRUE(fit.usable);
    EXPECT_EQ(fit.law.speckle, sim::SpeckleLaw::kKDiffuse) << looks << " " << share;
    EXPECT_LT(fit.judged.ks, 0.015);
    for (const auto& [name, truth] :
         {std::pair{"receiver.looks", looks}, {"receiver.diffuse_share", share}}) {
      const FittedParameter* found = fit.report.Find(name);
      ASSERT_TRUE(found && found->sigma) << name;
      EXPECT_EQ(found->status, ParameterStatus::kFree);
      EXPECT_NEAR(found->value, truth, 4.0 * *found->sigma) << name;
      EXPECT_LT(*found->sigma, 0.03) << name;
      RecordProperty(fmt::format("{}_of_{}", name, truth),
                     fmt::format("{:.4f}_{:.4f}", found->value, *found->sigma));
    }
  }
}

TEST(NoiseFitTest, TextureAloneHasNoDiffuseComponent) {
  for (const double looks : {0.3, 0.6}) {
    for (const std::uint64_t seed : {3, 4}) {
      Source source(Logarithm(looks));
      source.info.scale.db_span = 80.0;
      const NoiseFit fit = FitNoise(source.Draw(66, seed), {});
      ASSERT_TRUE(fit.usable);
      EXPECT_EQ(fit.law.speckle, sim::SpeckleLaw::kK) << looks << " " << seed;
      EXPECT_EQ(fit.law.receiver.diffuse_share, 0.0);
      EXPECT_FALSE(fit.report.Find("receiver.diffuse_share"));
      EXPECT_EQ(fit.choices.back().speckle, sim::SpeckleLaw::kKDiffuse) << "was tried";
    }
  }
}

TEST(NoiseFitTest, NoTextureIsFoundWhereThereIsNone) {
  Source source(Logarithm(1.0));
  source.info.scale.db_span = 80.0;
  for (const std::uint64_t seed : {2, 3, 4}) {
    const NoiseFit fit = FitNoise(source.Draw(30, seed), {});
    ASSERT_TRUE(fit.usable);
    EXPECT_NE(fit.law.speckle, sim::SpeckleLaw::kK);
    EXPECT_NE(fit.law.speckle, sim::SpeckleLaw::kKDiffuse);
  }
}

TEST(NoiseFitTest, ParametersNotDeterminedByAShortWindowAreNamed) {
  Source source(Logarithm(1.0));
  source.info.scale.db_span = 80.0;
  const MemoryRecording recording = source.Draw(9, 4);
  NoiseFitOptions options;
  options.range_min_m = 9.0;
  options.range_max_m = 9.5;  // one band: no trend to be seen, and range 0 is far
  const NoiseFit fit = FitNoise(recording, options);
  ASSERT_TRUE(fit.usable);
  for (const char* name : {"receiver.noise_db", "receiver.noise_slope_db_per_m"}) {
    const FittedParameter* parameter = fit.report.Find(name);
    ASSERT_TRUE(parameter) << name;
    EXPECT_EQ(parameter->status, ParameterStatus::kUnidentifiable) << name;
    EXPECT_FALSE(parameter->sigma) << name;
    EXPECT_EQ(std::count(fit.report.correlation_names.begin(), fit.report.correlation_names.end(), name), 0);
  }
  ASSERT_EQ(fit.report.unidentifiable_directions.size(), 1u);
  const std::string& sentence = fit.report.unidentifiable_directions.front();
  EXPECT_NE(
      sentence.find("receiver.noise_db and receiver.noise_slope_db_per_m are not determined separately"),
      std::string::npos);
  EXPECT_NE(sentence.find("9.00 to 9.50 m"), std::string::npos) << sentence;
  const auto level_db = [](const NoiseLaw& law) {
    return *law.receiver.noise_db + 9.25 * law.receiver.noise_slope_db_per_m;
  };
  EXPECT_NEAR(level_db(fit.law), level_db(source.law), 1.0);

  const NoiseFit whole = FitNoise(recording, {});
  ASSERT_TRUE(whole.report.Find("receiver.noise_db")->sigma);
  EXPECT_LT(*whole.report.Find("receiver.noise_db")->sigma, 1.0);
  for (const std::string& direction : whole.report.unidentifiable_directions) {
    EXPECT_EQ(direction.find("receiver.noise_db"), std::string::npos) << direction;
  }
}

TEST(NoiseFitTest, SomeHeldOutPingsChooseAndOthersEvaluate) {
  Source source(Logarithm(1.0));
  source.info.scale.db_span = 80.0;
  const NoiseFit twelve = FitNoise(source.Draw(12, 5), {});
  EXPECT_EQ(twelve.report.frames_held_out, (std::vector<int>{8, 9, 10, 11}));
  EXPECT_EQ(twelve.frames_chosen_on, (std::vector<int>{8, 9}));
  EXPECT_EQ(twelve.frames_judged_on, (std::vector<int>{10, 11}));
  EXPECT_TRUE(twelve.judged_apart_from_choice);
  const auto chosen = std::find_if(twelve.choices.begin(), twelve.choices.end(),
                                   [](const NoiseModelChoice& choice) { return choice.chosen; });
  ASSERT_NE(chosen, twelve.choices.end());
  EXPECT_NE(chosen->nats_per_pixel, twelve.judged.nats_per_pixel);

  const NoiseFit six = FitNoise(source.Draw(6, 5), {});
  EXPECT_EQ(six.frames_chosen_on, (std::vector<int>{4, 5}));
  EXPECT_EQ(six.frames_judged_on, six.frames_chosen_on);
  EXPECT_TRUE(six.judged_on_held_out);
  EXPECT_FALSE(six.judged_apart_from_choice);

  const NoiseFit one = FitNoise(source.Draw(1, 5), {});
  EXPECT_EQ(one.frames_judged_on, one.report.frames_used);
  EXPECT_TRUE(one.bands_held_out);
  EXPECT_TRUE(one.judged_on_held_out);
  for (int band = 0; band < one.cells.bands(); ++band) {
    EXPECT_EQ(std::isnan(one.used.recorded_mean(band, 0)), band % 2 == 1) << band;
    EXPECT_EQ(std::isnan(one.judged.recorded_mean(band, 0)), band % 2 == 0) << band;
  }

  NoiseFitOptions itself;
  itself.choose_held_out = false;
  const NoiseFit alone = FitNoise(source.Draw(1, 5), itself);
  EXPECT_FALSE(alone.judged_on_held_out);
  EXPECT_EQ(alone.judged.ks, alone.used.ks);
}

TEST(NoiseFitTest, LeavesOutCellsThatHoldATarget) {
  Source source(Logarithm(1.0));
  source.info.scale.db_span = 80.0;
  const MemoryRecording clean = source.Draw(9, 3);
  std::vector<Frame> frames;
  for (int i = 0; i < clean.frame_count(); ++i) {
    frames.push_back(clean.ReadFrame(i));
    for (int bin = 60; bin < 75; ++bin) {
      for (int beam = 2; beam < 4; ++beam) frames.back().image.value(bin, beam) += 60.0f;
    }
  }
  NoiseFitOptions options;
  options.reject_beyond = 4.0;
  const NoiseFit fit = FitNoise(MemoryRecording(source.info, frames), options);
  ASSERT_TRUE(fit.usable);
  const FittedParameter* level = fit.report.Find("receiver.noise_db");
  ASSERT_TRUE(level);
  for (std::size_t i = 0; i < fit.weight.size(); ++i) {
    const int band = (static_cast<int>(i) / kBeams);
    const int beam = static_cast<int>(i) % kBeams;
    if (band == 8 && (beam == 2 || beam == 3)) {
      EXPECT_EQ(fit.weight[i], 0.0) << beam;
    }
  }
  EXPECT_LT(std::count(fit.weight.begin(), fit.weight.end(), 0.0), 12);
  EXPECT_LT(fit.judged.ks, 0.015);
}

// A corner that a viewer's picture does not show, filled with what would be far too bright, and a beam of it.
TEST(NoiseFitTest, SamplesThatAreNotValidDoNotCount) {
  Source source(Logarithm(1.0));
  source.info.scale.db_span = 80.0;
  source.info.valid = Mask(source.info.sonar.axes.range_bins, kBeams, 1);
  const MemoryRecording clean = source.Draw(9, 3);
  std::vector<Frame> frames;
  for (int i = 0; i < clean.frame_count(); ++i) frames.push_back(clean.ReadFrame(i));
  for (int bin = 0; bin < source.info.sonar.axes.range_bins; ++bin) {
    for (int beam = 0; beam < kBeams; ++beam) {
      if (beam > 0 && !(bin < 21 && beam < 3)) continue;
      (*source.info.valid)(bin, beam) = 0;
      for (Frame& frame : frames) frame.image.value(bin, beam) = 255.0F;
    }
  }
  const NoiseFit fit = FitNoise(MemoryRecording(source.info, frames), {});
  ASSERT_TRUE(fit.usable);
  const FittedParameter* level = fit.report.Find("receiver.noise_db");
  ASSERT_TRUE(level && level->sigma);
  // A beam without samples has the mean of the others, and these lie 0.4 dB above the mean of all.
  EXPECT_NEAR(level->value, 22.4, 3.0 * *level->sigma);
  EXPECT_LT(*level->sigma, 0.5);
  const auto level_db = [](const NoiseLaw& law, int beam) {
    return 10.0 * std::log10(sim::NoisePower(law.receiver, 6.0, beam, 0.0));
  };
  for (int beam = 1; beam < kBeams; ++beam) {
    EXPECT_NEAR(level_db(fit.law, beam), level_db(source.law, beam), 0.5) << beam;
  }
  EXPECT_LT(fit.judged.ks, 0.015);
}

Eigen::MatrixXd SandwichOf(const NoiseSolution& solution, const std::vector<NoiseCounts>& pings,
                           const NoiseCells& cells) {
  const int count = solution.layout.count;
  const Eigen::MatrixXd bread = solution.information.ldlt().solve(Eigen::MatrixXd::Identity(count, count));
  Eigen::MatrixXd meat = Eigen::MatrixXd::Zero(count, count);
  for (const NoiseCounts& ping : pings) {
    const Eigen::VectorXd score = NoiseScore(solution, ping, cells, {}, 0.0);
    meat += score * score.transpose();
  }
  const auto count_of_pings = static_cast<double>(pings.size());
  return bread * meat * bread * (count_of_pings / (count_of_pings - 1.0));
}

// A quick form of the coverage study: how often the 68 % interval holds the truth, over synthetic sets.
TEST(NoiseFitTest, IntervalsHoldTheTruthAsOftenAsTheySay) {
  Source source(Logarithm(1.0));
  const NoiseLaw& truth = source.law;
  const NoiseCells cells = CellsOf(source);
  constexpr int kSets = 60;
  constexpr int kPings = 40;  // so many that a sandwich over pings is no Student's t
  int within = 0;
  int within_two = 0;
  int counted = 0;
  for (int set = 0; set < kSets; ++set) {
    const MemoryRecording recording = source.Draw(kPings, 100 + set);
    std::vector<NoiseCounts> pings;
    pings.reserve(kPings);
    for (int i = 0; i < kPings; ++i) pings.push_back(CountGrey(recording.ReadFrame(i).image, cells));
    const NoiseCounts all = AddCounts(pings, cells);
    NoiseLaw start = truth;
    start.receiver.noise_db = 20.0;
    const NoiseSolution solution = SolveNoise(start, true, all, cells, {}, {});
    ASSERT_TRUE(solution.converged);
    const Eigen::MatrixXd covariance = SandwichOf(solution, pings, cells);
    const auto count_in = [&](int place, double value, double true_value) {
      const double z = std::abs(value - true_value) / std::sqrt(covariance(place, place));
      within += z < 1.0;
      within_two += z < 1.96;
      ++counted;
    };
    const NoiseLaw& law = solution.law;
    count_in(solution.layout.noise_db, *law.receiver.noise_db, *truth.receiver.noise_db);
    count_in(solution.layout.slope, law.receiver.noise_slope_db_per_m, truth.receiver.noise_slope_db_per_m);
    count_in(solution.layout.span_db, law.display.db_max, truth.display.db_max);
    for (int beam = 0; beam < kBeams; ++beam) {
      count_in(solution.layout.taper + beam, law.receiver.noise_taper_db[beam],
               truth.receiver.noise_taper_db[beam]);
    }
  }
  // 540 intervals, about 400 of them independent: two standard deviations are 5 % and 2.5 %.
  RecordProperty("share_within_one_sigma", std::to_string(static_cast<double>(within) / counted));
  EXPECT_NEAR(static_cast<double>(within) / counted, 0.68, 0.05);
  EXPECT_NEAR(static_cast<double>(within_two) / counted, 0.95, 0.03);
}

TEST(NoiseFitTest, IntervalsOfLooksAndDiffuseShareHoldTheTruth) {
  Source source(TextureAndDiffuse(0.4, 0.5));
  const NoiseCells cells = CellsOf(source);
  constexpr int kSets = 40;
  constexpr int kPings = 40;
  int within = 0;
  int within_two = 0;
  double sum_z = 0.0;
  for (int set = 0; set < kSets; ++set) {
    const MemoryRecording recording = source.Draw(kPings, 300 + set);
    std::vector<NoiseCounts> pings;
    pings.reserve(kPings);
    for (int i = 0; i < kPings; ++i) pings.push_back(CountGrey(recording.ReadFrame(i).image, cells));
    NoiseLaw start = TextureAndDiffuse(0.8, 0.3);
    start.receiver.noise_db = 20.0;
    const NoiseSolution solution = SolveNoise(start, false, AddCounts(pings, cells), cells, {}, {});
    ASSERT_TRUE(solution.converged);
    const Eigen::MatrixXd covariance = SandwichOf(solution, pings, cells);
    const auto count_in = [&](int place, double truth) {
      const double z = (solution.value[place] - truth) / std::sqrt(covariance(place, place));
      within += std::abs(z) < 1.0;
      within_two += std::abs(z) < 1.96;
      sum_z += z;
    };
    count_in(solution.layout.log_looks, std::log(0.4));
    count_in(solution.layout.logit_diffuse, 0.0);
  }
  RecordProperty("share_within_one_sigma", std::to_string(within / (2.0 * kSets)));
  RecordProperty("share_within_two_sigma", std::to_string(within_two / (2.0 * kSets)));
  // 80 intervals, correlated by pairs: two standard deviations are 10 to 15 % and 5 to 7 %.
  EXPECT_NEAR(within / (2.0 * kSets), 0.68, 0.15);
  EXPECT_NEAR(within_two / (2.0 * kSets), 0.95, 0.07);
  EXPECT_LT(std::abs(sum_z), 2.0 * 2.0 * std::sqrt(2.0 * kSets));
}

TEST(NoiseFitTest, InvalidHeldOutPingsAndRecordingsAreRefused) {
  const Source source(Logarithm(1.0));
  NoiseFitOptions options;
  options.held_out = {0, 1, 2};
  EXPECT_THROW(FitNoise(source.Draw(3, 1), options), DataError);
  options.held_out = {7};
  EXPECT_THROW(FitNoise(source.Draw(3, 1), options), DataError);
  options.held_out = {};
  options.range_min_m = 9.99;
  EXPECT_THROW(FitNoise(source.Draw(3, 1), options), DataError);
}

// Levels with a correlation of `correlation` from ping to ping and a trend.
std::vector<double> Levels(int count, double correlation, double trend, std::uint64_t seed) {
  const CounterRandom random(seed, 0);
  std::vector<double> level;
  double state = 0.0;
  for (int i = -50; i < count; ++i) {
    const auto [u, v] = random.Uniform2(i + 50);
    const double normal = std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::numbers::pi * v);
    state = correlation * state + std::sqrt(1.0 - correlation * correlation) * normal;
    if (i >= 0) level.push_back(state + trend * i);
  }
  return level;
}

TEST(NoiseDriftTest, AStandingLevelIsRarelyCalledADriftAndATrendIsFound) {
  constexpr int kRuns = 1000;
  std::vector<int> frames(80);
  for (int i = 0; i < 80; ++i) frames[i] = i;
  for (const double correlation : {0.0, 0.5}) {
    int alarms = 0;
    int covered = 0;
    for (int run = 0; run < kRuns; ++run) {
      alarms += DriftOf(frames, Levels(80, correlation, 0.0, 2 * run + 1))->significant;
      const NoiseDrift drift = *DriftOf(frames, Levels(80, correlation, 0.05, 2 * run + 2));
      covered += std::abs(drift.trend_db_per_ping - 0.05) < 1.96 * drift.trend_sigma;
      EXPECT_EQ(drift.parts.size(), 4u);
    }
    // 5 % and 95 %; the correlation is estimated from the same 80 pings.
    EXPECT_LT(alarms, 0.09 * kRuns) << correlation;
    EXPECT_GT(covered, 0.91 * kRuns) << correlation;
  }
  EXPECT_TRUE(DriftOf(frames, Levels(80, 0.5, 0.05, 7))->significant);
  EXPECT_FALSE(DriftOf(std::vector<int>{0, 1, 2}, std::vector<double>{0.0, 0.1, 0.2}));
}

TEST(NoiseJudgementTest, LevelsOfPingsAreFoundAndTheLawIsNotFitted) {
  const Source source(TwoFloors());
  Source louder = source;
  *louder.law.receiver.noise_db += 2.0;
  *louder.law.receiver.noise_after_gain_db += 2.0;
  const MemoryRecording recording = louder.Draw(2, 5);
  const NoiseJudgement judgement = JudgeNoise(source.law, recording, {0, 1}, CellsOf(source), {});
  ASSERT_EQ(judgement.pings.size(), 2u);
  for (const NoisePing& ping : judgement.pings) {
    EXPECT_NEAR(ping.level_db, 2.0, 4.0 * ping.level_sigma_db);
    EXPECT_LT(ping.level_sigma_db, 0.4);
  }
  EXPECT_EQ(judgement.pings_beyond_chance(), 2);
  EXPECT_FALSE(judgement.drift);
  const NoiseJudgement true_law = JudgeNoise(louder.law, recording, {0, 1}, CellsOf(source), {});
  EXPECT_EQ(true_law.pings_beyond_chance(), 0);
  EXPECT_LE(true_law.cells_beyond_chance(), 1);
}

TEST(NoiseJudgementTest, ALawWithADiffuseComponentIsJudgedByItself) {
  const Source source(TextureAndDiffuse(0.4, 0.5));
  const MemoryRecording recording = source.Draw(4, 5);
  const std::vector<int> pings = {0, 1, 2, 3};
  EXPECT_LE(JudgeNoise(source.law, recording, pings, CellsOf(source), {}).pings_beyond_chance(), 1);
  NoiseLaw other = source.law;
  other.receiver.diffuse_share = 0.0;  // the K law of the same variance
  EXPECT_EQ(JudgeNoise(other, recording, pings, CellsOf(source), {}).pings_beyond_chance(), 4);
  other.speckle = sim::SpeckleLaw::kK;
  const double ks = JudgeNoise(other, recording, pings, CellsOf(source), {}).agreement.ks;
  other.speckle = sim::SpeckleLaw::kKDiffuse;
  EXPECT_EQ(JudgeNoise(other, recording, pings, CellsOf(source), {}).agreement.ks, ks);

  other = source.law;
  other.speckle = sim::SpeckleLaw::kK;
  EXPECT_THROW(JudgeNoise(other, recording, pings, CellsOf(source), {}), DataError);
  other = source.law;
  other.receiver.looks = 0.01;
  EXPECT_THROW(JudgeNoise(other, recording, pings, CellsOf(source), {}), DataError);
}

TEST(NoiseJudgementTest, WeightedLooksBelowOneAreRefused) {
  Source source(Logarithm(1.0));
  const MemoryRecording recording = source.Draw(1, 5);
  NoiseLaw law = source.law;
  law.receiver.looks = 0.8;
  EXPECT_NO_THROW(JudgeNoise(law, recording, {0}, CellsOf(source), {})) << "Gamma speckle";
  law.speckle = sim::SpeckleLaw::kWeighted;
  EXPECT_THAT([&] { JudgeNoise(law, recording, {0}, CellsOf(source), {}); },
              ::testing::ThrowsMessage<DataError>(
                  ::testing::HasSubstr("weighted speckle and receiver.looks 0.8, expected at least 1")));
}

// Background of one look and 0 dB through a display, 8 bits.
PolarImage BackgroundThrough(const DisplayParameters<double>& display, bool span_stated) {
  const Source source(TwoFloors(), 4000);
  PolarImage image{source.info.sonar.axes, source.info.scale, Grid<float>(4000, kBeams)};
  if (span_stated) image.scale.db_span = display.db_max - display.db_min;
  const CounterRandom random(3, 0);
  for (std::size_t i = 0; i < image.value.size(); ++i) {
    const double value = sim::DisplayValue(display, -std::log(random.Uniform2(i).first));
    image.value.values()[i] = static_cast<float>(std::round(255.0 * std::clamp(value, 0.0, 1.0)));
  }
  return image;
}

TEST(BackgroundDisplayTest, TheLawThatMadeTheBackgroundIsFoundAmongAll) {
  const Mask all(4000, kBeams, 1);
  const std::vector<DisplayParameters<double>> truths = {
      {.db_min = -20.0, .db_max = 40.0, .law = DisplayLaw::kLog},
      {.db_min = -12.0, .db_max = 48.0, .law = DisplayLaw::kSoftLog, .soft_db = -6.0},
      {.db_min = -14.0, .db_max = 56.0, .law = DisplayLaw::kSoftAmplitude, .soft_db = -8.0},
      {.db_min = -40.0, .db_max = 20.0, .law = DisplayLaw::kPower, .exponent = 0.7}};
  for (const bool span_stated : {true, false}) {
    for (const DisplayParameters<double>& truth : truths) {
      const PolarImage image = BackgroundThrough(truth, span_stated);
      const BackgroundDisplay own = FitBackgroundDisplay(image, all, truth.law);
      const auto named = [&] { return fmt::format("{}, span stated: {}", ToString(truth.law), span_stated); };
      EXPECT_LT(own.ks, 0.01) << named();
      if (truth.law == DisplayLaw::kPower) {
        EXPECT_NEAR(own.display.db_max, truth.db_max, 1.0) << named();
        EXPECT_NEAR(own.display.exponent, truth.exponent, 0.02) << named();
      } else {
        EXPECT_NEAR(own.display.db_min, truth.db_min, 0.6) << named();
        EXPECT_NEAR(own.display.db_max, truth.db_max, span_stated ? 0.6 : 3.0) << named();
      }
      for (const DisplayParameters<double>& other : truths) {
        if (other.law == truth.law) continue;
        // Softened by next to nothing, a soft law is the logarithm.
        const bool holds = truth.law == DisplayLaw::kLog && other.law != DisplayLaw::kPower;
        const double loss = FitBackgroundDisplay(image, all, other.law).nats_per_pixel - own.nats_per_pixel;
        EXPECT_GT(loss, holds ? -1e-3 : 1e-3) << named() << " by " << ToString(other.law);
      }
    }
  }
}

}  // namespace
}  // namespace sonarcal::calib
