#include "data_io/recordings/recalibrated_recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "tests/data_io/refusal.h"

namespace sonarcal::data_io {
namespace {

using ::testing::HasSubstr;
using testing::MessageOf;

PolarAxes AxesUpTo(double range_max_m, int range_bins = 4) {
  return {.range_min_m = 1.0,
          .range_max_m = range_max_m,
          .range_bins = range_bins,
          .beam_azimuth_rad = {-0.1, 0.0, 0.1}};
}

std::shared_ptr<const MemoryRecording> RecordingOf(const std::vector<PolarAxes>& axes) {
  RecordingInfo info;
  info.source = "made up";
  info.sonar.axes = axes.front();
  std::vector<Frame> frames;
  for (const PolarAxes& of_frame : axes) {
    frames.push_back({{"a frame", std::nullopt, std::nullopt},
                      {of_frame, {}, Grid<float>(of_frame.range_bins, of_frame.beam_count())}});
  }
  return std::make_shared<MemoryRecording>(info, std::move(frames));
}

SonarModel Calibrated() {
  SonarModel sonar;
  sonar.name = "calibrated";
  sonar.axes = AxesUpTo(2.125);
  return sonar;
}

TEST(RecalibratedRecordingTest, EveryFrameGetsTheAxesOfTheOtherSonar) {
  const RecalibratedRecording recording(RecordingOf({AxesUpTo(2.0), AxesUpTo(2.0)}), Calibrated());
  EXPECT_EQ(recording.info().sonar.name, "calibrated");
  for (int i = 0; i < 2; ++i) EXPECT_EQ(recording.ReadFrame(i).image.axes.range_max_m, 2.125) << i;
}

TEST(RecalibratedRecordingTest, ASonarOfAnotherSizeIsRefused) {
  EXPECT_THAT(MessageOf([] { RecalibratedRecording(RecordingOf({AxesUpTo(2.0, 5)}), Calibrated()); }),
              HasSubstr("made up: 5 range bins and 3 beams, but the sonar 'calibrated' has 4 and 3"));
}

TEST(RecalibratedRecordingTest, AFrameWithAxesOfItsOwnIsRefused) {
  const RecalibratedRecording recording(RecordingOf({AxesUpTo(2.0), AxesUpTo(3.0), AxesUpTo(2.0, 5)}),
                                        Calibrated());
  EXPECT_EQ(recording.ReadFrame(0).image.axes.range_max_m, 2.125);
  EXPECT_THAT(MessageOf([&] { recording.ReadFrame(1); }),
              HasSubstr("made up: frame 1 differs from the first: range windows 1.0000..2.0000 m and "
                        "1.0000..3.0000 m"));
  EXPECT_THAT(MessageOf([&] { recording.ReadFrame(2); }), HasSubstr("frame 2 differs from the first: range"));
}

}  // namespace
}  // namespace sonarcal::data_io
