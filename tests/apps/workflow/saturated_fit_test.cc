// A SYNTHETIC recording made by the coherent model, with the traces of a saturated receiver added, is fitted
// as if they were not there.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include <nlohmann/json.hpp>

#include "apps/workflow/fit.h"
#include "apps/workflow/simulate.h"
#include "core/types/units.h"
#include "tests/calib/small_tank.h"

namespace sonarcal::workflow {
namespace {

constexpr int kFrames = 4;
constexpr int kStreakBin = 30;  // 1.25 m, before the floor
constexpr int kStreakBins = 3;

class SaturatedReceiver : public ::testing::Test {
 protected:
  static ParameterSet Truth() {
    ParameterSet truth = testing::SmallTankAcousticTruth();
    truth.pulse.length_m = 0.05;
    return truth;
  }

  static std::vector<Frame> Frames() {
    std::vector<Frame> frames;
    for (int i = 0; i < kFrames; ++i) frames.push_back(Recording().ReadFrame(i));
    return frames;
  }

  static RecordingFit FitOf(std::vector<Frame> frames) {
    ParameterSet start = Truth();
    *start.receiver.noise_db += 6.0;
    for (auto& [name, material] : start.materials)
      material.gsab = {.a = 0.05, .b_deg = 5.0, .c = 0.005, .d = 1.5, .e = 0.02, .f_deg = 15.0};
    FitOptions options;
    options.free = {"materials", "receiver.noise_db"};
    options.trust_all = true;
    options.starts = 1;
    return Fit(MemoryRecording(Recording().info(), std::move(frames)), testing::SmallTank(), start, options);
  }

  static const calib::FittedParameter& Noise(const RecordingFit& fit) {
    return *fit.fit.report.Find("receiver.noise_db");
  }

 private:
  static const MemoryRecording& Recording() {
    static const std::unique_ptr<MemoryRecording> kRecording = Simulated();
    return *kRecording;
  }

  static std::unique_ptr<MemoryRecording> Simulated() {
    ParameterSet coherent = Truth();
    coherent.model = EchoModel::kCoherent;
    std::vector<data_io::TimedPose> poses;
    for (int i = 0; i < kFrames; ++i) {
      const double yaw_rad = RadFromDeg(-12.0 + 8.0 * i);
      poses.push_back({.time_s = 0.1 * i,
                       .world_from_sonar = {RotationFromYawPitchRoll(yaw_rad, RadFromDeg(-25.0), 0.0),
                                            {0.1 * (i - 2.5), -2.5, 1.2}}});
    }
    SimulateOptions options;
    options.bits = 12;
    return Simulate(testing::SmallTank(),
                    {.sonar = testing::SmallSonar(), .water = Water{.salinity_ppt = 0.5}, .input = {}},
                    coherent, poses, options);
  }
};

TEST_F(SaturatedReceiver, StreaksAreLeftOutOfTheFitAndNamed) {
  const RecordingFit clean = FitOf(Frames());
  ASSERT_TRUE(clean.fit.usable);
  ASSERT_TRUE(clean.fit.report.saturation);
  EXPECT_TRUE(clean.fit.report.saturation->empty());

  std::vector<Frame> frames = Frames();
  std::mt19937_64 random(5);
  for (Frame& frame : frames) {
    const double full_scale = frame.image.scale.full_scale;
    std::uniform_real_distribution<float> level(0.8F * static_cast<float>(full_scale),
                                                0.9F * static_cast<float>(full_scale));
    for (int bin = kStreakBin; bin < kStreakBin + kStreakBins; ++bin) {
      for (float& value : frame.image.value.row(bin)) value = std::round(std::max(value, level(random)));
    }
  }
  const RecordingFit fit = FitOf(frames);
  ASSERT_TRUE(fit.fit.usable);
  ASSERT_EQ(fit.fit.report.saturation->size(), std::size_t{kFrames});
  for (const calib::FrameSaturation& of : *fit.fit.report.saturation) {
    ASSERT_EQ(of.streaks.size(), 1U);
    EXPECT_TRUE(of.streaks[0].bright);
    // At most one neighbour on each side may happen to be as bright.
    EXPECT_LE(of.streaks[0].first_bin, kStreakBin);
    EXPECT_GE(of.streaks[0].first_bin, kStreakBin - 1);
    EXPECT_GE(of.streaks[0].end_bin, kStreakBin + kStreakBins);
    EXPECT_LE(of.streaks[0].end_bin, kStreakBin + kStreakBins + 1);
  }
  ASSERT_TRUE(Noise(fit).sigma);
  EXPECT_NEAR(Noise(fit).value, Noise(clean).value, *Noise(clean).sigma);
  EXPECT_NEAR(Noise(fit).value, *Truth().receiver.noise_db, 4.0 * *Noise(fit).sigma);
  EXPECT_EQ(fit.streaked_frames.size(), 3U);
  const auto json = nlohmann::json::parse(calib::FitReportJson(fit.fit.report));
  EXPECT_EQ(json["saturation"].size(), std::size_t{kFrames});
}

TEST_F(SaturatedReceiver, ValuesThatPileUpStandForAllHigherPowers) {
  std::vector<Frame> frames = Frames();
  std::vector<float> values;
  for (const Frame& frame : frames)
    values.insert(values.end(), frame.image.value.values().begin(), frame.image.value.values().end());
  std::ranges::sort(values);
  const float limit = values[values.size() * 9 / 10];
  for (Frame& frame : frames) {
    for (float& value : frame.image.value.values()) value = std::min(value, limit);
  }
  const RecordingFit clean = FitOf(Frames());
  const RecordingFit fit = FitOf(frames);
  ASSERT_TRUE(fit.fit.usable);
  ASSERT_FALSE(fit.fit.report.saturation->empty());
  EXPECT_EQ(fit.fit.report.saturation->front().level, limit);
  EXPECT_TRUE(fit.streaked_frames.empty());
  ASSERT_TRUE(Noise(fit).sigma);
  EXPECT_NEAR(Noise(fit).value, *Truth().receiver.noise_db, 4.0 * *Noise(fit).sigma);
  for (const calib::FittedCurve& curve : clean.fit.report.curves) {
    const auto limited =
        std::ranges::find(fit.fit.report.curves, curve.material, &calib::FittedCurve::material);
    ASSERT_NE(limited, fit.fit.report.curves.end());
    int compared = 0;
    for (std::size_t i = 0; i < curve.backscatter_db.size(); ++i) {
      if (!curve.determined[i] || !limited->determined[i]) continue;
      ++compared;
      EXPECT_NEAR(limited->backscatter_db[i], curve.backscatter_db[i],
                  4.0 * std::hypot(limited->sigma_db[i], curve.sigma_db[i]))
          << curve.material << " " << curve.incidence_deg[i];
    }
    EXPECT_GT(compared, 0) << curve.material;
  }
}

}  // namespace
}  // namespace sonarcal::workflow
