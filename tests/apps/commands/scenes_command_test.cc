#include "apps/commands/scenes_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "data_io/open_recording.h"
#include "data_io/scenes/scene_io.h"
#include "tests/apps/tiny_world.h"

namespace sonarcal::commands {
namespace {

using testing::Outcome;
using testing::Quoted;
using testing::RunSonarcal;

TEST(ScenesCommand, WrittenScenesCanBeSimulated) {
  const testing::TempDir dir;
  const Outcome outcome = RunSonarcal("scenes --surface --out " + Quoted(dir / "scenes"));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, ::testing::HasSubstr("next: sonarcal simulate"));
  EXPECT_THAT(data_io::ReadGltf(dir / "scenes/tank.gltf").material_names,
              ::testing::UnorderedElementsAre("floor", "wall", "surface", "mockup"));
  for (const char* set : {"1", "2", "3"}) {
    const std::string base = (dir / "scenes").string();
    EXPECT_EQ(
        RunSonarcal(fmt::format("simulate -q --scene {0}/tank.gltf --sonar p900-45 --params {0}/params.json "
                                "--poses {0}/poses_{1}.json --rays 256x64 --out {0}/sim_{1}",
                                base, set))
            .status,
        0);
  }
}

TEST(ScenesCommand, TextSizesAreOthers) {
  const testing::TempDir dir;
  ASSERT_EQ(RunSonarcal("scenes --out " + Quoted(dir / "table")).status, 0);
  ASSERT_EQ(RunSonarcal("scenes --text-sizes --out " + Quoted(dir / "text")).status, 0);
  const auto length_m = [](const Scene& scene) {
    float longest_m = 0.0F;
    for (const Eigen::Vector3f& vertex_m : scene.vertices_m) longest_m = std::max(longest_m, vertex_m.x());
    return longest_m;
  };
  EXPECT_FLOAT_EQ(length_m(data_io::ReadGltf(dir / "table/tank.gltf")), 12.0F);
  EXPECT_FLOAT_EQ(length_m(data_io::ReadGltf(dir / "text/tank.gltf")), 15.0F);
}

TEST(ScenesCommand, ListNamesEverySceneAndWritesNothing) {
  const Outcome outcome = RunSonarcal("scenes --list");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Outcome json = RunSonarcal("scenes --list --json --edge 0.5");
  ASSERT_EQ(json.status, 0) << json.err;
  std::vector<std::string> names;
  const nlohmann::json listed = nlohmann::json::parse(json.out);
  for (const auto& scene : listed["scenes"]) {
    names.push_back(scene["name"]);
    EXPECT_GE(scene["viewpoints"].get<int>(), 3);
    EXPECT_GT(scene["triangles"].get<int>(), 100);
    EXPECT_THAT(outcome.out, ::testing::HasSubstr(names.back()));
  }
  EXPECT_THAT(names, ::testing::ElementsAre("tank", "mockup", "seabed", "bridge_pier", "jacket"));
  const Outcome neither = RunSonarcal("scenes");
  EXPECT_EQ(neither.status, 2);
  EXPECT_TRUE(testing::IsOneSentence(neither.err)) << neither.err;
}

TEST(ScenesCommand, EachSceneComesWithPosesAndParametersThatRenderIt) {
  const testing::TempDir dir;
  ASSERT_EQ(RunSonarcal("scenes -q --bed --edge 0.4 --out " + Quoted(dir / "s")).status, 0);
  for (const char* name : {"tank", "mockup", "seabed", "bridge_pier", "jacket"}) {
    const std::string base = (dir / "s").string();
    ASSERT_EQ(
        RunSonarcal(fmt::format("simulate -q --scene {0}/{1}.gltf --sonar p900-45 --params {0}/params.json "
                                "--poses {0}/poses_{1}.json --rays 256x128 --out {0}/sim_{1}",
                                base, name))
            .status,
        0)
        << name;
    // Something is seen from each place, and not everywhere.
    const auto recording = data_io::OpenRecording(dir / fmt::format("s/sim_{}", name));
    for (int i = 0; i < recording->frame_count(); ++i) {
      const PolarImage image = recording->ReadFrame(i).image;
      const auto lit = std::count_if(image.value.values().begin(), image.value.values().end(),
                                     [](float grey) { return grey > 0.0F; });
      EXPECT_GT(lit, 300) << name << " " << i;
      EXPECT_LT(lit, static_cast<std::ptrdiff_t>(image.value.size())) << name << " " << i;
    }
  }
}

TEST(ScenesCommand, ResolutionAndChoiceAreOptions) {
  const testing::TempDir dir;
  ASSERT_EQ(RunSonarcal("scenes -q --only seabed,jacket --edge 0.5 --out " + Quoted(dir / "coarse")).status,
            0);
  ASSERT_EQ(RunSonarcal("scenes -q --only seabed --edge 0.25 --seed 7 --out " + Quoted(dir / "fine")).status,
            0);
  EXPECT_FALSE(std::filesystem::exists(dir / "coarse/tank.gltf"));
  EXPECT_TRUE(std::filesystem::exists(dir / "coarse/jacket.gltf"));
  const Scene coarse = data_io::ReadGltf(dir / "coarse/seabed.gltf");
  const Scene fine = data_io::ReadGltf(dir / "fine/seabed.gltf");
  EXPECT_EQ(coarse.triangles.size(), 800u);
  EXPECT_EQ(fine.triangles.size(), 3200u);
  EXPECT_NE(coarse.vertices_m[30].z(), fine.vertices_m[60].z());  // another relief
  const Outcome unknown = RunSonarcal("scenes --only moon --out " + Quoted(dir / "moon"));
  EXPECT_EQ(unknown.status, 2);
  EXPECT_THAT(unknown.err, ::testing::HasSubstr("unknown scene 'moon'"));
}

}  // namespace
}  // namespace sonarcal::commands
