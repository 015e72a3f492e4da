// Speckle told from receiver noise: on frames made here by drawing fields, which share no code with the
// estimator, and on a SYNTHETIC recording made by another kind of simulation.
#include "calib/noise/still_frames.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numeric>
#include <random>

#include "calib/noise/still_likelihood.h"
#include "core/types/units.h"
#include "sim/gathered/pixel_echoes.h"
#include "sim/physics/frozen_speckle.h"
#include "sim/physics/gsab.h"
#include "tests/calib/synthetic_tank.h"
#include "tests/support/recordings.h"

namespace sonarcal::calib {
namespace {

// Slowly varying echoes from 20 dB below to 40 dB above the noise, speckle in grains of 2 x 3 pixels.
struct StillScene {
  int bins = 160;
  int beams = 96;
  int frames = 6;
  int looks = 1;
  double noise_db = 40.0;
  double echo_low_db = 20.0;
  double echo_high_db = 70.0;
  double db_min = 20.0;
  double db_max = 90.0;
  int moved_frame = -1;  // shows another draw of the speckle
  bool fresh = false;    // every frame does
  unsigned seed = 1;

  double EchoDb(int bin, int beam) const {
    const double along = (bin + 0.3 * beam) / (bins + 0.3 * beams);
    return echo_low_db + (echo_high_db - echo_low_db) * along;
  }
  DisplayParameters<double> display() const { return {.db_min = db_min, .db_max = db_max}; }
};

using Field = std::vector<std::complex<double>>;

Field DrawField(const StillScene& scene, std::mt19937_64& random) {
  std::normal_distribution<double> normal(0.0, std::sqrt(0.5));
  const auto grains = static_cast<std::size_t>(scene.bins / 2 + 1) * (scene.beams / 3 + 1) * scene.looks;
  Field grain(grains);
  for (auto& value : grain) value = {normal(random), normal(random)};
  Field field;
  for (int bin = 0; bin < scene.bins; ++bin) {
    for (int beam = 0; beam < scene.beams; ++beam) {
      const std::size_t of = static_cast<std::size_t>(bin / 2) * (scene.beams / 3 + 1) + beam / 3;
      for (int look = 0; look < scene.looks; ++look)
        field.push_back(std::pow(10.0, scene.EchoDb(bin, beam) / 20.0) * grain[of * scene.looks + look]);
    }
  }
  return field;
}

std::vector<PolarImage> Draw(const StillScene& scene) {
  std::mt19937_64 random(scene.seed);
  std::normal_distribution<double> normal(0.0, std::sqrt(0.5 * std::pow(10.0, scene.noise_db / 10.0)));
  const Field echo = DrawField(scene, random);
  std::vector<PolarImage> images;
  for (int frame = 0; frame < scene.frames; ++frame) {
    const Field here = scene.fresh || frame == scene.moved_frame ? DrawField(scene, random) : echo;
    PolarImage image;
    image.value = Grid<float>(scene.bins, scene.beams);
    for (std::size_t pixel = 0; pixel < image.value.size(); ++pixel) {
      double power = 0.0;
      for (int look = 0; look < scene.looks; ++look)
        power += std::norm(here[pixel * scene.looks + look] + std::complex{normal(random), normal(random)});
      const double db = 10.0 * std::log10(power / scene.looks);
      const double grey = 255.0 * (db - scene.db_min) / (scene.db_max - scene.db_min);
      image.value.values()[pixel] = static_cast<float>(std::clamp(std::round(grey), 0.0, 255.0));
    }
    images.push_back(std::move(image));
  }
  return images;
}

std::vector<int> Numbers(int count) {
  std::vector<int> numbers(count);
  std::iota(numbers.begin(), numbers.end(), 0);
  return numbers;
}

StillOptions OptionsFor(const StillScene& scene) {
  return {.display = scene.display(), .looks = static_cast<double>(scene.looks)};
}

StillLevels Tell(const StillScene& scene) {
  return SeparateSpeckleFromNoise(Draw(scene), Numbers(scene.frames), OptionsFor(scene));
}

std::vector<double> ExpectedPower(const StillScene& scene) {
  std::vector<double> power;
  for (int bin = 0; bin < scene.bins; ++bin) {
    for (int beam = 0; beam < scene.beams; ++beam)
      power.push_back(std::pow(10.0, scene.EchoDb(bin, beam) / 10.0));
  }
  return power;
}

// Speckle in grains of six pixels, all within a block of pixels of its own.
void ExpectLevels(const StillScene& scene) {
  const StillLevels levels = Tell(scene);
  EXPECT_EQ(levels.frames, Numbers(scene.frames));
  EXPECT_NEAR(levels.noise_db, scene.noise_db, 4.0 * levels.noise_sigma_db);
  EXPECT_LT(levels.noise_sigma_db, 0.15);
  const SceneEchoes echoes = CompareSceneEchoes(levels, ExpectedPower(scene), OptionsFor(scene));
  EXPECT_NEAR(echoes.measured_db, echoes.expected_db, 4.0 * echoes.sigma_db);
  EXPECT_LT(echoes.sigma_db, 0.5);
}

TEST(FrozenPowerCdf, EqualsTheFractionOfDraws) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal(0.0, std::sqrt(0.5));
  constexpr int kDraws = 200000;
  for (const int looks : {1, 3}) {
    for (const double echo : {0.0, 0.4, 5.0, 400.0}) {
      std::vector<double> power(kDraws);
      for (double& value : power) {
        value = 0.0;
        for (int look = 0; look < looks; ++look)
          value += std::norm(std::complex{std::sqrt(echo) + normal(random), normal(random)}) / looks;
      }
      for (const double of_mean : {0.2, 0.8, 0.95, 1.0, 1.1, 2.0}) {
        const double ratio = of_mean * (echo + 1.0);
        const auto below = std::count_if(power.begin(), power.end(), [&](double p) { return p <= ratio; });
        EXPECT_NEAR(sim::FrozenPowerCdf(looks, echo, ratio), static_cast<double>(below) / kDraws, 0.005)
            << looks << " looks, echo " << echo << ", ratio " << ratio;
      }
    }
  }
}

TEST(FrozenPowerCdf, HasMeanAndVarianceOfTheLaw) {
  for (const double looks : {1.0, 1.4, 3.0}) {
    for (const double echo : {0.0, 2.0, 50.0, 2000.0}) {
      // E[z] and E[z^2] by the integral of 1 - F.
      const double end = echo + 1.0 + 14.0 * std::sqrt((1.0 + 2.0 * echo) / looks) + 20.0;
      constexpr int kSteps = 20000;
      const double h = end / kSteps;
      double mean = 0.0;
      double square = 0.0;
      for (int i = 0; i < kSteps; ++i) {
        const double z = (i + 0.5) * h;
        const double above = 1.0 - sim::FrozenPowerCdf(looks, echo, z);
        mean += above * h;
        square += 2.0 * z * above * h;
      }
      EXPECT_NEAR(mean, echo + 1.0, 1e-4 * (echo + 1.0));
      EXPECT_NEAR(square - mean * mean, (1.0 + 2.0 * echo) / looks, 2e-3 * (1.0 + 2.0 * echo));
    }
  }
}

// The nodes between the noise and the brightest pixels are limited in number.
TEST(StillFrames, AnyNumberOfFramesAndLooksUsesPixelsUpToTenDbAboveTheNoise) {
  EXPECT_EQ(BrightestUsedDb(1.0, 6, 30.0), 30.0);
  double last_db = 40.0;
  for (const int frames : {6, 100, 400, 525, 1300, 1500, 2500, 100000}) {
    const double brightest_db = BrightestUsedDb(4.0, frames, 40.0);
    EXPECT_GE(brightest_db, kMinBrightestDb) << frames;
    EXPECT_LE(brightest_db, last_db) << frames;
    last_db = brightest_db;
  }
  EXPECT_NEAR(last_db, kMinBrightestDb, 1e-9);
}

TEST(StillFrames, NoiseAndSpeckleOfOneLookAreSeparated) {
  ExpectLevels({});
}

TEST(StillFrames, NoiseAndSpeckleOfThreeLooksAreSeparated) {
  ExpectLevels({.looks = 3, .seed = 2});
}

TEST(StillFrames, TwoFramesSufficeToSeparateNoise) {
  ExpectLevels({.frames = 2, .seed = 3});
}

// Noise is seen in one pixel of four, and echoes only up to 20 dB above it.
TEST(StillFrames, ClippingAtBothEndsIsCarriedThrough) {
  const StillScene scene{.echo_low_db = 0.0, .db_min = 41.5, .db_max = 60.0, .seed = 4};
  const StillLevels levels = Tell(scene);
  EXPECT_NEAR(levels.noise_db, scene.noise_db, 4.0 * levels.noise_sigma_db);
  EXPECT_LT(levels.noise_sigma_db, 0.25);
  EXPECT_GT(levels.clipped_at_top, 0U);
}

// The deviations of many small recordings, in sigmas, are those of a normal law: no speckle is counted once
// a frame, no block twice.
TEST(StillFrames, ErrorsScatterAsTheStandardErrorsState) {
  constexpr int kDraws = 24;
  double noise = 0.0;
  double echo = 0.0;
  for (unsigned draw = 0; draw < kDraws; ++draw) {
    const StillScene scene{.bins = 96, .beams = 64, .frames = 4, .seed = 100 + draw};
    const StillLevels levels = Tell(scene);
    noise += std::pow((levels.noise_db - scene.noise_db) / levels.noise_sigma_db, 2);
    const SceneEchoes echoes = CompareSceneEchoes(levels, ExpectedPower(scene), OptionsFor(scene));
    echo += std::pow((echoes.measured_db - echoes.expected_db) / echoes.sigma_db, 2);
  }
  // Chi-square of 24 degrees of freedom: 99.9 % lie between 0.33 and 2.2 times that.
  EXPECT_GT(noise / kDraws, 0.33);
  EXPECT_LT(noise / kDraws, 2.2);
  EXPECT_GT(echo / kDraws, 0.33);
  EXPECT_LT(echo / kDraws, 2.2);
}

TEST(StillFrames, AKnownShapeOfTheNoiseIsFollowed) {
  StillScene scene{.seed = 5};
  // The same frames read as if the far half had been amplified by 6 dB: its noise is as much higher.
  std::vector<PolarImage> images = Draw(scene);
  StillOptions options = OptionsFor(scene);
  const int half = scene.bins / 2;
  const auto grey = static_cast<float>(std::round(6.0 * 255.0 / (scene.db_max - scene.db_min)));
  const double shift_db = grey * (scene.db_max - scene.db_min) / 255.0;
  for (PolarImage& image : images) {
    for (int bin = half; bin < scene.bins; ++bin) {
      for (float& value : image.value.row(bin)) value = std::min(255.0F, value + grey);
    }
  }
  options.noise_shape_db.assign(static_cast<std::size_t>(scene.bins) * scene.beams, 0.0);
  std::fill(options.noise_shape_db.begin() + static_cast<std::ptrdiff_t>(half) * scene.beams,
            options.noise_shape_db.end(), shift_db);
  const StillLevels levels = SeparateSpeckleFromNoise(images, Numbers(scene.frames), options);
  EXPECT_NEAR(levels.noise_db, scene.noise_db, 4.0 * levels.noise_sigma_db);
}

TEST(StillFrames, AFrameThatMovedIsLeftOutAndNamed) {
  const StillScene scene{.moved_frame = 3, .seed = 6};
  const StillLevels levels = Tell(scene);
  EXPECT_EQ(levels.moved, std::vector<int>{3});
  EXPECT_EQ(levels.frames, (std::vector<int>{0, 1, 2, 4, 5}));
  EXPECT_NEAR(levels.noise_db, scene.noise_db, 4.0 * levels.noise_sigma_db);
}

TEST(StillFrames, RefusesASceneThatMoves) {
  try {
    Tell({.fresh = true, .seed = 7});
    FAIL() << "fresh speckle was taken for frozen";
  } catch (const DataError& error) {
    EXPECT_NE(std::string(error.what()).find("either the scene moves"), std::string::npos) << error.what();
  }
  EXPECT_THROW(Tell({.frames = 1}), DataError);
}

TEST(StillFrames, FramesOfClippedPixelsAreCalledThat) {
  const StillScene scene{.frames = 6};
  std::vector<PolarImage> images = Draw(scene);
  for (PolarImage& image : images) std::ranges::fill(image.value.values(), 255.0F);
  try {
    SeparateSpeckleFromNoise(images, Numbers(scene.frames), OptionsFor(scene));
    FAIL() << "nothing is known of clipped pixels";
  } catch (const DataError& error) {
    EXPECT_NE(std::string(error.what()).find("every pixel is clipped"), std::string::npos) << error.what();
  }
}

// What the true parameters make the simulator expect, without noise.
std::vector<double> ExpectedEchoes(const sim::Simulator& simulator, const Pose& pose,
                                   const ParameterSet& parameters) {
  const sim::PixelEchoes echoes = sim::GatherPixelEchoes(simulator, pose, parameters);
  const std::vector<double>& angles = sim::CoarseIncidenceDeg();
  const std::vector<std::string>& names = simulator.caster().material_names();
  const PolarAxes& axes = simulator.sonar().axes;
  std::vector<double> power;
  for (std::size_t pixel = 0; pixel + 1 < echoes.start.size(); ++pixel) {
    double sum = 0.0;
    for (std::uint32_t e = echoes.start[pixel]; e < echoes.start[pixel + 1]; ++e) {
      const sim::PixelEchoes::Entry& entry = echoes.entries[e];
      const auto& gsab = parameters.Material(names[entry.node / angles.size()]).gsab;
      sum += entry.weight * std::pow(10.0, sim::GsabDb(gsab, angles[entry.node % angles.size()]) / 10.0);
    }
    power.push_back(sum * std::pow(10.0, parameters.source_level_db / 10.0));
  }
  EXPECT_EQ(power.size(), static_cast<std::size_t>(axes.range_bins) * axes.beam_count());
  return power;
}

TEST(StillFrames, SyntheticTankStandsStill) {
  SONARCAL_NEEDS_RECORDING(folder, "synthetic_tank_static");
  const testing::SyntheticTank tank(folder);
  const RecordingSource& recording = *tank.recording;
  std::vector<PolarImage> images;
  for (int i = 0; i < recording.frame_count(); ++i) images.push_back(recording.ReadFrame(i).image);
  const StillOptions options{.display = tank.known.display};
  const StillLevels levels = SeparateSpeckleFromNoise(images, Numbers(recording.frame_count()), options);
  EXPECT_TRUE(levels.moved.empty());
  const double noise_db = tank.TrueNoiseDb();
  EXPECT_NEAR(levels.noise_db, noise_db, 0.5);
  EXPECT_NEAR(levels.noise_db, noise_db, 4.0 * levels.noise_sigma_db);
  EXPECT_LT(levels.noise_sigma_db, 0.1);

  const std::vector<double> expected =
      ExpectedEchoes(tank.simulator, recording.frame_info(0).world_from_sonar.value(), tank.TrueParameters());
  const SceneEchoes echoes = CompareSceneEchoes(levels, expected, options);
  EXPECT_GT(echoes.pixels, 10000U);
  EXPECT_NEAR(echoes.measured_db, echoes.expected_db, 0.5);
  EXPECT_NEAR(echoes.measured_db, echoes.expected_db, 4.0 * echoes.sigma_db);
  EXPECT_LT(echoes.sigma_db, 0.15);
  const double mean_db = DbFromPower(std::accumulate(expected.begin(), expected.end(), 0.0) /
                                     static_cast<double>(expected.size()));
  EXPECT_NEAR(levels.echo_db, mean_db, 4.0 * levels.echo_sigma_db);
  EXPECT_NEAR(echoes.contrast, 1.0, 0.15) << "speckle of one look";
}

}  // namespace
}  // namespace sonarcal::calib
