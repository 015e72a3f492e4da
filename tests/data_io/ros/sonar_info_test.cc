#include "data_io/ros/sonar_info.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/types/error.h"
#include "data_io/open_recording.h"
#include "data_io/recordings/recording_io.h"
#include "tests/data_io/hostile.h"
#include "tests/data_io/made_up_mcap.h"
#include "tests/data_io/message_writer.h"
#include "tests/data_io/refusal.h"
#include "tests/data_io/sonar_messages.h"

namespace sonarcal::data_io {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsSupersetOf;
using testing::MadeUpMessage;
using testing::MadeUpProjected;
using testing::MessageWriter;
using ::testing::Not;
using ::testing::Pair;
using testing::Wire;

// marine_interfaces/SonarInfo; a test changes what it is about.
struct MadeUpSonarInfo {
  int version = 3;  // 1: no bandwidths, 2: no transmission loss of the angular response
  std::uint32_t seconds = 100;
  std::string model = "m3";
  std::vector<float> pulses_s = {20e-6F};
  std::uint8_t quantity = 3;
  std::uint8_t intensity_scale = 2;
  std::uint8_t reference = 2;
  float scale = 0.5F;
  float offset = 40.0F;
  std::uint8_t tvg = 3;
  std::vector<float> response_deg = {0.0F, 10.0F};
  std::vector<float> response_db = {0.0F, -3.0F};
  float source_level_db = 190.0F;

  std::string Write(Wire wire = Wire::kCdrLittle) const {
    MessageWriter message(wire);
    message.Header(seconds, 0, "sonar").String(model).String("a calibration").U32(7).U32(8);
    message.F32s(pulses_s);
    if (version > 1) message.F32s({5e4F});
    message.Blob("\1").U8(quantity).U8(intensity_scale).U8(reference).F32(scale).F32(offset);
    message.U8(tvg).F32(250.0F).F32(source_level_db).U8(1).F32s(response_deg).F32s(response_db);
    if (version > 2) message.U8(2).F32(0.001F);
    message.F32s({-5.0F, 0.0F, 5.0F}).F32s({-1.0F, 0.0F, -1.0F});
    return message.bytes();
  }
};

SonarInfo Read(const std::string& bytes, MessageEncoding encoding = MessageEncoding::kCdr) {
  return ReadSonarInfo(std::as_bytes(std::span(bytes)), encoding, "m");
}

TEST(SonarInfoTest, EveryVersionOfTheDefinitionIsRead) {
  for (const int version : {1, 2, 3}) {
    for (const Wire wire : testing::kWires) {
      const SonarInfo sonar = Read(MadeUpSonarInfo{.version = version}.Write(wire),
                                   wire == Wire::kRos1 ? MessageEncoding::kRos1 : MessageEncoding::kCdr);
      EXPECT_EQ(sonar.stamp_ns, 100'000'000'000);
      EXPECT_EQ(sonar.sonar_model, "m3");
      EXPECT_EQ(sonar.calibration_time_ns, 7'000'000'008);
      EXPECT_THAT(sonar.pulse_length_s, ElementsAre(20e-6F));
      EXPECT_EQ(sonar.bandwidth_hz.size(), version > 1 ? 1U : 0U);
      EXPECT_EQ(sonar.reference, IntensityReference::kAbsolute);
      EXPECT_EQ(sonar.tvg, TvgModel::k40LogR);
      EXPECT_EQ(sonar.source_level_db, 190.0F);
      EXPECT_EQ(sonar.angular_normalization, version > 1 ? 1 : 2);
      EXPECT_EQ(sonar.angular_response_loss, version > 2 ? 2 : 0);
      EXPECT_EQ(std::isnan(sonar.angular_response_absorption_db_per_m), version < 3);
      EXPECT_THAT(sonar.beam_pattern_gain_db, ElementsAre(-1.0F, 0.0F, -1.0F));
    }
  }
}

TEST(SonarInfoTest, DamagedMessagesAreRefused) {
  const auto refusal = [](const MadeUpSonarInfo& sonar) {
    return testing::MessageOf([&] { Read(sonar.Write()); });
  };
  EXPECT_THAT(refusal({.tvg = 5}), HasSubstr("tvg_model: 5, expected 0..4"));
  EXPECT_THAT(refusal({.response_db = {0.0F}}),
              HasSubstr("angles and levels of the angular response have 2 and 1 elements"));
  const std::string whole = MadeUpSonarInfo{}.Write();
  testing::ExpectSurvivesDamage(whole, whole.size(), 2000, [](const std::string& bytes) { Read(bytes); });
}

class SonarInfoBagTest : public ::testing::Test {
 protected:
  // A bag with one frame at 105 s, whose samples are 1, 2, 3, 11, ..., and these SonarInfo messages.
  std::unique_ptr<RecordingSource> Open(const std::vector<std::pair<std::string, MadeUpSonarInfo>>& infos,
                                        std::uint32_t sample_type = 0) {
    std::vector<MadeUpMessage> messages = {
        {"/m3/image", "marine_acoustic_msgs/ProjectedSonarImage", 1,
         MadeUpProjected{.seconds = 105, .type = sample_type}.Write(Wire::kCdrLittle)}};
    for (const auto& [topic, info] : infos) messages.push_back({topic, kSonarInfoType, 2, info.Write()});
    testing::WriteFile(dir_ / "test.mcap", testing::McapBytes(messages, {}));
    return OpenRecording(dir_ / "test.mcap");
  }
  testing::TempDir dir_;
};

TEST_F(SonarInfoBagTest, GreyValuesGetTheirLevels) {
  const auto absolute = Open({{"/m3/sonar_info", {}}});
  EXPECT_EQ(absolute->info().sonar.name, "m3");
  EXPECT_EQ(absolute->info().scale.db_min, 40.0);
  EXPECT_EQ(absolute->info().scale.db_max, 40.0 + 0.5 * 255.0);
  EXPECT_EQ(absolute->info().source_level_db, 190.0);
  EXPECT_EQ(absolute->ReadFrame(0).image.scale, absolute->info().scale);
  EXPECT_EQ(absolute->ReadFrame(0).image.value(1, 0), 11.0F);
  EXPECT_NEAR(*absolute->frame_info(0).settings.pulse_length_us, 20.0, 1e-4);
  EXPECT_THAT(absolute->info().details, Contains(Pair("calibration", "a calibration")));
  EXPECT_THAT(absolute->info().notes, Contains(HasSubstr("are those of SonarInfo")));
  const auto relative = Open({{"/m3/sonar_info", {.reference = 1}}});
  EXPECT_FALSE(relative->info().scale.db_min);
  EXPECT_EQ(relative->info().scale.db_span, 0.5 * 255.0);
  const auto no_map = Open({{"/m3/sonar_info", {.scale = 0.0F}}});
  EXPECT_FALSE(no_map->info().scale.db_span);
  EXPECT_EQ(no_map->info().settings.compression, Compression::kLogarithm);
  const auto linear = Open({{"/m3/sonar_info", {.quantity = 2, .intensity_scale = 1}}});
  EXPECT_EQ(linear->info().display_gamma, 1.0);
  EXPECT_EQ(linear->info().settings.compression, Compression::kPower);
}

TEST_F(SonarInfoBagTest, WhatRecordingJsonCannotHoldIsLeftOutAndNoted) {
  const auto odd =
      Open({{"/m3/sonar_info", {.pulses_s = {2.0F}, .scale = 100.0F, .source_level_db = -5000.0F}}});
  EXPECT_FALSE(odd->info().scale.db_min);
  EXPECT_FALSE(odd->info().scale.db_max);
  EXPECT_FALSE(odd->info().source_level_db);
  EXPECT_FALSE(odd->frame_info(0).settings.pulse_length_us);
  EXPECT_THAT(odd->info().notes,
              IsSupersetOf({"The dB scale 40 .. 25540 dB of SonarInfo is invalid and was omitted.",
                            "The source level -5000 dB of SonarInfo is invalid and was omitted.",
                            "The pulse length 2 s of SonarInfo is invalid and was omitted."}));
  WriteRecording(*odd, dir_ / "out");
  EXPECT_EQ(OpenRecording(dir_ / "out")->info().settings, odd->info().settings);
  EXPECT_FALSE(Open({{"/m3/sonar_info", {.reference = 1, .scale = 4.0F}}})->info().scale.db_span);
  EXPECT_THAT(Open({{"/m3/sonar_info", {}}})->info().notes, Each(Not(HasSubstr("is invalid"))));
}

// A user may state a span for a picture.
TEST(SonarInfoTest, AbsoluteLevelsReplaceASpan) {
  ImageScale scale;
  scale.db_span = 60.0;
  const ImageScale with = ScaleWith(Read(MadeUpSonarInfo{}.Write()), scale);
  EXPECT_EQ(with.db_max, 40.0 + 0.5 * 255.0);
  EXPECT_EQ(with.db_span, std::nullopt);
}

TEST_F(SonarInfoBagTest, GainAndWaterAreSaidToBeMissingOnlyWhereTheyAre) {
  constexpr const char* kMissing = "Neither gain nor water is recorded.";
  EXPECT_THAT(Open({{"/m3/sonar_info", {}}})->info().notes, Contains(kMissing));
  testing::WriteFile(dir_ / "ping.mcap",
                     testing::McapBytes({{"/m3/ping", "sonar_oculus/OculusPing", 1,
                                          testing::MadeUpOculusPing{}.Write(Wire::kCdrLittle)},
                                         {"/m3/sonar_info", kSonarInfoType, 2, MadeUpSonarInfo{}.Write()}},
                                        {}));
  const auto ping = OpenRecording(dir_ / "ping.mcap");
  ASSERT_TRUE(ping->info().water);
  EXPECT_THAT(ping->info().details, Contains(Pair("gain", "35 %")));
  EXPECT_THAT(ping->info().notes,
              AllOf(Contains(HasSubstr("are those of SonarInfo")), Not(Contains(kMissing))));
}

TEST_F(SonarInfoBagTest, FloatsBecomeLevelsOrPower) {
  constexpr std::uint32_t kFloats = 8;
  const auto levels = Open({{"/m3/sonar_info", {}}}, kFloats);
  EXPECT_EQ(levels->info().scale.quantity, Quantity::kDecibel);
  EXPECT_EQ(levels->ReadFrame(0).image.scale.quantity, Quantity::kDecibel);
  EXPECT_EQ(levels->ReadFrame(0).image.value(1, 0), 40.0F + 0.5F * 11.0F);
  EXPECT_THAT(levels->info().notes, ::testing::Each(::testing::Not(HasSubstr("read as linear power"))));
  const auto amplitude = Open({{"/m3/sonar_info", {.quantity = 2, .intensity_scale = 1}}}, kFloats);
  EXPECT_EQ(amplitude->info().scale.quantity, Quantity::kPower);
  EXPECT_EQ(amplitude->ReadFrame(0).image.value(1, 0), 121.0F);
}

TEST_F(SonarInfoBagTest, TheLastMessageBeforeAFrameHoldsForIt) {
  const auto recording = Open({{"/m3/sonar_info", {.seconds = 90, .pulses_s = {10e-6F}}},
                               {"/m3/sonar_info", {.seconds = 100, .pulses_s = {20e-6F}}},
                               {"/m3/sonar_info", {.seconds = 110, .pulses_s = {30e-6F}}}});
  EXPECT_NEAR(*recording->frame_info(0).settings.pulse_length_us, 20.0, 1e-4);
  EXPECT_THAT(recording->info().notes, Contains(HasSubstr("SonarInfo has 3 versions")));
}

TEST_F(SonarInfoBagTest, TheRecordingIsDescribedByTheMessageOfItsFirstFrame) {
  const auto recording =
      Open({{"/m3/sonar_info", {.seconds = 90, .model = "old"}},
            {"/m3/sonar_info", {.seconds = 100, .model = "new", .scale = 0.3F, .offset = 50.0F}}});
  EXPECT_EQ(recording->info().sonar.name, "new");
  EXPECT_EQ(recording->info().scale.db_min, 50.0);
  EXPECT_EQ(recording->ReadFrame(0).image.scale, recording->info().scale);
  EXPECT_EQ(recording->frame_info(0).settings, recording->info().settings);
}

// Recorded in the order 90, 104, 95 s. The messages of 90 and 104 s state the same.
TEST_F(SonarInfoBagTest, StampsDecideWhateverTheOrderOfRecording) {
  const auto recording = Open({{"/m3/sonar_info", {.seconds = 90, .pulses_s = {10e-6F}}},
                               {"/m3/sonar_info", {.seconds = 104, .pulses_s = {10e-6F}}},
                               {"/m3/sonar_info", {.seconds = 95, .pulses_s = {20e-6F}}}});
  EXPECT_NEAR(*recording->frame_info(0).settings.pulse_length_us, 10.0, 1e-4);
  EXPECT_THAT(recording->info().notes, Contains(HasSubstr("SonarInfo has 3 versions")));
}

TEST_F(SonarInfoBagTest, TakesTheTopicBesideTheSonar) {
  EXPECT_EQ(Open({{"/m3/sonar_info", {.model = "beside"}}, {"/other/sonar_info", {.model = "far"}}})
                ->info()
                .sonar.name,
            "beside");
  EXPECT_EQ(Open({{"/other/sonar_info", {.model = "the only one"}}})->info().sonar.name, "the only one");
  const auto none = Open({{"/a/sonar_info", {.model = "a"}}, {"/b/sonar_info", {.model = "b"}}});
  EXPECT_EQ(none->info().sonar.name, "sonar of a ProjectedSonarImage");
  EXPECT_THAT(
      none->info().notes,
      Contains(HasSubstr(
          "2 topics of SonarInfo were ignored: expected one, or exactly one beside the topic of the sonar")));
}

TEST_F(SonarInfoBagTest, ADamagedMessageIsNotedAndLeftOut) {
  const auto recording = Open({{"/m3/sonar_info", {.tvg = 9}}});
  EXPECT_THAT(recording->info().notes, Contains(HasSubstr("SonarInfo was left out: ")));
  EXPECT_EQ(recording->ReadFrame(0).image.value(1, 0), 11.0F);
}

}  // namespace
}  // namespace sonarcal::data_io
