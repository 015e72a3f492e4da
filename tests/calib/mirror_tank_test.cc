// Losses of floor, walls and surface, curves and noise fitted together to a SYNTHETIC recording of a tank
// with ghosts, made by another kind of simulation, against its truth.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "calib/acoustic_fit.h"
#include "tests/calib/synthetic_tank.h"
#include "tests/support/recordings.h"

namespace sonarcal::calib {
namespace {

using testing::SyntheticTank;

TEST(SyntheticTankGhosts, LossesCurvesAndNoiseAreFoundTogether) {
  SONARCAL_NEEDS_RECORDING(folder, "synthetic_tank_ghosts");
  const SyntheticTank tank(folder);
  const ParameterSet truth = tank.TrueParameters();
  const std::vector<AcousticFrame> frames = tank.Frames({0, 1, 3, 4, 5, 7});
  ParameterSet initial = WithNoiseStart(tank.known, frames);
  for (const char* mirror : {"floor", "wall", "surface"}) initial.mirrors[mirror].loss_db = 6.0;
  FitOptions options;
  options.starts = 1;
  options.down_weight = true;  // as the command does
  const AcousticFit fit = FitAcousticModel(tank.simulator, frames, initial, {}, options);
  ASSERT_TRUE(fit.usable) << fit.report.termination;
  for (const auto& [name, mirror] : truth.mirrors) {
    const FittedParameter* loss = fit.report.Find("mirror." + name + ".loss_db");
    ASSERT_NE(loss, nullptr);
    std::cout << fmt::format("  {} {:.3f} dB, sigma {:.3f}, truth {:.3f}\n", loss->name, loss->value,
                             loss->sigma.value_or(-1.0), mirror.loss_db);
    EXPECT_NEAR(loss->value, mirror.loss_db, 1.5) << name;
  }
  EXPECT_NEAR(fit.parameters.receiver.noise_db.value(), tank.TrueNoiseDb(), 0.3);
  for (const char* material : {"floor", "mockup"}) {
    EXPECT_GE(testing::ExpectCurve(tank, fit.report, material).share_in_band, 0.85)
        << material << ": the target, all of them, is not reached";
  }

  // Held out: the error of the expected image beside what speckle alone makes of the true one's.
  double error = 0.0;
  double floor = 0.0;
  for (const int index : {2, 6}) {
    const Frame frame = tank.recording->ReadFrame(index);
    const Pose& pose = frame.info.world_from_sonar.value();
    const sim::EchoList echoes = tank.simulator.TraceEchoes(pose);
    const sim::AcousticGeometry geometry{tank.simulator.sonar(), tank.simulator.absorption_db_per_m()};
    const sim::ScatterMap scatter =
        tank.simulator.Scatter(echoes, truth, tank.simulator.TraceGhosts(pose, truth));
    const PolarImage power = sim::ExpectedPower(scatter, geometry, truth);
    const PolarImage expected = tank.simulator.RenderExpected(
        echoes, fit.parameters, tank.simulator.TraceGhosts(pose, fit.parameters));
    for (std::size_t i = 0; i < power.value.size(); ++i) {
      floor += testing::SpeckleFloorOf(power.value.values()[i], truth.display);
      error += std::abs(frame.image.value.values()[i] / frame.image.scale.full_scale -
                        expected.value.values()[i] / expected.scale.full_scale);
    }
  }
  std::cout << fmt::format("  held-out error over floor {:.4f}\n", error / floor);
  EXPECT_LT(error, 1.15 * floor);
  EXPECT_GT(error, 0.97 * floor) << "below what speckle allows: the floor is wrong";
}

}  // namespace
}  // namespace sonarcal::calib
