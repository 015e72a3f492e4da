#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "data_io/open_recording.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/recordings/recording_io.h"
#include "tests/apps/html_check.h"
#include "tests/apps/tiny_world.h"

namespace sonarcal::commands {
namespace {

using ::testing::HasSubstr;
using testing::IsOneSentence;
using ::testing::Not;
using testing::Outcome;
using testing::Quoted;
using testing::ReadJsonFile;
using testing::RunSonarcal;
using testing::TinyWorld;

// Noisy frames of a box to train on and to test on. Masks are images in which only the box echoes.
class TransferCommand : public ::testing::Test {
 protected:
  TransferCommand() {
    Simulate("train", "--noise --seed 1");
    Simulate("test", "--noise --seed 2");
    ParameterSet bright = testing::TinyParameters();
    bright.display = {.db_min = 0.0, .db_max = 1.0};
    bright.materials["floor"].gsab = {.a = 0.0, .b_deg = 4.0, .c = 0.0, .d = 1.0, .e = 0.0, .f_deg = 10.0};
    data_io::WriteParameters(world_.params(), bright);
    Simulate("masks", "--expected");
  }

  void Simulate(const std::string& name, const std::string& how) {
    const Outcome outcome =
        RunSonarcal(world_.SimulateArguments() + " -q " + how + " --out " + Quoted(world_ / name));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
  }

  // The first frames of a recording.
  void Keep(const std::string& name, int frames, const std::string& as) {
    const auto recording = data_io::OpenRecording(world_ / name);
    std::vector<Frame> kept;
    for (int i = 0; i < frames; ++i) kept.push_back(recording->ReadFrame(i));
    data_io::WriteRecording(MemoryRecording(recording->info(), std::move(kept)), world_ / as);
  }

  std::string Arguments(const std::string& extra, const std::string& test = "test",
                        const std::string& masks = "masks") const {
    return "transfer -q --train " + Quoted(world_ / "train") + " --test " + Quoted(world_ / test) +
           " --test-masks " + Quoted(world_ / masks) + " " + extra;
  }

  TinyWorld world_;
};

TEST_F(TransferCommand, WritesFiguresReportAndProvenance) {
  const Outcome outcome = RunSonarcal(Arguments("--object box --out " + Quoted(world_ / "out")));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("trained on"));
  EXPECT_THAT(outcome.out, HasSubstr("report: "));

  const nlohmann::json json = ReadJsonFile(world_ / "out/transfer.json");
  EXPECT_EQ(json["format"], "sonar-transfer/1");
  EXPECT_EQ(json["training_frames"], 4);
  EXPECT_EQ(json["blocks"], 4);
  const double guessing = json["object_share"];
  EXPECT_GT(json["trained_on_training"]["average_precision"]["value"].get<double>(), 2.0 * guessing);
  EXPECT_TRUE(json["difference"]["average_precision"]["ci"].is_array());
  for (const char* detector : {"trained_on_training", "trained_on_test_blocks"}) {
    const nlohmann::json& curve = json["curves"][detector];
    EXPECT_EQ(curve["recall"].size(), curve["precision"].size());
    EXPECT_EQ(curve["recall"].back(), 1.0);
    EXPECT_DOUBLE_EQ(curve["precision"].back().get<double>(), guessing);
  }

  const nlohmann::json provenance = ReadJsonFile(world_ / "out/provenance.json");
  EXPECT_EQ(provenance["command"], "transfer");
  EXPECT_EQ(provenance["configuration"]["object"], "box");
  EXPECT_EQ(provenance["inputs"].size(), 3U);
}

TEST_F(TransferCommand, TheReportShowsFiguresCurvesAndFrames) {
  ASSERT_EQ(RunSonarcal(Arguments("--object box --out " + Quoted(world_ / "out"))).status, 0);
  const std::string html = testing::ReadFile(world_ / "out/report.html");
  EXPECT_EQ(testing::HtmlFault(html), "");
  EXPECT_EQ(testing::PictureFault(html), "");
  EXPECT_EQ(testing::PicturesOf(html).size(), 9U) << "three frames, each recorded and with two detections";
  for (const char* part : {"Test frames are synthetic", "Precision-recall curves", "guessing",
                           "labelled only", "95 %:", "Provenance", "Frame 0 of", "Frame 3 of"}) {
    EXPECT_THAT(html, HasSubstr(part));
  }
  EXPECT_TRUE(std::filesystem::exists(world_ / "out/tables/table_1.csv"));
}

TEST_F(TransferCommand, PrintsTheFileAsJson) {
  const Outcome by_object = RunSonarcal(Arguments("--json --object box --out " + Quoted(world_ / "out")));
  ASSERT_EQ(by_object.status, 0) << by_object.err;
  EXPECT_EQ(nlohmann::json::parse(by_object.out), ReadJsonFile(world_ / "out/transfer.json"));
  // The scene and the masks label nearly the same pixels.
  const Outcome by_masks = RunSonarcal(Arguments("--json --train-masks " + Quoted(world_ / "masks")));
  ASSERT_EQ(by_masks.status, 0) << by_masks.err;
  const auto reference = [](const Outcome& outcome) {
    return nlohmann::json::parse(outcome.out)["trained_on_test_blocks"];
  };
  EXPECT_EQ(reference(by_masks), reference(by_object));
}

TEST_F(TransferCommand, TwoTestFramesHaveNoIntervals) {
  Keep("test", 2, "two");
  Keep("masks", 2, "two_masks");
  const std::string out = " --out " + Quoted(world_ / "out");
  ASSERT_EQ(RunSonarcal(Arguments("--object box" + out, "two", "two_masks")).status, 0);
  EXPECT_TRUE(ReadJsonFile(world_ / "out/transfer.json")["difference"]["iou"]["ci"].is_null());
  const std::string html = testing::ReadFile(world_ / "out/report.html");
  EXPECT_EQ(testing::HtmlFault(html), "");
  EXPECT_THAT(html, HasSubstr("too few for an interval"));
  EXPECT_THAT(html, Not(HasSubstr("95 %:")));
}

TEST_F(TransferCommand, MistakesAreRefusedInOneSentence) {
  const auto refusal = [&](const std::string& extra, int status, const std::string& masks = "masks") {
    const Outcome outcome = RunSonarcal(Arguments(extra + " --out " + Quoted(world_ / "out"), "test", masks));
    EXPECT_EQ(outcome.status, status) << extra;
    EXPECT_TRUE(IsOneSentence(outcome.err)) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(world_ / "out"));
    return outcome.err;
  };
  EXPECT_THAT(refusal("", 2), HasSubstr("expected either --train-masks or --object"));
  EXPECT_THAT(refusal("--object bix", 1), HasSubstr("no material 'bix'"));
  const std::string twice = Quoted(world_ / "masks") + "," + Quoted(world_ / "masks");
  EXPECT_THAT(refusal("--train-masks " + twice, 2), HasSubstr("names 2 recordings, expected 1"));
  EXPECT_THAT(refusal("--object box", 2, "test"), HasSubstr("--test-masks names"));
  Keep("masks", 3, "three_masks");
  EXPECT_THAT(refusal("--object box", 1, "three_masks"), HasSubstr("has 3 masks, expected one for each"));
}

TEST_F(TransferCommand, NoRecordingIsTrainedOnAndTested) {
  const Outcome outcome = RunSonarcal(Arguments("--train-masks " + Quoted(world_ / "masks"), "train"));
  EXPECT_EQ(outcome.status, 2);
  EXPECT_TRUE(IsOneSentence(outcome.err)) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("is given for training and for the test"));
}

}  // namespace
}  // namespace sonarcal::commands
