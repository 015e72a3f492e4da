#include "data_io/parameters/parameters_io.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include <nlohmann/json.hpp>

#include "core/types/error.h"
#include "data_io/json/json_writer.h"
#include "tests/data_io/refusal.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::data_io {
namespace {

using ::testing::HasSubstr;
using testing::MessageOf;

constexpr std::string_view kExample =
    R"({"format": "sonar-parameters/1", "model": "paper", "source_level_db": 190,
 "display": {"db_min": 80, "db_max": 190},
 "materials": {
  "floor": {"gsab": {"A": 90, "B_deg": 4, "C": 100, "D": 1, "E": 90, "F_deg": 8}},
  "default": {"gsab": {"A": 1, "B_deg": 2, "C": 3, "D": 4, "E": 5, "F_deg": 6}}}})";

// The example with one piece of it replaced.
std::string Changed(std::string_view from, std::string_view to) {
  std::string text(kExample);
  const std::size_t at = text.find(from);
  EXPECT_NE(at, text.npos) << from;
  return text.replace(at, from.size(), to);
}

std::string RefusalOf(const std::string& text) {
  return MessageOf([&] { ParseParameters(text, "p.json"); });
}

ParameterSet UnlikeTheDefaults() {
  ParameterSet set;
  set.model = EchoModel::kAcoustic;
  set.source_level_db = 1.0 / 3.0;
  set.noise_level_db = 0.1;
  set.array_gain_db = std::nextafter(20.0, 21.0);
  set.display = {-12.3, 45.6, DisplayLaw::kSoftLog, -14.1, 0.498};
  set.materials["floor"].gsab = {0.1, 3.3, 1e-12, 1.7, 2.2e5, 9.9};
  set.materials["Wände \"x\""].gsab = {};
  set.mirrors = {{"floor", {10.5}}, {"surface", {0.0}}};
  set.jitter = {0.011, 0.22, 7.7, 1.8e6, JitterGrowth::kLinear};
  set.receiver = {.gain_db = 3.3,
                  .time_varied_gain = TimeVariedGain::k40LogRAndAbsorption,
                  .noise_db = -41.7,
                  .noise_slope_db_per_m = -0.77,
                  .noise_taper_db = {0.1, -0.2, 1.0 / 3.0},
                  .noise_after_gain_db = -3.9,
                  .noise_after_gain_taper_db = {1.5, 0.0},
                  .looks = 2.5,
                  .diffuse_share = 0.3};
  set.beam = {0.7,
              19.3,
              AzimuthPattern::kTable,
              1.0 / 3.0,
              ElevationPattern::kAperture,
              0.4,
              {-31.4, -12.1, 0.0, -12.1, -1.0 / 7.0},
              24.5,
              1000.0 / 23.0,
              MirrorLobes::kMain,
              {-1.5, 0.0, 2.0 / 3.0}};
  set.pulse = {0.0254};
  set.water = Water{14.2, 0.31, 7.4, 3.3};
  return set;
}

TEST(ParametersIoTest, ReadsTheExampleOfTheHeader) {
  const ParameterSet set = ParseParameters(kExample, "p.json");
  EXPECT_EQ(set.model, EchoModel::kPaper);
  EXPECT_EQ(set.source_level_db, 190.0);
  EXPECT_EQ(set.display.db_max, 190.0);
  EXPECT_EQ(set.Material("floor").gsab.f_deg, 8.0);
  EXPECT_EQ(set.Material("anything").gsab.d, 4.0);
  EXPECT_EQ(set.jitter, JitterParameters<double>());
  EXPECT_FALSE(set.water);
  EXPECT_FALSE(set.receiver.noise_db);
}

TEST(ParametersIoTest, ComesBackToTheLastBit) {
  const testing::TempDir dir;
  for (const ParameterSet& set : {UnlikeTheDefaults(), ParseParameters(kExample, "p.json")}) {
    WriteParameters(dir / "p.json", set);
    EXPECT_EQ(ReadParameters(dir / "p.json"), set);
  }
}

TEST(ParametersIoTest, ReadsDisplayLawsAndTheNoiseFloorAndRefusesOthers) {
  const auto with_receiver = [](const std::string& members) {
    return Changed(R"("materials": {)", R"("receiver": {)" + members + R"(}, "materials": {)");
  };
  const auto with_display = [](const std::string& members) {
    return Changed(R"("db_max": 190})", R"("db_max": 190, )" + members + "}");
  };
  const ParameterSet set = ParseParameters(
      with_receiver(R"("time_varied_gain": "20logR", "noise_taper_db": [1, -2.5])"), "p.json");
  EXPECT_EQ(set.receiver.time_varied_gain, TimeVariedGain::k20LogR);
  EXPECT_EQ(set.receiver.noise_taper_db, (std::vector<double>{1.0, -2.5}));
  EXPECT_FALSE(set.receiver.noise_after_gain_db);
  EXPECT_EQ(set.display.law, DisplayLaw::kLog);
  EXPECT_EQ(ParseParameters(with_display(R"("law": "power", "exponent": 0.5)"), "p.json").display.law,
            DisplayLaw::kPower);

  EXPECT_THAT(RefusalOf(with_display(R"("law": "loud")")), HasSubstr("soft_log"));
  EXPECT_THAT(RefusalOf(with_display(R"("softness_db": 1)")), HasSubstr("unknown key 'display.softness_db'"));
  EXPECT_THAT(RefusalOf(with_display(R"("law": "power", "exponent": 0)")), HasSubstr("exponent"));
  EXPECT_THAT(RefusalOf(with_receiver(R"("time_varied_gain": "30logR")")), HasSubstr("40logR+alpha"));
  EXPECT_THAT(RefusalOf(with_receiver(R"("noise_slope_db": 1)")),
              HasSubstr("unknown key 'receiver.noise_slope_db'"));
  EXPECT_THAT(RefusalOf(with_receiver(R"("noise_taper_db": [0, 1e9])")), HasSubstr("noise_taper_db"));
}

TEST(ParametersIoTest, UnknownKeysAreRefusedAtEveryDepth) {
  EXPECT_EQ(RefusalOf(Changed("\"source_level_db\"", "\"source_lvl_db\"")).substr(0, 46),
            "p.json:1: unknown key 'source_lvl_db'; expecte");
  EXPECT_EQ(RefusalOf(Changed("\"F_deg\": 8", "\"F_deg\": 8, \"G\": 1")),
            "p.json:4: unknown key 'materials.floor.gsab.G'; expected one of A, B_deg, C, D, E, F_deg");
  EXPECT_EQ(RefusalOf(Changed("\"db_max\": 190", "\"db_max\": 190, \"gamma\": 1")),
            "p.json:2: unknown key 'display.gamma'; expected one of db_max, db_min, exponent, law, soft_db");
  EXPECT_EQ(RefusalOf(Changed("\"display\"", "\"receiver\": {\"gian_db\": 1},\n\"display\"")),
            "p.json:2: unknown key 'receiver.gian_db'; expected one of diffuse_share, gain_db, looks, "
            "noise_after_gain_db, "
            "noise_after_gain_taper_db, noise_db, noise_slope_db_per_m, noise_taper_db, time_varied_gain");
}

TEST(ParametersIoTest, ValuesOutOfRangeAreRefused) {
  EXPECT_EQ(RefusalOf(Changed("\"db_max\": 190", "\"db_max\": 80")),
            "p.json:2: 'display.db_max' is 80, expected more than db_min, 80");
  EXPECT_EQ(RefusalOf(Changed("\"B_deg\": 4", "\"B_deg\": 0")),
            "p.json:4: 'materials.floor.gsab.B_deg' is 0, expected a number > 0 and <= 1000");
  for (const char* bad : {"\"A\": -1", "\"A\": 1e999", "\"A\": \"90\"", "\"A\": null"}) {
    EXPECT_THAT(RefusalOf(Changed("\"A\": 90", bad)), HasSubstr("p.json:4: ")) << bad;
  }
  EXPECT_THAT(RefusalOf(Changed("\"D\": 1", "\"D\": -0.1")), HasSubstr("'materials.floor.gsab.D' is -0.1"));
  EXPECT_THAT(RefusalOf(Changed("\"paper\"", "\"papper\"")),
              HasSubstr("p.json:1: 'model' is \"papper\", expected one of paper, acoustic, coherent"));
  EXPECT_THAT(RefusalOf(Changed("\"display\"", "\"jitter\": {\"growth\": \"cubic\"},\n\"display\"")),
              HasSubstr("'jitter.growth' is \"cubic\", expected one of root, linear"));
  EXPECT_THAT(RefusalOf(Changed("\"display\"", "\"receiver\": {\"looks\": 0},\n\"display\"")),
              HasSubstr("'receiver.looks' is 0, expected a number > 0"));
  EXPECT_THAT(RefusalOf(Changed(
                  "\"display\"",
                  "\"water\": {\"temperature_c\": 288, \"salinity_ppt\": 0, \"ph\": 7, \"depth_m\": 1},\n"
                  "\"display\"")),
              HasSubstr("'water.temperature_c' is 288, expected a number >= -4 and <= 100"));
}

TEST(ParametersIoTest, BeamPatternsAreNamedAndTheirTablesOdd) {
  const auto with_beam = [](const std::string& members) {
    return Changed("\"display\"", "\"beam\": {" + members + "},\n\"display\"");
  };
  const BeamParameters aperture =
      ParseParameters(with_beam(R"("azimuth_pattern": "aperture", "azimuth_taper": 0.4)"), "p.json").beam;
  EXPECT_EQ(aperture.azimuth_pattern, AzimuthPattern::kAperture);
  EXPECT_EQ(aperture.azimuth_taper, 0.4);
  EXPECT_EQ(ParseParameters(kExample, "p.json").beam.azimuth_pattern, AzimuthPattern::kAperture);
  EXPECT_EQ(ParseParameters(kExample, "p.json").beam.elevation_pattern, ElevationPattern::kCosine);
  const BeamParameters table =
      ParseParameters(with_beam(R"("azimuth_pattern": "table", "azimuth_table_db": [-9, 0, -8])"), "p.json")
          .beam;
  EXPECT_EQ(table.azimuth_table_db, (std::vector<double>{-9.0, 0.0, -8.0}));

  EXPECT_EQ(RefusalOf(with_beam(R"("azimuth_pattern": "sinc")")),
            "p.json:2: 'beam.azimuth_pattern' is \"sinc\", expected one of gaussian, aperture, table");
  EXPECT_EQ(RefusalOf(with_beam(R"("azimuth_taper": 1.1)")),
            "p.json:2: 'beam.azimuth_taper' is 1.1, expected a number >= 0 and <= 1");
  for (const char* bad : {"[-9, 0]", "[]", "[0]"}) {
    EXPECT_THAT(RefusalOf(with_beam(std::string(R"("azimuth_table_db": )") + bad)),
                HasSubstr("'beam.azimuth_table_db' has "))
        << bad;
  }
  EXPECT_THAT(RefusalOf(with_beam(R"("azimuth_table_db": [0, 1, 0])")),
              HasSubstr("azimuth_table_db[1]' is 1"));
  EXPECT_EQ(RefusalOf(with_beam(R"("azimuth_pattern": "table")")),
            "p.json:2: 'beam' has the azimuth pattern \"table\" but no azimuth_table_db");
}

TEST(ParametersIoTest, SendingEndsBehindWhereItIsEven) {
  const auto with_beam = [](std::string_view beam) {
    return Changed("\"display\"", "\"beam\": " + std::string(beam) + ",\n\"display\"");
  };
  const auto beam =
      ParseParameters(with_beam(R"({"transmit_even_deg": 24, "transmit_end_deg": 45})"), "p.json").beam;
  EXPECT_EQ(beam.transmit_even_deg, 24.0);
  EXPECT_EQ(beam.transmit_end_deg, 45.0);
  EXPECT_THAT(RefusalOf(with_beam(R"({"transmit_even_deg": 24})")),
              HasSubstr("ends sending at 0 degrees, expected no less than transmit_even_deg, 24"));
  EXPECT_THAT(RefusalOf(with_beam(R"({"transmit_end_deg": 91})")),
              HasSubstr("'beam.transmit_end_deg' is 91"));
}

TEST(ParametersIoTest, MirrorsAreNamedByMaterialAndLoseWhatTheyReflect) {
  const auto with_mirror = [](std::string_view mirror) {
    return Changed("\"display\"", "\"mirror\": " + std::string(mirror) + ",\n\"display\"");
  };
  const ParameterSet set = ParseParameters(with_mirror(R"({"floor": {"loss_db": 10.46}})"), "p.json");
  ASSERT_EQ(set.mirrors.size(), 1U);
  EXPECT_EQ(set.mirrors.at("floor").loss_db, 10.46);
  EXPECT_TRUE(ParseParameters(kExample, "p.json").mirrors.empty());
  EXPECT_THAT(RefusalOf(with_mirror(R"({"floor": {"loss_db": -0.1}})")),
              HasSubstr("'mirror.floor.loss_db' is -0.1"));
  EXPECT_THAT(RefusalOf(with_mirror(R"({"floor": {}})")), HasSubstr("'mirror.floor.loss_db' is missing"));
  EXPECT_THAT(RefusalOf(with_mirror(R"({"floor": {"loss_db": 3, "order": 2}})")),
              HasSubstr("unknown key 'mirror.floor.order'"));
}

TEST(ParametersIoTest, MissingRequiredKeysAreRefusedByName) {
  EXPECT_THAT(RefusalOf("{}"), HasSubstr("p.json:1: required key 'format' is missing"));
  EXPECT_THAT(RefusalOf(Changed("sonar-parameters/1", "sonar-parameters/9")),
              HasSubstr("p.json:1: 'format' is \"sonar-parameters/9\", expected one of sonar-parameters/1"));
  EXPECT_THAT(RefusalOf(Changed("\"E\": 90, ", "")),
              HasSubstr("p.json:4: required key 'materials.floor.gsab.E' is missing"));
  EXPECT_THAT(RefusalOf(R"({"format": "sonar-parameters/1", "model": "paper", "materials": {}})"),
              HasSubstr("p.json:1: 'materials' is empty, expected at least one material"));
}

TEST(ParametersIoTest, MoreMaterialsThanASceneCanHaveAreRefused) {
  std::string materials;
  std::string mirrors;
  for (std::size_t i = 0; i <= kMaxMaterials; ++i) {
    const std::string_view separator = i == 0 ? "" : ", ";
    materials +=
        fmt::format(R"({}"m{}": {{"gsab": {{"A": 90, "B_deg": 4, "C": 100, "D": 1, "E": 90, "F_deg": 8}}}})",
                    separator, i);
    mirrors += fmt::format(R"({}"m{}": {{"loss_db": 3}})", separator, i);
  }
  EXPECT_THAT(
      RefusalOf(R"({"format": "sonar-parameters/1", "model": "paper", "materials": {)" + materials + "}}"),
      HasSubstr("p.json:1: 'materials' has 4097 members, expected at most 4096"));
  EXPECT_THAT(RefusalOf(Changed(R"("model")", R"("mirror": {)" + mirrors + R"(}, "model")")),
              HasSubstr("'mirror' has 4097 members, expected at most 4096"));
}

TEST(ParametersIoTest, ParametersThatCannotBeReadBackAreNotWritten) {
  const testing::TempDir dir;
  ParameterSet set = UnlikeTheDefaults();
  set.materials["floor"].gsab.b_deg = -1.0;
  EXPECT_THROW(WriteParameters(dir / "p.json", set), DataError);
  set = UnlikeTheDefaults();
  set.display.db_min = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(WriteParameters(dir / "p.json", set), DataError);
  EXPECT_FALSE(std::filesystem::exists(dir / "p.json"));
}

TEST(ParametersIoTest, DamagedFilesAreReadOrRefused) {
  const std::string text = JsonText(ParametersJson(UnlikeTheDefaults()));
  testing::ExpectSurvivesDamage(text, text.size(), 2000,
                                [](const std::string& t) { ParseParameters(t, "p"); });
}

}  // namespace
}  // namespace sonarcal::data_io
