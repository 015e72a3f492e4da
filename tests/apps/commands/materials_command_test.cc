// Named materials on the command line: the list, a fit that takes a prior, an export that gives one.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/materials/named_materials.h"
#include "data_io/parameters/materials_io.h"
#include "data_io/parameters/parameters_io.h"
#include "tests/apps/tiny_world.h"

namespace sonarcal::commands {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::IsOneSentence;
using testing::Outcome;
using testing::Quoted;
using testing::ReadJsonFile;
using testing::RunSonarcal;
using testing::TinyWorld;

TEST(MaterialsCommand, ListsAllMaterialsAndShowsOne) {
  const Outcome list = RunSonarcal("materials --list");
  ASSERT_EQ(list.status, 0) << list.err;
  for (const NamedMaterial& material : BuiltInMaterials()) EXPECT_THAT(list.out, HasSubstr(material.name));
  const json all = json::parse(RunSonarcal("materials --json").out);
  EXPECT_EQ(all["materials"].size(), BuiltInMaterials().size());
  const Outcome one = RunSonarcal("materials sand:medium");
  EXPECT_THAT(one.out, AllOf(HasSubstr("TR 9407"), HasSubstr("our judgement"), HasSubstr("10..100 kHz")));
  const Outcome wrong = RunSonarcal("materials sand:medum");
  EXPECT_EQ(wrong.status, 1);
  EXPECT_TRUE(IsOneSentence(wrong.err)) << wrong.err;
  EXPECT_THAT(wrong.err, HasSubstr("did you mean 'sand:medium'?"));
  EXPECT_EQ(RunSonarcal("materials --list silt").status, 2);
}

constexpr const char* kPriors = "--material floor=sand:medium,box=concrete";

class MaterialsOfAFit : public ::testing::Test {
 protected:
  MaterialsOfAFit() { data_io::WriteParameters(world_.params(), testing::TinyAcousticParameters()); }

  std::string Arguments(const std::string& out, const std::string& extra) const {
    return "fit --real " + Quoted(real()) + " --scene " + Quoted(world_.scene()) + " --params " +
           Quoted(world_.params()) + " --out " + Quoted(world_ / out) +
           " --rays 96x200 --starts 1 --trust-all --held-out 3 " + extra;
  }

  std::filesystem::path real() const { return world_ / "real"; }

  TinyWorld world_;
};

TEST_F(MaterialsOfAFit, APriorDoesNotMoveCurvesThatTheFramesDetermine) {
  world_.WriteSimulated("real", true);
  const std::string free = "--free 'material.*.gsab.C,material.*.gsab.D' ";
  ASSERT_EQ(RunSonarcal(Arguments("without", free)).status, 0);
  const Outcome outcome = RunSonarcal(Arguments("with", free + kPriors));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("material 'floor' has the prior of sand:medium"),
                                 HasSubstr("its band, 10 to 100 kHz, does not contain 900 kHz")));
  const json with = ReadJsonFile(world_ / "with/fit.json");
  const json without = ReadJsonFile(world_ / "without/fit.json");
  int determined = 0;
  for (const json& parameter : with["parameters"]) {
    determined += parameter["status"] == "free" ? 1 : 0;
    if (parameter["name"] != "material.floor.gsab.C") continue;
    EXPECT_NEAR(std::log10(parameter["prior"][0].get<double>()), -2.3, 1e-9);
  }
  ASSERT_EQ(determined, 4) << "the frames do not determine all of C and D: this test shows nothing";
  double largest = 0.0;
  for (std::size_t i = 0; i < with["curves"].size(); ++i) {
    for (std::size_t deg = 0; deg <= 80; ++deg) {
      const double moved = with["curves"][i]["backscatter_db"][deg].get<double>() -
                           without["curves"][i]["backscatter_db"][deg].get<double>();
      largest = std::max(largest, std::abs(moved) / without["curves"][i]["sigma_db"][deg].get<double>());
    }
  }
  fmt::print("the priors move the curves by {:.3f} standard errors at most\n", largest);
  EXPECT_LT(largest, 0.1);
}

TEST_F(MaterialsOfAFit, TheResultIsThePriorOfTheNextFit) {
  world_.WriteSimulated("real", true);
  const std::string free = "--free 'material.*' ";
  const Outcome outcome = RunSonarcal(Arguments("with", free + kPriors));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json with = ReadJsonFile(world_ / "with/fit.json");
  const std::filesystem::path file = world_ / "materials.json";
  const Outcome exported = RunSonarcal("export --to materials --fit " + Quoted(world_ / "with/fit.json") +
                                       " --recording " + Quoted(real()) + " --out " + Quoted(file));
  ASSERT_EQ(exported.status, 0) << exported.err;
  EXPECT_THAT(exported.out, HasSubstr("(synthetic)"));
  const std::vector<NamedMaterial> materials = data_io::ReadMaterials(file);
  ASSERT_EQ(materials.size(), 2U);
  const NamedMaterial& floor = materials[1];
  EXPECT_EQ(floor.name, "floor");
  EXPECT_EQ(floor.centre, data_io::ReadParameters(world_ / "with/params.json").materials.at("floor").gsab);
  EXPECT_EQ(floor.level_db, 200.0);
  EXPECT_EQ(floor.frequency_min_hz, 900e3);
  ASSERT_TRUE(floor.origin.has_value());
  EXPECT_TRUE(floor.origin->synthetic);
  EXPECT_THAT(floor.origin->program, HasSubstr("sonarcal "));
  for (const json& parameter : with["parameters"]) {
    if (parameter["name"] != "material.floor.gsab.D" || parameter["status"] != "free") continue;
    EXPECT_EQ(floor.spread.d, parameter["sigma"].get<double>()) << "the standard error";
  }
  const Outcome shown = RunSonarcal("materials floor --materials " + Quoted(file));
  EXPECT_THAT(shown.out, HasSubstr("fit to the synthetic recording"));
  const Outcome again =
      RunSonarcal(Arguments("again", free + "--material floor=floor --materials " + Quoted(file)));
  EXPECT_EQ(again.status, 0) << again.err;
}

TEST_F(MaterialsOfAFit, MistakesAreRefusedInOneSentence) {
  world_.WriteSimulated("real", true);
  const auto refusal = [&](const std::string& extra, int status) {
    const Outcome outcome = RunSonarcal(Arguments("out", "-q " + extra));
    EXPECT_EQ(outcome.status, status) << extra;
    EXPECT_TRUE(IsOneSentence(outcome.err)) << outcome.err;
    return outcome.err;
  };
  EXPECT_THAT(refusal("--material sand:medium", 2),
              HasSubstr("expected MATERIAL=NAME with one of floor, box"));
  EXPECT_THAT(refusal("--material floor=sand:medum", 1), HasSubstr("did you mean 'sand:medium'?"));
  EXPECT_THAT(refusal("--material flor=silt", 1), HasSubstr("did you mean 'floor'?"));
  EXPECT_THAT(refusal("--material floor=park-2024", 1), HasSubstr("is one of the paper model"));
  EXPECT_THAT(RunSonarcal("export --to materials --recording " + Quoted(real()) + " --out m.json").err,
              HasSubstr("needs --fit"));
}

}  // namespace
}  // namespace sonarcal::commands
