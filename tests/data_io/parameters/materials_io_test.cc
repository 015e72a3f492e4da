#include "data_io/parameters/materials_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "data_io/json/json_writer.h"
#include "data_io/parameters/parameters_io.h"
#include "tests/data_io/refusal.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::data_io {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::MessageOf;
using testing::TempDir;
using testing::WriteFile;

NamedMaterial TankFloor() {
  return {.name = "tank floor",
          .centre = {0.1, 1.0 / 3.0, 2e-3, 1.8, 0.01, 11.0},
          .spread = {1.2, 1.1, 1.05, 0.1, 1.3, 1.4},
          .level_db = 200.0,
          .frequency_min_hz = 900e3,
          .frequency_max_hz = 900e3,
          .source = "fit to the synthetic recording tank",
          .comment = "Spreads are standard errors.",
          .origin = MaterialOrigin{.recording = "tank", .synthetic = true, .program = "sonarcal 0.1.0"}};
}

TEST(MaterialsIo, AWrittenFileReadsBackAsTheSameMaterials) {
  const TempDir dir;
  NamedMaterial published = FindMaterial("silt", BuiltInMaterials());
  published.name = "silt of mine";
  WriteJson(dir / "m.json", MaterialsJson({published, TankFloor()}));
  EXPECT_EQ(ReadMaterials(dir / "m.json"), (std::vector<NamedMaterial>{published, TankFloor()}));
  EXPECT_EQ(KnownMaterials({dir / "m.json"}).size(), BuiltInMaterials().size() + 2);
  EXPECT_THAT(MessageOf([&] {
                KnownMaterials({dir / "m.json", dir / "m.json"});
              }),
              HasSubstr("is also in another file"));
}

TEST(MaterialsIo, MistakesAreRefusedWithFileAndKey) {
  const TempDir dir;
  const auto refusal = [&](const char* pointer, const nlohmann::ordered_json& value) {
    nlohmann::ordered_json json = MaterialsJson({TankFloor()});
    json["materials"]["tank floor"][nlohmann::ordered_json::json_pointer(pointer)] = value;
    WriteJson(dir / "m.json", json);
    return MessageOf([&] { ReadMaterials(dir / "m.json"); });
  };
  EXPECT_THAT(refusal("/gsab/A/factor", 1.0), AllOf(HasSubstr("m.json:"), HasSubstr("gsab.A.factor")));
  EXPECT_THAT(refusal("/gsab/D/factor", 2.0), HasSubstr("unknown key"));
  EXPECT_THAT(refusal("/gsab/C/centre", 0.0), HasSubstr("gsab.C.centre"));
  EXPECT_THAT(refusal("/frequency_hz", {2e6, 1e6}), HasSubstr("is not [lowest, highest] frequency"));
  nlohmann::ordered_json json = MaterialsJson({FindMaterial("silt", BuiltInMaterials())});
  WriteJson(dir / "m.json", json);
  EXPECT_THAT(MessageOf([&] { ReadMaterials(dir / "m.json"); }), HasSubstr("name of a built-in material"));
}

constexpr const char* kPriorOnly = R"({"format": "sonar-parameters/1", "model": "acoustic",
 "materials": {"floor": {"prior": "sand:medium"}}})";

TEST(MaterialsIo, ParametersMayNameAPriorInPlaceOfACurveWhereAFitBegins) {
  const TempDir dir;
  WriteFile(dir / "p.json", kPriorOnly);
  const ParameterSet start = ReadStartParameters(dir / "p.json", BuiltInMaterials());
  EXPECT_EQ(start.materials.at("floor").prior, "sand:medium");
  EXPECT_EQ(start.materials.at("floor").gsab, FindMaterial("sand:medium", BuiltInMaterials()).centre);
  EXPECT_THAT(MessageOf([&] { ReadParameters(dir / "p.json"); }),
              AllOf(HasSubstr("p.json:2"), HasSubstr("a prior is no value")));
  EXPECT_EQ(ParseParameters(JsonText(ParametersJson(start)), "p.json"), start) << "the prior stays";
}

TEST(MaterialsIo, AnUnknownPriorIsRefusedWithTheNearestName) {
  const TempDir dir;
  WriteFile(dir / "p.json", R"({"format": "sonar-parameters/1", "model": "acoustic",
 "materials": {"floor": {"prior": "sand:medum"}}})");
  EXPECT_THAT(MessageOf([&] { ReadStartParameters(dir / "p.json", BuiltInMaterials()); }),
              AllOf(HasSubstr("p.json:2"), HasSubstr("did you mean 'sand:medium'?")));
  WriteFile(dir / "p.json", R"({"format": "sonar-parameters/1", "model": "paper",
 "materials": {"floor": {"prior": "silt"}}})");
  EXPECT_THAT(MessageOf([&] { ReadStartParameters(dir / "p.json", BuiltInMaterials()); }),
              HasSubstr("is one of the acoustic model"));
}

}  // namespace
}  // namespace sonarcal::data_io
