// A SYNTHETIC recording of a sonar that turns while the pings of a frame are sent, made by the coherent model
// and fitted with and without the poses of the pings.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "apps/workflow/fit.h"
#include "apps/workflow/simulate.h"
#include "core/types/units.h"
#include "tests/calib/small_tank.h"

namespace sonarcal::workflow {
namespace {

constexpr int kPings = 8;
constexpr double kPeriodS = 0.005;
constexpr double kTurnDegPerS = 60.0;  // 2.1 degrees over a frame, two widths of a beam

class TurningSonar : public ::testing::Test {
 protected:
  static SonarChoice Sonar() {
    SonarModel sonar = testing::SmallSonar();
    sonar.pings.period_s = kPeriodS;
    for (int beam = 0; beam < sonar.axes.beam_count(); ++beam) sonar.pings.of_beam.push_back(beam % kPings);
    return {.sonar = sonar, .water = Water{.salinity_ppt = 0.5}, .input = {}};
  }

  static ParameterSet Truth() {
    ParameterSet truth = testing::SmallTankAcousticTruth();
    truth.pulse.length_m = 0.05;
    return truth;
  }

  // Frames 0.1 s apart, in front of the box. Poses and motion are recorded.
  static std::unique_ptr<MemoryRecording> Recording() {
    ParameterSet coherent = Truth();
    coherent.model = EchoModel::kCoherent;
    std::vector<data_io::TimedPose> poses;
    const Motion turn{.turn_rate_rad_per_s = {0.0, 0.0, RadFromDeg(kTurnDegPerS)}};
    for (int i = 0; i < 6; ++i) {
      const double yaw_rad = RadFromDeg(-15.0 + 6.0 * i);
      poses.push_back({.time_s = 0.1 * i,
                       .world_from_sonar = {RotationFromYawPitchRoll(yaw_rad, RadFromDeg(-25.0), 0.0),
                                            {0.1 * (i - 2.5), -2.5, 1.2}},
                       .motion = turn});
    }
    SimulateOptions options;
    options.bits = 12;
    return Simulate(testing::SmallTank(), Sonar(), coherent, poses, options);
  }

  static const RecordingFit& FitWith(PingUse pings) {
    static std::map<PingUse, RecordingFit> fits;
    if (const auto found = fits.find(pings); found != fits.end()) return found->second;
    ParameterSet start = Truth();
    for (auto& [name, material] : start.materials)
      material.gsab = {.a = 0.05, .b_deg = 5.0, .c = 0.005, .d = 1.5, .e = 0.02, .f_deg = 15.0};
    FitOptions options;
    options.free = {"materials", "receiver.noise_db", "beam.azimuth_width_deg"};
    options.trust_all = true;
    options.starts = 1;
    options.pings = pings;
    static const std::unique_ptr<MemoryRecording> kRecording = Recording();
    return fits.emplace(pings, Fit(*kRecording, testing::SmallTank(), start, options)).first->second;
  }

  static const calib::FittedParameter& Width(PingUse pings) {
    return *FitWith(pings).fit.report.Find("beam.azimuth_width_deg");
  }
};

// Without the pings, edges are drawn out over what the sonar turns in a frame, which makes the beam wide.
TEST_F(TurningSonar, PosesOfPingsRemoveTheErrorOfTheBeam) {
  ASSERT_TRUE(FitWith(PingUse::kUse).fit.usable);
  ASSERT_TRUE(FitWith(PingUse::kIgnore).fit.usable);
  const calib::FittedParameter& with = Width(PingUse::kUse);
  const calib::FittedParameter& without = Width(PingUse::kIgnore);
  RecordProperty("width_with_deg", std::to_string(with.value));
  RecordProperty("width_without_deg", std::to_string(without.value));
  ASSERT_TRUE(with.sigma);
  RecordProperty("width_with_sigma_deg", std::to_string(*with.sigma));
  EXPECT_NEAR(with.value, 1.0, std::max(0.05, 3.0 * *with.sigma));
  EXPECT_GT(without.value, 1.5);
}

TEST_F(TurningSonar, TheReportSaysWhatThePingsAreWorth) {
  const calib::FitReport& report = FitWith(PingUse::kUse).fit.report;
  ASSERT_TRUE(report.pings);
  EXPECT_TRUE(report.pings->used);
  EXPECT_TRUE(report.pings->held_out);
  EXPECT_EQ(report.pings->pings, kPings);
  EXPECT_NEAR(report.pings->max_turn_deg, kTurnDegPerS * kPeriodS * (kPings - 1), 1e-6);
  EXPECT_GT(report.pings->gain_nats_per_pixel, 2.0 * report.pings->gain_sigma);
  RecordProperty("gain", std::to_string(report.pings->gain_nats_per_pixel));
  RecordProperty("gain_sigma", std::to_string(report.pings->gain_sigma));
  const calib::FitReport& ignored = FitWith(PingUse::kIgnore).fit.report;
  ASSERT_TRUE(ignored.pings);
  EXPECT_FALSE(ignored.pings->used);
  EXPECT_GT(ignored.pings->gain_nats_per_pixel, 0.0);
  EXPECT_THAT(calib::FitReportJson(report), ::testing::HasSubstr("\"gain_nats_per_pixel\""));
}

TEST_F(TurningSonar, HeldOutImagesAgreeBetter) {
  const auto error = [](const RecordingFit& fit) {
    return *fit.after.aggregate.macro.polar.Over(metrics::IntensityDomain::kWhole).mean_absolute.value;
  };
  RecordProperty("error_with", std::to_string(error(FitWith(PingUse::kUse))));
  RecordProperty("error_without", std::to_string(error(FitWith(PingUse::kIgnore))));
  EXPECT_LT(error(FitWith(PingUse::kUse)), error(FitWith(PingUse::kIgnore)));
}

}  // namespace
}  // namespace sonarcal::workflow
