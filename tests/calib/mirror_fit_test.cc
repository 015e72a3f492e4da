// Losses of mirrors in a fit: the model against the image that rays make, rays counted, losses found, and
// what is said of a mirror that shows nothing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "calib/acoustic_fit.h"
#include "calib/mirror_start.h"
#include "core/types/error.h"
#include "sim/acoustic/acoustic_image.h"
#include "tests/calib/small_tank.h"

namespace sonarcal::calib {
namespace {

class MirrorFit : public ::testing::Test {
 protected:
  static ParameterSet Truth() {
    ParameterSet truth = testing::SmallTankAcousticTruth();
    truth.receiver.noise_db = 105.0;
    truth.display = {.db_min = 90.0, .db_max = 160.0};
    truth.pulse.length_m = 0.05;
    truth.materials["wall"].gsab = {.a = 0.3, .b_deg = 4.0, .c = 0.005, .d = 1.2, .e = 0.05, .f_deg = 12.0};
    truth.materials["board"] = truth.materials["wall"];
    truth.mirrors["floor"].loss_db = 4.0;
    truth.mirrors["wall"].loss_db = 7.0;
    truth.beam.transmit_even_deg = 15.0;
    truth.beam.transmit_end_deg = 25.0;
    return truth;
  }

  static sim::SimulationOptions Options() {
    sim::SimulationOptions options = testing::SmallTankOptions();
    options.bits = 16;
    options.noise = true;
    options.seed = 7;
    options.fan.elevation_span_deg = 80.0;
    return options;
  }

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

  const sim::Simulator simulator_{testing::SmallTankWithWall(), testing::SmallSonar(), Options()};
};

TEST_F(MirrorFit, MeanPowersAreThoseOfTheImageWithGhosts) {
  const std::vector<AcousticFrame> frames = Frames(Truth());
  const AcousticFrameModel model(simulator_, frames, Truth());
  ParameterValues values = model.initial_values();
  for (std::size_t i = 0; i < values.size(); ++i) {
    const CatalogEntry& entry = model.catalog()[i];
    if (entry.group == ParameterGroup::kMirror) values[i] -= 2.5;
    if (entry.group == ParameterGroup::kGsab) values[i] *= 1.2;
  }
  const ParameterSet moved = model.Parameters(values);
  EXPECT_EQ(moved.mirrors.at("wall").loss_db, 4.5);
  ParameterSet without = moved;
  without.mirrors.clear();
  const AcousticFrameModel direct_model(simulator_, frames, without);
  double ghosts_add = 0.0;
  for (std::size_t frame = 0; frame < frames.size(); ++frame) {
    const Pose& pose = frames[frame].world_from_sonar;
    const std::vector<double> mean = model.MeanPower(static_cast<int>(frame), values);
    const std::vector<double> mean_direct =
        direct_model.MeanPower(static_cast<int>(frame), direct_model.initial_values());
    const AcousticFrameModel::Rays rays = model.RaysAt(values, 1);
    const PolarImage slow = model.ExpectedPowerFrom(0, pose, moved, rays);
    const PolarImage direct = model.ExpectedPowerFrom(0, pose, without, rays);
    for (std::size_t i = 0; i < mean.size(); ++i) {
      // What ghosts add to direct echoes and noise, of which the nodes of curves have an error of their own.
      const double added_db = 10.0 * std::log10(slow.value.values()[i] / direct.value.values()[i]);
      EXPECT_NEAR(10.0 * std::log10(mean[i] / mean_direct[i]), added_db, 0.1) << frame << ", " << i;
      ghosts_add = std::max(ghosts_add, added_db);
    }
  }
  EXPECT_GT(ghosts_add, 6.0) << "dB: there is something to agree about";
}

TEST_F(MirrorFit, LossesAreFoundWithoutARayBeyondOneTrace) {
  const std::vector<AcousticFrame> frames = Frames(Truth());
  ParameterSet start = Truth();
  start.mirrors["floor"].loss_db = 12.0;
  start.mirrors["wall"].loss_db = 12.0;
  for (auto& [name, material] : start.materials) material.gsab.c *= 2.0;
  FitOptions options;
  options.starts = 1;
  const std::int64_t before = simulator_.caster().rays_cast();
  for (const AcousticFrame& frame : frames) {
    simulator_.TraceEchoes(frame.world_from_sonar);
    simulator_.TraceGhosts(frame.world_from_sonar, start);
  }
  const std::int64_t one_trace = simulator_.caster().rays_cast() - before;
  const AcousticFit fit = FitAcousticModel(simulator_, frames, start, {}, options);
  EXPECT_EQ(simulator_.caster().rays_cast() - before, 2 * one_trace);
  ASSERT_TRUE(fit.usable) << fit.report.termination;
  for (const char* name : {"floor", "wall"}) {
    const FittedParameter* loss = fit.report.Find(std::string("mirror.") + name + ".loss_db");
    ASSERT_NE(loss, nullptr);
    ASSERT_TRUE(loss->sigma.has_value()) << name;
    EXPECT_LT(*loss->sigma, 1.0) << name;
    EXPECT_NEAR(loss->value, Truth().mirrors.at(name).loss_db, 3.5 * *loss->sigma) << name;
    EXPECT_EQ(fit.parameters.mirrors.at(name).loss_db, loss->value);
  }
}

TEST_F(MirrorFit, AMirrorThatShowsNothingIsNotDetermined) {
  ParameterSet start = Truth();
  start.mirrors["board"].loss_db = 9.0;
  FitOptions options;
  options.starts = 1;
  FitConfig config{.free = std::vector<std::string>{"mirrors", "noise"},
                   .fixed = {"receiver.noise_slope_db_per_m"}};
  const AcousticFit fit = FitAcousticModel(simulator_, Frames(Truth()), start, config, options);
  ASSERT_TRUE(fit.usable);
  const FittedParameter* board = fit.report.Find("mirror.board.loss_db");
  ASSERT_NE(board, nullptr);
  EXPECT_EQ(board->status, ParameterStatus::kUnidentifiable);
  EXPECT_EQ(board->value, 9.0);
  EXPECT_THAT(fit.report.unidentifiable_directions,
              ::testing::Contains("mirror.board.loss_db: no ghost by way of it in the frames used"));
  EXPECT_EQ(fit.report.Find("mirror.floor.loss_db")->status, ParameterStatus::kFree);
}

TEST_F(MirrorFit, HeldMirrorsAreInTheImagesAllTheSame) {
  const std::vector<AcousticFrame> frames = Frames(Truth());
  FitOptions options;
  options.starts = 1;
  const auto cost = [&](const ParameterSet& start) {
    const FitConfig noise_alone{.free = std::vector<std::string>{"receiver.noise_db"}};
    return FitAcousticModel(simulator_, frames, start, noise_alone, options).report.cost_final;
  };
  ParameterSet without = Truth();
  without.mirrors.clear();
  EXPECT_LT(cost(Truth()), cost(without) - 100.0) << "nats";
}

TEST_F(MirrorFit, AbsentMirrorsAndTransmitLimitsGetStartingValues) {
  ParameterSet start = Truth();
  start.beam.transmit_even_deg = 0.0;
  start.beam.transmit_end_deg = 0.0;
  const std::vector<std::string> free = MirrorsFreeByDefault(start, simulator_.caster().material_names());
  EXPECT_EQ(free, (std::vector<std::string>{"mirrors", "beam.transmit_end_deg"}));
  EXPECT_TRUE(MirrorsFreeByDefault(testing::SmallTankAcousticTruth(), {"floor"}).empty());
  EXPECT_EQ(MirrorsFreeByDefault(Truth(), {"floor"}), std::vector<std::string>{"mirrors"});
  const FitConfig config{.free = free};
  const ParameterSet complete =
      WithMirrorStart(start, config, simulator_.caster().material_names(), simulator_.sonar());
  EXPECT_NEAR(complete.beam.transmit_even_deg, 14.4, 1e-9) << "where the outer beams end";
  EXPECT_NEAR(complete.beam.transmit_end_deg, 34.4, 1e-9);
  EXPECT_EQ(WithMirrorStart(Truth(), config, {"floor"}, simulator_.sonar()), Truth());
  const FitConfig named{.free = std::vector<std::string>{"mirror.box.loss_db"}};
  EXPECT_EQ(WithMirrorStart(Truth(), named, {"floor", "box"}, simulator_.sonar()).mirrors.at("box").loss_db,
            kStartLossDb);
}

TEST_F(MirrorFit, TransmitLimitsOfWideBeamsStartWithinThoseOfTheFile) {
  ParameterSet start = Truth();
  start.beam.transmit_even_deg = 0.0;
  start.beam.transmit_end_deg = 0.0;
  const FitConfig config{.free = std::vector<std::string>{"beam.transmit_end_deg"}};
  SonarModel wide = simulator_.sonar();
  for (double& azimuth_rad : wide.axes.beam_azimuth_rad) azimuth_rad *= 80.0 / 14.4;
  const BeamParameters beam = WithMirrorStart(start, config, {"floor"}, wide).beam;
  EXPECT_NEAR(beam.transmit_even_deg, 80.0, 1e-6);
  EXPECT_EQ(beam.transmit_end_deg, 90.0);
}

TEST_F(MirrorFit, AGroupThatNoMirrorIsOfIsRefused) {
  const FitConfig config{.free = std::vector<std::string>{"mirrors"}};
  const std::vector<AcousticFrame> frames = Frames(Truth());
  ParameterSet without = Truth();
  without.mirrors.clear();
  EXPECT_THROW(FitAcousticModel(simulator_, frames, without, config, {}), DataError);
}

}  // namespace
}  // namespace sonarcal::calib
