// The noise law on real recordings, with the thresholds it has to keep on pings that were not fitted.
#include <gtest/gtest.h>

#include <iostream>

#include "calib/noise/noise_fit.h"
#include "data_io/open_recording.h"
#include "tests/support/recordings.h"

namespace sonarcal::calib {
namespace {

void Print(const char* what, const NoiseFit& fit) {
  std::cout << what << ": KS " << fit.judged.ks << ", W1 " << fit.judged.wasserstein_grey << " grey, cell KS "
            << fit.judged.cell_ks_median << " / " << fit.judged.cell_ks_p95 << ", " << fit.report.solve_s
            << " s, looks " << fit.law.receiver.looks << ", span "
            << fit.law.display.db_max - fit.law.display.db_min << ", display "
            << static_cast<int>(fit.law.display.law) << ", speckle " << ToString(fit.law.speckle) << ", gain "
            << static_cast<int>(fit.law.receiver.time_varied_gain) << ", bins " << fit.cells.first_bin
            << " to " << fit.cells.last_bin << ", fitted KS " << fit.used.ks << "\n";
  for (const NoiseModelChoice& c : fit.choices) {
    std::cout << "   " << static_cast<int>(c.display) << " " << ToString(c.speckle) << " "
              << static_cast<int>(c.time_varied_gain) << " " << c.floor_after_gain << " " << c.nats_per_pixel
              << (c.chosen ? " *" : "") << (c.converged ? "" : " not converged") << "\n";
  }
}

std::vector<int> Every(int stride, int frames) {
  std::vector<int> list;
  for (int i = stride - 1; i < frames; i += stride) list.push_back(i);
  return list;
}

TEST(NoiseFitRecordingsTest, FortyDidsonPingsPredictTheOthers) {
  SONARCAL_NEEDS_RECORDING(folder, "didson_hull/background");
  const auto recording = data_io::OpenRecording(folder);
  NoiseFitOptions options;
  // Half of these judge: 20 pings. In a cell of 8 x 8 pixels fewer leave a KS of 0.03 to chance alone.
  options.held_out = Every(2, recording->frame_count());
  const NoiseFit fit = FitNoise(*recording, options);
  Print("40 pings", fit);
  ASSERT_TRUE(fit.usable);
  EXPECT_EQ(fit.law.display.law, DisplayLaw::kSoftLog);
  EXPECT_LE(fit.judged.ks, 0.012);
  EXPECT_LE(fit.judged.wasserstein_grey, 0.10);
  EXPECT_LE(fit.judged.cell_ks_median, 0.026);
}

TEST(NoiseFitRecordingsTest, DidsonFivePingsAreNearlyAsGood) {
  SONARCAL_NEEDS_RECORDING(folder, "didson_hull/background");
  const auto recording = data_io::OpenRecording(folder);
  NoiseFitOptions options;
  for (int i = 0; i < recording->frame_count(); ++i) {
    if (i % 16 != 5) options.held_out.push_back(i);
  }
  const NoiseFit fit = FitNoise(*recording, options);
  Print("five pings", fit);
  ASSERT_TRUE(fit.usable);
  EXPECT_EQ(fit.report.frames_used.size(), 5u);
  EXPECT_LE(fit.judged.ks, 0.015);
  EXPECT_LE(fit.judged.wasserstein_grey, 0.15);
  EXPECT_LE(fit.judged.cell_ks_median, 0.028);
}

// The recordings below hold scenes: no pings without targets. What counts as background is found by rule
// (calib/noise/noise_background.h), the same for both.
NoiseFitOptions BackgroundByRule() {
  NoiseFitOptions options;
  options.find_background = true;
  options.reject_beyond = 2.5;
  return options;
}

TEST(NoiseFitRecordingsTest, ArisBackgroundFollowsItsDisplay) {
  SONARCAL_NEEDS_RECORDING(file, "aris1200_telephoto/sample.aris");
  NoiseFitOptions options = BackgroundByRule();
  options.held_out = {1, 3, 5};
  const NoiseFit fit = FitNoise(*data_io::OpenRecording(file), options);
  Print("ARIS 1200", fit);
  ASSERT_TRUE(fit.usable);
  EXPECT_TRUE(fit.judged_on_held_out);
  EXPECT_LE(fit.judged.ks, 0.010);
  EXPECT_NEAR(fit.law.receiver.looks, 1.35, 0.1);
  EXPECT_EQ(fit.law.speckle, sim::SpeckleLaw::kWeighted);
}

TEST(NoiseFitRecordingsTest, OculusBackgroundFollowsItsPowerLaw) {
  SONARCAL_NEEDS_RECORDING(file, "oculus_m1200d/one_ping_8bit.raw");
  const NoiseFit fit = FitNoise(*data_io::OpenRecording(file), BackgroundByRule());
  Print("Oculus", fit);
  ASSERT_TRUE(fit.usable);
  EXPECT_TRUE(fit.bands_held_out);  // there is one ping
  EXPECT_EQ(fit.law.display.law, DisplayLaw::kPower);
  EXPECT_LE(fit.judged.ks, 0.015);
}

}  // namespace
}  // namespace sonarcal::calib
