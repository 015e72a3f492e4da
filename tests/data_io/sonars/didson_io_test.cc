#include "data_io/sonars/didson_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include <nlohmann/json.hpp>

#include "core/types/units.h"
#include "data_io/images/image_io.h"
#include "data_io/open_recording.h"
#include "tests/data_io/hostile.h"
#include "tests/support/recordings.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::data_io {
namespace {

using ::testing::HasSubstr;
using testing::RefusalOf;
using testing::TempDir;

constexpr int kBins = 30;

nlohmann::json Settings() {
  return {{"num_beams", 96},
          {"num_bins", kBins},
          {"min_range", 2.25},
          {"max_range", 11.25},
          {"fov", 0.50265},
          {"noise", 0.01},
          {"rx_gain", 20.0},
          {"psf", std::vector<double>(96, 0.1)},
          {"taper", std::vector<double>(96, 0.5)}};
}

Grid<std::uint8_t> Pixels() {
  Grid<std::uint8_t> grey(kBins, 96);
  for (int row = 0; row < kBins; ++row) {
    for (int col = 0; col < 96; ++col) grey(row, col) = static_cast<std::uint8_t>(3 * row + col);
  }
  return grey;
}

class DidsonTest : public ::testing::Test {
 protected:
  DidsonTest() { WritePing("1468966376000002", Settings()); }

  void WritePing(const std::string& stem, const nlohmann::json& settings) {
    testing::WriteFile(dir_ / (stem + ".json"), settings.dump());
    WritePng(dir_ / (stem + ".png"), Pixels());
  }
  std::string Refusal(const std::string& key, const nlohmann::json& value) {
    nlohmann::json settings = Settings();
    if (value.is_null()) {
      settings.erase(key);
    } else {
      settings[key] = value;
    }
    WritePing("1468966376000002", settings);
    return RefusalOf(dir_.path());
  }

  TempDir dir_;
};

TEST(DidsonSample, HoldsPingsOfAHull) {
  SONARCAL_NEEDS_RECORDING(folder, "didson_hull/test");
  const auto recording = OpenRecording(folder);
  const RecordingInfo& info = recording->info();
  ASSERT_EQ(recording->frame_count(), 6);
  EXPECT_EQ(info.sonar.axes.range_bins, 512);
  EXPECT_EQ(info.sonar.axes.range_min_m, 2.25);
  EXPECT_EQ(info.sonar.axes.range_max_m, 11.25);
  EXPECT_NEAR(info.sonar.axes.range_bin_m(), 17.58e-3, 5e-6);
  EXPECT_EQ(info.sonar.axes.beam_count(), 96);
  ASSERT_EQ(info.azimuth_psf.size(), 96u);
  EXPECT_EQ(std::max_element(info.azimuth_psf.begin(), info.azimuth_psf.end()) - info.azimuth_psf.begin(),
            48);
  ASSERT_EQ(info.beam_taper.size(), 96u);
  EXPECT_EQ(info.beam_taper[42], 1.0);

  // From an independent decoding with OpenCV in Python.
  const Frame frame = recording->ReadFrame(2);
  EXPECT_EQ(frame.info.name, "1468966376476216.png");
  ASSERT_TRUE(frame.info.time_s);
  EXPECT_NEAR(*frame.info.time_s, 1468966376.476216, 1e-6);
  EXPECT_EQ(frame.image.value(100, 50), 7.0f);
  EXPECT_EQ(std::accumulate(frame.image.value.values().begin(), frame.image.value.values().end(), 0.0),
            192305.0);
}

TEST(DidsonSample, EveryTargetFreePingOpens) {
  SONARCAL_NEEDS_RECORDING(folder, "didson_hull/background");
  EXPECT_EQ(OpenRecording(folder)->frame_count(), 80);
  EXPECT_TRUE(testing::OpensWholly(folder));
}

TEST(DidsonAzimuths, AzimuthsInvertThePolynomialOfTheMaker) {
  const std::vector<double> azimuth_rad = DidsonAzimuthsRad();
  ASSERT_EQ(azimuth_rad.size(), 96u);
  for (int beam = 0; beam < 96; ++beam) {
    const double t = DegFromRad(azimuth_rad[beam]);
    EXPECT_NEAR(0.0030 * t * t * t - 0.0055 * t * t + 2.6829 * t + 48.04, beam, 1e-9);
    if (beam > 0) {
      EXPECT_GT(azimuth_rad[beam], azimuth_rad[beam - 1]);
    }
  }
  // From numpy.roots.
  EXPECT_NEAR(DegFromRad(azimuth_rad[0]), -14.252337293, 1e-8);
  EXPECT_NEAR(DegFromRad(azimuth_rad[48]), -0.014908781, 1e-8);
  EXPECT_NEAR(DegFromRad(azimuth_rad[95]), 14.515494882, 1e-8);
  // The outer beams of a lens lie closer than the middle ones.
  EXPECT_LT(azimuth_rad[1] - azimuth_rad[0], azimuth_rad[48] - azimuth_rad[47]);
}

TEST_F(DidsonTest, OpensAFolderInOrderOfTimeAndASinglePing) {
  nlohmann::json later = Settings();
  later["max_range"] = 20.25;
  WritePing("1468966376000010", later);
  WritePing("999999999999999", Settings());                  // a digit shorter, and earlier
  testing::WriteFile(dir_ / "1468966376000011.json", "{}");  // without its picture: no ping
  testing::WriteFile(dir_ / "notes.json", "{}");
  const auto recording = OpenRecording(dir_.path());
  ASSERT_EQ(recording->frame_count(), 3);
  EXPECT_EQ(recording->frame_info(0).name, "999999999999999.png");
  EXPECT_EQ(recording->frame_info(2).name, "1468966376000010.png");
  EXPECT_EQ(recording->ReadFrame(1).image.axes.range_max_m, 11.25);
  EXPECT_EQ(recording->ReadFrame(2).image.axes.range_max_m, 20.25);
  EXPECT_EQ(recording->ReadFrame(2).image.value(29, 95), 3.0f * 29 + 95);

  EXPECT_EQ(OpenRecording(dir_ / "1468966376000010.png")->frame_count(), 1);
  EXPECT_EQ(OpenRecording(dir_ / "1468966376000010.json")->info().sonar.axes.range_max_m, 20.25);
  EXPECT_THROW(OpenRecording(dir_ / "1468966376000011.json"), DataError);
}

TEST_F(DidsonTest, GainsThatCannotBeAreLeftOut) {
  EXPECT_EQ(OpenRecording(dir_.path())->info().settings.gain_db, 20.0);
  nlohmann::json odd = Settings();
  odd["rx_gain"] = -1e4;
  WritePing("1468966376000002", odd);
  EXPECT_FALSE(OpenRecording(dir_.path())->info().settings.gain_db);
  EXPECT_THAT(OpenRecording(dir_.path())->info().notes,
              ::testing::Contains(HasSubstr("Receiver gain -10000 dB is impossible")));
}

TEST_F(DidsonTest, RefusesSettingsOutsideTheirDomain) {
  EXPECT_THAT(Refusal("num_beams", 48), HasSubstr("num_beams"));
  EXPECT_THAT(Refusal("num_bins", 0), HasSubstr("num_bins"));
  EXPECT_THAT(Refusal("num_bins", 1e9), HasSubstr("num_bins"));
  EXPECT_THAT(Refusal("num_bins", 31), HasSubstr("expected 8-bit grey, 31 x 96 pixels"));
  EXPECT_THAT(Refusal("min_range", 12.0), HasSubstr("range window"));
  EXPECT_THAT(Refusal("min_range", -1.0), HasSubstr("min_range"));
  EXPECT_THAT(Refusal("max_range", "far"), HasSubstr("max_range"));
  EXPECT_THAT(Refusal("psf", {1.0, 2.0}), HasSubstr("has 2 numbers, expected one per beam, 96"));
  EXPECT_THAT(Refusal("taper", nullptr), HasSubstr("taper"));
  EXPECT_THAT(Refusal("fov", 0.0), HasSubstr("fov"));
  EXPECT_EQ(Refusal("fov", 0.5), "");
}

TEST_F(DidsonTest, HostileFilesEndInDataError) {
  const auto json = dir_ / "1468966376000002.json";
  const auto png = dir_ / "1468966376000002.png";
  testing::ExpectOnlyDataErrors(dir_.path(), json, Settings().dump(), 200);
  testing::ExpectOnlyDataErrors(dir_.path(), png, testing::ReadFile(png), 100);
}

}  // namespace
}  // namespace sonarcal::data_io
