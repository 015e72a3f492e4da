// The frame in one pass against the same rays traced to echoes and shaded one at a time.
#include "sim/paper/paper_frame.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "sim/scenes/scenes.h"
#include "sim/scenes/sonar_presets.h"
#include "tests/sim/thread_limit.h"
#include "tests/sim/water.h"

namespace sonarcal::sim {
namespace {

using testing::kAlphaDbPerM;

struct PaperCase {
  Sampling sampling = Sampling::kFrustum;
  bool noise = false;
  JitterGrowth growth = JitterGrowth::kRoot;
  bool uneven_beams = false;
  RayWeight weight = RayWeight::kEven;
  bool stagger = false;
};

class PaperFrame : public ::testing::TestWithParam<PaperCase> {
 protected:
  static SonarModel Sonar(bool uneven_beams) {
    SonarModel sonar = FindSonarPreset("p900-45").sonar;
    if (uneven_beams) {
      for (double& azimuth : sonar.axes.beam_azimuth_rad) azimuth += 0.1 * azimuth * azimuth;
    }
    return sonar;
  }

  static PaperParameters<double> Parameters(const RayCaster& caster, JitterGrowth growth) {
    ParameterSet set;
    set.source_level_db = 200.0;
    set.display = {.db_min = 100.0, .db_max = 130.0};
    set.materials["default"].gsab = {.a = 80.0, .b_deg = 0.7, .c = 2.0, .d = 1.5, .e = 8.0, .f_deg = 14.0};
    set.materials["mockup"].gsab = {.a = 40.0, .b_deg = 3.0, .c = 20.0, .d = 1.0, .e = 10.0, .f_deg = 12.0};
    set.jitter = {
        .sigma_range_m = 0.02, .sigma_azimuth_deg = 0.6, .reference_range_m = 4.0, .growth = growth};
    return PaperParametersFor(set, caster.material_names());
  }
};

TEST_P(PaperFrame, IsTheImageOfTheEchoes) {
  const RayCaster caster(MakeMockupTank());
  const SonarModel sonar = Sonar(GetParam().uneven_beams);
  const RayFan fan(sonar, {.sampling = GetParam().sampling,
                           .cols = 700,
                           .rows = 500,
                           .row_crowding = GetParam().weight == RayWeight::kEven ? 1.0 : 3.0,
                           .weight = GetParam().weight,
                           .stagger = GetParam().stagger});
  const PaperParameters<double> parameters = Parameters(caster, GetParam().growth);
  PaperImageOptions options;
  if (GetParam().noise) options.noise_seed = 0xABCDEF0123ULL;
  for (const Pose& pose : MockupTankPoses(3)) {
    const PolarImage slow =
        RenderPaperImage(Trace(caster, fan, pose, sonar.axes), sonar, parameters, kAlphaDbPerM, options);
    const PolarImage fast = RenderPaperFrame(caster, fan, pose, sonar, parameters, kAlphaDbPerM, options);
    ASSERT_EQ(fast.value.size(), slow.value.size());
    // A ray on a bin's border may fall to either side: then two pixels of one beam (or, with errors, of two)
    // differ, and their sum does not.
    std::size_t off = 0;
    double sum_slow = 0.0;
    double sum_fast = 0.0;
    double largest = 0.0;
    for (std::size_t i = 0; i < slow.value.size(); ++i) {
      const double difference = std::abs(fast.value.values()[i] - slow.value.values()[i]);
      if (difference > 0.01) ++off;
      largest = std::max(largest, difference);
      sum_slow += slow.value.values()[i];
      sum_fast += fast.value.values()[i];
    }
    EXPECT_LT(static_cast<double>(off), 1e-3 * static_cast<double>(slow.value.size()));
    EXPECT_NEAR(sum_fast / sum_slow, 1.0, 1e-4);
    const std::span<const float> shown = slow.value.values();
    EXPECT_GT(*std::max_element(shown.begin(), shown.end()), 50.0F) << "the image shows something";
    RecordProperty("largest_difference_grey", std::to_string(largest));
    RecordProperty("pixels_off", static_cast<int>(off));
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, PaperFrame,
    ::testing::Values(
        PaperCase{.sampling = Sampling::kFrustum}, PaperCase{.sampling = Sampling::kBeams},
        PaperCase{.sampling = Sampling::kFrustum, .noise = true},
        PaperCase{.sampling = Sampling::kBeams, .noise = true, .growth = JitterGrowth::kLinear},
        PaperCase{.sampling = Sampling::kBeams, .noise = true, .uneven_beams = true},
        PaperCase{.sampling = Sampling::kFrustum, .weight = RayWeight::kSolidAngle},
        PaperCase{.sampling = Sampling::kBeams, .noise = true, .weight = RayWeight::kSolidAngle},
        PaperCase{.sampling = Sampling::kBeams, .stagger = true},
        PaperCase{.sampling = Sampling::kBeams, .noise = true, .uneven_beams = true, .stagger = true}));

TEST(PaperFrameThreads, AnyNumberGivesTheSame) {
  const RayCaster caster(MakeMockupTank());
  const SonarModel sonar = FindSonarPreset("p900-45").sonar;
  const RayFan fan(sonar, {.cols = 301, .rows = 200});
  ParameterSet set;
  set.display = {.db_min = 150.0, .db_max = 153.0};
  set.jitter = {.sigma_range_m = 0.02, .sigma_azimuth_deg = 0.6};
  set.materials["default"];
  const PaperParameters<double> parameters = PaperParametersFor(set, caster.material_names());
  const Pose pose = MockupTankPoses(1).front();
  const auto render = [&] {
    const PolarImage image =
        RenderPaperFrame(caster, fan, pose, sonar, parameters, kAlphaDbPerM, {.noise_seed = 7});
    return std::vector<float>(image.value.values().begin(), image.value.values().end());
  };
  EXPECT_EQ(testing::WithThreads(1, render), testing::WithThreads(3, render));
}

// A sonar in open water, and one whose window begins behind everything.
TEST(PaperFrameEmpty, NothingThereIsBlack) {
  const RayCaster caster(MakeMockupTank());
  SonarModel sonar = FindSonarPreset("p900-45").sonar;
  const RayFan fan(sonar, {.cols = 64, .rows = 20});
  ParameterSet set;
  set.materials["default"];
  const PaperParameters<double> parameters = PaperParametersFor(set, caster.material_names());
  const auto brightest = [&](const Pose& pose) {
    const PolarImage image = RenderPaperFrame(caster, fan, pose, sonar, parameters, kAlphaDbPerM);
    return *std::max_element(image.value.values().begin(), image.value.values().end());
  };
  EXPECT_EQ(brightest({Eigen::Quaterniond::Identity(), {0.0, 500.0, 1.0}}), 0.0F);
  const Pose inside = MockupTankPoses(1).front();
  EXPECT_GT(brightest(inside), 0.0F);
  sonar.axes.range_min_m = 60.0;
  sonar.axes.range_max_m = 80.0;
  EXPECT_EQ(brightest(inside), 0.0F);
}

}  // namespace
}  // namespace sonarcal::sim
