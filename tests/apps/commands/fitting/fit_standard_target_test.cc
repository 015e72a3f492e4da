#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include <nlohmann/json.hpp>

#include "core/types/units.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/pose_io.h"
#include "tests/apps/html_check.h"
#include "tests/apps/tiny_world.h"

namespace sonarcal::commands {
namespace {

using ::testing::HasSubstr;
using testing::IsOneSentence;
using testing::Outcome;
using testing::Quoted;
using testing::RunSonarcal;
using testing::TinyWorld;

constexpr double kLevelDb = 203.5;
constexpr int kTargetFrames = 12;

// A sphere in open water above the tiny world, SYNTHETIC, by the coherent model.
class FitStandardTargetCommand : public ::testing::Test {
 protected:
  FitStandardTargetCommand() {
    ParameterSet parameters = testing::TinyAcousticParameters();
    parameters.source_level_db = kLevelDb - 2.0;
    parameters.receiver.gain_db = 2.0;
    parameters.receiver.noise_db = 105.0;
    parameters.display = {.db_min = 90.0, .db_max = 170.0};
    data_io::WriteParameters(world_.params(), parameters);
    std::vector<data_io::TimedPose> poses;
    for (int i = 0; i < kTargetFrames; ++i) {
      const double yaw_rad = RadFromDeg(0.4 * (i - 0.5 * kTargetFrames));
      poses.push_back({0.1 * i, {RotationFromYawPitchRoll(yaw_rad, 0.0, 0.0), {0.0, 0.0, 50.0}}});
    }
    data_io::WritePoses(world_.poses(), poses);
  }

  void Simulate(const std::string& point_target) const {
    const Outcome outcome = RunSonarcal(world_.SimulateArguments() + " -q --model coherent --point-target " +
                                        point_target + " --out " + Quoted(world_ / "real"));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
  }

  Outcome Fit(const std::string& extra) const {
    return RunSonarcal("fit -q --standard-target sphere --real " + Quoted(world_ / "real") + " --out " +
                       Quoted(world_ / "out") + " " + extra);
  }

  TinyWorld world_;
};

TEST_F(FitStandardTargetCommand, FindsTheLevelOfASimulatedSphere) {
  Simulate("0.05:3:50:-40");
  const Outcome outcome = Fit("--material wc --diameter-mm 40");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("(synthetic)"));
  EXPECT_THAT(outcome.out, HasSubstr("frames with the sphere: 12 of 12"));
  const auto fit = testing::ReadJsonFile(world_ / "out/fit.json");
  const auto& target = fit["standard_target"];
  // The strength of this sphere is another than that of the simulated target.
  const double strength_db = target["target_strength_db"];
  EXPECT_NEAR(target["level_db"].get<double>() + strength_db, kLevelDb - 40.0, 0.2);
  EXPECT_EQ(target["frames"].size(), 12U);
  EXPECT_NEAR(target["frames"][0]["range_m"].get<double>(), std::hypot(0.05, 3.0), 0.005);
  EXPECT_NEAR(target["frames"][0]["azimuth_deg"].get<double>(), DegFromRad(std::atan2(0.05, 3.0)) - 2.4,
              0.05);
  const ParameterSet parameters = data_io::ReadParameters(world_ / "out/params.json");
  EXPECT_EQ(parameters.source_level_db, target["level_db"].get<double>());
  EXPECT_EQ(parameters.source_level_sigma_db.value(), target["level_sigma_db"].get<double>());
  EXPECT_EQ(fit["parameters"][0]["name"], "source_level_db");
  EXPECT_EQ(testing::HtmlFault(testing::ReadFile(world_ / "out/report.html")), "");
}

TEST_F(FitStandardTargetCommand, TheSameRunFindsTheSameValuesToTheBit) {
  Simulate("0.05:3:50:-40");
  std::string first;
  for (const char* threads : {"1", "2", "0"}) {
    const Outcome outcome = Fit(fmt::format("--material wc --diameter-mm 40 --threads {}", threads));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const std::string found = testing::ReadFile(world_ / "out/params.json");
    if (first.empty()) first = found;
    EXPECT_EQ(found, first) << threads;
  }
}

TEST_F(FitStandardTargetCommand, TheWindowOfRangeExcludesTheSphere) {
  Simulate("0:3:50:-40");
  const Outcome outcome = Fit("--material wc --diameter-mm 40 --range-max 2.5");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_TRUE(IsOneSentence(outcome.err)) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("found in none of 12 frames"));
  EXPECT_FALSE(std::filesystem::exists(world_ / "out"));
}

TEST_F(FitStandardTargetCommand, InvalidOptionsAreRefusedInOneSentence) {
  Simulate("0:3:50:-40");
  const auto expect = [&](const std::string& extra, int status, const std::string& words) {
    const Outcome outcome = Fit(extra);
    EXPECT_EQ(outcome.status, status) << extra;
    EXPECT_TRUE(IsOneSentence(outcome.err)) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(words));
  };
  expect("--material wc", 2, "needs --diameter-mm");
  expect("--diameter-mm 20", 2, "needs one --material");
  expect("--material copper --diameter-mm 20", 1, "expected one of wc, steel-440c");
  expect("--material wc --diameter-mm 20 --rays 10x10", 2, "--rays");
  expect("--material wc --diameter-mm 20 --still", 2, "--still");
  const Outcome alone = RunSonarcal("fit -q --noise-only --diameter-mm 20 --real " + Quoted(world_ / "real") +
                                    " --out " + Quoted(world_ / "out"));
  EXPECT_EQ(alone.status, 2);
  const Outcome target =
      RunSonarcal(world_.SimulateArguments() + " -q --model coherent --point-target 1:2 --out " +
                  Quoted(world_ / "other"));
  EXPECT_EQ(target.status, 2);
  EXPECT_THAT(target.err, HasSubstr("expected X:Y:Z:TS"));
}

}  // namespace
}  // namespace sonarcal::commands
