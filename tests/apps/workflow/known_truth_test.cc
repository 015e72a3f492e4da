#include "apps/workflow/known_truth.h"

#include <gtest/gtest.h>

#include "core/types/error.h"
#include "data_io/open_recording.h"
#include "data_io/parameters/parameters_io.h"
#include "sim/physics/gsab.h"
#include "tests/apps/tiny_world.h"

namespace sonarcal::workflow {
namespace {

using testing::TinyWorld;

Scene FloorAndBox() {
  Scene scene;
  scene.material_names = {"floor", "box"};
  return scene;
}

SonarModel Sonar() {
  SonarModel sonar;
  sonar.axes = {0.5, 4.5, 160, {-0.1, 0.0, 0.1}};
  sonar.azimuth_beam_width_deg = 1.25;
  sonar.elevation_beam_width_deg = 20.0;
  return sonar;
}

ParameterSet Truth(EchoModel model) {
  ParameterSet truth = testing::TinyParameters();
  truth.model = model;
  truth.receiver.noise_db = 94.0;
  return truth;
}

calib::FitReport Report() {
  calib::FitReport report;
  for (const char* name : {"source_level_db", "material.box.gsab.A", "material.box.gsab.B_deg",
                           "receiver.noise_db", "beam.azimuth_width_deg", "display.db_max", "pose.0.x_m"}) {
    calib::FittedParameter parameter;
    parameter.name = name;
    report.parameters.push_back(parameter);
  }
  report.curves.push_back(
      {.material = "box", .incidence_deg = {0.0, 30.0}, .backscatter_db = {1, 1}, .sigma_db = {1, 1}});
  return report;
}

std::optional<double> TrueValue(const calib::FitReport& report, const std::string& name) {
  return report.Find(name)->truth;
}

TEST(KnownTruth, StandsBesideTheFittedValuesOfTheSameName) {
  calib::FitReport report = Report();
  const ParameterSet truth = Truth(EchoModel::kCoherent);
  AddTruth(truth, Truth(EchoModel::kAcoustic), FloorAndBox(), Sonar(), report);
  EXPECT_EQ(TrueValue(report, "material.box.gsab.A"), 40.0);
  EXPECT_EQ(TrueValue(report, "material.box.gsab.B_deg"), 3.0);
  EXPECT_EQ(TrueValue(report, "receiver.noise_db"), 94.0);
  EXPECT_EQ(TrueValue(report, "beam.azimuth_width_deg"), 1.25) << "the sonar's own";
  EXPECT_FALSE(TrueValue(report, "pose.0.x_m"));
  ASSERT_EQ(report.curves[0].truth_db.size(), 2u);
  EXPECT_DOUBLE_EQ(report.curves[0].truth_db[1], sim::GsabDb(truth.Material("box").gsab, 30.0));
}

TEST(KnownTruth, ALevelIsComparedOnlyWhereTheGaugeIsTheSame) {
  calib::FitReport report = Report();
  ParameterSet fitted = Truth(EchoModel::kAcoustic);
  fitted.receiver.gain_db = 6.0;
  AddTruth(Truth(EchoModel::kAcoustic), fitted, FloorAndBox(), Sonar(), report);
  EXPECT_FALSE(TrueValue(report, "material.box.gsab.A"));
  EXPECT_EQ(TrueValue(report, "material.box.gsab.B_deg"), 3.0) << "a width hangs on no level";
  EXPECT_TRUE(report.curves[0].truth_db.empty());
}

TEST(KnownTruth, OfThePapersModelIsNotComparedWithAnother) {
  for (const auto& [truth, fitted] : {std::pair(EchoModel::kPaper, EchoModel::kAcoustic),
                                      std::pair(EchoModel::kCoherent, EchoModel::kPaper)}) {
    calib::FitReport report = Report();
    AddTruth(Truth(truth), Truth(fitted), FloorAndBox(), Sonar(), report);
    EXPECT_FALSE(calib::HasTruth(report));
  }
  calib::FitReport report = Report();
  AddTruth(Truth(EchoModel::kPaper), Truth(EchoModel::kPaper), FloorAndBox(), Sonar(), report);
  EXPECT_EQ(TrueValue(report, "display.db_max"), 166.0);
}

TEST(KnownTruth, IsReadFromASimulatedRecordingOnly) {
  const TinyWorld world;
  const std::filesystem::path simulated = world.WriteSimulated("simulated", true);
  RecordingInfo info = data_io::OpenRecording(simulated)->info();
  const std::optional<ParameterSet> truth = ReadTruth(info);
  ASSERT_TRUE(truth);
  EXPECT_EQ(*truth, data_io::ReadParameters(world.params()));
  info.synthetic = false;
  EXPECT_FALSE(ReadTruth(info)) << "the parameters of a real recording are somebody's guess";
}

TEST(KnownTruth, OfAnotherSimulationIsReadFromItsFile) {
  const TinyWorld world;
  const std::filesystem::path folder = world / "other";
  RecordingInfo info;
  info.source = folder.string();
  std::filesystem::create_directories(folder);
  EXPECT_FALSE(ReadTruth(info));
  testing::WriteFile(folder / "truth.json", R"({
    "gsab": {"floor": {"A": 0.1, "B": 5, "C": 0.002, "D": 1.8, "E": 0.01, "F": 11}},
    "noise_level_db": 94, "source_level_db": 200, "reflection_pressure": {"wall": -0.5},
    "cell": {"azimuth_half_power_deg_at_centre": 1, "elevation_half_power_deg": 20,
             "range_half_power_m": 0.0254}})");
  const std::optional<ParameterSet> truth = ReadTruth(info);
  ASSERT_TRUE(truth);
  EXPECT_EQ(truth->materials.at("floor").gsab.f_deg, 11.0);
  EXPECT_NEAR(truth->mirrors.at("wall").loss_db, 6.0206, 1e-4);
  testing::WriteFile(folder / "truth.json", "{");
  EXPECT_THROW(ReadTruth(info), DataError);
}

}  // namespace
}  // namespace sonarcal::workflow
