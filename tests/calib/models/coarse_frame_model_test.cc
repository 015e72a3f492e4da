#include "calib/models/coarse_frame_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "calib/fit_starts.h"
#include "calib/problem_builder.h"
#include "sim/physics/receiver.h"
#include "tests/calib/small_tank.h"

namespace sonarcal::calib {
namespace {

class CoarseFrameModelTest : public ::testing::Test {
 protected:
  std::vector<AcousticFrame> Frames(const ParameterSet& truth) const {
    std::vector<AcousticFrame> frames;
    for (const Pose& pose : testing::SmallTankPoses()) {
      const int index = static_cast<int>(frames.size());
      frames.push_back({.index = index,
                        .world_from_sonar = pose,
                        .recorded = RecordedPowers(simulator_.Render(pose, truth, index), truth.display)});
    }
    return frames;
  }

  const Scene scene_ = testing::SmallTank();
  const sim::Simulator simulator_{scene_, testing::SmallSonar(), [] {
                                    sim::SimulationOptions options = testing::SmallTankOptions();
                                    options.noise = true;
                                    return options;
                                  }()};
};

// A block's mean is that of its pixels, but for noise that time-varied gain bends within the block.
TEST_F(CoarseFrameModelTest, ABlocksMeanIsThatOfItsPixels) {
  ParameterSet truth = testing::SmallTankAcousticTruth();
  truth.mirrors["floor"].loss_db = 4.0;
  for (const TimeVariedGain law : {TimeVariedGain::kNone, TimeVariedGain::k40LogR}) {
    truth.receiver.time_varied_gain = law;
    std::vector<AcousticFrame> frames = Frames(truth);
    // A pixel that does not count must leave no trace; where gain bends, those that do must lie evenly.
    if (law == TimeVariedGain::kNone) {
      frames[0].use.assign(frames[0].recorded.size(), 1);
      for (std::size_t pixel = 0; pixel < frames[0].use.size(); pixel += 5) frames[0].use[pixel] = 0;
    }
    const AcousticFrameModel fine(simulator_, frames, truth);
    const PixelBlock block{.bins = 3, .beams = 5};
    const CoarseFrameModel coarse(fine, fine.sonar_at_point(), fine.echoes(), block);
    ParameterValues values = fine.initial_values();
    for (double& value : values) value *= 1.03;
    for (const int frame : {0, 1}) {
      const std::vector<double> fine_mean = fine.MeanPower(frame, values);
      const auto evaluation = coarse.At(frame, values, {}, FrameModel::Terms::kResiduals);
      const std::vector<double> mean = dynamic_cast<const AcousticEvaluation&>(*evaluation).Means();
      ASSERT_EQ(mean.size(), coarse.pixel_count());
      for (int bin = 0; bin < coarse.range_bins(); ++bin) {
        for (int beam = 0; beam < coarse.beams(); ++beam) {
          double sum = 0.0;
          int count = 0;
          for (int b = bin * block.bins; b < std::min((bin + 1) * block.bins, fine.range_bins()); ++b) {
            for (int a = beam * block.beams; a < std::min((beam + 1) * block.beams, fine.beams()); ++a) {
              const std::size_t pixel = static_cast<std::size_t>(b) * fine.beams() + a;
              if (!fine.Counts(frame, pixel)) continue;
              sum += fine_mean[pixel];
              ++count;
            }
          }
          const std::size_t at = static_cast<std::size_t>(bin) * coarse.beams() + beam;
          ASSERT_EQ(coarse.Counts(frame, at), count > 0);
          // A block of a few bins spans a percent of range: noise is 40 log R off by little.
          if (count == 0 || (bin + 1) * block.bins > fine.range_bins()) continue;
          // The fourth power of range is 1 + 4 (bin / range)^2 times its middle one, averaged over three
          // bins.
          const double bins_off =
              fine.sonar().axes.range_bin_m() / fine.sonar().axes.range_centre_m(bin * block.bins + 1);
          const double off = law == TimeVariedGain::kNone ? 1e-5 : 5.0 * bins_off * bins_off;
          EXPECT_NEAR(mean[at], sum / count, off * sum / count);
        }
      }
    }
  }
}

// A model with slopes has no coarse one of its own, as its geometry may move. About a held point it has
// that of a model which was traced there.
TEST_F(CoarseFrameModelTest, AboutAPointItIsThatOfAModelTracedThere) {
  const ParameterSet truth = testing::SmallTankAcousticTruth();
  const std::vector<AcousticFrame> frames = Frames(truth);
  AcousticFrameModel fine(simulator_, frames, truth);
  const int pulse = FindEntry(fine.catalog(), "pulse.length_m");
  ASSERT_GE(pulse, 0);
  ParameterValues moved = fine.initial_values();
  moved[pulse] *= 1.3;
  fine.Linearise(fine.initial_values(), {pulse});
  constexpr std::size_t kPixels = 500;
  EXPECT_EQ(fine.Coarse(kPixels), nullptr);
  const std::unique_ptr<FrameModel> about = fine.CoarseAbout(moved, kPixels);
  fine.Linearise(moved, {});
  const std::unique_ptr<FrameModel> traced = fine.Coarse(kPixels);
  ASSERT_TRUE(about != nullptr && traced != nullptr);
  EXPECT_EQ(CostAt(*about, moved, fine.frame_count()), CostAt(*traced, moved, fine.frame_count()));
}

// Costs differ by a constant, slopes do not differ. A quadratic form in the power of the nodes agrees nearby.
TEST_F(CoarseFrameModelTest, AModelOfOneCurveDiffersByAConstant) {
  const ParameterSet truth = testing::SmallTankAcousticTruth();
  const std::vector<AcousticFrame> frames = Frames(truth);
  const AcousticFrameModel fine(simulator_, frames, truth);
  const CoarseFrameModel coarse(fine, fine.sonar_at_point(), fine.echoes(), {.bins = 2, .beams = 4});
  const ParameterValues& at = fine.initial_values();
  const int first = FindEntry(fine.catalog(), "material.floor.gsab.A");
  ASSERT_GE(first, 0);
  const auto curve = coarse.OfCurve(fine.catalog()[first].material, at);
  ASSERT_NE(curve, nullptr);
  EXPECT_LT(curve->pixel_count(), coarse.pixel_count() * coarse.frame_count());
  const double constant = CostAt(coarse, at, coarse.frame_count()) - CostAt(*curve, at, 1);
  FitState state{.active = {}, .values = at};
  for (int member = 0; member < 6; ++member) {
    state.active.push_back(first + member);
    state.values[first + member] *= 1.0 + 0.1 * member;
  }
  const double cost = CostAt(coarse, state.values, coarse.frame_count());
  EXPECT_GT(std::abs(cost - CostAt(coarse, at, coarse.frame_count())), 1.0);
  EXPECT_NEAR(CostAt(*curve, state.values, 1), cost - constant, 1e-4);
  const CostSlopes of_all = SlopesOfCost(coarse, fine.catalog(), state);
  const CostSlopes of_curve = SlopesOfCost(*curve, fine.catalog(), state);
  EXPECT_TRUE(of_curve.gradient.isApprox(of_all.gradient, 1e-5)) << of_curve.gradient - of_all.gradient;
  EXPECT_TRUE(of_curve.information.isApprox(of_all.information, 1e-5));

  const auto quadratic = curve->Quadratic(at);
  ASSERT_NE(quadratic, nullptr);
  EXPECT_NEAR(CostAt(*quadratic, at, 1), CostAt(*curve, at, 1), 1e-6);
  state.values = at;
  const CostSlopes of_quadratic = SlopesOfCost(*quadratic, fine.catalog(), state);
  EXPECT_TRUE(of_quadratic.gradient.isApprox(SlopesOfCost(*curve, fine.catalog(), state).gradient, 1e-5));
  // A small step changes the cost of both by nearly the same amount.
  for (const double step : {0.01, 0.02}) {
    for (int member = 0; member < 6; ++member)
      state.values[first + member] = at[first + member] * (1.0 + step);
    const double change = CostAt(*curve, state.values, 1) - CostAt(*curve, at, 1);
    const double by_quadratic = CostAt(*quadratic, state.values, 1) - CostAt(*quadratic, at, 1);
    EXPECT_NEAR(by_quadratic, change, 0.1 * std::abs(change));
  }
}

// The best curves of the blocks are those of the pixels, within what these can tell.
TEST_F(CoarseFrameModelTest, BlocksAreBestExplainedNearThePixelsOptimum) {
  const ParameterSet truth = testing::SmallTankAcousticTruth();
  const std::vector<AcousticFrame> frames = Frames(truth);
  const AcousticFrameModel fine(simulator_, frames, truth);
  const CoarseFrameModel coarse(fine, fine.sonar_at_point(), fine.echoes(), {.bins = 2, .beams = 4});
  const FitConfig config{.free = std::vector<std::string>{"material.floor.gsab.C", "receiver.noise_db"}};
  FitOptions options;
  options.starts = 1;
  const ModelFit by_pixels = Fit(fine, fine.initial_values(), config, options);
  const ModelFit by_blocks = Fit(coarse, fine.initial_values(), config, options);
  ASSERT_TRUE(by_pixels.usable && by_blocks.usable);
  int compared = 0;
  for (const FittedParameter& parameter : by_pixels.report.parameters) {
    if (!parameter.sigma) continue;
    const auto index = static_cast<std::size_t>(&parameter - by_pixels.report.parameters.data());
    EXPECT_NEAR(by_blocks.values[index], parameter.value, 2.0 * *parameter.sigma) << parameter.name;
    ++compared;
  }
  EXPECT_EQ(compared, 2);
}

}  // namespace
}  // namespace sonarcal::calib
