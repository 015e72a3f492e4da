// `reproduce --quick` from end to end, without a real recording: its tank is SYNTHETIC.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <set>
#include <sstream>

#include "data_io/open_recording.h"
#include "tests/apps/html_check.h"
#include "tests/apps/tiny_world.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::commands {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using testing::Quoted;

// The command of README's tour that begins with `words`, without its comment.
std::string TourCommand(const std::string& words) {
  std::istringstream readme(testing::ReadFile(std::filesystem::path(SONARCAL_SOURCE_DIR) / "README.md"));
  for (std::string line; std::getline(readme, line);) {
    if (line.starts_with("sonarcal " + words)) return line.substr(9, line.find('#') - 9);
  }
  ADD_FAILURE() << "README's tour has no 'sonarcal " << words << "'";
  return {};
}

// README's tour goes on from the report: what it simulates and compares has the figures of the report's row.
// The rays are those of --quick.
void ExpectTheTourPrintsTheReportsFigures(const std::filesystem::path& folder, const nlohmann::json& rows) {
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(folder);
  ASSERT_EQ(setenv("R", "report/synthetic_recording", 1), 0);
  const testing::Outcome simulated = testing::RunSonarcal(TourCommand("simulate") + " --rays 256x600 -q");
  EXPECT_EQ(simulated.status, 0) << simulated.err;
  const testing::Outcome compared = testing::RunSonarcal(TourCommand("compare") + " -q");
  EXPECT_EQ(compared.status, 0) << compared.err;
  std::filesystem::current_path(before);
  const nlohmann::json macro = testing::ReadJsonFile(folder / "comparison/metrics.json")["macro"];
  const nlohmann::json& row = rows["acoustic_expected"];
  for (const char* ratio : {"iou", "ns_over_nr", "na_over_ns", "na_over_nr"})
    EXPECT_NEAR(macro[ratio].get<double>(), row[ratio].get<double>(), 0.01) << ratio;
  EXPECT_NEAR(macro["intensity_error"]["polar"].get<double>(), row["intensity_error"]["union"].get<double>(),
              0.005);
  for (const char* words : {"view", "fit", "explain"})
    EXPECT_THAT(TourCommand(words), HasSubstr("--object mockup"));
}

// A disk that is full at the first file, or at the report itself: one sentence, the earlier report stays.
void ExpectAFullDiskLeavesTheReport(const std::filesystem::path& folder, const std::string& arguments) {
  const std::string report = testing::ReadFile(folder / "report/report.html");
  const auto entries = [&] {
    std::set<std::filesystem::path> found;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
      found.insert(entry.path());
    return found;
  };
  const std::set<std::filesystem::path> before = entries();
  for (const std::size_t blocks : {std::size_t{1}, (report.size() - 1) / 512}) {  // of 512 bytes
    const testing::Outcome outcome =
        testing::RunSonarcal(arguments + " --force", fmt::format("trap '' XFSZ; ulimit -f {};", blocks));
    EXPECT_EQ(outcome.status, 1) << blocks;
    EXPECT_TRUE(testing::IsOneSentence(outcome.err)) << outcome.err;
    EXPECT_TRUE(testing::ReadFile(folder / "report/report.html") == report) << blocks;
    EXPECT_EQ(entries(), before) << blocks;
  }
}

TEST(ReproduceCommand, FitsBothModelsToACoherentRecordingAndSaysItIsSynthetic) {
  const testing::TempDir dir;
  std::filesystem::create_directories(dir / "no_recordings");
  const std::string arguments = "reproduce --quick -q --recordings " + Quoted(dir / "no_recordings") +
                                " --out " + Quoted(dir / "report");
  const testing::Outcome outcome = testing::RunSonarcal(arguments);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  for (const char* part : {"SYNTHETIC", "paper model, fitted", "acoustic model, fitted, a speckled sample"})
    EXPECT_THAT(outcome.out, HasSubstr(part));

  const auto recording = data_io::OpenRecording(dir / "report/synthetic_recording");
  EXPECT_TRUE(recording->info().synthetic);
  EXPECT_EQ(testing::ReadJsonFile(dir / "report/tank_params.json")["model"], "paper");
  EXPECT_EQ(testing::ReadJsonFile(dir / "report/tank_acoustic_params.json")["model"], "acoustic");

  const nlohmann::json metrics = testing::ReadJsonFile(dir / "report/metrics.json");
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

  const std::string html = testing::ReadFile(dir / "report/report.html");
  EXPECT_EQ(testing::HtmlFault(html), "");
  EXPECT_LT(html.size(), 6'000'000U);
  EXPECT_EQ(testing::PictureFault(html), "");
  EXPECT_LT(html.find("<figure class=\"pictures\">"), html.find("<h2")) << "it opens with the picture";
  EXPECT_THAT(html, HasSubstr("The recorded side is synthetic"));
  EXPECT_THAT(html, HasSubstr("The box comes from the model"));
  for (const char* image :
       {"acoustic model, fitted: expected image", "acoustic model, fitted: speckled sample"})
    EXPECT_THAT(html, HasSubstr(image)) << "each card names its image";
  if (!metrics["paper_fit_warnings"].empty()) {
    EXPECT_THAT(html, Not(HasSubstr("paper model, fitted: expected image"))) << "doubtful figures come later";
  }

  ExpectAFullDiskLeavesTheReport(dir.path(), arguments);
  ExpectTheTourPrintsTheReportsFigures(dir.path(), rows);
}

}  // namespace
}  // namespace sonarcal::commands
