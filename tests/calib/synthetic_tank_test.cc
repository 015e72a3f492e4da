// The acoustic fit on a SYNTHETIC recording made by another kind of simulation, against its truth.
#include "tests/calib/synthetic_tank.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "calib/acoustic_fit.h"
#include "sim/acoustic/acoustic_image.h"
#include "tests/support/recordings.h"

namespace sonarcal::calib {
namespace {

using testing::SyntheticTank;

TEST(SyntheticTank, CurvesAndNoiseAreFoundAndHeldOutFramesAgreeAsSpeckleAllows) {
  SONARCAL_NEEDS_RECORDING(folder, "synthetic_tank");
  const SyntheticTank tank(folder);
  const std::vector<AcousticFrame> frames = tank.Frames({0, 1, 3, 4, 5, 7});
  ParameterSet initial = WithNoiseStart(tank.known, frames);
  FitOptions fit_options;
  fit_options.starts = 2;
  const std::int64_t rays_before = tank.simulator.caster().rays_cast();
  const AcousticFit fit = FitAcousticModel(tank.simulator, frames, initial, {}, fit_options);
  EXPECT_EQ(tank.simulator.caster().rays_cast() - rays_before,
            static_cast<std::int64_t>(frames.size()) * tank.simulator.fan().size())
      << "each frame is traced once";
  ASSERT_TRUE(fit.usable) << fit.report.termination;
  EXPECT_NEAR(fit.parameters.receiver.noise_db.value(), tank.TrueNoiseDb(), 0.3);
  for (const char* material : {"floor", "mockup"}) {
    EXPECT_LE(testing::ExpectCurve(tank, fit.report, material).largest_error_db, testing::kMaxCurveErrorDb)
        << material;
  }
  // Few pixels show the wall. The fit says so: near its normal the standard error is several decibels.
  testing::ExpectCurve(tank, fit.report, "wall");
  for (const char* name : {"material.floor.gsab.C", "material.floor.gsab.D", "material.mockup.gsab.C"}) {
    const FittedParameter* parameter = fit.report.Find(name);
    ASSERT_NE(parameter, nullptr);
    EXPECT_TRUE(parameter->sigma.has_value()) << name;
  }

  // Held out: the error of the expected image beside what speckle alone makes of the true one's.
  const sim::AcousticGeometry geometry{tank.simulator.sonar(), tank.simulator.absorption_db_per_m()};
  double error = 0.0;
  double floor = 0.0;
  for (const int index : {2, 6}) {
    const Frame frame = tank.recording->ReadFrame(index);
    const sim::EchoList echoes = tank.simulator.TraceEchoes(frame.info.world_from_sonar.value());
    const ParameterSet truth = tank.TrueParameters();
    const PolarImage power = sim::ExpectedPower(
        sim::MakeScatterMap(echoes, tank.simulator.fan(), geometry, truth), geometry, truth);
    const PolarImage expected = tank.simulator.RenderExpected(echoes, fit.parameters);
    for (std::size_t i = 0; i < power.value.size(); ++i) {
      floor += testing::SpeckleFloorOf(power.value.values()[i], truth.display);
      error += std::abs(frame.image.value.values()[i] / frame.image.scale.full_scale -
                        expected.value.values()[i] / expected.scale.full_scale);
    }
  }
  RecordProperty("held_out_error_over_floor", fmt::format("{:.4f}", error / floor));
  EXPECT_LT(error, 1.1 * floor);
  EXPECT_GT(error, 0.97 * floor) << "below what speckle allows: the floor is wrong";
}

}  // namespace
}  // namespace sonarcal::calib
