#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "data_io/images/image_io.h"
#include "data_io/open_recording.h"
#include "data_io/parameters/parameters_io.h"
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

// The tiny world with a floor that reflects.
ParameterSet Truth() {
  ParameterSet parameters = testing::TinyAcousticParameters();
  parameters.mirrors["floor"].loss_db = 3.0;
  parameters.beam.transmit_even_deg = 15.0;
  parameters.beam.transmit_end_deg = 20.0;
  return parameters;
}

class ExplainCommand : public ::testing::Test {
 protected:
  ExplainCommand() {
    data_io::WriteParameters(world_.params(), Truth());
    real_ = world_.WriteSimulated("real", true);
  }

  std::string Arguments(const std::string& extra = "") const {
    return "explain --real " + Quoted(real_) + " --scene " + Quoted(world_.scene()) + " --params " +
           Quoted(world_.params()) + " --out " + Quoted(world_ / "out") +
           " --rays 96x200 --max-iterations 20 --segmentation otsu " + extra;
  }

  TinyWorld world_;
  std::filesystem::path real_;
};

TEST_F(ExplainCommand, ReportsTheGainOfEachPartAndTheCausesOfCells) {
  const Outcome outcome = RunSonarcal(Arguments("--held-out 1,3"));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("fitting: + ghosts"));
  EXPECT_THAT(outcome.out, HasSubstr("evaluated on frames 1 and 3"));
  EXPECT_THAT(outcome.out, HasSubstr("of the bright cells"));

  const nlohmann::json json = testing::ReadJsonFile(world_ / "out/explain.json");
  EXPECT_EQ(json["format"], "sonar-explanation/1");
  std::vector<std::string> parts;
  for (const nlohmann::json& step : json["steps"]) {
    parts.push_back(step["part"]);
    for (const char* key : {"intensity_error", "median_image_error", "about_object_error", "iou",
                            "ns_over_nr", "held_out_nats_per_pixel"})
      EXPECT_TRUE(step[key].is_number()) << parts.back() << " " << key;
    EXPECT_EQ(step["gain_nats_per_pixel"].is_null(), parts.size() == 1) << parts.back();
  }
  EXPECT_EQ(parts, (std::vector<std::string>{"start", "response", "elevation", "noise", "materials", "ghosts",
                                             "speckle"}));
  // Expected images are nearer to the recorded in the end than to begin with, and not below their own
  // speckle.
  const double last = json["steps"].back()["intensity_error"];
  EXPECT_LT(last, json["steps"][0]["intensity_error"].get<double>());
  EXPECT_GT(last, 0.8 * json["speckle_floor_error"].get<double>());

  const std::vector<std::string> names = json["causes"]["names"];
  for (const nlohmann::json& frame : json["causes"]["frames"]) {
    const std::string file = frame["file"];
    const data_io::ImageFile image(world_ / "out" / file);
    EXPECT_EQ(image.header().rows, 60);
    EXPECT_EQ(image.header().cols, 24);
    double sum = 0.0;
    for (const auto& [name, share] : frame["shares"].items()) {
      EXPECT_THAT(names, ::testing::Contains(name));
      sum += share.get<double>();
    }
    EXPECT_NEAR(sum, 1.0, 1e-9);
    EXPECT_TRUE(std::filesystem::exists(world_ / "out" / frame["picture"].get<std::string>()));
  }
  EXPECT_THAT(names, ::testing::IsSupersetOf({"not bright", "not explained", "noise", "floor", "box"}));

  const std::string html = testing::ReadFile(world_ / "out/report.html");
  EXPECT_EQ(testing::HtmlFault(html), "");
  for (const char* part : {"class=\"chart waterfall\"", "What each part is worth", "significant", "+ ghosts",
                           "What the bright cells come from", "synthetic"}) {
    EXPECT_THAT(html, HasSubstr(part));
  }
  EXPECT_THAT(html, HasSubstr("Frame 1, synthetic"));
  EXPECT_THAT(html, ::testing::Not(HasSubstr("Frame 1, recorded")));
  EXPECT_EQ(testing::PictureFault(html), "");
  // Terminal, report and JSON have the same warnings.
  ASSERT_TRUE(json["warnings"].is_array());
  for (const nlohmann::json& sentence : json["warnings"])
    EXPECT_THAT(outcome.out, HasSubstr("warning: " + sentence.get<std::string>() + "\n"));
  for (const nlohmann::json& step : json["steps"]) {
    const bool contradicted = step["verdict"] == "contradicted by the error";
    const double gain =
        step["gain_nats_per_pixel"].is_null() ? 0.0 : step["gain_nats_per_pixel"].get<double>();
    const double error =
        step["median_image_error_change"].is_null() ? 0.0 : step["median_image_error_change"].get<double>();
    if (step["verdict"] == "significant") {
      EXPECT_LE(error, 2.0 * step["median_image_error_change_sigma"].get<double>()) << step["part"];
    }
    if (contradicted) {
      EXPECT_GT(gain * error, 0.0) << step["part"];
    }
  }
  EXPECT_TRUE(std::filesystem::exists(world_ / "out/figures/figure_1.svg"));
  EXPECT_TRUE(std::filesystem::exists(world_ / "out/provenance.json"));
  EXPECT_TRUE(data_io::ReadParameters(world_ / "out/params.json").mirrors.contains("floor"));
}

// Both frames count as many pixels, so that together they say the mean of what each says.
TEST_F(ExplainCommand, HeldOutFramesAreEvaluatedOneByOneOnRequest) {
  const Outcome outcome = RunSonarcal(Arguments("--held-out 1,3 --apart --hold-noise"));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("evaluated on frame 1"));
  EXPECT_THAT(outcome.out, HasSubstr("evaluated on frame 3"));
  const nlohmann::json json = testing::ReadJsonFile(world_ / "out/explain.json");
  EXPECT_EQ(json["judged_apart"], true);
  for (const nlohmann::json& step : json["steps"]) {
    ASSERT_EQ(step["by_frame"].size(), 2U);
    EXPECT_EQ(step["by_frame"][1]["index"], 3);
    for (const char* key : {"held_out_nats_per_pixel", "intensity_error"}) {
      const double mean =
          0.5 * (step["by_frame"][0][key].get<double>() + step["by_frame"][1][key].get<double>());
      EXPECT_NEAR(step[key].get<double>(), mean, 1e-9) << step["part"] << " " << key;
    }
    for (const nlohmann::json& fitted : step["fitted"]) EXPECT_NE(fitted["name"], "receiver.noise_db");
  }
  const std::string html = testing::ReadFile(world_ / "out/report.html");
  EXPECT_EQ(testing::HtmlFault(html), "");
  for (const char* part : {"Judged by frame 1", "Judged by frame 3"}) EXPECT_THAT(html, HasSubstr(part));
  EXPECT_EQ(data_io::ReadParameters(world_ / "out/params.json").receiver.noise_db, Truth().receiver.noise_db);
}

TEST_F(ExplainCommand, KnownRecordingsHaveFilesOfTheirOwn) {
  const auto expect_usage = [&](const std::string& arguments, const std::string& part) {
    const Outcome outcome = RunSonarcal("explain -q --out " + Quoted(world_ / "out") + " " + arguments);
    EXPECT_EQ(outcome.status, 2) << arguments;
    EXPECT_TRUE(IsOneSentence(outcome.err)) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(part));
    EXPECT_FALSE(std::filesystem::exists(world_ / "out"));
  };
  expect_usage("--known bomb --real " + Quoted(real_), "--real does not go with --known");
  expect_usage("--real " + Quoted(real_), "--scene is required without --known");
  expect_usage("--known ship", "unknown case 'ship', expected bomb|hull_strip");
  const Outcome outcome = RunSonarcal("explain -q --known hull-strip --recordings " + Quoted(real_) +
                                      " --out " + Quoted(world_ / "out"));
  EXPECT_EQ(outcome.status, 1);
  EXPECT_TRUE(IsOneSentence(outcome.err)) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("didson_hull: no such folder"));
  EXPECT_FALSE(std::filesystem::exists(world_ / "out"));
}

TEST_F(ExplainCommand, InvalidOptionsAreRefusedInOneSentence) {
  const auto expect_failure = [&](const std::string& arguments, const std::string& part) {
    const Outcome outcome = RunSonarcal(arguments + " -q");
    EXPECT_EQ(outcome.status, 1) << arguments;
    EXPECT_TRUE(IsOneSentence(outcome.err)) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(part));
    EXPECT_FALSE(std::filesystem::exists(world_ / "out"));
  };
  expect_failure(Arguments("--held-out 9"), "held-out frame 9");
  const auto recording = data_io::OpenRecording(real_);
  data_io::WriteRecording(MemoryRecording(recording->info(), {recording->ReadFrame(0)}), world_ / "one");
  real_ = world_ / "one";
  expect_failure(Arguments(), "expected at least two");
  data_io::WriteParameters(world_.params(), testing::TinyParameters());
  expect_failure(Arguments(), "only 'acoustic' can be explained");
  EXPECT_EQ(RunSonarcal("explain --real " + Quoted(real_)).status, 2);
}

}  // namespace
}  // namespace sonarcal::commands
