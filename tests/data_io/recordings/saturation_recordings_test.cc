// Traces of saturation in recordings: the grey levels of an Oculus end at 254; the others, of which the
// SYNTHETIC ones are not by a saturated sonar, have none.
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

#include "core/imaging/saturation.h"
#include "data_io/open_recording.h"
#include "tests/support/recordings.h"

namespace sonarcal::data_io {
namespace {

struct Case {
  const char* recording;
  std::optional<double> level = {};  // where values pile up
};

class SaturationOfRecording : public ::testing::TestWithParam<Case> {};

TEST_P(SaturationOfRecording, IsFoundInItsFrames) {
  SONARCAL_NEEDS_RECORDING(path, GetParam().recording);
  const auto recording = OpenRecording(path);
  const std::optional<Mask>& valid = recording->info().valid;
  constexpr int kMaxFrames = 80;
  int frames = 0;
  for (; frames < std::min(kMaxFrames, recording->frame_count()); ++frames) {
    const PolarImage image = recording->ReadFrame(frames).image;
    const auto streaks = FindAzimuthStreaks(image, valid ? &*valid : nullptr);
    EXPECT_TRUE(streaks.empty()) << "frame " << frames << ": " << Describe(streaks, image.axes);
    EXPECT_EQ(FindSaturationLevel(image), GetParam().level) << "frame " << frames;
  }
  RecordProperty("frames", frames);
}

INSTANTIATE_TEST_SUITE_P(All, SaturationOfRecording,
                         ::testing::Values(Case{"aris1200_telephoto/sample.aris"},
                                           Case{"aris3000_broken/output.aris"},
                                           Case{"oculus_m1200d/one_ping_8bit.raw", 254.0},
                                           Case{"didson_hull/background"}, Case{"didson_hull/test"},
                                           Case{"neusis_pickles"}, Case{"synthetic_tank"},
                                           Case{"synthetic_tank_ghosts"}, Case{"synthetic_tank_static"},
                                           Case{"synthetic_tank_poses"}, Case{"synthetic_tank_geometry"}));

}  // namespace
}  // namespace sonarcal::data_io
