#include "sim/physics/recorded_beam.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/types/error.h"
#include "data_io/open_recording.h"
#include "sim/acoustic/acoustic_image.h"
#include "tests/support/recordings.h"

namespace sonarcal::sim {
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

// Beside the lobe at either end, the response has no level of its own, so the flank of that lobe gives it.
TEST(AzimuthTableDb, LobesAtBothEndsHaveFlanksToo) {
  const RecordedBeamOptions options{.grey_per_db = 4.0, .peak_grey = 200.0, .main_lobe_beams = 1.0};
  const std::vector<double> table =
      AzimuthTableDb({0.9, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.8}, options, "test");
  EXPECT_NEAR(table[1], -5.0 - 40.0 * std::log10(2.0), 1e-9);
  EXPECT_NEAR(table[7], -10.0 - 40.0 * std::log10(2.0), 1e-9);
}

TEST(AzimuthTableDb, AnEvenResponseIsCompletedFromItsOtherEnd) {
  const std::vector<double> table = AzimuthTableDb({0.1, 0.0, 0.2, 0.0}, {}, "test");
  ASSERT_EQ(table.size(), 5U);
  EXPECT_EQ(table.front(), table.back());
}

TEST(AzimuthTableDb, EmptyUnpeakedAndNegativeResponsesAreRefused) {
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
  const auto recording = data_io::OpenRecording(pings);
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

// Powers behind grey levels, in those of the display's P0; a level of 0 says at most 0.54.
double DidsonPower(double grey) {
  return grey > 0.0 ? std::pow(10.0, (grey + 7.0) / 39.8) - 1.0 : 0.25;
}

// The strong returns of these pings, sent through the recorded response: along the arcs of constant range,
// the mean power eight beams off a row's peak. Of pixels that hold no strong return of their own, nor lie
// beside one.
TEST(RecordedBeam, ArcsOfRealReturnsAreAsStrongAsPredicted) {
  SONARCAL_NEEDS_RECORDING(pings, "didson_hull/test");
  const auto recording = data_io::OpenRecording(pings);
  const SonarModel& sonar = recording->info().sonar;
  const int beams = sonar.axes.beam_count();
  ParameterSet parameters;
  parameters.beam = RecordedBeam(recording->info());
  parameters.pulse.length_m = 0.1 * sonar.axes.range_bin_m();  // the pings have spread in range themselves
  constexpr double kStrongGrey = 130.0;
  constexpr double kReturnGrey = 45.0;  // below the row's peak, at most
  constexpr int kLobe = 8;
  double peak = 0.0;
  double recorded = 0.0;
  double predicted = 0.0;
  int rows = 0;
  for (int ping = 0; ping < recording->frame_count(); ++ping) {
    const Grid<float> grey = recording->ReadFrame(ping).image.value;
    ScatterMap returns;
    returns.column_azimuth_rad = sonar.axes.beam_azimuth_rad;
    returns.power = Grid<double>(sonar.axes.range_bins * returns.range_steps, beams);
    const auto is_return = [&](int row, int beam) {
      if (row == 0 || beam < 0 || beam >= beams) return false;
      const auto of_row = grey.row(row);
      return grey(row, beam) >= *std::max_element(of_row.begin(), of_row.end()) - kReturnGrey;
    };
    std::vector<std::pair<int, int>> peaks;
    for (int row = 1; row < grey.rows(); ++row) {
      const auto of_row = grey.row(row);
      const auto highest = std::max_element(of_row.begin(), of_row.end());
      if (*highest < kStrongGrey) continue;
      peaks.emplace_back(row, static_cast<int>(highest - of_row.begin()));
      for (int beam = 0; beam < beams; ++beam) {
        if (is_return(row, beam))
          returns.power(row * returns.range_steps + returns.range_steps / 2, beam) =
              DidsonPower(grey(row, beam));
      }
    }
    const Grid<float> image = ExpectedPower(returns, {sonar, 0.0}, parameters).value;
    for (const auto& [row, at] : peaks) {
      for (const int beam : {at - kLobe, at + kLobe}) {
        bool apart = beam >= 0 && beam < beams;
        for (int near = -2; near <= 2; ++near) apart = apart && !is_return(row, beam + near);
        if (!apart) continue;
        ++rows;
        peak += DidsonPower(grey(row, at));
        recorded += DidsonPower(grey(row, beam));
        // What the peak's beam shows is its own echo and what the others send there.
        predicted += image(row, beam) * DidsonPower(grey(row, at)) / image(row, at);
      }
    }
  }
  EXPECT_GT(rows, 30);
  const double recorded_grey = 39.8 * std::log10(peak / recorded);
  const double predicted_grey = 39.8 * std::log10(peak / predicted);
  RecordProperty("recorded_grey", std::to_string(recorded_grey));
  RecordProperty("predicted_grey", std::to_string(predicted_grey));
  EXPECT_NEAR(recorded_grey, 88.0, 8.0) << "grey below the peak";
  EXPECT_NEAR(predicted_grey, 88.0, 8.0);
  EXPECT_NEAR(predicted_grey, recorded_grey, 8.0);
}

}  // namespace
}  // namespace sonarcal::sim
