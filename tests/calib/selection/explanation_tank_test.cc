// What each part of the model is worth on SYNTHETIC recordings of a tank made by another kind of simulation,
// one with ghosts and one without. Fewer rays and frames than a fit would have, so that it takes a minute or
// two.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "calib/selection/explanation.h"
#include "data_io/scenes/scene_io.h"
#include "tests/calib/synthetic_tank.h"
#include "tests/support/recordings.h"

namespace sonarcal::calib {
namespace {

using testing::SyntheticTank;

class SyntheticTankExplained : public ::testing::Test {
 protected:
  void Explained(const std::filesystem::path& folder) {
    const SyntheticTank tank(folder);
    ParameterSet given = tank.known;
    for (const char* mirror : {"floor", "wall", "surface"}) given.mirrors[mirror].loss_db = 6.0;
    // As the recording's truth says; what `fit` finds where nobody does.
    given.beam.transmit_even_deg = 24.0;
    given.beam.transmit_end_deg = 45.0;
    const auto read = [&](const std::vector<int>& indices) {
      std::vector<GreyFrame> frames;
      for (const int index : indices) {
        Frame frame = tank.recording->ReadFrame(index);
        frames.push_back({.index = index,
                          .world_from_sonar = frame.info.world_from_sonar.value(),
                          .image = std::move(frame.image)});
      }
      return frames;
    };
    held_out_ = read({2, 6});
    ExplainOptions options{.simulation = tank.simulator.options()};
    options.simulation.fan.rows = 900;
    options.fit.max_iterations = 25;
    options.on_step = [](ExplainedPart part) { std::cout << "  " << ToString(part) << std::endl; };
    explanation_ = Explain(data_io::ReadGltf(folder / "scene.gltf"), tank.recording->info().sonar,
                           read({0, 4, 5}), held_out_, given, options);
    for (const ExplainedStep& step : explanation_.steps) {
      std::cout << fmt::format(
          "  {:<10} error {:.4f}, gain {:+.4f} +- {:.4f}, AIC {:+.0f}, BIC {:+.0f}: {}\n",
          ToString(step.part), ErrorOf(step), step.gain.mean, step.gain.sigma, step.aic_change,
          step.bic_change, ToString(step.verdict));
    }
  }

  // Mean absolute, of full scale.
  double ErrorOf(const ExplainedStep& step) const {
    const std::vector<PolarImage> expected = ExpectedGrey(step, held_out_);
    double sum = 0.0;
    double count = 0.0;
    for (std::size_t f = 0; f < expected.size(); ++f) {
      for (std::size_t i = 0; i < expected[f].value.size(); ++i) {
        sum += std::abs(expected[f].value.values()[i] - held_out_[f].image.value.values()[i]) / 255.0;
        count += 1.0;
      }
    }
    return sum / count;
  }

  std::vector<ExplainedStep>::const_iterator StepOf(ExplainedPart part) const {
    return std::find_if(explanation_.steps.begin(), explanation_.steps.end(),
                        [part](const ExplainedStep& step) { return step.part == part; });
  }

  std::vector<GreyFrame> held_out_;
  Explanation explanation_;
};

TEST_F(SyntheticTankExplained, GhostsAreSignificantIfTheTankHasThem) {
  SONARCAL_NEEDS_RECORDING(folder, "synthetic_tank_ghosts");
  Explained(folder);
  const auto ghosts = StepOf(ExplainedPart::kGhosts);
  EXPECT_EQ(ghosts->verdict, Verdict::kSignificant);
  EXPECT_LT(ErrorOf(*ghosts), ErrorOf(*(ghosts - 1)));
}

TEST_F(SyntheticTankExplained, GhostsAreNotSignificantIfTheTankHasNone) {
  SONARCAL_NEEDS_RECORDING(folder, "synthetic_tank");
  Explained(folder);
  EXPECT_NE(StepOf(ExplainedPart::kGhosts)->verdict, Verdict::kSignificant);
  EXPECT_EQ(StepOf(ExplainedPart::kNoise)->verdict, Verdict::kSignificant);
}

}  // namespace
}  // namespace sonarcal::calib
