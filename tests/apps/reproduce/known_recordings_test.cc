// The real recordings that `explain --known` explains, and the strip of surface that stands for a hull. Few
// rays, so that each takes half a minute; figures are those of docs/guide/explain.md for many.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numeric>

#include "apps/report/sections/explain_section.h"
#include "apps/reproduce/marked_surface.h"
#include "apps/reproduce/prepared_recording.h"
#include "apps/reproduce/target_comparison.h"
#include "apps/workflow/explain.h"
#include "core/types/error.h"
#include "core/types/units.h"
#include "data_io/images/image_io.h"
#include "data_io/open_recording.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/pictures/picture_frames.h"
#include "data_io/pictures/picture_geometry.h"
#include "data_io/scenes/scene_io.h"
#include "data_io/sonars/didson_io.h"
#include "sim/simulator.h"
#include "tests/support/fitted_bomb.h"
#include "tests/support/recordings.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::reproduce {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

PolarAxes DidsonAxes() {
  PolarAxes axes;
  axes.range_min_m = 2.25;
  axes.range_max_m = 11.25;
  axes.range_bins = 512;
  axes.beam_azimuth_rad = data_io::DidsonAzimuthsRad();
  return axes;
}

constexpr double kHalfBeamRad = RadFromDeg(7.0);

TEST(MarkedStripSearch, SaysThatItEndedAtTheEndOfItsRange) {
  EXPECT_FALSE(LeanAtEnd(15.0, 40.0).has_value());
  EXPECT_THAT(LeanAtEnd(40.0, 40.0).value_or(""), ::testing::HasSubstr("largest angle that was tried, 40"));
  EXPECT_THAT(LeanAtEnd(0.0, 40.0).value_or(""), ::testing::HasSubstr("least angle that was tried, 0"));
}

// The line's law beside its own construction: a point of the line by its height, upright or not.
TEST(MarkedStrip, LineIsNearestWhereTheMarkSays) {
  for (const double lean_deg : {0.0, 3.0, 7.0, 20.0, 60.0}) {
    const double lean = RadFromDeg(lean_deg);
    double nearest = 1e9;
    double nearest_at = 0.0;
    for (double at = -kHalfBeamRad; at <= kHalfBeamRad; at += 1e-4) {
      const double ratio = StripRangeRatio(lean, kHalfBeamRad, at);
      if (ratio < nearest) nearest_at = at;
      nearest = std::min(nearest, ratio);
    }
    EXPECT_NEAR(nearest, 1.0, 1e-7) << lean_deg;
    EXPECT_NEAR(nearest_at, -std::min(lean, kHalfBeamRad), 2e-4) << lean_deg;
    // Two points and a third of the same line: heights over distances are alike.
    const auto point = [&](double at) {
      const double ratio = StripRangeRatio(lean, kHalfBeamRad, at);
      return std::pair(ratio * std::cos(at), ratio * std::sin(at));
    };
    const auto [x0, z0] = point(-0.1);
    const auto [x1, z1] = point(0.2);
    EXPECT_NEAR((x1 - x0) * std::cos(lean), (z1 - z0) * std::sin(lean), 1e-12) << lean_deg;
  }
}

// Rays meet the strip where marks are, and nowhere else.
TEST(MarkedStrip, RaysMeetItAtTheMarks) {
  SonarModel sonar;
  sonar.name = "DIDSON";
  sonar.frequency_hz = 1.8e6;
  sonar.axes = DidsonAxes();
  sonar.elevation_beam_width_deg = 14.0;
  FirstReturn marks(96);
  for (int beam = 20; beam < 60; ++beam) marks[beam] = 200 + beam;  // a straight line in bins
  for (const double lean_deg : {0.0, 25.0}) {
    const Scene strip = MakeMarkedStrip(marks, sonar.axes, {.lean_deg = lean_deg});
    sim::SimulationOptions options;
    options.fan = {.sampling = sim::Sampling::kBeams, .cols = 96, .rows = 281, .elevation_span_deg = 14.0};
    const sim::Simulator simulator(strip, sonar, options);
    const sim::EchoList echoes = simulator.TraceEchoes(Pose{});
    std::vector<double> nearest_m(96, 1e9);
    for (std::size_t i = 0; i < echoes.size(); ++i) {
      double& nearest = nearest_m[echoes.Beam(i)];
      nearest = std::min(nearest, static_cast<double>(echoes.range_m[i]));
    }
    for (int beam = 0; beam < 96; ++beam) {
      if (!marks[beam]) {
        EXPECT_GT(nearest_m[beam], 1e8) << beam;
        continue;
      }
      EXPECT_NEAR(nearest_m[beam], sonar.axes.range_centre_m(*marks[beam]), 2e-3)
          << beam << " at " << lean_deg;
    }
  }
}

// A parabola in azimuth comes out as it is, but for its steps of whole bins, which a line through nine takes
// to a fraction.
TEST(MarkedStrip, SmoothingTakesTheStairAndLeavesTheCurve) {
  const PolarAxes axes = DidsonAxes();
  FirstReturn marks(96);
  const auto range_m = [&](int beam) {
    const double at = axes.beam_azimuth_rad[beam];
    return 6.0 + 2.0 * at + 3.0 * at * at;
  };
  for (int beam = 10; beam < 90; ++beam)
    marks[beam] = static_cast<int>((range_m(beam) - axes.range_min_m) / axes.range_bin_m());
  const auto smoothed = SmoothedRangesM(marks, axes);
  double stair = 0.0;
  double left = 0.0;
  for (int beam = 14; beam < 86; ++beam) {
    stair += std::pow(axes.range_centre_m(*marks[beam]) - range_m(beam), 2.0);
    left += std::pow(*smoothed[beam] - range_m(beam), 2.0);
  }
  // Of nine uniform errors a parabola's middle value keeps 0.255 of the variance (Savitzky and Golay 1964).
  EXPECT_LT(left, 0.4 * stair);
  EXPECT_FALSE(smoothed[5]);
}

TEST(MarkedStrip, MarksThatMakeNoStripAreRefused) {
  const PolarAxes axes = DidsonAxes();
  FirstReturn marks(96);
  EXPECT_THROW(MakeMarkedStrip(marks, axes, {}), DataError);
  marks[3] = 100;
  marks[5] = 100;
  EXPECT_THROW(MakeMarkedStrip(marks, axes, {}), DataError) << "no two neighbours";
  marks[4] = 100;
  EXPECT_THROW(MakeMarkedStrip(marks, axes, {.lean_deg = 85.0}), DataError);
  EXPECT_FALSE(MakeMarkedStrip(marks, axes, {}).triangles.empty());
  const testing::TempDir folder;
  data_io::WritePng(folder / "small.png", Grid<std::uint8_t>(10, 96));
  EXPECT_THROW(ReadFirstReturn(folder / "small.png", axes), DataError);
  Grid<std::uint8_t> marked(512, 96);
  marked(300, 7) = 255;
  marked(200, 7) = 255;
  data_io::WritePng(folder / "marks.png", marked);
  EXPECT_EQ(ReadFirstReturn(folder / "marks.png", axes)[7], 200);
  EXPECT_EQ(ReadFirstReturn(folder / "marks.png", axes)[8], std::nullopt);
}

TEST(KnownRecordings, AbsentFolderCostsOneSentence) {
  const testing::TempDir folder;
  try {
    PrepareCase(FindCase("bomb"), folder.path());
    FAIL() << "no recording is there";
  } catch (const DataError& error) {
    EXPECT_THAT(error.what(), HasSubstr("aris3000_uxo: no such folder"));
  }
}

double Sum(const Grid<float>& grid) {
  return std::accumulate(grid.values().begin(), grid.values().end(), 0.0);
}

// From an independent decoding with Python.
TEST(KnownRecordings, BombFramesAreReadAsPublished) {
  SONARCAL_NEEDS_RECORDING(folder, "aris3000_uxo");
  const CasePlan plan = FindCase("bomb");
  const auto recording = OpenTarget(plan, folder);
  const RecordingInfo& info = recording->info();
  EXPECT_EQ(info.source, folder.string());
  EXPECT_FALSE(info.synthetic);
  EXPECT_EQ(info.sonar.axes.range_bins, 780);
  ASSERT_EQ(info.sonar.axes.beam_count(), 128);
  EXPECT_NEAR(DegFromRad(info.sonar.axes.beam_azimuth_rad.front()), -15.0068, 1e-9);
  EXPECT_NEAR(DegFromRad(info.sonar.axes.beam_azimuth_rad.back()), 15.0156, 1e-9);
  EXPECT_EQ(info.scale.db_span, 97 * (80.0 / 255.0));
  EXPECT_EQ(info.settings.compression, Compression::kLogarithm);
  const Frame frame = recording->ReadFrame(0);
  EXPECT_EQ(frame.info.name, "frame_0000_128x780.png");
  EXPECT_FALSE(frame.info.world_from_sonar);
  EXPECT_EQ(frame.image.value(0, 0), 36.0f);
  EXPECT_EQ(frame.image.value(0, 127), 26.0f);
  EXPECT_EQ(frame.image.value(120, 70), 115.0f);
  EXPECT_EQ(frame.image.value(779, 0), 60.0f);
  EXPECT_EQ(Sum(frame.image.value), 3326281.0);
  EXPECT_EQ(Sum(recording->ReadFrame(1).image.value), 3326028.0);

  // The strongest echo, the corners and the sum, from an independent resampling with Python.
  const TargetCase::OtherView& other = TargetOf(plan).other.value();
  const Grid<float> view = data_io::SampleFan(data_io::OpenPictures(folder / other.picture)->Read(0),
                                              other.fan, info.sonar.axes, "");
  EXPECT_EQ(view(250, 70), 13.0f);
  EXPECT_EQ(view(260, 60), 32.0f);
  EXPECT_EQ(view(0, 0), 16.0f);
  EXPECT_EQ(view(779, 127), 6.0f);
  EXPECT_EQ(Sum(view), 1406812.0);
}

std::vector<std::string> PartsOf(const workflow::ExplainedRecording& explained) {
  std::vector<std::string> parts;
  for (const calib::ExplainedStep& step : explained.explanation.steps)
    parts.emplace_back(ToString(step.part));
  return parts;
}

workflow::ExplainedRecording Explained(const PreparedRecording& prepared, RayGridSize rays) {
  workflow::ExplainRecordingOptions options;
  options.rays.rays = rays;
  options.held_out = prepared.held_out;
  options.comparison = prepared.comparison;
  options.hold_noise = prepared.hold_noise;
  options.fit.max_iterations = 25;
  workflow::ExplainedRecording explained =
      workflow::ExplainRecording(*prepared.recording, prepared.scene, prepared.parameters, options);
  std::cout << report::ExplanationText(explained, {.title = prepared.title, .apart = prepared.apart});
  return explained;
}

// What is written is what was explained, for every other command.
void ExpectWritten(const PreparedRecording& prepared) {
  const testing::TempDir folder;
  WritePrepared(prepared, folder / "recording");
  const auto read = data_io::OpenRecording(folder / "recording");
  ASSERT_EQ(read->frame_count(), prepared.recording->frame_count());
  for (int i = 0; i < read->frame_count(); ++i) {
    const Frame a = read->ReadFrame(i);
    const Frame b = prepared.recording->ReadFrame(i);
    EXPECT_TRUE(std::equal(a.image.value.values().begin(), a.image.value.values().end(),
                           b.image.value.values().begin()))
        << "frame " << i;
    EXPECT_TRUE(IsSamePose(*a.info.world_from_sonar, *b.info.world_from_sonar)) << "frame " << i;
  }
  EXPECT_EQ(data_io::ReadGltf(folder / "recording/scene.gltf").triangles.size(),
            prepared.scene.triangles.size());
  EXPECT_EQ(data_io::ReadParameters(folder / "recording/params.json").materials.size(),
            prepared.parameters.materials.size());
  for (const std::string& caveat : prepared.caveats)
    EXPECT_THAT(read->info().notes, ::testing::Contains(caveat));
}

// What docs/studies/bomb.md holds its own fit to, over the whole image. A draw moves the IoU by 0.02: two of
// these.
void ExpectExplained(const std::vector<workflow::JudgedSteps>& by_frame, double same_iou, double other_iou) {
  ASSERT_EQ(by_frame.size(), 2U);
  for (const workflow::JudgedSteps& judged : by_frame) {
    EXPECT_GT(judged.nats_per_pixel.back(), judged.nats_per_pixel.front());
    EXPECT_LT(*judged.figures.back().about_error, *judged.figures.front().about_error);
    EXPECT_EQ(judged.verdict.back(), calib::Verdict::kSignificant) << "speckle";
  }
  const workflow::JudgedSteps& same = by_frame[0];
  const workflow::JudgedSteps& other = by_frame[1];
  EXPECT_EQ(same.verdict[3], calib::Verdict::kSignificant) << "the noise floor";
  EXPECT_LE(*same.figures.back().intensity_error, 0.053);
  EXPECT_LE(*other.figures.back().intensity_error, 0.050);
  EXPECT_GE(*same.figures.back().iou, same_iou - 0.04);
  EXPECT_GE(*other.figures.back().iou, other_iou - 0.04);
}

TEST(KnownRecordings, SpeckleIsASignificantPartOfTheBomb) {
  SONARCAL_NEEDS_RECORDING(folder, "aris3000_uxo");
  const PreparedRecording prepared = PrepareTarget(FindCase("bomb"), folder, {});
  ExpectWritten(prepared);
  const workflow::ExplainedRecording explained = Explained(prepared, {256, 700});
  EXPECT_THAT(PartsOf(explained), ElementsAre("start", "response", "elevation", "noise", "speckle"));
  ExpectExplained(explained.by_frame, 0.80, 0.80);
}

// The frame that shares the speckle of the one fitted is nearer to what speckle leaves than the other, where
// the outline was fitted to that speckle: why they judge apart.
TEST(KnownRecordings, AFittedOutlineIsBetterOnTheSpeckleItWasFittedTo) {
  SONARCAL_NEEDS_RECORDING(folder, "aris3000_uxo");
  const PreparedRecording prepared = PrepareTarget(testing::FittedBomb(), folder, {});
  const workflow::ExplainedRecording explained = Explained(prepared, {256, 700});
  ExpectExplained(explained.by_frame, 0.80, 0.75);
  const workflow::JudgedSteps& same = explained.by_frame.at(0);
  const workflow::JudgedSteps& other = explained.by_frame.at(1);
  EXPECT_LT(*same.figures.back().about_error - *same.about_floor_error,
            *other.figures.back().about_error - *other.about_floor_error);
}

TEST(KnownRecordings, HullStripIsExplained) {
  SONARCAL_NEEDS_RECORDING(folder, "didson_hull");
  const PreparedRecording prepared = PrepareMarkedSurface(FindCase("hull-strip"), folder, {.quick = true});
  EXPECT_THAT(prepared.title, HasSubstr("hull strip from marks"));
  EXPECT_THAT(prepared.scene.material_names, ElementsAre("hull strip from marks"));
  ExpectWritten(prepared);
  const workflow::ExplainedRecording explained = Explained(prepared, {192, 400});
  EXPECT_THAT(PartsOf(explained), ElementsAre("start", "response", "elevation", "noise", "speckle"));
  const workflow::JudgedSteps& judged = explained.judged;
  EXPECT_THAT(judged.frames, ElementsAre(2));
  EXPECT_EQ(judged.verdict[3], calib::Verdict::kSignificant) << "the noise floor";
  EXPECT_EQ(judged.verdict[4], calib::Verdict::kSignificant) << "speckle";
  EXPECT_GT(judged.nats_per_pixel.back(), judged.nats_per_pixel.front());
  EXPECT_LT(*judged.figures.back().about_error, *judged.figures.front().about_error);
  // The noise law is that of the target-free pings: held, so that what the strips lack does not become noise.
  EXPECT_EQ(explained.explanation.steps.back().parameters.receiver.noise_db,
            prepared.parameters.receiver.noise_db);
  EXPECT_THAT(explained.cause_names, ::testing::Contains("hull strip from marks"));
  EXPECT_THAT(explained.cause_names, ::testing::Contains("not explained"));
}

}  // namespace
}  // namespace sonarcal::reproduce
