// A target's case with a SYNTHETIC recording of three frames and 4096 grey levels. The plan states the water,
// the recording does not. A fan picture of the first frame is the other view.
#include "apps/reproduce/target_comparison.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "apps/reproduce/prepared_recording.h"
#include "apps/reproduce/reproduce_report.h"
#include "apps/reproduce/summary_rows.h"
#include "apps/reproduce/target_report.h"
#include "data_io/images/image_io.h"
#include "data_io/pictures/fan_pictures.h"
#include "data_io/pictures/picture_geometry.h"
#include "data_io/recordings/recording_io.h"
#include "sim/scenes/scenes.h"
#include "sim/simulator.h"
#include "tests/calib/small_body.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::reproduce {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kFullScale = 4095.0;
constexpr int kFittedFrame = 1;
constexpr int kFrameHeldOut = 2;

float LargestOf(const PolarImage& image) {
  const auto values = image.value.values();
  return *std::max_element(values.begin(), values.end());
}

class TargetComparisonTest : public ::testing::Test {
 protected:
  // The search and both fits run once for all tests.
  static void SetUpTestSuite() {
    dir_ = std::make_unique<testing::TempDir>();
    WriteImages();
    result_ = std::make_unique<TargetComparison>(CompareTarget(
        Plan(), Images(),
        {.quick = true, .on_note = [](const std::string& line) { comparison_notes_.push_back(line); }}));
  }
  static void TearDownTestSuite() {
    result_.reset();
    dir_.reset();
  }

  static std::filesystem::path Images() { return *dir_ / "recording"; }

  static void WriteImages() {
    ParameterSet parameters = testing::BodyParameters();
    parameters.model = EchoModel::kCoherent;
    sim::SimulationOptions recorder;
    recorder.bits = 12;
    recorder.frozen_speckle = true;
    recorder.fan = {
        .sampling = sim::Sampling::kBeams, .cols = 56 * 4, .rows = 400, .elevation_span_deg = 28.0};
    const sim::Simulator simulator(Body(), testing::CoarseSonar(), recorder);
    std::vector<Frame> frames;
    for (int i = 0; i < 3; ++i) {
      frames.push_back({{.name = "", .time_s = 1.0 * i, .world_from_sonar = {}},
                        simulator.Render(testing::BodyPose().WorldFromSonar(), parameters, i)});
    }
    RecordingInfo info;
    info.sonar = testing::CoarseSonar();
    info.scale = frames.front().image.scale;
    info.synthetic = true;
    data_io::WriteRecording(MemoryRecording(info, frames), Images());
    const data_io::FanPainter painter(info, {});
    data_io::WritePng(Images() / "other_view.png", painter.Paint(frames.front()));
    testing::WriteFile(Images() / "geometry.json", painter.GeometryJson());
  }

  static Scene Body() { return sim::MakeBody({.max_edge_m = 0.04}); }

  static CasePlan Plan() {
    TargetCase target;
    target.recording = "recording";
    target.fitted_frame = kFittedFrame;
    target.held_out_frame = kFrameHeldOut;
    target.water = Water{.temperature_c = 5.0, .salinity_ppt = 35.0, .ph = 8.0, .depth_m = 10.0};
    target.azimuth_beam_width_deg = 0.6;
    target.elevation_span_deg = 28.0;
    target.scene = Body();
    target.pose = testing::BodyPose();
    target.start = testing::BodyParameters();
    target.start.receiver.noise_db = 0.0;
    target.start.materials["body"].gsab = {
        .a = 1e-7, .b_deg = 4.0, .c = 1.0, .d = 1.5, .e = 0.1, .f_deg = 20.0};
    target.start.beam.azimuth_width_deg = 0.6;
    target.start.beam.elevation_width_deg = 15.0;
    target.start.pulse.length_m = 0.01;
    target.fit.free_pose = false;
    target.fit.beam_width_max_deg = 2.0;
    target.fit.fit.starts = 1;
    target.other =
        TargetCase::OtherView{.picture = "other_view.png",
                              .fan = data_io::ReadPictureGeometry(Images() / "geometry.json").fan.value(),
                              .db_span = 40.0,
                              .start = testing::BodyPose()};
    target.heading = "A body";
    target.about = "A body in open water.";
    target.limit = "Both frames have the same speckle.";
    CasePlan plan;
    plan.name = "body";
    plan.folder = Images();
    plan.title = "body (SYNTHETIC)";
    plan.label = "Body";
    plan.study = std::move(target);
    return plan;
  }

  // A report's content, with the paper's fit to the target also in place of both fits to the tank.
  static Reproduction Reproduced(const TargetComparison& target) {
    Reproduction reproduction{.synthetic = {}, .targets = {}, .shown = {}};
    SyntheticComparison& synthetic = reproduction.synthetic;
    synthetic.plan = ReadCase(std::filesystem::path(SONARCAL_SOURCE_DIR) / "cases/tank");
    synthetic.fit = target.paper;
    synthetic.acoustic = target.paper;
    synthetic.acoustic.fit.report.warnings.clear();
    synthetic.acoustic.sample_before = target.paper.before;
    synthetic.acoustic.sample_after = target.paper.after;
    synthetic.data_sets.push_back({.frames = {kFrameHeldOut},
                                   .before = {},
                                   .after = {},
                                   .acoustic_expected = {},
                                   .acoustic_sample = {}});
    reproduction.targets.push_back({.name = "body", .comparison = target, .absent = {}});
    return reproduction;
  }

  static inline std::unique_ptr<testing::TempDir> dir_;
  static inline std::unique_ptr<TargetComparison> result_;
  static inline std::vector<std::string> comparison_notes_;
};

TEST_F(TargetComparisonTest, SimulatedImagesHaveTheGreyLevelsOfTheRecording) {
  ASSERT_EQ(result_->fitted.expected_frames.size(), 1U);
  ASSERT_EQ(result_->fitted.sample_frames.size(), 1U);
  for (const auto* frames : {&result_->fitted.expected_frames, &result_->fitted.sample_frames}) {
    const PolarImage& simulated = frames->front().simulated;
    EXPECT_EQ(simulated.scale.full_scale, kFullScale);
    EXPECT_GT(LargestOf(simulated), 255.0F);
    for (const float value : simulated.value.values()) ASSERT_EQ(value, std::round(value));
  }
  const auto error_of = [](const metrics::MetricsReport& report) {
    return report.aggregate.macro.polar.Over(metrics::IntensityDomain::kUnion).mean_absolute.value.value();
  };
  EXPECT_LT(error_of(result_->acoustic_expected), 0.25);
  EXPECT_LT(error_of(result_->acoustic_samples), 0.25);
  EXPECT_LT(error_of(result_->fitted.expected), 0.25);
  EXPECT_LT(error_of(result_->fitted.samples), 0.25);
  EXPECT_GT(error_of(result_->fitted.floor), 0.03) << "what speckle leaves";
}

TEST_F(TargetComparisonTest, FramesHaveTheNumbersOfThePlan) {
  const calib::FitReport& acoustic = result_->fitted.acoustic.fit.report;
  EXPECT_THAT(acoustic.frames_used, ElementsAre(kFittedFrame));
  EXPECT_THAT(acoustic.frames_held_out, ElementsAre(kFrameHeldOut));
  ASSERT_EQ(result_->fitted.expected_frames.size(), 1U);
  EXPECT_EQ(result_->fitted.expected_frames[0].metrics.index, kFrameHeldOut);
  EXPECT_EQ(result_->fitted.sample_frames.at(0).metrics.index, kFrameHeldOut);
  EXPECT_EQ(result_->fitted.expected.frames.at(0).index, kFrameHeldOut);
  ASSERT_TRUE(result_->paper.fit.usable);
  EXPECT_THAT(result_->paper.fit.report.frames_used, ElementsAre(kFittedFrame));
  EXPECT_THAT(result_->paper.fit.report.frames_held_out, ElementsAre(kFrameHeldOut));
  ASSERT_EQ(result_->paper.after.frames.size(), 1U);
  EXPECT_EQ(result_->paper.after.frames[0].index, kFrameHeldOut);
}

TEST_F(TargetComparisonTest, TheWaterIsThatOfThePlan) {
  EXPECT_THAT(comparison_notes_, Not(::testing::IsEmpty()));
  EXPECT_THAT(comparison_notes_, Each(Not(HasSubstr("give a water")))) << "the search knows the water";
  const Water water = TargetOf(Plan()).water.value();
  EXPECT_EQ(result_->info.water, water);
  EXPECT_EQ(PoseTarget(Plan(), Images()).recording->info().water, water);
}

TEST_F(TargetComparisonTest, SyntheticFramesAreCalledSynthetic) {
  EXPECT_EQ(TargetRows(*result_).back().name, "the other synthetic frame");
  report::HtmlReport page("Title");
  AddTarget(page, *result_);
  const std::string html = page.Html();
  EXPECT_THAT(html, HasSubstr("The frame that was not fitted (synthetic)"));
  for (const char* words : {"recorded by a sonar", "recorded frame", "recorded one", "recorded image"})
    EXPECT_THAT(html, Not(HasSubstr(words)));
  const auto json = nlohmann::json::parse(ReproductionMetricsJson(Reproduced(*result_)));
  EXPECT_TRUE(json["body"]["synthetic"].get<bool>());
}

TEST_F(TargetComparisonTest, ADoubtfulAcousticFitIsMarkedInTheReport) {
  TargetComparison target = *result_;
  target.fitted.acoustic.fit.report.warnings = {"the fit is degenerate"};
  Reproduction reproduction = Reproduced(target);
  reproduction.synthetic.acoustic.fit.report.warnings = {"the fit is degenerate"};
  const report::HtmlReport page = MakeReproductionReport(reproduction, nlohmann::ordered_json::object());
  int marked = 0;
  for (const report::Table& table : page.tables()) {
    for (const report::TableRow& row : table.rows) {
      const std::string& name = row.cells.front();
      EXPECT_THAT(name, Not(HasSubstr("acoustic model, fitted,"))) << table.caption;
      if (!name.starts_with("acoustic model, fitted (doubtful)")) continue;
      EXPECT_NE(row.style, report::RowStyle::kStrong) << table.caption;
      ++marked;
    }
  }
  EXPECT_EQ(marked, 7) << "of occupancy one, of each other table two";
  for (const report::KeyFigure& figure : page.key_figures())
    EXPECT_THAT(figure.note, Not(HasSubstr("acoustic model, fitted")));
  EXPECT_THAT(page.Html(), HasSubstr("The fit of the acoustic model is doubtful"));
}

TEST_F(TargetComparisonTest, APictureOfAnotherViewIsShownOnTheScaleOfTheRecording) {
  const PreparedRecording prepared = PrepareTarget(Plan(), Images(), {.quick = true});
  ASSERT_EQ(prepared.recording->frame_count(), 3);
  EXPECT_EQ(prepared.recording->info().water, TargetOf(Plan()).water);
  const PolarImage fitted = prepared.recording->ReadFrame(0).image;
  const PolarImage other = prepared.recording->ReadFrame(2).image;
  EXPECT_EQ(other.scale.full_scale, kFullScale);
  EXPECT_NEAR(LargestOf(other), LargestOf(fitted), 0.1 * kFullScale);
}

}  // namespace
}  // namespace sonarcal::reproduce
