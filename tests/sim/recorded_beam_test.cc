#include "sim/recorded_beam.h"

#include <gtest/gtest.h>

#include <cmath>

#include "data_io/open_recording.h"
#include "data_io/types/error.h"
#include "sim/acoustic_image.h"
#include "tests/support/recordings.h"

namespace sonarcal {
namespace {

TEST(AzimuthTableDb, RatiosOfGreyBecomeLevels) {
  const RecordedBeamOptions options{.grey_per_db = 4.0, .peak_grey = 200.0, .main_lobe_beams = 1.0};
  const std::vector<double> table =
      AzimuthTableDb({0.0, 0.0, 0.1, 0.0, 0.2, 0.0, 0.1, 0.0, 0.0}, options, "test");
  ASSERT_EQ(table.size(), 9U);
  EXPECT_NEAR(table[4], 0.0, 1e-12);
  EXPECT_NEAR(table[2], -25.0, 1e-12) << "half of 200 grey";
  EXPECT_NEAR(table[3], -40.0 * std::log10(2.0), 1e-9) << "the main lobe's flank, 2^-4";
  EXPECT_NEAR(table[1], -25.0 - 40.0 * std::log10(2.0), 1e-9);
  EXPECT_EQ(table[6], table[2]);
}

TEST(AzimuthTableDb, AnEvenResponseIsCompletedFromItsOtherEnd) {
  const std::vector<double> table = AzimuthTableDb({0.1, 0.0, 0.2, 0.0}, {}, "test");
  ASSERT_EQ(table.size(), 5U);
  EXPECT_EQ(table.front(), table.back());
}

TEST(AzimuthTableDb, NonsenseIsRefused) {
  EXPECT_THROW(AzimuthTableDb({}, {}, "test"), DataError);
  EXPECT_THROW(AzimuthTableDb({0.1, 0.0, 0.1}, {}, "test"), DataError);
  EXPECT_THROW(AzimuthTableDb({0.3, 0.2, 0.1}, {}, "test"), DataError) << "peak not in the middle";
  EXPECT_THROW(AzimuthTableDb({-0.1, 0.2, 0.1}, {}, "test"), DataError);
  EXPECT_THROW(AzimuthTableDb({0.1, 0.2, 0.1}, {.grey_per_db = 0.0}, "test"), DataError);
  EXPECT_THROW(RecordedBeam(RecordingInfo{}), DataError);
}

// Levels of the arcs that strong surface returns of these pings show, in grey below the return.
TEST(RecordedBeam, DidsonArcsLieWhereItsPingsShowThem) {
  SONARCAL_NEEDS_RECORDING(pings, "didson_hull/test");
  const auto recording = OpenRecording(pings);
  ParameterSet parameters;
  parameters.beam = RecordedBeam(recording->info());
  const SonarModel& sonar = recording->info().sonar;
  ScatterMap point;
  point.column_azimuth_rad = {sonar.axes.beam_azimuth_rad[45]};
  point.power = Grid<double>(sonar.axes.range_bins * point.range_steps, 1);
  point.power(200 * point.range_steps + 2, 0) = 1e6;
  const Grid<float> image = ExpectedPower(point, {sonar, 0.0}, parameters).value;
  const double grey_below[] = {88.0, 116.0, 131.0, 140.0};
  for (int lobe = 1; lobe <= 4; ++lobe) {
    for (const int beam : {45 - 8 * lobe, 45 + 8 * lobe}) {
      const double grey = 3.98 * 10.0 * std::log10(image(200, 45) / image(200, beam));
      EXPECT_NEAR(grey, grey_below[lobe - 1], 8.0) << "beam " << beam;
      EXPECT_GT(image(200, beam), 4.0F * image(200, beam + 2)) << "an arc of its own";
    }
  }
}

}  // namespace
}  // namespace sonarcal
