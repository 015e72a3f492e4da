// A frame whose pings have their own poses, against frames of one pose each.
#include "calib/models/ping_echoes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "calib/acoustic_fit.h"
#include "calib/models/acoustic_frame_model.h"
#include "calib/selection/ping_worth.h"
#include "core/types/units.h"
#include "tests/calib/small_tank.h"

namespace sonarcal::calib {
namespace {

constexpr int kPings = 3;

class PingFrames : public ::testing::Test {
 protected:
  PingFrames() : simulator_(testing::SmallTankWithWall(), testing::SmallSonar(), Options()) {
    truth_.materials["wall"] = truth_.materials["box"];
    truth_.materials["board"] = truth_.materials["box"];
    truth_.beam.azimuth_width_deg = 1.2;
    pattern_.period_s = 0.01;
    for (int beam = 0; beam < simulator_.sonar().axes.beam_count(); ++beam)
      pattern_.of_beam.push_back(beam % kPings);
    pings_ = PosesOfPings(pattern_, motion_);
  }

  static sim::SimulationOptions Options() {
    sim::SimulationOptions options = testing::SmallTankOptions();
    options.noise = true;
    options.fan.azimuth_margin_deg = 2.0;
    return options;
  }

  // A frame of 12 bits by the coherent model.
  GreyFrame Recorded(int index, const ParameterSet& truth) const {
    ParameterSet coherent = truth;
    coherent.model = EchoModel::kCoherent;
    return {.index = index,
            .world_from_sonar = poses_[index],
            .image = simulator_.RenderPings(poses_[index], pings_, coherent, index),
            .pings = pings_};
  }

  sim::Simulator simulator_;
  ParameterSet truth_ = testing::SmallTankAcousticTruth();
  std::vector<Pose> poses_ = testing::SmallTankPoses();
  PingPattern pattern_;
  Motion motion_{.velocity_m_per_s = {0.3, -0.4, 0.2}, .turn_rate_rad_per_s = {0.0, 0.0, RadFromDeg(60.0)}};
  std::vector<PingPose> pings_;
};

// Compares all parameters except poses and the tilt, with which the motion turns. Means, and their
// derivatives by curves, beam, losses of mirrors and geometry, are those of the frame at the pose of the
// pixel's ping, bit by bit.
TEST_F(PingFrames, EachPixelIsThatOfTheFrameAtItsPing) {
  truth_.mirrors["wall"].loss_db = 6.0;
  truth_.mirrors["floor"].loss_db = 3.0;
  std::vector<AcousticFrame> frames = FramesFor({Recorded(0, truth_)}, truth_.display);
  for (const PingPose& ping : pings_) {
    frames.push_back(frames.front());
    frames.back().index = static_cast<int>(frames.size());
    frames.back().pings.clear();
    frames.back().world_from_sonar = poses_[0] * ping.frame_from_ping;
  }
  AcousticFrameModel model(simulator_, frames, truth_);
  std::vector<int> active;
  std::vector<int> geometric;
  for (std::size_t i = 0; i < model.catalog().size(); ++i) {
    const CatalogEntry& entry = model.catalog()[i];
    if (entry.group == ParameterGroup::kPose || entry.name == "geometry.tilt_deg") continue;
    if (IsGeometric(entry) && !IsPlacement(entry) && !(model.initial_values()[i] > 0.0)) continue;
    active.push_back(static_cast<int>(i));
    if (IsGeometric(entry)) geometric.push_back(static_cast<int>(i));
  }
  model.Linearise(model.initial_values(), geometric);
  const ParameterValues values = model.initial_values();
  std::vector<PixelTerms> terms(frames.size());
  for (std::size_t frame = 0; frame < frames.size(); ++frame)
    ASSERT_TRUE(model.Evaluate(static_cast<int>(frame), values, active, FrameModel::Terms::kDerivatives,
                               terms[frame]));
  EXPECT_FALSE(model.echoes()[0].ghosts.empty());
  std::size_t differ = 0;
  for (std::size_t pixel = 0; pixel < model.pixel_count(); ++pixel) {
    const std::size_t of_ping = 1 + pixel % model.beams() % kPings;
    EXPECT_NEAR(terms[0].residual[pixel], terms[of_ping].residual[pixel], 1e-9);
    differ += std::abs(terms[0].residual[pixel] - terms[1].residual[pixel]) > 1e-3 ? 1 : 0;
    for (std::size_t k = 0; k < active.size(); ++k) {
      const double expected = terms[of_ping].eta_jacobian[pixel * active.size() + k];
      EXPECT_NEAR(terms[0].eta_jacobian[pixel * active.size() + k], expected,
                  1e-6 * (1.0 + std::abs(expected)))
          << model.catalog()[active[k]].name;
    }
  }
  EXPECT_GT(differ, model.pixel_count() / 10);
}

// The pings follow the pose of their frame, which has six parameters. Slopes agree with differences of
// images as well as those of a frame of one pose do.
TEST_F(PingFrames, DerivativesByThePoseAreThoseOfTheImage) {
  std::vector<AcousticFrame> frames = FramesFor({Recorded(0, truth_), Recorded(0, truth_)}, truth_.display);
  frames[1].pings.clear();
  AcousticFrameModel model(simulator_, frames, truth_);
  std::vector<int> entries;
  for (std::size_t i = 0; i < model.catalog().size(); ++i) {
    if (model.catalog()[i].group == ParameterGroup::kPose && model.catalog()[i].frame >= 0)
      entries.push_back(static_cast<int>(i));
  }
  ASSERT_EQ(entries.size(), 12U);
  const ParameterValues values = model.initial_values();
  model.Linearise(values, entries);
  const AcousticFrameModel::Rays rays = model.RaysAt(values, 1);
  const ParameterSet parameters = model.Parameters(values);
  const double noise = PowerFromDb(*truth_.receiver.noise_db);
  // Regression of the difference on the slope.
  const auto agreement = [&](int frame, std::size_t component) {
    const int entry = entries[6 * static_cast<std::size_t>(frame) + component];
    const double step = component < 3 ? 0.005 : 0.1;
    ParameterValues above = values;
    ParameterValues below = values;
    above[entry] += step;
    below[entry] -= step;
    const Grid<float> high =
        model.ExpectedPowerFrom(frame, model.PoseOf(frame, above), parameters, rays).value;
    const Grid<float> low =
        model.ExpectedPowerFrom(frame, model.PoseOf(frame, below), parameters, rays).value;
    EXPECT_EQ(model.echoes()[frame].slopes[component].entry, entry);
    const std::vector<float>& slope = model.echoes()[frame].slopes[component].logarithm;
    const std::vector<double> mean = model.MeanPower(frame, values);
    double both = 0.0;
    double own = 0.0;
    for (std::size_t pixel = 0; pixel < model.pixel_count(); ++pixel) {
      const double of_echoes = slope[pixel] * (1.0 - noise / mean[pixel]);
      both += of_echoes * std::log(high.values()[pixel] / low.values()[pixel]) / (2.0 * step);
      own += of_echoes * of_echoes;
    }
    return both / own;
  };
  for (std::size_t component = 0; component < 6; ++component)
    EXPECT_NEAR(agreement(0, component), agreement(1, component), 0.06)
        << model.catalog()[entries[component]].name;
}

// Over the frame the sonar turns by 1.2 degrees. Without the pings, the fitted yaw is off by about half of
// that. Both fits see the same speckle, so their difference is hardly random.
TEST_F(PingFrames, AFreePoseIsThatOfTheFrame) {
  const auto yaw_error_deg = [&](bool by_ping) {
    std::vector<GreyFrame> recorded = {Recorded(0, truth_)};
    recorded[0].world_from_sonar = recorded[0].world_from_sonar *
                                   Pose{RotationFromYawPitchRoll(RadFromDeg(0.8), 0, 0), {0.01, 0.0, 0.0}};
    if (!by_ping) recorded[0].pings.clear();
    const std::vector<AcousticFrame> frames = FramesFor(recorded, truth_.display);
    const Pose found = FitPosesOnly(simulator_, frames, truth_).at(0);
    const Pose off = poses_[0].Inverse() * found;
    return DegFromRad(YawPitchRollFromRotation(off.rotation)(0));
  };
  const double with_deg = yaw_error_deg(true);
  EXPECT_NEAR(with_deg, 0.0, 0.25);
  EXPECT_NEAR(yaw_error_deg(false) - with_deg, 0.6, 0.25);
}

TEST_F(PingFrames, TheirWorthIsMeasured) {
  const std::vector<GreyFrame> frames = {Recorded(0, truth_), Recorded(1, truth_)};
  const std::optional<PingWorth> worth = MeasurePingWorth(simulator_, frames, pattern_, truth_);
  ASSERT_TRUE(worth);
  EXPECT_EQ(worth->pings, kPings);
  EXPECT_THAT(worth->frames, ::testing::ElementsAre(0, 1));
  EXPECT_NEAR(worth->max_turn_deg, 1.2, 1e-9);
  EXPECT_NEAR(worth->max_distance_m, 0.02 * motion_.velocity_m_per_s.norm(), 1e-3);
  EXPECT_GT(worth->gain_nats_per_pixel, 3.0 * worth->gain_sigma);
  EXPECT_THAT(PingWorthText(*worth), ::testing::HasSubstr("Each frame has 3 pings, 10 ms apart."));
  std::vector<GreyFrame> still = frames;
  for (GreyFrame& frame : still) frame.pings.clear();
  EXPECT_FALSE(MeasurePingWorth(simulator_, still, pattern_, truth_));
}

}  // namespace
}  // namespace sonarcal::calib
