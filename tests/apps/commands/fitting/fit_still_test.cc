#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <thread>

#include <nlohmann/json.hpp>

#include "apps/commands/fitting/fit_command.h"
#include "data_io/open_recording.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/pose_io.h"
#include "data_io/recordings/recording_io.h"
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

constexpr double kNoiseDb = 140.0;

// A recording of the tiny world from one pose, SYNTHETIC, its speckle frozen or not.
class FitStillCommand : public ::testing::Test {
 protected:
  void Simulate(const std::string& extra, int frames = 4) {
    ParameterSet parameters = testing::TinyParameters();
    parameters.model = EchoModel::kAcoustic;
    parameters.display = {.db_min = 120.0, .db_max = 200.0};
    parameters.receiver = {};
    parameters.receiver.noise_db = kNoiseDb;
    data_io::WriteParameters(world_.params(), parameters);
    const std::vector<data_io::TimedPose> poses = data_io::ReadPoses(world_.poses());
    std::vector<data_io::TimedPose> still;
    for (int i = 0; i < frames; ++i)
      still.push_back({static_cast<double>(i), poses.front().world_from_sonar});
    data_io::WritePoses(world_.poses(), still);
    const Outcome outcome =
        RunSonarcal(world_.SimulateArguments() + " -q --noise --bits 8 " + extra + " --out " + Quoted(real_));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
  }

  std::string Arguments(const std::string& extra = "") const {
    return "fit --still -q --real " + Quoted(real_) + " --out " + Quoted(world_ / "out") + " " + extra;
  }

  TinyWorld world_;
  std::filesystem::path real_ = world_ / "real";
};

TEST_F(FitStillCommand, SeparatesNoiseFromFrozenSpeckle) {
  Simulate("--frozen-speckle");
  const Outcome outcome = RunSonarcal(Arguments());
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("frames 0, 1, 2 and 3 show one pose of a static scene"));
  EXPECT_THAT(outcome.out, HasSubstr("(synthetic)"));
  const auto fit = testing::ReadJsonFile(world_ / "out/fit.json");
  const auto& still = fit["still"][0];
  EXPECT_EQ(still["frames"].size(), 4U);
  EXPECT_NEAR(still["noise_db"].get<double>(), kNoiseDb, 1.0);
  EXPECT_LT(still["noise_sigma_db"].get<double>(), 0.5);
  EXPECT_EQ(fit["parameters"][0]["name"], "receiver.noise_db");
  EXPECT_EQ(fit["parameters"][0]["value"], still["noise_db"]);
  EXPECT_EQ(data_io::ReadParameters(world_ / "out/params.json").receiver.noise_db.value(),
            still["noise_db"].get<double>());
  EXPECT_EQ(testing::HtmlFault(testing::ReadFile(world_ / "out/report.html")), "");
}

TEST_F(FitStillCommand, TakesNoMoreThreadsThanAllowed) {
  Simulate("--frozen-speckle");
  FitCommandOptions options;
  options.common = {.json = false, .quiet = true};
  options.real = real_;
  options.out = world_ / "out";
  options.still = true;
  options.fit.rays.threads = 1;
  std::atomic<bool> has_ended = false;
  std::size_t allowed = std::numeric_limits<std::size_t>::max();
  std::thread observer([&] {
    while (!has_ended) {
      using tbb::global_control;
      allowed = std::min(allowed, global_control::active_value(global_control::max_allowed_parallelism));
    }
  });
  ::testing::internal::CaptureStdout();
  const cli::ExitStatus status = RunFit(options);
  ::testing::internal::GetCapturedStdout();
  has_ended = true;
  observer.join();
  EXPECT_EQ(status, cli::ExitStatus::kDone);
  EXPECT_EQ(allowed, 1U);
}

TEST_F(FitStillCommand, RefusesFreshSpeckleInOneSentence) {
  Simulate("");
  const Outcome outcome = RunSonarcal(Arguments());
  EXPECT_EQ(outcome.status, 1);
  EXPECT_TRUE(IsOneSentence(outcome.err)) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("either the scene moves or nothing exceeds the noise"));
  EXPECT_FALSE(std::filesystem::exists(world_ / "out"));
}

TEST_F(FitStillCommand, RefusesASingleFrameAndOtherModes) {
  Simulate("--frozen-speckle", 1);
  const Outcome single = RunSonarcal(Arguments());
  EXPECT_EQ(single.status, 1);
  EXPECT_THAT(single.err, HasSubstr("no pose has two frames"));
  EXPECT_EQ(RunSonarcal(Arguments("--noise-only")).status, 2);
}

}  // namespace
}  // namespace sonarcal::commands
