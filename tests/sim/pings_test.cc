// Frames whose pings have their own poses.

#include "core/types/pings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/types/units.h"
#include "sim/simulator.h"
#include "tests/sim/meshes.h"
#include "tests/sim/slow_paper_model.h"

namespace sonarcal::sim {
namespace {

using namespace testing;  // NOLINT: the helpers of tests/sim

constexpr int kBins = 40;
constexpr int kBeams = 30;
constexpr int kPings = 3;
constexpr double kSpacingDeg = 1.0;
constexpr double kWidthDeg = 2.0;

class Pings : public ::testing::Test {
 protected:
  static SonarModel TestSonar() {
    SonarModel sonar = MakeSonar(EvenAzimuthsDeg(kBeams, kSpacingDeg), 22.0, 2.4, 4.0, kBins);
    sonar.azimuth_beam_width_deg = kWidthDeg;
    sonar.pings.period_s = 0.01;
    for (int beam = 0; beam < kBeams; ++beam) sonar.pings.of_beam.push_back(beam % kPings);
    return sonar;
  }

  static ParameterSet TestParameters(EchoModel model) {
    ParameterSet parameters;
    parameters.model = model;
    parameters.source_level_db = 180.0;
    parameters.materials["default"].gsab = {
        .a = 0.16, .b_deg = 12.0, .c = 4e-3, .d = 2.0, .e = 0.016, .f_deg = 20.0};
    parameters.pulse.length_m = 0.08;  // two bins
    parameters.receiver.noise_db = 40.0;
    parameters.display = {.db_min = 60.0, .db_max = 180.0};
    if (model != EchoModel::kPaper) return parameters;
    parameters.source_level_db = 200.0;
    parameters.materials["default"].gsab = {
        .a = 90.0, .b_deg = 12.0, .c = 0.5, .d = 2.0, .e = 8.0, .f_deg = 20.0};
    parameters.display = {.db_min = 160.0, .db_max = 170.0};
    return parameters;
  }

  std::unique_ptr<Simulator> Simulate(const Scene& scene, bool noise = false, int rows = 80) const {
    SimulationOptions options;
    options.bits = 16;
    options.noise = noise;
    options.fan = {
        .sampling = Sampling::kBeams, .cols = 8 * kBeams, .rows = rows, .elevation_span_deg = 30.0};
    if (noise) options.fan.azimuth_margin_deg = 8.0;
    return std::make_unique<Simulator>(scene, sonar_, options);
  }

  static Scene Floor() {
    Scene scene;
    AddQuad(scene, {-10, -4, 0}, {20, 0, 0}, {0, 20, 0}, "floor");
    return scene;
  }

  static Scene FloorWithPlate() {
    Scene scene = Floor();
    AddQuad(scene, {-0.4, 3.1, 0}, {0.8, 0.15, 0}, {0, 0.1, 1}, "plate");
    return scene;
  }

  // Powers of a 16-bit image of 120 dB.
  static Grid<double> PowerOf(const PolarImage& image) {
    Grid<double> power(image.value.rows(), image.value.cols());
    for (std::size_t i = 0; i < power.size(); ++i)
      power.values()[i] = PowerFromDb(60.0 + 120.0 * image.value.values()[i] / image.scale.full_scale);
    return power;
  }

  // Powers of a frame of two pings, the second after a move: all beams belong to the first or to the second.
  static Grid<double> AllBeams(const Simulator& simulator, const Pose& pose, const Eigen::Vector3d& move_m,
                               bool moved, const ParameterSet& parameters, int draw) {
    std::vector<PingPose> pings = {
        {.frame_from_ping = {}, .beams = {}},
        {.frame_from_ping = {Eigen::Quaterniond::Identity(), move_m}, .beams = {}}};
    for (int beam = 0; beam < kBeams; ++beam) pings[moved ? 1 : 0].beams.push_back(beam);
    return PowerOf(simulator.RenderPings(pose, pings, parameters, draw));
  }

  SonarModel sonar_ = TestSonar();
  Pose pose_{RotationFromYawPitchRoll(0.05, -0.12, 0.02), {0, 0, 0.5}};
};

// Sums of the products of two speckle patterns, each relative to its mean.
struct Correlation {
  double aa = 0.0;
  double bb = 0.0;
  double ab = 0.0;

  void Add(double a, double b) {
    aa += a * a;
    bb += b * b;
    ab += a * b;
  }
  double value() const { return ab / std::sqrt(aa * bb); }
};

TEST_F(Pings, EachBeamIsThatOfAnImageAtThePoseOfItsPing) {
  const Motion motion{.velocity_m_per_s = {0.8, 1.5, -0.4},
                      .turn_rate_rad_per_s = {RadFromDeg(40.0), RadFromDeg(-30.0), RadFromDeg(120.0)}};
  const std::unique_ptr<Simulator> simulator = Simulate(FloorWithPlate());
  for (const EchoModel model : {EchoModel::kPaper, EchoModel::kAcoustic}) {
    const ParameterSet parameters = TestParameters(model);
    const PolarImage frame = simulator->RenderPings(pose_, PosesOfPings(sonar_.pings, motion), parameters);
    const PolarImage at_once = simulator->Render(pose_, parameters);
    int moved = 0;
    for (int beam = 0; beam < kBeams; ++beam) {
      const PolarImage alone = simulator->Render(pose_ * motion.After(0.01 * (beam % kPings)), parameters);
      for (int bin = 0; bin < kBins; ++bin) {
        EXPECT_EQ(frame.value(bin, beam), alone.value(bin, beam)) << bin << " " << beam;
        moved += frame.value(bin, beam) != at_once.value(bin, beam) ? 1 : 0;
      }
    }
    EXPECT_GT(moved, kBins * kBeams / 5) << ToString(model);
  }
}

TEST_F(Pings, WithoutMotionNothingChanges) {
  for (const EchoModel model : {EchoModel::kPaper, EchoModel::kAcoustic, EchoModel::kCoherent}) {
    const bool noise = model != EchoModel::kPaper;
    const std::unique_ptr<Simulator> simulator = Simulate(FloorWithPlate(), noise);
    const ParameterSet parameters = TestParameters(model);
    EXPECT_EQ(simulator->RenderPings(pose_, PosesOfPings(sonar_.pings, Motion()), parameters, 3).value,
              simulator->Render(pose_, parameters, 3).value);
  }
}

// The sonar turns left by the spacing of its beams from ping to ping. Beam k + 1 of ping p + 1 then looks
// where beam k of ping p looked, from the same position. Nothing has changed, so the speckle is the same.
TEST_F(Pings, SpeckleStaysOnTheFloorWhileTheSonarTurns) {
  const Pose level{Eigen::Quaterniond::Identity(), {0, 0, 0.5}};
  const Motion turn{.turn_rate_rad_per_s = {0.0, 0.0, RadFromDeg(kSpacingDeg / 0.01)}};
  const std::vector<PingPose> pings = PosesOfPings(sonar_.pings, turn);
  const std::unique_ptr<Simulator> simulator = Simulate(Floor(), /*noise=*/true);
  for (const EchoModel model : {EchoModel::kAcoustic, EchoModel::kCoherent}) {
    const ParameterSet parameters = TestParameters(model);
    Correlation same;
    Correlation neighbours;
    for (int draw = 0; draw < 8; ++draw) {
      const Grid<double> power = PowerOf(simulator->RenderPings(level, pings, parameters, draw));
      for (int bin = 4; bin < kBins - 4; ++bin) {
        const auto row = power.row(bin);
        double mean = 0.0;
        for (const double value : row) mean += value / kBeams;
        for (int beam = 3; beam + 4 < kBeams; beam += kPings) {
          same.Add(power(bin, beam) / mean - 1.0, power(bin, beam + 1) / mean - 1.0);
          same.Add(power(bin, beam) / mean - 1.0, power(bin, beam + 2) / mean - 1.0);
          neighbours.Add(power(bin, beam + 2) / mean - 1.0, power(bin, beam + 3) / mean - 1.0);
        }
      }
    }
    EXPECT_GT(same.value(), 0.97) << ToString(model);
    // Beam k + 3 looks three spacings beside beam k + 2: a beam and a half.
    EXPECT_LT(neighbours.value(), 0.3) << ToString(model);
  }
}

// Seen from d beside, the echoes of a beam add with other phases. Through a Gaussian beam of standard
// deviation s (two-way power) the correlation of the powers is exp(-(2 k d s)^2); the beam of an aperture is
// about that. After a move ahead by a bin, all phases of a beam that looks ahead change alike: the pattern is
// a bin nearer.
TEST_F(Pings, SpeckleDecorrelatesWithMotionAside) {
  const Pose level{RotationFromYawPitchRoll(0.0, -0.12, 0.0), {0, 0, 0.5}};
  constexpr int kDraws = 12;
  // The acoustic model needs rays as close in range as its rows.
  const std::unique_ptr<Simulator> few_rays = Simulate(Floor(), /*noise=*/true);
  const std::unique_ptr<Simulator> many_rays = Simulate(Floor(), /*noise=*/true, 1200);
  const double s_rad = RadFromDeg(kWidthDeg) / std::sqrt(8.0 * std::log(2.0));
  const double twice_k = 4.0 * kPi * sonar_.frequency_hz / sonar_.sound_speed_m_per_s;
  const auto correlation = [&](EchoModel model, const Eigen::Vector3d& move_m, int bins_nearer, int left) {
    const ParameterSet parameters = TestParameters(model);
    const Simulator& simulator = model == EchoModel::kCoherent ? *few_rays : *many_rays;
    std::vector<Grid<double>> here;
    std::vector<Grid<double>> there;
    std::vector<double> mean_here(kBins, 0.0);
    std::vector<double> mean_there(kBins, 0.0);
    for (int draw = 0; draw < kDraws; ++draw) {
      here.push_back(AllBeams(simulator, level, move_m, false, parameters, draw));
      there.push_back(AllBeams(simulator, level, move_m, true, parameters, draw));
      for (int bin = 0; bin < kBins; ++bin) {
        for (int beam = 0; beam < kBeams; ++beam) {
          mean_here[bin] += here.back()(bin, beam) / (kBeams * kDraws);
          mean_there[bin] += there.back()(bin, beam) / (kBeams * kDraws);
        }
      }
    }
    Correlation of;
    for (int draw = 0; draw < kDraws; ++draw) {
      for (int bin = 4; bin < kBins - 4; ++bin) {
        const int moved = bin - bins_nearer;
        for (int beam = left; beam < kBeams - left; ++beam)
          of.Add(here[draw](bin, beam) / mean_here[bin] - 1.0,
                 there[draw](moved, beam) / mean_there[moved] - 1.0);
      }
    }
    return of.value();
  };
  for (const EchoModel model : {EchoModel::kAcoustic, EchoModel::kCoherent}) {
    for (const double aside_m : {0.002, 0.005, 0.02}) {
      EXPECT_NEAR(correlation(model, {aside_m, 0.0, 0.0}, 0, 4),
                  std::exp(-std::pow(twice_k * aside_m * s_rad, 2)), 0.12)
          << ToString(model) << " " << aside_m;
    }
    EXPECT_GT(correlation(model, {0.0, sonar_.axes.range_bin_m(), 0.0}, 1, kBeams / 2 - 2), 0.8)
        << ToString(model);
  }
}

// The scatterers of the coherent model stay where they are. Its mean power is still that of each ping's pose.
TEST_F(Pings, MeanOfCoherentFramesIsTheExpectedFrame) {
  constexpr int kDraws = 60;
  const Motion motion{.velocity_m_per_s = {0.5, 0.5, 0.0},
                      .turn_rate_rad_per_s = {0.0, 0.0, RadFromDeg(150.0)}};
  const std::vector<PingPose> pings = PosesOfPings(sonar_.pings, motion);
  ParameterSet parameters = TestParameters(EchoModel::kCoherent);
  parameters.beam.azimuth_pattern = AzimuthPattern::kAperture;
  const std::unique_ptr<Simulator> simulator = Simulate(Floor(), /*noise=*/true);
  const AcousticGeometry geometry{sonar_, simulator->absorption_db_per_m()};
  const Grid<double> expected = RenderByPing(pose_, pings, [&](const Pose& pose) {
    return EchoPowerImage(simulator->Scatter(simulator->TraceEchoes(pose), parameters), geometry, parameters);
  });
  Grid<double> sum(kBins, kBeams);
  for (int draw = 0; draw < kDraws; ++draw) {
    const Grid<double> power = PowerOf(simulator->RenderPings(pose_, pings, parameters, draw));
    for (std::size_t i = 0; i < sum.size(); ++i) sum.values()[i] += power.values()[i] / kDraws;
  }
  constexpr int kBeamsPerPing = kBeams / kPings;
  std::vector<double> of_ping(kPings, 0.0);
  for (int beam = 0; beam < kBeams; ++beam) {
    for (int bin = 4; bin < kBins - 4; ++bin)
      of_ping[beam % kPings] += sum(bin, beam) / expected(bin, beam) / (kBeamsPerPing * (kBins - 8));
  }
  // About 60 independent values per draw and ping.
  for (int ping = 0; ping < kPings; ++ping) EXPECT_NEAR(of_ping[ping], 1.0, 0.06) << ping;
}

}  // namespace
}  // namespace sonarcal::sim
