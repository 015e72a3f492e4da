// Commands whose output cannot be written, because a file may not grow beyond a limit. They end with one
// sentence, and what an earlier run wrote stays as it was.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "data_io/parameters/parameters_io.h"
#include "tests/apps/tiny_world.h"

namespace sonarcal::cli {
namespace {

namespace fs = std::filesystem;
using testing::IsOneSentence;
using testing::Outcome;
using testing::Quoted;
using testing::RunSonarcal;
using testing::TinyWorld;

// Content by path; of folders "".
std::map<std::string, std::string> ContentOf(const fs::path& folder) {
  std::map<std::string, std::string> content;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    content[entry.path().lexically_relative(folder).string()] =
        entry.is_directory() ? "" : testing::ReadFile(entry.path());
  }
  return content;
}

struct Writer {
  std::string name;
  std::string arguments;  // {} stands for the folder of the tiny world
  std::string out;
  bool replaces = true;  // takes --force
};

class FailedWriteTest : public ::testing::TestWithParam<Writer> {};

TEST_P(FailedWriteTest, LeavesTheEarlierOutputAndOneSentence) {
  const TinyWorld world;
  world.WriteSimulated("real", true);
  world.WriteSimulated("sim", false);
  data_io::WriteParameters(world / "acoustic.json", testing::TinyAcousticParameters());
  fs::create_directory(world / "outputs");
  const Writer& writer = GetParam();
  const std::string dir = world.scene().parent_path().string();
  std::string arguments = writer.arguments;
  for (std::size_t at = 0; (at = arguments.find("{}", at)) != std::string::npos;)
    arguments.replace(at, 2, dir);
  arguments += " -q --out " + Quoted(world / "outputs" / writer.out) + (writer.replaces ? " --force" : "");
  const Outcome first = RunSonarcal(arguments);
  ASSERT_EQ(first.status, 0) << first.err;
  const std::map<std::string, std::string> before = ContentOf(world / "outputs");
  std::size_t largest_bytes = 0;
  for (const auto& [path, bytes] : before) largest_bytes = std::max(largest_bytes, bytes.size());

  // In blocks of 512 bytes. The largest file fits by none of them.
  constexpr std::size_t kBlock = 512;
  const std::size_t too_few = (largest_bytes - 1) / kBlock;
  ASSERT_GT(too_few, 0U) << "no output is larger than a block";
  for (const std::size_t blocks : {std::size_t{1}, (too_few + 1) / 2, too_few}) {
    const Outcome outcome = RunSonarcal(arguments, fmt::format("trap '' XFSZ; ulimit -f {};", blocks));
    EXPECT_EQ(outcome.status, 1) << blocks;
    EXPECT_TRUE(IsOneSentence(outcome.err)) << outcome.err;
    EXPECT_TRUE(ContentOf(world / "outputs") == before) << blocks << ": " << outcome.err;
  }
}

std::vector<Writer> Writers() {
  const std::string scene = " --scene {}/scene.gltf --params {}/params.json";
  const std::string rays = " --rays 96x200";
  const std::string simulator = " --params {}/params.json --sonar {}/sonar.json";
  std::vector<Writer> writers = {
      {"Scenes", "scenes --only tank", "scenes"},
      {"Simulate", "simulate --noise --sonar {}/sonar.json --poses {}/poses.json" + scene + rays,
       "simulated"},
      {"Convert", "convert {}/real", "converted"},
      {"Compare", "compare --real {}/real --sim {}/sim", "compared"},
      {"Fit", "fit --real {}/real --starts 1 --max-iterations 2" + scene + rays, "fitted"},
      {"Explain", "explain --real {}/real --scene {}/scene.gltf --params {}/acoustic.json" + rays,
       "explained"},
      {"Png", "export --to png --recording {}/real", "png"}};
  for (const char* kind : {"npz", "mcap", "rosbag1", "mp4"})
    writers.push_back(
        {kind, fmt::format("export --to {} --recording {{}}/real", kind), fmt::format("a.{}", kind), false});
  for (const char* kind : {"dave", "holoocean", "oceansim"})
    writers.push_back({kind, fmt::format("export --to {}", kind) + simulator, kind, false});
  for (const char* kind : {"dave-ros2", "stonefish", "gazebo"})
    writers.push_back(
        {kind, fmt::format("export --to {} --scene {{}}/scene.gltf", kind) + simulator, kind, false});
  return writers;
}

std::string NameOf(const ::testing::TestParamInfo<Writer>& info) {
  std::string name = info.param.name;
  std::erase(name, '-');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Commands, FailedWriteTest, ::testing::ValuesIn(Writers()), NameOf);

}  // namespace
}  // namespace sonarcal::cli
