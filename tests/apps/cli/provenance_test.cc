// provenance.json: which files a run lists as its inputs.
#include "apps/cli/provenance.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "apps/cli/add_options.h"
#include "apps/workflow/calibration/calibrate.h"
#include "apps/workflow/explain.h"
#include "apps/workflow/fit.h"
#include "data_io/images/image_io.h"
#include "tests/apps/tiny_world.h"

namespace sonarcal::cli {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using testing::Outcome;
using testing::Quoted;
using testing::ReadJsonFile;
using testing::RunSonarcal;
using testing::TinyWorld;
using ::testing::UnorderedElementsAre;

std::vector<std::string> Texts(const std::vector<fs::path>& paths) {
  std::vector<std::string> texts;
  for (const fs::path& path : paths) texts.push_back(path.string());
  return texts;
}

// Runs a command that writes into `out`, and returns the paths of its inputs.
std::set<std::string> InputsOf(const std::string& arguments, const fs::path& out) {
  const Outcome outcome = RunSonarcal(fmt::format("{} -q --out {}", arguments, Quoted(out)));
  EXPECT_EQ(outcome.status, 0) << arguments << '\n' << outcome.err;
  std::set<std::string> paths;
  const nlohmann::json provenance = ReadJsonFile(out / "provenance.json");
  for (const nlohmann::json& input : provenance.at("inputs"))
    paths.insert(input.at("path").get<std::string>());
  return paths;
}

TEST(Provenance, AFolderCountsWithoutStagedOutputs) {
  const testing::TempDir dir;
  for (const char* folder : {".out.partial-12-1", ".out.unfinished", "other"})
    fs::create_directory(dir / folder);
  testing::WriteFile(dir / "a", "1");
  testing::WriteFile(dir / "other/b", "2");
  const auto whole = ProvenanceToJson({.command = "test", .inputs = {dir.path(), fs::path()}})["inputs"];
  ASSERT_EQ(whole.size(), 1U) << "an empty path is no input";
  EXPECT_EQ(whole[0]["files"], 2);
  testing::WriteFile(dir / ".out.partial-12-1/c", "3");
  testing::WriteFile(dir / ".out.unfinished/d", "4");
  testing::WriteFile(dir / ".e.partial-12-1", "5");
  EXPECT_EQ(ProvenanceToJson({.command = "test", .inputs = {dir.path()}})["inputs"], whole);
}

TEST(Provenance, OutputsWithinAnInputDoNotCountAsIt) {
  const TinyWorld world;
  const fs::path real = world.WriteSimulated("real", true);
  const nlohmann::json alone = ProvenanceToJson({.command = "test", .inputs = {real}})["inputs"][0];
  const std::string compare = fmt::format("compare -q --pictures 0 --real {0} --sim {0} --out {1}",
                                          Quoted(real), Quoted(real / "compared"));
  for (int run = 0; run < 2; ++run) {
    ASSERT_EQ(RunSonarcal(compare).status, 0);
    const nlohmann::json inputs = ReadJsonFile(real / "compared/provenance.json").at("inputs");
    EXPECT_EQ(inputs.at(0), alone) << run;
  }
}

TEST(Provenance, FilesOfOptionsAreFound) {
  workflow::FitOptions fit;
  EXPECT_TRUE(OptionFiles(fit).empty());
  fit.config.file = "config.json";
  fit.materials.material = {"floor=sand:medium"};
  fit.materials.materials = {"first.json", "second.json"};
  fit.comparison.background_params.file = "background.json";
  fit.comparison.region.file = "region.png";
  EXPECT_THAT(Texts(OptionFiles(fit)), UnorderedElementsAre("config.json", "first.json", "second.json",
                                                            "background.json", "region.png"));
  workflow::ExplainOptions explain;
  explain.comparison.background_params.file = "background.json";
  EXPECT_THAT(Texts(OptionFiles(explain)), ElementsAre("background.json"));
  workflow::CalibrateOptions calibrate;
  calibrate.materials.materials = {"first.json"};
  EXPECT_THAT(Texts(OptionFiles(calibrate)), ElementsAre("first.json"));
}

TEST(Provenance, CommandsListTheFilesThatTheyRead) {
  const TinyWorld world;
  const std::string real = world.WriteSimulated("real", true).string();
  const std::string region = (world / "region.png").string();
  data_io::WritePng(region, Grid<std::uint8_t>(60, 24, 255));
  const std::string sonar = world.sonar().string();
  const std::string others = fmt::format(" --sonar '{}' --region '{}'", sonar, region);
  EXPECT_THAT(InputsOf(fmt::format("convert '{}'", real), world / "plain"), ElementsAre(real));
  EXPECT_THAT(InputsOf(fmt::format("convert '{}' --sonar '{}'", real, sonar), world / "converted"),
              UnorderedElementsAre(real, sonar));
  EXPECT_THAT(InputsOf(fmt::format("compare --real '{0}' --sim '{0}'{1}", real, others), world / "compared"),
              UnorderedElementsAre(real, sonar, region));
  EXPECT_THAT(InputsOf(fmt::format("fit --real '{}' --scene {} --params {} --rays 96x200 --starts 1 --free "
                                   "display.db_max --held-out 1{}",
                                   real, Quoted(world.scene()), Quoted(world.params()), others),
                       world / "fitted"),
              UnorderedElementsAre(real, world.scene().string(), world.params().string(), sonar, region));
}

}  // namespace
}  // namespace sonarcal::cli
