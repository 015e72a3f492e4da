// Plans of case studies: those of the project, and mistakes in a plan.
#include "apps/reproduce/case_plan.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <string>

#include "core/types/error.h"
#include "core/types/units.h"
#include "data_io/recordings/recording_catalogue.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::reproduce {
namespace {

using ::testing::HasSubstr;

const std::filesystem::path kCases = std::filesystem::path(SONARCAL_SOURCE_DIR) / "cases";

TEST(CasePlan, TheCasesOfTheProjectAreRead) {
  EXPECT_THAT(CaseNames(kCases), ::testing::ElementsAre("bomb", "hull_strip", "tank"));
  const CasePlan bomb = ReadCase(kCases / "bomb");
  const auto& target = std::get<TargetCase>(bomb.study);
  EXPECT_EQ(target.recording, "aris3000_uxo");
  EXPECT_EQ(target.pose.range_m, 1.286);
  EXPECT_EQ(target.pose.yaw_rad, RadFromDeg(126.9));
  EXPECT_EQ(target.start.beam.azimuth_taper, 0.6);
  EXPECT_EQ(target.scene.material_names, std::vector<std::string>{"body"});
  ASSERT_TRUE(target.other);
  EXPECT_EQ(target.other->fan.apex_y_px, 1343.0);

  const CasePlan hull = ReadCase(kCases / "hull_strip");
  EXPECT_EQ(std::get<MarkedSurfaceCase>(hull.study).leans_deg.size(), 8U);

  const CasePlan tank = ReadCase(kCases / "tank");
  const auto& synthetic = std::get<SyntheticCase>(tank.study);
  ASSERT_EQ(synthetic.data_sets.size(), 3U);
  EXPECT_EQ(synthetic.data_sets[1].ns_over_nr, 1.10);
  EXPECT_EQ(synthetic.truth.model, EchoModel::kCoherent);
}

// `sonarcal recordings` lists each recording, and what it fetches has the folders of the plan.
TEST(CasePlan, TheRecordingsOfTheCasesAreInTheCatalogue) {
  const auto find = [](const std::string& name) {
    const std::vector<data_io::PublicRecording>& all = data_io::RecordingCatalogue();
    const auto found = std::ranges::find(all, name, &data_io::PublicRecording::name);
    return found == all.end() ? nullptr : &*found;
  };
  EXPECT_TRUE(find(std::get<TargetCase>(ReadCase(kCases / "bomb").study).recording));
  const CasePlan hull = ReadCase(kCases / "hull_strip");
  const auto& surface = std::get<MarkedSurfaceCase>(hull.study);
  const data_io::PublicRecording* recording = find(surface.recording);
  ASSERT_TRUE(recording);
  for (const std::string& folder : {surface.pings, surface.background, surface.marks})
    EXPECT_TRUE(std::ranges::count(recording->paths, folder, &data_io::PublicRecording::Path::to)) << folder;
}

TEST(CasePlan, SaysWhereThePoseComesFrom) {
  EXPECT_THAT(KnownSentences(ReadCase(kCases / "bomb")),
              ::testing::Contains(::testing::AllOf(HasSubstr("Pose"), HasSubstr("`sonarcal locate`"))));
}

class CasesVariable : public ::testing::Test {
 protected:
  void SetUp() override { setenv("SONARCAL_CASES", folder_.path().c_str(), 1); }
  void TearDown() override { unsetenv("SONARCAL_CASES"); }

  testing::TempDir folder_;
};

TEST_F(CasesVariable, NamesTheFolder) {
  EXPECT_EQ(CasesFolder(), folder_.path());
  std::filesystem::copy(kCases / "hull_strip", folder_ / "my_hull");
  EXPECT_EQ(FindCase("my-hull").name, "my_hull");
  try {
    FindCase("ship");
    FAIL() << "there is no ship";
  } catch (const UsageError& error) {
    EXPECT_STREQ(error.what(), "unknown case 'ship', expected my_hull");
  }
  setenv("SONARCAL_CASES", (folder_ / "nowhere").c_str(), 1);
  EXPECT_THROW(CasesFolder(), DataError);
}

// The sentence about a plan of `name` in which `from` is replaced by `to`.
std::string Refusal(const std::string& name, const std::string& from, const std::string& to) {
  const testing::TempDir folder;
  std::filesystem::copy(kCases / name, folder / name);
  std::string text = testing::ReadFile(folder / name / "case.json");
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  testing::WriteFile(folder / name / "case.json", text.replace(at, from.size(), to));
  try {
    ReadCase(folder / name);
  } catch (const DataError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(CasePlan, MistakesAreNamedWithFileLineAndKey) {
  EXPECT_THAT(Refusal("bomb", "sonar-case/1", "sonar-case/2"), HasSubstr("case.json:2: 'format'"));
  EXPECT_THAT(Refusal("bomb", "\"held_out_frame\": 1", "\"held_out_frame\": 0"),
              HasSubstr("'target.held_out_frame' is fitted_frame"));
  EXPECT_THAT(Refusal("bomb", "\"db_span\"", "\"db_spam\""), HasSubstr("'target.other_view.db_span'"));
  EXPECT_THAT(Refusal("bomb", "\"label\"", "\"colour\": 3, \"label\""), HasSubstr("unknown key 'colour'"));
  const auto turned = [&](const char* radii_mm) {
    return Refusal(
        "bomb", R"("scene": {"ogive_body")",
        fmt::format(R"("scene": {{"turned_solid": {{"length_m": 1, "max_edge_m": 0.1, "material": "body",
                               "radii_mm": {}}}}}, "unused": {{"ogive_body")",
                    radii_mm));
  };
  EXPECT_THAT(turned("[[0, 10], [0.5, 20], [0.5, 10]]"), HasSubstr("nearer to the tip"));
  EXPECT_THAT(turned("[[0, 10], [0.5, 0]]"), HasSubstr("a radius above 0"));
  EXPECT_THAT(Refusal("bomb", "\"aris3000_uxo\"", "\"../secret\""), HasSubstr("a path below the folder"));
  EXPECT_THAT(Refusal("bomb", "\"ogive_body\"", "\"solid\""), HasSubstr("needs one of file, environment"));
  EXPECT_THAT(Refusal("bomb", "\"start.json\"", "\"absent.json\""), HasSubstr("absent.json"));
  EXPECT_THAT(Refusal("bomb", "[0.1, 0.5]", "[0.5, 0.1]"), HasSubstr("the smaller first"));
  EXPECT_THAT(Refusal("hull_strip", "\"marked_surface\"", "\"surface\""), HasSubstr("needs exactly one of"));
  EXPECT_THAT(Refusal("hull_strip", "[0, 5, 10", "[10, 5, 0"), HasSubstr("in rising order"));
  EXPECT_THAT(Refusal("hull_strip", "\"material\": \"hull strip from marks\"", "\"material\": \"hull\""),
              HasSubstr("has no material 'hull'"));
  EXPECT_THAT(Refusal("tank", "\"environment\": \"tank\"", "\"environment\": \"moon\""),
              HasSubstr("unknown scene 'moon'"));
  EXPECT_THAT(Refusal("tank", "\"pose_set\": 3", "\"pose_set\": 4"), HasSubstr("pose_set"));
  EXPECT_THAT(Refusal("tank", "\"recording_params.json\"", "\"acoustic_start.json\""),
              HasSubstr("has the model 'acoustic', expected 'coherent'"));
  EXPECT_THAT(Refusal("tank", "\"p900-45\"", "\"p901\""), HasSubstr("'synthetic.sonar'"));
}

}  // namespace
}  // namespace sonarcal::reproduce
