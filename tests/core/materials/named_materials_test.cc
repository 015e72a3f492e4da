#include "core/materials/named_materials.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "core/types/error.h"
#include "core/types/parameter_table.h"
#include "core/types/units.h"

namespace sonarcal {
namespace {

using ::testing::HasSubstr;

TEST(NamedMaterials, EachIsWideAndLiesWithinTheBoundsOfAFit) {
  std::set<std::string> names;
  for (const NamedMaterial& material : BuiltInMaterials()) {
    EXPECT_TRUE(names.insert(material.name).second) << material.name;
    EXPECT_FALSE(material.source.empty()) << material.name;
    EXPECT_FALSE(material.origin) << material.name;
    EXPECT_THAT(material.comment, HasSubstr("our judgement")) << material.name;
    EXPECT_GT(material.frequency_min_hz, 0.0) << material.name;
    EXPECT_GE(material.frequency_max_hz, material.frequency_min_hz) << material.name;
    VisitParameters(material.centre, [&](const ParameterInfo& info, double centre) {
      const double spread = ParameterMember<const double>(material.spread, info.key);
      const bool logarithmic = info.scale == ParameterScale::kLogarithmic;
      EXPECT_GE(logarithmic ? std::log(spread) : spread, info.step * (1.0 - 1e-12))
          << material.name << " " << info.key << ": narrower than the default prior";
      if (material.model != EchoModel::kAcoustic) return;
      EXPECT_GT(centre, info.acoustic_fit->lower) << material.name << " " << info.key;
      EXPECT_LT(centre, info.acoustic_fit->upper) << material.name << " " << info.key;
    });
    EXPECT_LT(material.centre.b_deg, material.centre.f_deg) << material.name;
  }
  for (const char* name : {"clay", "silt", "sand:fine", "sand:medium", "sand:coarse", "gravel", "cobble",
                           "rock", "concrete", "steel", "rubber", "water-surface", "park-2024"}) {
    EXPECT_TRUE(names.contains(name)) << name;
  }
}

TEST(NamedMaterials, RockFollowsLambertsLawWithMinus27Db) {
  const NamedMaterial& rock = FindMaterial("rock", BuiltInMaterials());
  EXPECT_NEAR(DbFromPower(rock.centre.c), -27.0, 1e-9);
  EXPECT_EQ(rock.centre.d, 2.0);
}

TEST(NamedMaterials, ThePapersSetIsItsTable4) {
  const NamedMaterial& paper = FindMaterial("park-2024", BuiltInMaterials());
  EXPECT_EQ(paper.model, EchoModel::kPaper);
  EXPECT_EQ(paper.centre, (GsabParameters<double>{90.0, 4.0, 100.0, 1.0, 90.0, 8.0}));
}

// A second way: the density of slopes at zero, 1 / (2 pi s^2), times R^2 / 4, for s the RMS slope.
TEST(NamedMaterials, TheSpecularAmplitudeIsThatOfFacets) {
  const double slope = 0.1;
  const double b_deg = DegFromRad(std::atan(slope));
  const double reflection = 0.5;  // of an impedance ratio of 3
  const double facets = reflection * reflection / 4.0 / (2.0 * std::numbers::pi * slope * slope);
  EXPECT_NEAR(SpecularAmplitude(3.0, b_deg), facets, 1e-12);
  EXPECT_NEAR(SpecularAmplitude(1.0 / 3.0, b_deg), facets, 1e-12) << "the sign of R does not matter";
  EXPECT_EQ(SpecularAmplitude(1.0, b_deg), 0.0);
}

TEST(NamedMaterials, AMisspeltNameIsRefusedWithTheNearestOne) {
  EXPECT_THAT([] { FindMaterial("sand:medum", BuiltInMaterials()); },
              ::testing::ThrowsMessage<DataError>(HasSubstr("did you mean 'sand:medium'?")));
  EXPECT_THAT([] { FindMaterial("xylophone", BuiltInMaterials()); },
              ::testing::ThrowsMessage<DataError>(HasSubstr("expected one of clay, silt")));
}

TEST(NamedMaterials, AmplitudesAreScaledToTheLevelOfTheParameters) {
  ParameterSet parameters;
  parameters.model = EchoModel::kAcoustic;
  parameters.source_level_db = 200.0;
  parameters.receiver.gain_db = 10.0;
  NamedMaterial material = FindMaterial("silt", BuiltInMaterials());
  EXPECT_EQ(CentreFor(material, parameters), material.centre) << "backscattering strength per unit area";
  material.level_db = 200.0;  // 10 dB below the parameters: their echoes are stronger, so amplitudes are less
  const GsabParameters<double> centre = CentreFor(material, parameters);
  EXPECT_NEAR(centre.a, 0.1 * material.centre.a, 1e-12);
  EXPECT_NEAR(centre.c, 0.1 * material.centre.c, 1e-12);
  EXPECT_NEAR(centre.e, 0.1 * material.centre.e, 1e-12);
  EXPECT_EQ(centre.b_deg, material.centre.b_deg);
  EXPECT_EQ(centre.d, material.centre.d);
  parameters.model = EchoModel::kPaper;
  EXPECT_THAT([&] { CentreFor(material, parameters); },
              ::testing::ThrowsMessage<DataError>(HasSubstr("acoustic model")));
}

}  // namespace
}  // namespace sonarcal
