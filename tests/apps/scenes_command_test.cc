#include "apps/scenes_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "data_io/scene_io.h"
#include "tests/apps/tiny_world.h"

namespace sonarcal {
namespace {

using testing::Outcome;
using testing::Quoted;
using testing::RunSonarcal;

TEST(ScenesCommand, WhatItWritesCanBeSimulated) {
  const testing::TempDir dir;
  const Outcome outcome = RunSonarcal("scenes --surface --out " + Quoted(dir / "scenes"));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, ::testing::HasSubstr("next: sonarcal simulate"));
  EXPECT_THAT(ReadGltf(dir / "scenes/tank.gltf").material_names,
              ::testing::UnorderedElementsAre("floor", "wall", "surface", "mockup"));
  for (const char* set : {"1", "2", "3"}) {
    const std::string base = (dir / "scenes").string();
    EXPECT_EQ(
        RunSonarcal(fmt::format("simulate -q --scene {0}/tank.gltf --sonar p900-45 --params {0}/params.json "
                                "--poses {0}/poses_{1}.json --rays 128x64 --out {0}/sim_{1}",
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
  EXPECT_FLOAT_EQ(length_m(ReadGltf(dir / "table/tank.gltf")), 12.0F);
  EXPECT_FLOAT_EQ(length_m(ReadGltf(dir / "text/tank.gltf")), 15.0F);
}

}  // namespace
}  // namespace sonarcal
