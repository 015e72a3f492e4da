// How far the acoustic model's default rays are from very many, in what a fit counts by: half the sum of
// squares of the differences of ln(power), which is what they cost in log likelihood, pixel by pixel. Both
// sides are SYNTHETIC, by the scene and the truth of a SYNTHETIC recording.
#include <gtest/gtest.h>

#include <cmath>

#include "calib/models/acoustic_frame_model.h"
#include "sim/rays/acoustic_fan.h"
#include "tests/calib/synthetic_tank.h"
#include "tests/support/recordings.h"

namespace sonarcal::calib {
namespace {

TEST(RayCount, StaggeredColumnsBringAFrameNearToVeryMany) {
  SONARCAL_NEEDS_RECORDING(folder, "synthetic_tank_poses");
  const testing::SyntheticTank tank(folder);
  const ParameterSet truth = tank.TrueParameters();
  const sim::RayFanOptions options = sim::AcousticFanOptions(tank.simulator.sonar(), truth);
  sim::RayFanOptions dense = options;
  dense.cols *= 4;
  dense.rows *= 5;
  sim::RayFanOptions alike = options;
  alike.stagger = false;
  alike.stagger_rows = false;
  for (const int frame : {0, 3, 7}) {
    const std::vector<AcousticFrame> frames = tank.Frames({frame});
    const AcousticFrameModel model(tank.simulator, frames, truth);
    const auto power = [&](const sim::RayFanOptions& rays) {
      const AcousticFrameModel::Rays traced{model.SimulatorAt(model.initial_values()),
                                            sim::RayFan(tank.simulator.sonar(), rays)};
      return model.ExpectedPowerFrom(0, tank.TruePose(frame), truth, traced).value;
    };
    const Grid<float> very_many = power(dense);
    const auto nats = [&](const Grid<float>& of) {
      double sum = 0.0;
      for (std::size_t i = 0; i < of.size(); ++i)
        sum += 0.5 * std::pow(std::log(of.values()[i] / very_many.values()[i]), 2);
      return sum;
    };
    const double staggered = nats(power(options));
    const double unstaggered = nats(power(alike));
    std::printf("frame %d: %.1f nats by %d x %d rays, %.1f by as many that are not staggered\n", frame,
                staggered, options.cols, options.rows, unstaggered);
    // Speckle varies a parameter's worth by half a nat a grain of some 20 pixels: 10.
    EXPECT_LT(staggered, 10.0);
    EXPECT_GT(unstaggered, 3.0 * staggered);
  }
}

}  // namespace
}  // namespace sonarcal::calib
