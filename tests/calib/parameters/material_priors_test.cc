// Priors of named materials in fits of one SYNTHETIC curve (tests/calib/curve_model.h): a wide prior does not
// move what the data determine, and decides what they do not.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "calib/fit.h"
#include "core/types/error.h"
#include "core/types/units.h"
#include "sim/paper/paper_values.h"
#include "tests/calib/curve_model.h"

namespace sonarcal::calib {
namespace {

using testing::CurveModel;

constexpr GsabParameters<double> kTruth = {
    .a = 0.126, .b_deg = 5.5, .c = 0.01, .d = 1.3, .e = 0.025, .f_deg = 17.0};

ParameterSet Acoustic() {
  ParameterSet parameters;
  parameters.model = EchoModel::kAcoustic;
  return parameters;
}

// Without a named prior: no prior at all, so that nothing but the data decides.
ModelFit FitCurve(const CurveModel& model, const std::string& material, std::vector<std::string> fixed = {}) {
  FitConfig config{.free = std::vector<std::string>{"materials"}, .fixed = std::move(fixed)};
  if (material.empty()) {
    config.priors["*"] = std::nullopt;
  } else {
    AddMaterialPriors("plate", FindMaterial(material, BuiltInMaterials()), Acoustic(), kUnknownLevelDb,
                      config);
  }
  FitOptions options;
  options.starts = 1;
  options.threads = 1;
  options.search_level = false;
  options.test_others = false;
  return Fit(model, model.truth(), config, options);
}

TEST(MaterialPriors, AWidePriorDoesNotMoveACurveThatTheDataDetermine) {
  const CurveModel model({.truth = kTruth, .pixels = 600, .least_pixels = 120});
  const ModelFit without = FitCurve(model, "");
  for (const NamedMaterial& material : BuiltInMaterials()) {
    if (material.model != EchoModel::kAcoustic) continue;
    const ModelFit with = FitCurve(model, material.name);
    ASSERT_TRUE(with.usable);
    const FittedCurve& curve = with.report.curves.at(0);
    const FittedCurve& data_only = without.report.curves.at(0);
    double largest = 0.0;  // in standard errors
    for (std::size_t deg = 0; deg <= 80; ++deg) {
      const double moved = std::abs(curve.backscatter_db[deg] - data_only.backscatter_db[deg]);
      largest = std::max(largest, moved / data_only.sigma_db[deg]);
      EXPECT_NEAR(curve.sigma_db[deg], data_only.sigma_db[deg], 0.05 * data_only.sigma_db[deg]) << deg;
    }
    fmt::print("{}: moves the curve by {:.3f} standard errors at most\n", material.name, largest);
    EXPECT_LT(largest, 0.1) << material.name;
  }
}

TEST(MaterialPriors, WhatTheDataDoNotDetermineHasCentreAndStandardErrorOfThePrior) {
  // No pixel within 50 degrees of normal incidence, where the specular peak of 5.5 degrees is.
  const CurveModel model({.truth = kTruth, .pixels = 200, .first_angle = 50});
  const std::vector<std::string> fixed = {"*.B_deg", "*.E", "*.F_deg"};
  const ModelFit with = FitCurve(model, "sand:medium", fixed);
  ASSERT_TRUE(with.usable);
  const GsabParameters<double> prior = FindMaterial("sand:medium", BuiltInMaterials()).centre;
  const double spread = FindMaterial("sand:medium", BuiltInMaterials()).spread.a;
  const double sigma_of_log = std::hypot(std::log(spread), std::log(PowerFromDb(kUnknownLevelDb)));

  const FittedParameter* a = with.report.Find("material.plate.gsab.A");
  EXPECT_EQ(a->status, ParameterStatus::kUnidentifiable);
  EXPECT_NEAR(a->value, prior.a, 1e-3 * prior.a);
  ASSERT_TRUE(a->prior.has_value());
  EXPECT_NEAR(a->prior->value, prior.a, 1e-12);
  EXPECT_NEAR(a->prior->sigma / a->prior->value, sigma_of_log, 1e-12);

  // At normal incidence: S = A + C + E, of which only A is uncertain.
  const GsabParameters<double> fitted = {a->value,
                                         kTruth.b_deg,
                                         with.report.Find("material.plate.gsab.C")->value,
                                         with.report.Find("material.plate.gsab.D")->value,
                                         kTruth.e,
                                         kTruth.f_deg};
  const double share = fitted.a / (fitted.a + fitted.c + fitted.e);
  const double expected_db = 10.0 / std::log(10.0) * sigma_of_log * share;
  const FittedCurve& curve = with.report.curves.at(0);
  EXPECT_NEAR(curve.sigma_db[0], expected_db, 0.02 * expected_db);
  EXPECT_LT(curve.sigma_db[60], 0.5) << "where the data are, they decide";
  EXPECT_FALSE(curve.determined[0]);
  EXPECT_TRUE(curve.determined[60]);
  fmt::print("sigma at 0 degrees {:.2f} dB, of the prior {:.2f} dB; at 60 degrees {:.2f} dB\n",
             curve.sigma_db[0], expected_db, curve.sigma_db[60]);

  const ModelFit without = FitCurve(model, "", fixed);
  EXPECT_FALSE(without.report.curves.size() == 1 && std::isfinite(without.report.curves[0].sigma_db[0]) &&
               without.report.curves[0].sigma_db[0] < 2.0 * expected_db)
      << "the data determine the peak: this test shows nothing";
}

TEST(MaterialPriors, APriorOfTheConfigurationCountsMore) {
  FitConfig config;
  config.priors = {{"material.floor.gsab.A", {{0.3, 0.1}}}, {"*.D", std::nullopt}};
  AddMaterialPriors("floor", FindMaterial("silt", BuiltInMaterials()), Acoustic(), 0.0, config);
  EXPECT_EQ(config.priors.at("material.floor.gsab.A")->first, 0.3);
  EXPECT_FALSE(config.priors.contains("material.floor.gsab.D"));
  const auto& [centre, sigma] = *config.priors.at("material.floor.gsab.C");
  EXPECT_NEAR(DbFromPower(centre), -29.0, 1e-9);
  EXPECT_NEAR(sigma / centre, std::log(PowerFromDb(13.0)), 1e-9) << "a calibrated level adds nothing";
  AddMaterialPriors("floor", FindMaterial("rock", BuiltInMaterials()), Acoustic(), 0.0, config);
  EXPECT_NEAR(DbFromPower(config.priors.at("material.floor.gsab.C")->first), -29.0, 1e-9)
      << "the first stays";
}

TEST(MaterialPriors, ThePapersSetBelongsToThePapersModel) {
  EXPECT_EQ(FindMaterial("park-2024", BuiltInMaterials()).level_db, sim::kPaperBlackBelowSourceDb);
  FitConfig config;
  EXPECT_THAT(
      [&] {
        AddMaterialPriors("floor", FindMaterial("park-2024", BuiltInMaterials()), Acoustic(), 20.0, config);
      },
      ::testing::ThrowsMessage<DataError>(::testing::HasSubstr("paper model")));
}

}  // namespace
}  // namespace sonarcal::calib
