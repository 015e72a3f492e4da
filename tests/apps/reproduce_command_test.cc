// `reproduce --quick` from end to end, without a real recording: its tank is SYNTHETIC.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "data_io/open_recording.h"
#include "tests/apps/html_check.h"
#include "tests/apps/tiny_world.h"
#include "tests/support/temp_dir.h"

namespace sonarcal {
namespace {

using ::testing::HasSubstr;
using testing::Quoted;

TEST(ReproduceCommand, FitsBothModelsToACoherentRecordingAndSaysItIsSynthetic) {
  const testing::TempDir dir;
  std::filesystem::create_directories(dir / "no_recordings");
  const testing::Outcome outcome = testing::RunSonarcal(
      "reproduce --quick -q --recordings " + Quoted(dir / "no_recordings") + " --out " + Quoted(dir / "out"));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  for (const char* part : {"SYNTHETIC", "paper model, fitted", "acoustic model, fitted, a speckled sample"})
    EXPECT_THAT(outcome.out, HasSubstr(part));

  const auto recording = OpenRecording(dir / "out/synthetic_recording");
  EXPECT_TRUE(recording->info().synthetic);
  EXPECT_EQ(testing::ReadJsonFile(dir / "out/tank_params.json")["model"], "paper");
  EXPECT_EQ(testing::ReadJsonFile(dir / "out/tank_acoustic_params.json")["model"], "acoustic");

  const nlohmann::json metrics = testing::ReadJsonFile(dir / "out/metrics.json");
  EXPECT_TRUE(metrics["summary"]["synthetic"].get<bool>());
  const nlohmann::json& rows = metrics["summary"]["rows"];
  for (const char* key :
       {"paper_initial", "paper_fitted", "acoustic_initial", "acoustic_expected", "acoustic_sample"}) {
    ASSERT_TRUE(rows.contains(key)) << key;
    EXPECT_TRUE(rows[key]["intensity_error"]["union"].is_number()) << key;
  }
  // Fitted, each model is nearer to frames it did not see than before; the one with noise and speckle nearer
  // than the one without.
  const auto error = [&](const char* key) { return rows[key]["intensity_error"]["whole"].get<double>(); };
  EXPECT_LT(error("acoustic_expected"), error("acoustic_initial"));
  EXPECT_LT(error("acoustic_expected"), error("paper_fitted"));
  EXPECT_TRUE(metrics["bomb"].contains("absent_because"));
  ASSERT_EQ(metrics["data_sets"].size(), 3U);
  for (const char* key : {"before", "after", "acoustic_expected", "acoustic_sample", "published"})
    EXPECT_TRUE(metrics["data_sets"][2].contains(key)) << key;

  const std::string html = testing::ReadFile(dir / "out/report.html");
  EXPECT_EQ(testing::HtmlFault(html), "");
  EXPECT_THAT(html, HasSubstr("The recorded side is synthetic"));
}

}  // namespace
}  // namespace sonarcal
