#include "calib/parameters/fit_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/types/error.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::calib {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::TempDir;
using testing::WriteFile;

TEST(FitConfigTest, AFileIsReadWhole) {
  const TempDir dir;
  WriteFile(dir / "fit.json",
            R"({"format": "sonar-fit-config/1", "free": ["materials"], "fixed": ["material.wall.*"],
    "bounds": {"material.floor.gsab.D": [0.5, 3]}, "held_out": [2]})");
  const FitConfig config = ReadFitConfig(dir / "fit.json");
  std::vector<CatalogEntry> catalog = BuildCatalog({"floor", "wall"});
  const std::vector<bool> free = ApplyFitConfig(config, catalog);
  int free_count = 0;
  for (std::size_t i = 0; i < catalog.size(); ++i) {
    if (free[i]) {
      ++free_count;
      EXPECT_THAT(catalog[i].name, HasSubstr("material.floor.gsab."));
    }
    if (catalog[i].name == "material.floor.gsab.D") {
      EXPECT_EQ(catalog[i].lower, 0.5);
      EXPECT_EQ(catalog[i].upper, 3.0);
    }
  }
  EXPECT_EQ(free_count, 6);
  EXPECT_THAT(SplitFrames(config, 4).used, ElementsAre(0, 1, 3));
}

TEST(FitConfigTest, PriorsAreOfValuesAndBecomePriorsOfCoordinates) {
  const TempDir dir;
  WriteFile(dir / "fit.json", R"({"format": "sonar-fit-config/1", "free": ["materials"],
    "priors": {"material.floor.gsab.C": [0.002, 0.0002], "material.floor.gsab.D": [1.8, 0.1],
               "material.wall.*": "none"}})");
  std::vector<CatalogEntry> catalog = BuildCatalog({"floor", "wall"});
  ApplyFitConfig(ReadFitConfig(dir / "fit.json"), catalog);
  for (const CatalogEntry& entry : catalog) {
    if (entry.name == "material.floor.gsab.C") {
      EXPECT_DOUBLE_EQ(entry.prior.value().coordinate, std::log(0.002));
      EXPECT_DOUBLE_EQ(entry.prior.value().sigma, 0.1);
    } else if (entry.name == "material.floor.gsab.D") {
      EXPECT_DOUBLE_EQ(entry.prior.value().coordinate, 1.8);
      EXPECT_DOUBLE_EQ(entry.prior.value().sigma, 0.1);
    } else if (entry.name.starts_with("material.wall.")) {
      EXPECT_TRUE(std::isinf(entry.prior.value().sigma));
    } else {
      EXPECT_FALSE(entry.prior.has_value());
    }
  }
  WriteFile(dir / "fit.json",
            "{\"format\": \"sonar-fit-config/1\",\n\"priors\": {\"source_level_db\": [200, 0]}}");
  EXPECT_THAT([&] { ReadFitConfig(dir / "fit.json"); },
              ::testing::ThrowsMessage<DataError>(HasSubstr("sigma > 0")));
}

// A fit must not find a value that params.json cannot hold.
TEST(FitConfigTest, BoundsBeyondTheLimitsOfTheParameterFileAreRefused) {
  std::vector<CatalogEntry> catalog = BuildCatalog({"floor"});
  const auto d = std::ranges::find(catalog, "material.floor.gsab.D", &CatalogEntry::name);
  FitConfig config{.free = std::vector<std::string>{"materials"}};
  for (const auto& [lower, upper] :
       {std::pair{d->file_lower - 1.0, d->file_upper}, std::pair{d->file_lower, d->file_upper + 1.0}}) {
    config.bounds = {{d->name, {lower, upper}}};
    EXPECT_THAT([&] { ApplyFitConfig(config, catalog); },
                ::testing::ThrowsMessage<DataError>(HasSubstr("the limits of params.json")));
  }
  config.bounds = {{d->name, {d->file_lower, d->file_upper}}};
  ApplyFitConfig(config, catalog);
  EXPECT_EQ(d->upper, d->file_upper);
}

// Bounds of each key in turn as [1, 1 + place], in an order in which the alphabet would choose another one.
TEST(FitConfigTest, TheClosestKeyCountsWhereSeveralMatch) {
  std::vector<CatalogEntry> catalog = BuildCatalog({"floor", "wall"});
  FitConfig config{.free = std::vector<std::string>{"materials"}};
  config.bounds = {{"*", {1.0, 2.0}},
                   {"materials", {1.0, 3.0}},
                   {"m*", {1.0, 4.0}},
                   {"material.floor.*", {1.0, 5.0}},
                   {"material.floor.gsab.D", {1.0, 6.0}},
                   {"material.floor.gsab.[A-D]", {1.0, 6.0}}};
  config.priors = {
      {"material.*", std::nullopt}, {"material.wall.gsab.D", {{2.0, 0.1}}}, {"*.D", {{1.0, 0.1}}}};
  ApplyFitConfig(config, catalog);
  for (const CatalogEntry& entry : catalog) {
    double upper = 2.0;
    if (entry.name.starts_with("material.")) upper = 4.0;
    if (entry.name.starts_with("material.floor.")) upper = 5.0;
    const bool listed = entry.key == "A" || entry.key == "C" || entry.key == "D";
    if (entry.name.starts_with("material.floor.") && listed) upper = 6.0;
    EXPECT_EQ(entry.upper, upper) << entry.name;
    if (entry.name == "material.wall.gsab.D") {
      EXPECT_EQ(entry.prior.value().coordinate, 2.0);
    } else if (entry.name.starts_with("material.")) {
      EXPECT_TRUE(std::isinf(entry.prior.value().sigma)) << entry.name;
    }
  }
}

TEST(FitConfigTest, EquallyCloseKeysMustAgreeWhereTheyMatchTheSameParameter) {
  std::vector<CatalogEntry> catalog = BuildCatalog({"floor", "wall"});
  FitConfig config{.free = std::vector<std::string>{"materials"}};
  config.bounds = {{"*floor*", {1.0, 2.0}}, {"*gsab.*", {1.0, 3.0}}};
  try {
    ApplyFitConfig(config, catalog);
    FAIL() << "contradicting bounds were accepted";
  } catch (const DataError& error) {
    EXPECT_THAT(error.what(),
                HasSubstr("'*floor*' and '*gsab.*' give different bounds to material.floor.gsab.A"));
  }
  config.bounds["*gsab.*"] = {1.0, 2.0};
  ApplyFitConfig(config, catalog);
}

TEST(FitConfigTest, AnUnknownKeyIsRefusedWithItsLine) {
  const TempDir dir;
  WriteFile(dir / "fit.json", "{\"format\": \"sonar-fit-config/1\",\n\"fre\": []}");
  try {
    ReadFitConfig(dir / "fit.json");
    FAIL() << "accepted";
  } catch (const DataError& error) {
    EXPECT_THAT(error.what(), HasSubstr("fit.json:2"));
    EXPECT_THAT(error.what(), HasSubstr("fre"));
  }
}

TEST(FitConfigTest, TextIsReadAsTheFileAndNamedInMessages) {
  const TempDir dir;
  const std::string text = R"({"format": "sonar-fit-config/1", "free": ["materials"],
    "bounds": {"material.floor.gsab.D": [0.5, 3]}, "pose_prior": {"angle_deg": 1}, "held_out": [2]})";
  WriteFile(dir / "fit.json", text);
  EXPECT_EQ(ParseFitConfig(text, "config"), ReadFitConfig(dir / "fit.json"));
  EXPECT_THAT([&] { ParseFitConfig("{\"format\": \"sonar-fit-config/1\", \"fre\": []}", "config"); },
              ::testing::ThrowsMessage<DataError>(::testing::AllOf(HasSubstr("config"), HasSubstr("fre"))));
}

TEST(FitConfigTest, ByDefaultTheLastThirdIsHeldOut) {
  EXPECT_THAT(SplitFrames({}, 1).held_out, ElementsAre());
  EXPECT_THAT(SplitFrames({}, 2).held_out, ElementsAre(1));
  EXPECT_THAT(SplitFrames({}, 6).held_out, ElementsAre(4, 5));
}

TEST(FitConfigTest, ByDefaultTheLastThirdOfTheUsedFramesIsHeldOut) {
  const auto split_of = [](std::vector<int> used) {
    const FrameSplit split = SplitFrames({.used = std::move(used)}, 8);
    return std::pair(split.used, split.held_out);
  };
  using Lists = std::pair<std::vector<int>, std::vector<int>>;
  EXPECT_EQ(split_of({4, 5, 6, 7}), (Lists{{4, 5, 6}, {7}}));
  EXPECT_EQ(split_of({7, 6}), (Lists{{6}, {7}}));
  EXPECT_EQ(split_of({5, 0, 1, 2, 3, 4}), (Lists{{0, 1, 2, 3}, {4, 5}}));
  EXPECT_EQ(split_of({7}), (Lists{{7}, {}}));
}

TEST(FitConfigTest, UsedFramesAreThoseGivenWithoutTheHeldOutOnes) {
  FitConfig config;
  config.used = {5, 1, 1, 3};
  config.held_out = {3};
  const FrameSplit split = SplitFrames(config, 6);
  EXPECT_THAT(split.used, ElementsAre(1, 5));
  EXPECT_THAT(split.held_out, ElementsAre(3));
  config.used = {6};
  EXPECT_THROW(SplitFrames(config, 6), DataError);
}

TEST(FitConfigTest, IsWrittenAsItIsRead) {
  FitConfig config;
  config.free = {"materials", "object:mockup"};
  config.fixed = {"material.wall.*"};
  config.bounds["material.floor.gsab.D"] = {0.5, 3.0};
  config.priors["receiver.noise_db"] = std::nullopt;
  config.priors["beam.azimuth_width_deg"] = std::pair{1.0, 0.05};
  config.pose_prior = {.position_m = 0.0123456789012345, .angle_deg = 0.7};
  config.start["geometry.range_scale"] = 0.99;
  config.held_out = std::vector<int>{};
  config.used = {0, 2};
  EXPECT_EQ(ParseFitConfig(FitConfigJson(config).dump(), "written"), config);
  EXPECT_THAT(ObjectsNamed(config), ElementsAre("mockup"));
  config.free = {"object.a.b.x_m", "object:a.b", "pose"};
  EXPECT_THAT(ObjectsNamed(config), ElementsAre("a.b"));
}

TEST(FitConfigTest, FramesThatDoNotExistOrLeaveNoneAreRefused) {
  FitConfig config;
  config.held_out = {5};
  EXPECT_THROW(SplitFrames(config, 5), DataError);
  config.held_out = {0, 1};
  EXPECT_THAT([&] { SplitFrames(config, 2); },
              ::testing::ThrowsMessage<DataError>(HasSubstr("all 2 frames are held out")));
  config.used = {1};
  EXPECT_THAT([&] { SplitFrames(config, 8); },
              ::testing::ThrowsMessage<DataError>(HasSubstr("all 1 used frames are held out")));
}

}  // namespace
}  // namespace sonarcal::calib
